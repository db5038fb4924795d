// The numbers of a robot by name: its load and Tables 1 to 3.
#pragma once

#include <string>
#include <vector>

#include "arm/load.hpp"
#include "robot/options.hpp"
#include "robot/tables.hpp"

namespace manutec_r3::fmu {

// One number, or one of each axis, arm or point, row by row.
struct Parameter {
  std::string name, unit, text;
  std::vector<int> shape;
  std::vector<double*> places;  // in the load and the tables that it was asked of
};

// All numbers of a model: places are in this load and these tables. Friction characteristics have
// as many points as the tables say.
std::vector<Parameter> parameters_of(robot::Model model, arm::Load& load, robot::Tables& tables);

}  // namespace manutec_r3::fmu
