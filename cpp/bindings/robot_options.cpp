#include "bindings/robot_options.hpp"

#include <pybind11/stl.h>

#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace manutec_r3::bindings {
namespace {

using robot::Model;

template <class Value>
using Names = std::vector<std::pair<const char*, Value>>;

const Names<robot::Controller> controllers = {{"continuous", robot::Controller::continuous},
                                              {"sampled", robot::Controller::sampled},
                                              {"external", robot::Controller::external}};
const Names<robot::Coupling> couplings = {{"full", robot::Coupling::full},
                                          {"simplified", robot::Coupling::simplified}};
const Names<drive::GearDamping> gear_dampings = {{"parallel", drive::GearDamping::parallel},
                                                 {"contact", drive::GearDamping::contact}};
const Names<robot::Stiction> stictions = {{"exact", robot::Stiction::exact},
                                          {"stiff-spring", robot::Stiction::stiff_spring},
                                          {"stiff-damper", robot::Stiction::stiff_damper}};
const Names<robot::ArmData> arms = {{"lumped", robot::ArmData::lumped},
                                    {"six-arm", robot::ArmData::six_arm}};

[[noreturn]] void refuse(const std::string& option, const std::string& expected,
                         const py::handle& got) {
  throw std::invalid_argument(option + ": expected " + expected + ", got " +
                              py::repr(got).cast<std::string>());
}

template <class Value>
std::string listed(const Names<Value>& names) {
  std::string list;
  for (const auto& [name, value] : names) {
    list += (list.empty() ? "'" : ", '") + std::string(name) + "'";
  }
  return list;
}

template <class Value>
const char* name_of(Value value, const Names<Value>& names) {
  for (const auto& [name, named] : names) {
    if (named == value) return name;
  }
  throw std::logic_error("an option without a name");
}

template <class Value>
Value named(const std::string& option, const py::handle& got, const Names<Value>& names,
            const std::string& or_else = "") {
  if (py::isinstance<py::str>(got)) {
    const auto text = got.cast<std::string>();
    for (const auto& [name, value] : names) {
      if (text == name) return value;
    }
  }
  refuse(option, listed(names) + or_else, got);
}

// One for all axes, or one for each.
void read_couplings(const py::handle& got, Model model, robot::Options& options) {
  if (py::isinstance<py::str>(got)) {
    options.coupling.fill(named("rotor_coupling", got, couplings));
    return;
  }
  const int n = robot::n_axes(model);
  if (!py::isinstance<py::sequence>(got) || static_cast<int>(py::len(got)) != n) {
    refuse("rotor_coupling", listed(couplings) + " or " + std::to_string(n) + " of them", got);
  }
  int i = 0;
  for (const py::handle of_axis : got) {
    options.coupling[i] =
        named("rotor_coupling of axis " + std::to_string(i + 1), of_axis, couplings);
    ++i;
  }
}

}  // namespace

Model model_named(const py::object& model) {
  if (py::isinstance<py::int_>(model) && !py::isinstance<py::bool_>(model)) {
    const auto number = model.cast<long long>();
    if (number >= 1 && number <= 4) return static_cast<Model>(number);
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
    dict["controller"] = name_of(options.controller, controllers);
  }
  py::list coupling;
  for (int i = 0; i < robot::n_axes(model); ++i) {
    coupling.append(name_of(options.coupling[i], couplings));
  }
  dict["rotor_coupling"] = py::tuple(coupling);
  dict["gear_damping"] = name_of(options.gear_damping, gear_dampings);
  dict["stiction"] = name_of(options.stiction, stictions);
  dict["stiffness"] = options.stiffness;
  dict["arm"] = name_of(options.arm, arms);
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
    options.controller =
        got.is_none() ? robot::Controller::none : named("controller", got, controllers, " or None");
  }
  if (dict.contains("rotor_coupling")) read_couplings(dict["rotor_coupling"], model, options);
  if (dict.contains("gear_damping")) {
    options.gear_damping = named("gear_damping", dict["gear_damping"], gear_dampings);
  }
  if (dict.contains("stiction")) options.stiction = named("stiction", dict["stiction"], stictions);
  if (dict.contains("stiffness")) options.stiffness = dict["stiffness"].cast<double>();
  if (dict.contains("arm")) options.arm = named("arm", dict["arm"], arms);
  if (dict.contains("creep_rate")) options.creep_rate = dict["creep_rate"].cast<double>();
  if (dict.contains("voltage_limit")) options.voltage_limit = dict["voltage_limit"].cast<double>();
  return options;
}

}  // namespace manutec_r3::bindings
