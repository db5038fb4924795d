#include "robot/robot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace manutec_r3::robot {
namespace {

using arm::RotorCoupling;

std::array<RotorCoupling, 6> coupling(const Options& options, int n_separate) {
  std::array<RotorCoupling, 6> coupling;
  for (int i = 0; i < 6; ++i) {
    const bool full = options.coupling[i] == Coupling::full;
    coupling[i] = i < n_separate ? RotorCoupling::separate
                  : full         ? RotorCoupling::full
                                 : RotorCoupling::simplified;
  }
  return coupling;
}

// Rotors of the first `n_separate` axes have states of their own.
Robot::AnyMechanism mechanism(int n_axes, const arm::Load& load, const Options& options,
                              const Tables& tables, int n_separate) {
  const std::array<RotorCoupling, 6> of_rotors = coupling(options, n_separate);
  const drive::Row& p = tables.gear_ratio();
  if (n_axes == 1) return one_arm_mechanism(tables.table_3, p, of_rotors);
  if (n_axes == 6) return six_arm_mechanism(tables.table_3, load, p, of_rotors);
  if (options.arm == ArmData::six_arm) {
    return blocked_mechanism(tables.table_3, load, p, of_rotors);
  }
  return lumped_mechanism(tables.table_3, load, p, of_rotors);
}

const arm::Load& checked(Model model, const arm::Load& load) {
  arm::check(load);
  if (model == Model::one_axis && load != default_load(model)) {
    throw std::invalid_argument(
        "load: expected none for model one-axis; its inertia at the joint is I33 of arm 1");
  }
  return load;
}

const Options& checked(Model model, const Options& options) {
  check(model, options);
  return options;
}

const Tables& checked(const Tables& tables, int n_axes, double voltage_limit) {
  check(tables);
  if (const auto* table_1 = std::get_if<drive::Table1>(&tables.table_1)) {
    const double widest = *std::max_element(table_1->dead_zone_half_width.begin(),
                                            table_1->dead_zone_half_width.begin() + n_axes);
    if (voltage_limit <= widest) {
      std::ostringstream message;
      message << "voltage_limit: expected more than the dead zones' a, " << widest << " V, got "
              << voltage_limit << " V";
      throw std::invalid_argument(message.str());
    }
  }
  return tables;
}

}  // namespace

Robot::Robot(Model model, const arm::Load& load, const Options& options, const Tables& tables)
    : model_(model),
      load_(checked(model, load)),
      options_(checked(model, options)),
      tables_(checked(tables, n_axes(), options.voltage_limit)),
      arm_(mechanism(n_axes(), load_, options_, tables_, 0)),
      arm_behind_gears_(mechanism(n_axes(), load_, options_, tables_, n_elastic())) {
  name_states();
  name_indicators();
}

std::vector<ElementKind> Robot::elements() const {
  if (std::isinf(options_.voltage_limit)) return {dead_zone, torque_limit, backlash, friction};
  return {dead_zone, torque_limit, voltage_limit, backlash, friction};
}

int Robot::friction_side(int axis) const {
  const bool joint = is_modelica(model_) && axis >= drive::n_elastic;
  return joint && gear_ratio()[axis] < 0.0 ? -1 : +1;
}

void Robot::name_states() {
  const auto add = [this](const char* name, const char* unit, double nominal, int size,
                          const drive::Row& of_axis = {1, 1, 1, 1, 1, 1}) {
    if (size == 0) return;
    std::vector<double> nominals(of_axis.begin(), of_axis.begin() + size);
    for (double& value : nominals) value *= nominal;
    states_.push_back({name, unit, nominals, n_states(), size});
  };
  // Nominal values are of the order that a state reaches in the benchmark motion. Angles have a
  // much smaller one: their control errors, some 1e-2 rad, are to be accurate.
  add("joint_angle", "rad", 1e-2, n_axes());
  add("joint_rate", "rad/s", 1.0, n_axes());
  add("deflection", "rad", 0.1, n_elastic());
  add("rotor_rate", "rad/s", 50.0, n_elastic());
  if (!has_controller()) return;
  if (const auto* table_1 = std::get_if<drive::Table1>(&tables_.table_1)) {
    add("tachogenerator_1", "V", 1.0, n_axes());
    add("tachogenerator_2", "V", 1.0, n_axes());
    add("tachogenerator_3", "V/s", 2e3, n_axes());
    add("filter", "V", 1.0, n_axes());
    add("controller", "V", 0.1, n_axes());
    add("voltage", "V", 1.0, n_axes());
    // What a motor makes of a quarter of a volt: those of axes 4 to 6 are much weaker.
    add("pt2_torque", "N m", 0.25, n_axes(), table_1->K_M);
    add("pt2_torque_rate", "N m/s", 0.25 * 5e3, n_axes(), table_1->K_M);
  } else {
    add("controller", "rad/s", 1.0, n_axes());
    add("voltage", "V", 10.0, n_axes());
    add("current", "A", 0.2, n_axes());
  }
}

void Robot::name_indicators() {
  const auto add = [this](const char* name, int n) {
    if (n > 0) indicators_.push_back({name, n_indicators(), 2 * n});
  };
  const int electrical = has_controller() && !is_modelica(model_) ? n_axes() : 0;
  add("dead_zone", electrical);
  add("torque_limit", electrical);
  add("friction", has_real_gears() ? n_axes() : 0);
  add("backlash", n_elastic());
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
  const int n = robot.n_axes();
  if (motion.n_axes() != n && !(n == 3 && motion.n_axes() == 6)) {
    throw std::invalid_argument(
        "motion: expected " + std::to_string(n) + (n == 1 ? " axis" : " axes") + " for model " +
        name_of(robot.model()) + ", got " + std::to_string(motion.n_axes()));
  }
  for (int i = robot.n_axes(); i < motion.n_axes(); ++i) {
    if (!motion.rests_at_zero(i)) {
      throw std::invalid_argument("motion of axis " + std::to_string(i + 1) +
                                  ": expected exactly 0 rad, where model " +
                                  name_of(robot.model()) + " has a brake, got a motion");
    }
  }
}

}  // namespace manutec_r3::robot
