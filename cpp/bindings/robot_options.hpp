// Models, options and tables of a robot as Python has them: names, numbers and dictionaries.
#pragma once

#include "bindings/bindings.hpp"
#include "robot/options.hpp"
#include "robot/start.hpp"
#include "robot/tables.hpp"

namespace manutec_r3::bindings {

// 1 to 4, or the name of a Modelica model. Throws std::invalid_argument.
robot::Model model_named(const py::object& model);
py::object as_python(robot::Model model);

// 'rotor' or 'arm'. Throws std::invalid_argument.
robot::Start start_named(const std::string& name);

// All options of a robot; what is missing in a dictionary is the model's own.
py::dict as_dict(const robot::Options& options, robot::Model model);
robot::Options options_from(const py::dict& dict, robot::Model model);

// All rows of its tables; none may be missing.
py::dict as_dict(const robot::Tables& tables, robot::Model model);
robot::Tables tables_from(const py::dict& dict, robot::Model model);

}  // namespace manutec_r3::bindings
