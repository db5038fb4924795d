// The moving arms, their load and their rotors, prepared for the recursions (spec 3, spec 6).
//
// Equations of motion, with the joint torques tau (with ideal gears tau_j = p_j rF_j):
//
//   M(q) qdd + bias(q, qd) = tau
//
// Axes and offsets of the joints are the same in every variant of the robot and are read from
// `six_arms` at compile time; only masses and rotors vary.
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

// N moving arms: 6, or 3 with the joints of the wrist blocked. A value that nothing changes.
template <int N>
class Mechanism {
 public:
  Mechanism(const std::array<Moments, N>& arms, const std::array<double, N>& gear_ratio,
            const std::array<RotorCoupling, N>& coupling);

  // Moments about the origin of the arm's frame; the last arm contains the load.
  const Moments& arm(int j) const { return arms_[j]; }

  const RotorTerms& rotor(int j) const { return rotors_[j]; }

 private:
  std::array<Moments, N> arms_;
  std::array<RotorTerms, N> rotors_;
};

// Models 1 and 3.
Mechanism<6> six_arm_mechanism(const Load& load, const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling);

// Models 2 and 4: arms 3 to 6 are the lumped arm 3.
Mechanism<3> lumped_mechanism(const Load& load, const std::array<double, 3>& gear_ratio,
                              const std::array<RotorCoupling, 3>& coupling);

extern template class Mechanism<3>;
extern template class Mechanism<6>;

}  // namespace manutec_r3::arm
