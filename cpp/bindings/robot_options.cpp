#include "bindings/robot_options.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace manutec_r3::bindings {
namespace {

using robot::Model;

[[noreturn]] void refuse(const std::string& option, const std::string& expected,
                         const py::handle& got) {
  throw std::invalid_argument(option + ": expected " + expected + ", got " +
                              py::repr(got).cast<std::string>());
}

// 'a', 'b' or 'c'
template <std::size_t n>
std::string listed(const robot::Names<n>& names, const std::string& last = "") {
  std::string list;
  for (std::size_t k = 0; k < n; ++k) {
    const bool ends = last.empty() && k + 1 == n;
    list += (k == 0 ? "'" : ends ? " or '" : ", '") + std::string(names[k]) + "'";
  }
  return last.empty() ? list : list + " or " + last;
}

template <class Value, std::size_t n>
Value named(const std::string& option, const py::handle& got, const robot::Names<n>& names,
            const std::string& last = "") {
  if (py::isinstance<py::str>(got)) {
    const auto place = std::ranges::find(names, got.cast<std::string>());
    if (place != names.end()) return static_cast<Value>(place - names.begin());
  }
  refuse(option, listed(names, last), got);
}

// One for all axes, or one for each.
void read_couplings(const py::handle& got, Model model, robot::Options& options) {
  if (py::isinstance<py::str>(got)) {
    options.coupling.fill(named<robot::Coupling>("rotor_coupling", got, robot::coupling_names));
    return;
  }
  const int n = robot::n_axes(model);
  if (!py::isinstance<py::sequence>(got) || static_cast<int>(py::len(got)) != n) {
    refuse("rotor_coupling", listed(robot::coupling_names, std::to_string(n) + " of them"), got);
  }
  int i = 0;
  for (const py::handle of_axis : got) {
    options.coupling[i] = named<robot::Coupling>("rotor_coupling of axis " + std::to_string(i + 1),
                                                 of_axis, robot::coupling_names);
    ++i;
  }
}

}  // namespace

Model model_named(const py::object& model) {
  if (py::isinstance<py::int_>(model) && !py::isinstance<py::bool_>(model)) {
    for (int number = 1; number <= 4; ++number) {
      if (model.equal(py::int_(number))) return static_cast<Model>(number);
    }
  } else if (py::isinstance<py::str>(model)) {
    for (const Model candidate : {Model::full_robot, Model::one_axis}) {
      if (model.cast<std::string>() == robot::name_of(candidate)) return candidate;
    }
  }
  refuse("model", "1, 2, 3, 4, 'full-robot' or 'one-axis'", model);
}

py::object as_python(Model model) {
  if (robot::is_modelica(model)) return py::str(robot::name_of(model));
  return py::int_(static_cast<int>(model));
}

py::dict as_dict(const robot::Options& options, Model model) {
  py::dict dict;
  dict["controller"] = py::none();
  if (options.controller != robot::Controller::none) {
    dict["controller"] = robot::name_of(options.controller, robot::controller_names);
  }
  py::list coupling;
  for (int i = 0; i < robot::n_axes(model); ++i) {
    coupling.append(robot::name_of(options.coupling[i], robot::coupling_names));
  }
  dict["rotor_coupling"] = py::tuple(coupling);
  dict["gear_damping"] = robot::name_of(options.gear_damping, robot::gear_damping_names);
  dict["stiction"] = robot::name_of(options.stiction, robot::stiction_names);
  dict["stiffness"] = options.stiffness;
  dict["arm"] = robot::name_of(options.arm, robot::arm_names);
  dict["creep_rate"] = options.creep_rate;
  dict["voltage_limit"] = py::none();
  if (options.voltage_limit < std::numeric_limits<double>::infinity()) {
    dict["voltage_limit"] = options.voltage_limit;
  }
  return dict;
}

robot::Options options_from(const py::dict& dict, Model model) {
  robot::Options options = robot::default_options(model);
  if (dict.contains("controller")) {
    const py::object got = dict["controller"];
    options.controller = got.is_none() ? robot::Controller::none
                                       : named<robot::Controller>("controller", got,
                                                                  robot::controller_names, "None");
  }
  if (dict.contains("rotor_coupling")) read_couplings(dict["rotor_coupling"], model, options);
  if (dict.contains("gear_damping")) {
    options.gear_damping =
        named<drive::GearDamping>("gear_damping", dict["gear_damping"], robot::gear_damping_names);
  }
  if (dict.contains("stiction")) {
    options.stiction = named<robot::Stiction>("stiction", dict["stiction"], robot::stiction_names);
  }
  if (dict.contains("stiffness")) options.stiffness = dict["stiffness"].cast<double>();
  if (dict.contains("arm")) {
    options.arm = named<robot::ArmData>("arm", dict["arm"], robot::arm_names);
  }
  if (dict.contains("creep_rate")) options.creep_rate = dict["creep_rate"].cast<double>();
  if (dict.contains("voltage_limit")) options.voltage_limit = dict["voltage_limit"].cast<double>();
  return options;
}

}  // namespace manutec_r3::bindings
