// Bodies, load and rotors of the models' mechanisms (spec 3, spec 6, spec 7).
#include "arm/mechanism.hpp"

namespace manutec_r3::arm {
namespace {

// The recursions take the joint of the lumped arm from `six_arms`.
static_assert(lumped_arm_3.axis == six_arms[2].axis);
static_assert(lumped_arm_3.offset == six_arms[2].offset);

Moments moments(const Load& load) { return point_mass(load.mass, load.position); }

RotorTerms rotor_terms(int j, double p, RotorCoupling coupling) {
  const double rJ = rotors[j].inertia;
  // Rotor 1 sits in the base, which rests: there is nothing to couple it with.
  const bool carried = coupling == RotorCoupling::full && j > 0;
  const bool separate = coupling == RotorCoupling::separate;
  return {carried ? p * rJ : 0, separate ? 0 : p * p * rJ};
}

}  // namespace

template <int N>
Mechanism<N>::Mechanism(const std::array<Moments, N>& arms, const std::array<double, N>& gear_ratio,
                        const std::array<RotorCoupling, N>& coupling)
    : arms_(arms) {
  for (int j = 0; j < N; ++j) rotors_[j] = rotor_terms(j, gear_ratio[j], coupling[j]);
}

Mechanism<6> six_arm_mechanism(const Load& load, const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling) {
  std::array<Moments, 6> arms;
  for (int j = 0; j < 6; ++j) arms[j] = moments(six_arms[j].body);
  arms[5] += moments(load);
  return {arms, gear_ratio, coupling};
}

Mechanism<3> lumped_mechanism(const Load& load, const std::array<double, 3>& gear_ratio,
                              const std::array<RotorCoupling, 3>& coupling) {
  Load above_joint_3 = load;
  above_joint_3.position[2] += h5_distance;

  std::array<Moments, 3> arms = {moments(six_arms[0].body), moments(six_arms[1].body),
                                 moments(lumped_arm_3.body)};
  arms[2] += moments(above_joint_3);
  return {arms, gear_ratio, coupling};
}

template class Mechanism<3>;
template class Mechanism<6>;

}  // namespace manutec_r3::arm
