#include "robot/robot.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace manutec_r3::robot {
namespace {

using arm::RotorCoupling;

// Rotors of axes 1 to 3 in models 3 and 4 are treated as if their axes were fixed in space
// (spec 5.2); all others are fully coupled (spec 11).
template <std::size_t N>
std::array<RotorCoupling, N> coupling(int n_elastic, RotorCoupling of_elastic) {
  std::array<RotorCoupling, N> coupling;
  coupling.fill(RotorCoupling::full);
  std::fill_n(coupling.begin(), n_elastic, of_elastic);
  return coupling;
}

Robot::AnyMechanism mechanism(int n_axes, const arm::Load& load, int n_elastic,
                              RotorCoupling of_elastic) {
  if (n_axes == 6) {
    return six_arm_mechanism(load, drive::gear_ratio, coupling<6>(n_elastic, of_elastic));
  }
  std::array<double, 3> ratio;
  std::copy_n(drive::gear_ratio.begin(), 3, ratio.begin());
  return lumped_mechanism(load, ratio, coupling<3>(n_elastic, of_elastic));
}

int checked_model(int model) {
  if (model >= 1 && model <= 4) return model;
  throw std::invalid_argument("model: expected 1, 2, 3 or 4, got " + std::to_string(model));
}

const arm::Load& checked_load(const arm::Load& load) {
  arm::check(load);
  return load;
}

}  // namespace

Robot::Robot(int model, const arm::Load& load, Controller controller)
    : model_(checked_model(model)),
      load_(checked_load(load)),
      controller_(controller),
      arm_(mechanism(n_axes(), load, n_elastic(), RotorCoupling::simplified)),
      arm_behind_gears_(mechanism(n_axes(), load, n_elastic(), RotorCoupling::separate)) {
  const auto add_states = [this](const char* name, const char* unit, double nominal, int size,
                                 const drive::Row& of_axis = {1, 1, 1, 1, 1, 1}) {
    if (size == 0) return;
    std::vector<double> nominals(of_axis.begin(), of_axis.begin() + size);
    for (double& value : nominals) value *= nominal;
    states_.push_back({name, unit, nominals, n_states(), size});
  };
  const int n = n_axes();
  const int electrical = has_controller() ? n : 0;
  // Nominal values are of the order that a state reaches in the benchmark motion. Angles have a
  // much smaller one: their control errors, some 1e-2 rad, are to be accurate.
  add_states("joint_angle", "rad", 1e-2, n);
  add_states("joint_rate", "rad/s", 1.0, n);
  add_states("deflection", "rad", 0.1, n_elastic());
  add_states("rotor_rate", "rad/s", 50.0, n_elastic());
  add_states("tachogenerator_1", "V", 1.0, electrical);
  add_states("tachogenerator_2", "V", 1.0, electrical);
  add_states("tachogenerator_3", "V/s", 2e3, electrical);
  add_states("filter", "V", 1.0, electrical);
  add_states("controller", "V", 0.1, electrical);
  add_states("voltage", "V", 1.0, electrical);
  // What a motor makes of a quarter of a volt: those of axes 4 to 6 are much weaker.
  add_states("pt2_torque", "N m", 0.25, electrical, drive::K_M);
  add_states("pt2_torque_rate", "N m/s", 0.25 * 5e3, electrical, drive::K_M);

  const auto add_indicators = [this](const char* name, int n_axes) {
    if (n_axes > 0) indicators_.push_back({name, n_indicators(), 2 * n_axes});
  };
  add_indicators("dead_zone", electrical);
  add_indicators("torque_limit", electrical);
  add_indicators("friction", has_real_gears() ? n : 0);
  add_indicators("backlash", n_elastic());
}

int Robot::first_state(std::string_view name) const {
  const auto group = std::ranges::find(states_, name, &StateGroup::name);
  return group == states_.end() ? n_states() : group->first;
}

int Robot::n_states() const {
  return states_.empty() ? 0 : states_.back().first + states_.back().size;
}

int Robot::n_indicators() const {
  return indicators_.empty() ? 0 : indicators_.back().first + indicators_.back().size;
}

void check_motion(const Robot& robot, const motion::Motion& motion) {
  if (motion.n_axes() < robot.n_axes()) {
    throw std::invalid_argument("motion: expected 6 axes for model " +
                                std::to_string(robot.model()) + ", got " +
                                std::to_string(motion.n_axes()));
  }
  for (int i = robot.n_axes(); i < motion.n_axes(); ++i) {
    if (!motion.rests_at_zero(i)) {
      throw std::invalid_argument("motion of axis " + std::to_string(i + 1) +
                                  ": expected exactly 0 rad, where model " +
                                  std::to_string(robot.model()) + " has a brake, got a motion");
    }
  }
}

}  // namespace manutec_r3::robot
