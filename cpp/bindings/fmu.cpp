// What is exported as an FMU: its resources, and the variables of its model description.
#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bindings/bindings.hpp"
#include "bindings/robot_options.hpp"
#include "fmu/recipe.hpp"
#include "fmu/variables.hpp"

namespace manutec_r3::bindings {
namespace {

// As the enum Group has them.
constexpr std::array<std::string_view, fmu::n_groups> group_names = {
    "time",     "parameter", "input",      "signal",    "energy", "branch",
    "n_events", "state",     "derivative", "indicator", "clock"};

// As tuples (name, unit, description, group, shape, value reference, start values, nominal values,
// value reference of the state that it is the derivative of).
py::list variables_of(const fmu::Recipe& recipe) {
  py::list list;
  for (const fmu::Variable& variable : fmu::variables_of(recipe)) {
    const auto state =
        variable.derivative_of < 0 ? std::nullopt : std::optional(variable.derivative_of);
    list.append(py::make_tuple(variable.name, variable.unit, variable.text,
                               std::string(group_names[static_cast<int>(variable.group)]),
                               py::tuple(py::cast(variable.shape)), variable.first, variable.start,
                               variable.nominal, state));
  }
  return list;
}

}  // namespace

void register_fmu(py::module_& module) {
  py::class_<fmu::Recipe>(module, "FmuRecipe")
      .def(py::init([](std::shared_ptr<const robot::Robot> robot,
                       std::shared_ptr<const motion::Motion> motion, bool reference_is_input,
                       const std::variant<std::string, Array>& start, const Array& input,
                       const std::array<double, 3>& tip_force, const std::vector<bool>& brakes,
                       solver::Method method, double relative_tolerance) {
        fmu::Recipe recipe{.robot = std::move(robot), .motion = std::move(motion)};
        recipe.reference_is_input = reference_is_input;
        if (const auto* name = std::get_if<std::string>(&start)) {
          recipe.start = start_named(*name);
        } else {
          recipe.start = as_vector(std::get<Array>(start));
        }
        recipe.input = as_vector(input);
        recipe.tip_force = tip_force;
        recipe.brakes = brakes;
        recipe.method = method;
        recipe.relative_tolerance = relative_tolerance;
        return recipe;
      }))
      .def_property_readonly("text", &fmu::as_text)
      .def_property_readonly("variables", &variables_of);
}

}  // namespace manutec_r3::bindings
