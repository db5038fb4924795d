// Composite bodies: outwards the motion of each arm at qdd = 0; on the way back the arms beyond
// each joint as one rigid body, and what its acceleration takes (spec 6).
#include "arm/composite.hpp"

#include "arm/planar.hpp"
#include "arm/solve.hpp"

namespace manutec_r3::arm {
namespace {

// K = [w']x + [w]x [w]x, by columns: the points of an arm accelerate with a(r) = a + K r.
struct Gradient {
  Triple x, y, z;
};

Gradient gradient(const Triple& w, const Triple& wd) {
  const double xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  const double xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
  return {{-yy - zz, xy + wd.z, xz - wd.y},
          {xy - wd.z, -xx - zz, yz + wd.x},
          {xz + wd.y, yz - wd.x, -xx - yy}};
}

// force = integral a(r) dm, torque = integral r x a(r) dm.
Wrench wrench(const Moments& arm, const Triple& a, const Gradient& K) {
  const auto& [m, h, J] = arm;
  const Triple Jx = {J.xx, J.xy, J.xz}, Jy = {J.xy, J.yy, J.yz}, Jz = {J.xz, J.yz, J.zz};
  return {cross(h, a) + cross(Jx, K.x) + cross(Jy, K.y) + cross(Jz, K.z),
          m * a + h.x * K.x + h.y * K.y + h.z * K.z};
}

// The same for unit acceleration about an axis through the origin, from rest and without gravity.
template <Axis axis>
Wrench unit_acceleration(const Moments& body) {
  const auto& [m, h, J] = body;
  if constexpr (axis == Axis::x) {
    return {{J.yy + J.zz, -J.xy, -J.xz}, {0, -h.z, h.y}};
  } else {
    return {{-J.xz, -J.yz, J.xx + J.yy}, {-h.y, h.x, 0}};
  }
}

// An arm and all arms beyond it: as one rigid body, and the wrench that their motion takes.
struct Composite {
  Moments moments;
  Wrench bias;
};

template <int N, Layout layout>
struct Recursion {
  const Mechanism<N>& mechanism;
  const std::array<Turn, N>& turns;
  const Vector<N>& qd;
  EquationsOfMotion<N>& equations;

  // Gravity acts like a base that is accelerated upwards, in arm 1 as in the world.
  // Flattened into one function: the recursion is fast if its numbers stay in registers.
  [[gnu::flatten]] void run() {
    arm_and_beyond<0>({{0, 0, qd[0]}, {0, 0, 0}, {0, 0, mechanism.gravity()}});
  }

  // Arm j, which moves thus, and those beyond it, in the frame of arm j. Sets their joints' bias,
  // and the columns of M.
  template <int j>
  Composite arm_and_beyond(const ArmMotion& motion) {
    const Moments& arm = mechanism.arm(j);
    const Gradient K = gradient(motion.w, motion.wd);
    Composite composite = {arm, wrench(arm, motion.a, K)};

    if constexpr (constexpr int next = j + 1; next < N) {
      const Composite outer = arm_and_beyond<next>(motion_of<next>(motion, K));
      const Triple& offset = mechanism.offset(next);
      composite.moments += seen_from_inner_arm<next, layout>(turns[next], offset, outer.moments);
      composite.bias += seen_from_inner_arm<next, layout>(turns[next], offset, outer.bias);

      // The rotor of the next joint spins in this arm with p qd.
      const double p_rJ = mechanism.rotor(next).p_rJ;
      composite.bias.torque += p_rJ * qd[next] * cross_rotor_axis<next>(motion.w);
      equations.bias[next] += p_rJ * along_rotor_axis<next>(motion.wd);
    }

    constexpr Axis an = joint_axes[j];
    equations.bias[j] = along<an>(composite.bias.torque);
    set_column<j, j>(unit_acceleration<an>(composite.moments));
    equations.M(j, j) += mechanism.rotor(j).p2_rJ;
    return composite;
  }

  // Arm j at qdd = 0, carried by arm j-1.
  template <int j>
  ArmMotion motion_of(const ArmMotion& inner, const Gradient& K) {
    constexpr Axis an = joint_axes[j];
    const Turn back = turns[j].inverse();
    ArmMotion outer = {rotated<j>(back, inner.w), rotated<j>(back, inner.wd),
                       rotated<j>(back, inner.a + lift<j>(K))};
    outer.wd += qd[j] * cross_unit<an>(outer.w);
    along<an>(outer.w) += qd[j];
    return outer;
  }

  // How the place of joint j accelerates against the origin of arm j-1.
  template <int j>
  Triple lift(const Gradient& K) const {
    const Triple& r = mechanism.offset(j);
    if constexpr (layout == Layout::anything) {
      return r.x * K.x + r.y * K.y + r.z * K.z;
    } else if constexpr (is_displaced_in_report(j)) {
      return r.z * K.z;
    } else {
      return {0, 0, 0};
    }
  }

  // <rn_j, v>, v x rn_j, and v + value rn_j.
  template <int j>
  double along_rotor_axis(const Triple& v) const {
    if constexpr (layout == Layout::report) {
      return along<rotor_axes_of_report[j]>(v);
    } else {
      return dot(mechanism.rotor_axis(j), v);
    }
  }
  template <int j>
  Triple cross_rotor_axis(const Triple& v) const {
    if constexpr (layout == Layout::report) {
      return cross_unit<rotor_axes_of_report[j]>(v);
    } else {
      return cross(v, mechanism.rotor_axis(j));
    }
  }
  template <int j>
  void add_along_rotor_axis(double value, Triple& v) const {
    if constexpr (layout == Layout::report) {
      along<rotor_axes_of_report[j]>(v) += value;
    } else {
      v += value * mechanism.rotor_axis(j);
    }
  }

  // The wrench that unit acceleration of joint j takes, as the joints i = j, j-1, .., 0 feel it.
  template <int i, int j>
  void set_column(const Wrench& wrench) {
    equations.M(i, j) = equations.M(j, i) = along<joint_axes[i]>(wrench.torque);
    if constexpr (i > 0) {
      Wrench inner = seen_from_inner_arm<i, layout>(turns[i], mechanism.offset(i), wrench);
      if constexpr (i == j) add_along_rotor_axis<j>(mechanism.rotor(j).p_rJ, inner.torque);
      set_column<i - 1, j>(inner);
    }
  }
};

}  // namespace

template <int N>
EquationsOfMotion<N> equations_of_motion(const Mechanism<N>& mechanism, const Vector<N>& q,
                                         const Vector<N>& qd) {
  std::array<Turn, N> turns;
  for (int j = 1; j < N; ++j) turns[j] = turn(q[j]);

  EquationsOfMotion<N> equations;
  if (mechanism.has_layout_of_report()) {
    Recursion<N, Layout::report>{mechanism, turns, qd, equations}.run();
  } else {
    Recursion<N, Layout::anything>{mechanism, turns, qd, equations}.run();
  }
  return equations;
}

template <int N>
Vector<N> forward_dynamics(const Mechanism<N>& mechanism, const Vector<N>& q, const Vector<N>& qd,
                           const Vector<N>& tau) {
  EquationsOfMotion<N> equations = equations_of_motion(mechanism, q, qd);
  Vector<N> qdd = tau - equations.bias;
  solve_in_place(equations.M, qdd);
  return qdd;
}

template EquationsOfMotion<1> equations_of_motion(const Mechanism<1>&, const Vector<1>&,
                                                  const Vector<1>&);
template EquationsOfMotion<3> equations_of_motion(const Mechanism<3>&, const Vector<3>&,
                                                  const Vector<3>&);
template EquationsOfMotion<6> equations_of_motion(const Mechanism<6>&, const Vector<6>&,
                                                  const Vector<6>&);
template Vector<1> forward_dynamics(const Mechanism<1>&, const Vector<1>&, const Vector<1>&,
                                    const Vector<1>&);
template Vector<3> forward_dynamics(const Mechanism<3>&, const Vector<3>&, const Vector<3>&,
                                    const Vector<3>&);
template Vector<6> forward_dynamics(const Mechanism<6>&, const Vector<6>&, const Vector<6>&,
                                    const Vector<6>&);

}  // namespace manutec_r3::arm
