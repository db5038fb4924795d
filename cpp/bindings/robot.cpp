#include "robot/robot.hpp"

#include <pybind11/stl.h>

#include <optional>
#include <stdexcept>
#include <string>

#include "bindings/bindings.hpp"
#include "bindings/robot_options.hpp"
#include "robot/start.hpp"

namespace manutec_r3::bindings {
namespace {

using robot::Robot;

// Groups of states as tuples (name, unit, nominal values, first, size).
py::list state_groups(const Robot& robot) {
  py::list groups;
  for (const robot::StateGroup& group : robot.states()) {
    groups.append(py::make_tuple(group.name, group.unit, group.nominals, group.first, group.size));
  }
  return groups;
}

py::list indicator_groups(const Robot& robot) {
  py::list groups;
  for (const robot::IndicatorGroup& group : robot.indicators()) {
    groups.append(py::make_tuple(group.name, group.size));
  }
  return groups;
}

}  // namespace

robot::Start start_named(const std::string& name) {
  if (name == "rotor") return robot::Start::rotor;
  if (name == "arm") return robot::Start::arm;
  throw std::invalid_argument("start: expected 'rotor', 'arm' or a state vector, got '" + name +
                              "'");
}

void register_robot(py::module_& module) {
  py::class_<arm::Load>(module, "Load")
      .def(py::init([](double mass, const std::array<double, 3>& position, bool bounds) {
        const arm::Load load{.mass = mass, .position = position, .bounds = bounds};
        arm::check(load);
        return load;
      }))
      .def_readonly("mass", &arm::Load::mass)
      .def_readonly("position", &arm::Load::position)
      .def_readonly("bounds", &arm::Load::bounds);
  module.def("default_load",
             [](const py::object& model) { return robot::default_load(model_named(model)); });
  module.def("default_start", [](const Robot& robot) {
    return robot::default_start(robot.model()) == robot::Start::arm ? "arm" : "rotor";
  });

  py::class_<Robot, std::shared_ptr<Robot>>(module, "Robot")
      .def(py::init([](const py::object& model, const arm::Load& load, const py::dict& options,
                       const py::dict& tables) {
        const robot::Model named = model_named(model);
        return std::make_shared<Robot>(named, load, options_from(options, named),
                                       tables_from(tables, named));
      }))
      .def("__eq__", [](const Robot& a, const Robot& b) { return a == b; })
      .def_property_readonly(
          "options", [](const Robot& robot) { return as_dict(robot.options(), robot.model()); })
      .def_property_readonly(
          "tables", [](const Robot& robot) { return as_dict(robot.tables(), robot.model()); })
      .def_property_readonly("n_axes", &Robot::n_axes)
      .def_property_readonly("elements",
                             [](const Robot& robot) {
                               std::vector<std::string> names;
                               for (const robot::ElementKind kind : robot.elements()) {
                                 names.emplace_back(robot::element_names[kind]);
                               }
                               return names;
                             })
      .def_property_readonly("has_real_gears", &Robot::has_real_gears)
      .def_property_readonly("n_states", &Robot::n_states)
      .def_property_readonly("n_indicators", &Robot::n_indicators)
      .def_property_readonly("state_groups", &state_groups)
      .def_property_readonly("indicator_groups", &indicator_groups)
      .def("check_motion", &robot::check_motion)
      .def("check_state",
           [](const Robot& robot, const Array& x) { robot::check_state(robot, as_span(x)); })
      .def("rest_state",
           [](const Robot& robot, const motion::Motion* motion, const std::string& start) {
             return as_array(robot::rest_state(robot, motion, start_named(start)));
           })
      .def("state_from",
           [](const Robot& robot, const Array& joint_angle, const std::optional<Array>& joint_rate,
              const std::optional<Array>& rotor_angle, const std::optional<Array>& rotor_rate,
              const std::optional<Array>& motor_torque) {
             const auto optional = [](const std::optional<Array>& array) {
               return array ? std::optional(as_vector(*array)) : std::nullopt;
             };
             return as_array(robot::state_from(robot, {.joint_angle = as_vector(joint_angle),
                                                       .joint_rate = optional(joint_rate),
                                                       .rotor_angle = optional(rotor_angle),
                                                       .rotor_rate = optional(rotor_rate),
                                                       .motor_torque = optional(motor_torque)}));
           });
}

}  // namespace manutec_r3::bindings
