// Elastic gear with backlash of axes 1 to 3 (spec 5.2; report Figure 4, Table 2):
//
//   delta = rq - p aq,   delta' = rq' - p aq'          (deflection, seen from the rotor)
//   NL4:  s = delta - b for delta > b,  0 for |delta| <= b,  delta + b for delta < -b
//   tau   = c s + d delta'                             (torque that the gear takes from the rotor)
//
// The damper acts in parallel to the spring with its backlash, also inside the gap. Axis 3 has no
// backlash: its gear is always in contact.
#pragma once

#include "drive/line.hpp"
#include "drive/parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

using PerElasticAxis = PerAxis<n_elastic>;

struct ElasticGear {
  PerElasticAxis c = ConstView<n_elastic>(stiffness.data());
  PerElasticAxis d = ConstView<n_elastic>(damping.data());
  PerElasticAxis b = ConstView<n_elastic>(backlash_half_width.data());
  Line<n_elastic> NL4;  // s from delta, on the present branches

  bool has_backlash(int axis) const { return b[axis] > 0.0; }

  void set_branch(int axis, int branch) {
    if (has_backlash(axis)) {
      NL4.set_dead_zone(axis, branch, b[axis]);
    } else {
      NL4.set(axis, 1.0, 0.0);
    }
  }

  PerElasticAxis torque(const PerElasticAxis& delta, const PerElasticAxis& delta_rate) const {
    return c * NL4(delta) + d * delta_rate;
  }

  // The deflection at which the gear at rest transmits this torque [N m] (axis 0, 1 or 2).
  double deflection_under(int axis, double tau) const {
    return tau == 0.0 ? 0.0 : tau / c[axis] + (tau > 0.0 ? b[axis] : -b[axis]);
  }
};

}  // namespace manutec_r3::drive
