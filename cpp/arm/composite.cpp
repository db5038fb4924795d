// Composite bodies: outwards the motion of each arm at qdd = 0; on the way back the arms beyond
// each joint as one rigid body, and what its acceleration takes (spec 6).
//
// Joint j is where two frames meet: its axis has the same components in the directions of arm j and
// of arm j-1. What passes a joint is therefore turned first, and then looked at: about the origin
// of arm j, in the directions of arm j-1.
#include "arm/composite.hpp"

#include "arm/planar.hpp"
#include "arm/sines_and_cosines.hpp"
#include "arm/solve.hpp"

namespace manutec_r3::arm {
namespace {

// K = [w']x + [w]x [w]x, by columns: the points of an arm accelerate with a(r) = a + K r.
template <class Number>
struct Gradient {
  TripleOf<Number> x, y, z;
};

template <class Number>
Gradient<Number> gradient(const TripleOf<Number>& w, const TripleOf<Number>& wd) {
  const Number xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
  const Number xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
  return {{-(yy + zz), xy + wd.z, xz - wd.y},
          {xy - wd.z, -(xx + zz), yz + wd.x},
          {xz + wd.y, yz - wd.x, -(xx + yy)}};
}

// force = integral a(r) dm, torque = integral r x a(r) dm.
template <class Number>
Wrench<Number> wrench(const Moments& arm, const TripleOf<Number>& a, const Gradient<Number>& K) {
  const auto& [m, h, J] = arm;
  const Triple Jx = {J.xx, J.xy, J.xz}, Jy = {J.xy, J.yy, J.yz}, Jz = {J.xz, J.yz, J.zz};
  return {cross(h, a) + cross(Jx, K.x) + cross(Jy, K.y) + cross(Jz, K.z),
          m * a + h.x * K.x + h.y * K.y + h.z * K.z};
}

// The same for an arm that is symmetrical to its x-z plane, without what is zero.
template <class Number>
Wrench<Number> wrench_of_symmetrical(const Moments& arm, const TripleOf<Number>& a,
                                     const Gradient<Number>& K) {
  const auto& [m, h, J] = arm;
  return {{J.yy * K.y.z - J.zz * K.z.y - J.xz * K.x.y - h.z * a.y,
           J.zz * K.z.x - J.xx * K.x.z + J.xz * (K.x.x - K.z.z) + h.z * a.x - h.x * a.z,
           J.xx * K.x.y - J.yy * K.y.x + J.xz * K.z.y + h.x * a.y},
          m * a + h.x * K.x + h.z * K.z};
}

// The same for unit acceleration about an axis through the origin, from rest and without gravity.
template <Axis axis, class Number>
Wrench<Number> unit_acceleration(const MomentsOf<Number>& body) {
  const auto& [m, h, J] = body;
  if constexpr (axis == Axis::x) {
    return {{J.yy + J.zz, -J.xy, -J.xz}, {0, -h.z, h.y}};
  } else {
    return {{-J.xz, -J.yz, J.xx + J.yy}, {-h.y, h.x, 0}};
  }
}

// An arm and all arms beyond it: as one rigid body, and the wrench that their motion takes.
template <class Number>
struct CompositeOf {
  MomentsOf<Number> moments;
  Wrench<Number> bias;
};

template <int N, Layout layout, class Number>
struct Recursion {
  using Triple = TripleOf<Number>;
  using Wrench = arm::Wrench<Number>;
  using ArmMotion = arm::ArmMotion<Number>;
  using Gradient = arm::Gradient<Number>;
  using Composite = CompositeOf<Number>;

  const Mechanism<N>& mechanism;
  const std::array<Turn<Number>, N>& turns;
  const VectorView<N, Number>& qd;
  EquationsOfMotion<N, Number>& equations;

  // Flattened into one function: the recursion is fast if its numbers stay in registers.
  [[gnu::flatten]] void run() {
    // Arm 1 turns about the vertical, and only torques about the vertical matter to its joint:
    // neither its own motion at constant rate nor its weight takes one.
    const Moments& arm = mechanism.arm(0);
    Composite composite = {arm, {}};
    if constexpr (N > 1) {
      composite = sum<1>(arm, {}, {0, 0, qd[0]}, arm_and_beyond<1>(motion_of_arm_2()));
    }
    set_equation_of_joint<0>(composite);
  }

  // Arm j, which moves thus, and those beyond it, about the origin of arm j, in the directions of
  // arm j-1. Sets the bias of their joints, and the columns of M.
  template <int j>
  Composite arm_and_beyond(const ArmMotion& motion) {
    const Moments& arm = mechanism.arm(j);
    const Gradient K = gradient(motion.w, motion.wd);
    const Wrench bias = wrench_of<j>(arm, motion.a, K);
    Composite composite;
    if constexpr (constexpr int next = j + 1; next < N) {
      const Composite beyond = arm_and_beyond<next>(motion_of<next>(motion, K));
      composite = sum<next>(arm, bias, motion.w, beyond);
      equations.bias[next] += mechanism.rotor(next).p_rJ * along_rotor_axis<next>(motion.wd);
    } else {
      composite = {arm, bias};
    }
    composite = {rotated<j>(turns[j], composite.moments), rotated<j>(turns[j], composite.bias)};
    set_equation_of_joint<j>(composite);
    return composite;
  }

  // Arm j-1, which turns with w, and what is beyond joint j.
  template <int j>
  Composite sum(const Moments& arm, const Wrench& bias, const Triple& w, Composite beyond) const {
    shift<j, layout>(mechanism.offset(j), beyond.moments);
    shift<j, layout>(mechanism.offset(j), beyond.bias);
    // The rotor of joint j spins in arm j-1 with p qd.
    add_cross_rotor_axis<j>(mechanism.rotor(j).p_rJ * qd[j], w, beyond.bias.torque);
    return {arm + beyond.moments, bias + beyond.bias};
  }

  // What an arm's own motion takes. The arms of the report are symmetrical, but the load, which the
  // last one contains, may be anywhere.
  template <int j>
  static Wrench wrench_of(const Moments& arm, const Triple& a, const Gradient& K) {
    if constexpr (layout == Layout::report && j < N - 1) {
      return wrench_of_symmetrical(arm, a, K);
    } else {
      return wrench(arm, a, K);
    }
  }

  // Arm 2 at qdd = 0, carried by arm 1, which turns about the vertical. Gravity acts like a base
  // that is accelerated upwards.
  ArmMotion motion_of_arm_2() const {
    const auto [c, s] = turns[1];
    const Number w = qd[0], g = mechanism.gravity();
    ArmMotion arm_2 = {
        {qd[1], s * w, c * w}, {0, c * w * qd[1], -s * w * qd[1]}, {0, s * g, c * g}};
    if constexpr (layout == Layout::anything) {
      const auto& r = mechanism.offset(1);
      arm_2.a += rotated_back<1>(turns[1], {-w * w * r.x, -w * w * r.y, 0});
    }
    return arm_2;
  }

  // Arm j at qdd = 0, carried by arm j-1.
  template <int j>
  ArmMotion motion_of(const ArmMotion& inner, const Gradient& K) {
    constexpr Axis an = joint_axes[j];
    const Turn<Number>& turn = turns[j];
    ArmMotion outer = {rotated_back<j>(turn, inner.w), rotated_back<j>(turn, inner.wd),
                       rotated_back<j>(turn, acceleration_of_joint<j>(inner.a, K))};
    add_cross_unit<an>(qd[j], outer.w, outer.wd);
    along<an>(outer.w) += qd[j];
    return outer;
  }

  // How the place of joint j accelerates, from the origin of arm j-1.
  template <int j>
  Triple acceleration_of_joint(const Triple& a, const Gradient& K) const {
    const auto& r = mechanism.offset(j);
    if constexpr (layout == Layout::anything) {
      return a + r.x * K.x + r.y * K.y + r.z * K.z;
    } else if constexpr (is_displaced_in_report(j)) {
      return a + r.z * K.z;
    } else {
      return a;
    }
  }

  // <rn_j, v>; and adds value (v x rn_j), or value rn_j.
  template <int j>
  Number along_rotor_axis(const Triple& v) const {
    if constexpr (layout == Layout::report) {
      return along<rotor_axes_of_report[j]>(v);
    } else {
      return dot(mechanism.rotor_axis(j), v);
    }
  }
  template <int j>
  void add_cross_rotor_axis(const Number& value, const Triple& v, Triple& sum) const {
    if constexpr (layout == Layout::report) {
      add_cross_unit<rotor_axes_of_report[j]>(value, v, sum);
    } else {
      sum += value * cross(v, mechanism.rotor_axis(j));
    }
  }
  template <int j>
  void add_along_rotor_axis(double value, Triple& sum) const {
    if constexpr (layout == Layout::report) {
      along<rotor_axes_of_report[j]>(sum) += value;
    } else {
      sum += value * mechanism.rotor_axis(j);
    }
  }

  // From the arms beyond joint j, about the origin of arm j.
  template <int j>
  void set_equation_of_joint(const Composite& beyond) {
    constexpr Axis an = joint_axes[j];
    equations.bias[j] = along<an>(beyond.bias.torque);
    Wrench wrench = unit_acceleration<an>(beyond.moments);
    equations.M(j, j) = along<an>(wrench.torque) + mechanism.rotor(j).p2_rJ;
    if constexpr (j > 0) {
      add_along_rotor_axis<j>(mechanism.rotor(j).p_rJ, wrench.torque);
      set_column<j, j>(wrench);
    }
  }

  // The wrench that unit acceleration of joint j takes, about the origin of arm i, as the joints
  // i-1, .., 0 feel it.
  template <int i, int j>
  void set_column(Wrench wrench) {
    constexpr int inner = i - 1;
    shift<i, layout>(mechanism.offset(i), wrench);
    if constexpr (inner > 0) wrench = rotated<inner>(turns[inner], wrench);
    equations.M(inner, j) = along<joint_axes[inner]>(wrench.torque);
    if constexpr (inner > 0) set_column<inner, j>(wrench);
  }
};

// Of all joints but the first, whose angle has no effect.
template <int N, class Number>
std::array<Turn<Number>, N> turns_of(const VectorView<N, Number>& q) {
  constexpr int n = numbers::n_abreast<Number>;
  std::array<double, n*(N - 1)> angles;
  for (int j = 1; j < N; ++j) numbers::store(q[j], &angles[n * (j - 1)]);
  const auto [sine, cosine] = sines_and_cosines<n*(N - 1)>(angles);
  std::array<Turn<Number>, N> turns{};
  for (int j = 1; j < N; ++j) {
    turns[j] = {numbers::load<Number>(&cosine[n * (j - 1)]),
                numbers::load<Number>(&sine[n * (j - 1)])};
  }
  return turns;
}

}  // namespace

template <int N, class Number>
EquationsOfMotion<N, Number> equations_of_motion(const Mechanism<N>& mechanism,
                                                 const VectorView<N, Number>& q,
                                                 const VectorView<N, Number>& qd) {
  const std::array<Turn<Number>, N> turns = turns_of<N, Number>(q);
  EquationsOfMotion<N, Number> equations;
  if (mechanism.has_layout_of_report()) {
    Recursion<N, Layout::report, Number>{mechanism, turns, qd, equations}.run();
  } else {
    Recursion<N, Layout::anything, Number>{mechanism, turns, qd, equations}.run();
  }
  return equations;
}

template <int N>
Vector<N> forward_dynamics(const Mechanism<N>& mechanism, const VectorView<N>& q,
                           const VectorView<N>& qd, const VectorView<N>& tau) {
  const EquationsOfMotion<N> equations = equations_of_motion<N, double>(mechanism, q, qd);
  return solution<N, double>(equations.M, tau - equations.bias);
}

template EquationsOfMotion<1> equations_of_motion(const Mechanism<1>&, const VectorView<1>&,
                                                  const VectorView<1>&);
template EquationsOfMotion<3> equations_of_motion(const Mechanism<3>&, const VectorView<3>&,
                                                  const VectorView<3>&);
template EquationsOfMotion<6> equations_of_motion(const Mechanism<6>&, const VectorView<6>&,
                                                  const VectorView<6>&);
template EquationsOfMotion<1, numbers::Abreast> equations_of_motion(
    const Mechanism<1>&, const VectorView<1, numbers::Abreast>&,
    const VectorView<1, numbers::Abreast>&);
template EquationsOfMotion<3, numbers::Abreast> equations_of_motion(
    const Mechanism<3>&, const VectorView<3, numbers::Abreast>&,
    const VectorView<3, numbers::Abreast>&);
template EquationsOfMotion<6, numbers::Abreast> equations_of_motion(
    const Mechanism<6>&, const VectorView<6, numbers::Abreast>&,
    const VectorView<6, numbers::Abreast>&);
template Vector<1> forward_dynamics(const Mechanism<1>&, const VectorView<1>&, const VectorView<1>&,
                                    const VectorView<1>&);
template Vector<3> forward_dynamics(const Mechanism<3>&, const VectorView<3>&, const VectorView<3>&,
                                    const VectorView<3>&);
template Vector<6> forward_dynamics(const Mechanism<6>&, const VectorView<6>&, const VectorView<6>&,
                                    const VectorView<6>&);

}  // namespace manutec_r3::arm
