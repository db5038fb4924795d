#include "robot/options.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace manutec_r3::robot {
namespace {

template <class Got>
[[noreturn]] void refuse(const std::string& option, const std::string& expected, const Got& got) {
  std::ostringstream message;
  message << option << ": expected " << expected << ", got " << got;
  throw std::invalid_argument(message.str());
}

template <class Value, std::size_t n>
[[noreturn]] void refuse_named(const std::string& option, const std::string& expected, Value got,
                               const Names<n>& names) {
  refuse(option, expected, "'" + std::string(name_of(got, names)) + "'");
}

}  // namespace

std::string name_of(Model model) {
  if (model == Model::full_robot) return "full-robot";
  if (model == Model::one_axis) return "one-axis";
  return std::to_string(static_cast<int>(model));
}

Options default_options(Model model) {
  Options options = {
      .controller = Controller::continuous,
      .coupling = {},
      .gear_damping = drive::GearDamping::parallel,
      .stiction = Stiction::exact,
      .stiffness = 1e7,
      .arm = n_axes(model) == 3 ? ArmData::lumped : ArmData::six_arm,
      .creep_rate = 1e-9,
      .voltage_limit = std::numeric_limits<double>::infinity(),
  };
  // Rotors behind elastic gears are treated as if their axes were fixed in space (spec 5.2), and
  // so are all rotors of the Modelica variant.
  options.coupling.fill(is_modelica(model) ? Coupling::simplified : Coupling::full);
  std::fill_n(options.coupling.begin(), n_elastic(model), Coupling::simplified);
  return options;
}

void check(Model model, const Options& options) {
  const std::string for_model = " for model " + name_of(model);
  const Options usual = default_options(model);
  if (is_modelica(model)) {
    if (options.controller != Controller::continuous && options.controller != Controller::none) {
      refuse_named("controller", "'continuous' or None" + for_model, options.controller,
                   controller_names);
    }
    for (int i = 0; i < n_axes(model); ++i) {
      if (options.coupling[i] == usual.coupling[i]) continue;
      refuse_named("rotor_coupling of axis " + std::to_string(i + 1),
                   "'simplified'" + for_model + ", whose rotors are not carried",
                   options.coupling[i], coupling_names);
    }
  }
  if (options.gear_damping != usual.gear_damping && !has_real_gears(model)) {
    refuse_named("gear_damping", "'parallel'" + for_model + ", whose gears are ideal",
                 options.gear_damping, gear_damping_names);
  }
  if (options.stiction != usual.stiction && n_axes(model) == n_elastic(model)) {
    refuse_named("stiction", "'exact'" + for_model + ", whose gears are all elastic",
                 options.stiction, stiction_names);
  }
  if (options.stiction != usual.stiction && !has_real_gears(model)) {
    refuse_named("stiction", "'exact'" + for_model + ", which has no friction", options.stiction,
                 stiction_names);
  }
  if (options.arm != usual.arm && n_axes(model) != 3) {
    refuse_named("arm", "'six-arm'" + for_model + ", whose joints 4 to 6 are not blocked",
                 options.arm, arm_names);
  }
  if (!(std::isfinite(options.stiffness) && options.stiffness > 0.0)) {
    refuse("stiffness", "a positive k [N m/rad, N m s/rad]", options.stiffness);
  }
  if (!(std::isfinite(options.creep_rate) && options.creep_rate >= 0.0)) {
    refuse("creep_rate", "a finite rate of 0 rad/s or more", options.creep_rate);
  }
  if (std::isinf(options.voltage_limit) && options.voltage_limit > 0.0) return;
  if (!(std::isfinite(options.voltage_limit) && options.voltage_limit > 0.0)) {
    refuse("voltage_limit", "a positive voltage [V]", options.voltage_limit);
  }
  if (is_modelica(model) || options.controller == Controller::none) {
    const std::string where = is_modelica(model) ? for_model : " with controller=None";
    refuse("voltage_limit", "none" + where + ", which has no rate controllers of the report",
           options.voltage_limit);
  }
}

}  // namespace manutec_r3::robot
