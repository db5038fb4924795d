#include "robot/options.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace manutec_r3::robot {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
  throw std::invalid_argument(option + ": expected " + why);
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
      refuse("controller", "'continuous' or None" + for_model);
    }
    if (options.coupling != usual.coupling) refuse("rotor_coupling", "'simplified'" + for_model);
  }
  if (!has_real_gears(model)) {
    if (options.gear_damping != usual.gear_damping) {
      refuse("gear_damping", "'parallel'" + for_model + ", whose gears are ideal");
    }
    if (options.stiction != usual.stiction) {
      refuse("stiction", "'exact'" + for_model + ", which has no friction");
    }
  } else if (n_axes(model) <= drive::n_elastic && options.stiction != usual.stiction) {
    refuse("stiction", "'exact'" + for_model + ", whose rigid gears do not move");
  }
  if (n_axes(model) != 3 && options.arm != usual.arm) {
    refuse("arm", "'six-arm'" + for_model);
  }
  if (!(std::isfinite(options.stiffness) && options.stiffness > 0.0)) {
    std::ostringstream why;
    why << "a positive k [N m/rad, N m s/rad], got " << options.stiffness;
    refuse("stiffness", why.str());
  }
  if (!(std::isfinite(options.creep_rate) && options.creep_rate >= 0.0)) {
    std::ostringstream why;
    why << "a finite rate of 0 rad/s or more, got " << options.creep_rate;
    refuse("creep_rate", why.str());
  }
  if (std::isinf(options.voltage_limit) && options.voltage_limit > 0.0) return;
  if (is_modelica(model) || options.controller == Controller::none) {
    refuse("voltage_limit", "none" + for_model + " without the report's rate controllers");
  }
  if (!(std::isfinite(options.voltage_limit) && options.voltage_limit > 0.0)) {
    std::ostringstream why;
    why << "a positive voltage [V], got " << options.voltage_limit;
    refuse("voltage_limit", why.str());
  }
}

}  // namespace manutec_r3::robot
