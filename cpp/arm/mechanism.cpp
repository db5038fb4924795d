// Bodies, load and rotors of the models' mechanisms (spec 3, spec 6, spec 7).
#include "arm/mechanism.hpp"

#include "arm/planar.hpp"

namespace manutec_r3::arm {
namespace {

RotorTerms rotor_terms(int j, double rJ, double p, RotorCoupling coupling) {
  // Rotor 1 sits in the base, which rests: there is nothing to couple it with.
  const bool carried = coupling == RotorCoupling::full && j > 0;
  const bool separate = coupling == RotorCoupling::separate;
  return {carried ? p * rJ : 0, separate ? 0 : p * p * rJ};
}

template <int N>
Moments moments_of_load(const Table3& table, const Load& load) {
  return point_mass(load.mass, load_in_last_arm<N>(table, load));
}

// The body of arm j in the frame of arm `frame`, joints between them at zero.
Moments body_seen_from(const Table3& table, int frame, int j) {
  Body body = table.arms[j].body;
  for (int i = frame + 1; i <= j; ++i) {
    for (int k = 0; k < 3; ++k) body.centre[k] += table.arms[i].offset[k];
  }
  return moments(body);
}

}  // namespace

template <int N>
Mechanism<N>::Mechanism(const Table3& table, const std::array<Moments, N>& arms,
                        const std::array<double, 6>& gear_ratio,
                        const std::array<RotorCoupling, 6>& coupling)
    : arms_(arms), has_layout_of_report_(true), gravity_(table.gravity) {
  for (int j = 0; j < N; ++j) {
    const auto [x, y, z] = table.arms[j].offset;
    offsets_[j] = {x, y, z};
    const Axis rn = table.rotor_axes[j];
    rotor_axes_[j] = {rn == Axis::x ? 1.0 : 0.0, rn == Axis::y ? 1.0 : 0.0,
                      rn == Axis::z ? 1.0 : 0.0};
    has_layout_of_report_ = has_layout_of_report_ && x == 0 && y == 0 &&
                            (z == 0 || is_displaced_in_report(j)) && rn == rotor_axes_of_report[j];
    // Whatever is in arm 1 turns about the vertical, and the last arm contains the load.
    const auto& [m, h, J] = arms[j];
    const bool is_symmetrical = h.y == 0 && J.xy == 0 && J.yz == 0;
    has_layout_of_report_ = has_layout_of_report_ && (is_symmetrical || j == 0 || j == N - 1);
    rotors_[j] = rotor_terms(j, table.rotor_inertia[j], gear_ratio[j], coupling[j]);
  }
}

Mechanism<6> six_arm_mechanism(const Table3& table, const Load& load,
                               const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling) {
  std::array<Moments, 6> arms;
  for (int j = 0; j < 6; ++j) arms[j] = moments(table.arms[j].body);
  arms[5] += moments_of_load<6>(table, load);
  return {table, arms, gear_ratio, coupling};
}

Mechanism<3> lumped_mechanism(const Table3& table, const Load& load,
                              const std::array<double, 6>& gear_ratio,
                              const std::array<RotorCoupling, 6>& coupling) {
  std::array<Moments, 3> arms = {moments(table.arms[0].body), moments(table.arms[1].body),
                                 moments(table.lumped_arm_3)};
  arms[2] += moments_of_load<3>(table, load);
  return {table, arms, gear_ratio, coupling};
}

Mechanism<3> blocked_mechanism(const Table3& table, const Load& load,
                               const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling) {
  std::array<Moments, 3> arms;
  for (int j = 0; j < 3; ++j) arms[j] = moments(table.arms[j].body);
  for (int j = 3; j < 6; ++j) arms[2] += body_seen_from(table, 2, j);
  arms[2] += moments_of_load<3>(table, load);
  return {table, arms, gear_ratio, coupling};
}

Mechanism<1> one_arm_mechanism(const Table3& table, const std::array<double, 6>& gear_ratio,
                               const std::array<RotorCoupling, 6>& coupling) {
  return {table, {moments(table.arms[0].body)}, gear_ratio, coupling};
}

template class Mechanism<1>;
template class Mechanism<3>;
template class Mechanism<6>;

}  // namespace manutec_r3::arm
