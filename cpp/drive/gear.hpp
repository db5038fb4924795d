// Elastic gears with backlash of axes 1 to 3 (spec 5.2; report Figure 4, Table 2):
//
//   delta = rq - p aq,   delta' = rq' - p aq'          (deflection, seen from the rotor)
//   NL4:  s = delta - b for delta > b,  0 for |delta| <= b,  delta + b for delta < -b
//   tau   = c s + d delta'                             (torque that the gear takes from the rotor)
//
// The damper acts in parallel to the spring with its backlash, also inside the gap; or, as an
// option, only in contact, that is, for |delta| > b (spec 11). A gear without backlash, such as
// that of axis 3, is always in contact.
#pragma once

#include "drive/line.hpp"
#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

enum class GearDamping {
  parallel,  // also inside the gap
  contact,   // the damper may pull, and tau jumps where teeth meet and part
};

// The gears of the first E axes.
template <int E>
struct ElasticGear {
  PerAxis<E> c, d, b;
  GearDamping damping;
  // On the present branches:
  Line<E> NL4;          // s from delta
  PerAxis<E> acting_d;  // the damping that acts

  ElasticGear(const Table2& table, GearDamping damping)
      : c(first<E>(table.stiffness)),
        d(first<E>(table.damping)),
        b(first<E>(table.backlash_half_width)),
        damping(damping),
        acting_d(d) {}

  bool has_backlash(int axis) const { return b[axis] > 0.0; }

  void set_branch(int axis, int branch) {
    NL4.set_dead_zone(axis, branch, b[axis]);
    const bool in_contact = branch != 0 || !has_backlash(axis);
    acting_d[axis] = in_contact || damping == GearDamping::parallel ? d[axis] : 0.0;
  }

  template <class Number>
  PerAxis<E, Number> torque(const PerAxis<E, Number>& delta,
                            const PerAxis<E, Number>& delta_rate) const {
    return c * NL4(delta) + acting_d * delta_rate;
  }

  // c s^2 / 2 [J].
  PerAxis<E> energy(const PerAxis<E>& delta) const { return c * NL4(delta).square() / 2.0; }

  // The deflection at which the gear at rest transmits this torque [N m].
  double deflection_under(int axis, double tau) const {
    return tau == 0.0 ? 0.0 : tau / c[axis] + (tau > 0.0 ? b[axis] : -b[axis]);
  }
};

}  // namespace manutec_r3::drive
