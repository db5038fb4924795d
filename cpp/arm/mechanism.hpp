// The moving arms, their load and their rotors, prepared for the recursions (spec 3, spec 6).
//
// Equations of motion, with the joint torques tau (with ideal gears tau_j = p_j rF_j):
//
//   M(q) qdd + bias(q, qd) = tau
//
// The axes of the joints are the same in every variant of the robot and known at compile time;
// masses, offsets of joints and rotors vary. The report's layout is known at compile time, too.
#pragma once

#include <array>

#include "arm/load.hpp"
#include "arm/moments.hpp"
#include "arm/parameters.hpp"

namespace manutec_r3::arm {

// What the equations of motion of the arms contain of a rotor (spec 6).
enum class RotorCoupling {
  full,        // it is carried by the preceding arm and spins there: all terms
  simplified,  // its axis is fixed in inertial space: p^2 rJ on the diagonal of M
  separate,    // an elastic gear, the rotor has states of its own: nothing
};

// Terms of one rotor on a rigid gear, rq = p aq.
struct RotorTerms {
  double p_rJ;   // p rJ, couples the spin with the arm that carries the rotor; 0 unless full
  double p2_rJ;  // p^2 rJ, felt by its own joint; 0 if separate
};

// N moving arms: 6, or 3 with the joints of the wrist blocked, or 1. A value that nothing changes.
template <int N>
class Mechanism {
 public:
  // `table` for the offsets of the joints and gravity; moments about the origin of each arm's
  // frame, the last with the load.
  Mechanism(const Table3& table, const std::array<Moments, N>& arms,
            const std::array<double, 6>& gear_ratio, const std::array<RotorCoupling, 6>& coupling);

  const Moments& arm(int j) const { return arms_[j]; }
  // Where joint j is in the frame of arm j-1 [m].
  const Triple& offset(int j) const { return offsets_[j]; }
  // Whether joints are displaced and rotors turn as in the report, see planar.hpp.
  bool has_layout_of_report() const { return has_layout_of_report_; }
  double gravity() const { return gravity_; }

  const RotorTerms& rotor(int j) const { return rotors_[j]; }
  // The axis about which rotor j turns, in the frame of arm j-1: a unit vector.
  const Triple& rotor_axis(int j) const { return rotor_axes_[j]; }

 private:
  std::array<Moments, N> arms_;
  std::array<Triple, N> offsets_;
  std::array<Triple, N> rotor_axes_;
  bool has_layout_of_report_;
  double gravity_;
  std::array<RotorTerms, N> rotors_;
};

// Models 1 and 3, and the Modelica variant.
Mechanism<6> six_arm_mechanism(const Table3& table, const Load& load,
                               const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling);

// Models 2 and 4: arms 3 to 6 are the lumped arm 3, from which the load is as far as from arm 3 of
// the six.
Mechanism<3> lumped_mechanism(const Table3& table, const Load& load,
                              const std::array<double, 6>& gear_ratio,
                              const std::array<RotorCoupling, 6>& coupling);

// The same with the data of all six arms, joints 4 to 6 at zero.
Mechanism<3> blocked_mechanism(const Table3& table, const Load& load,
                               const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling);

// Arm 1 alone.
Mechanism<1> one_arm_mechanism(const Table3& table, const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling);

// Where the load is in the frame of the last of N moving arms, the others at zero [m].
template <int N>
std::array<double, 3> load_in_last_arm(const Table3& table, const Load& load) {
  std::array<double, 3> position = load.position;
  for (int j = N; j < n_axes; ++j) {
    for (int k = 0; k < 3; ++k) position[k] += table.arms[j].offset[k];
  }
  return position;
}

extern template class Mechanism<1>;
extern template class Mechanism<3>;
extern template class Mechanism<6>;

}  // namespace manutec_r3::arm
