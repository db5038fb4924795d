// What an importer sees of an exported robot: every variable by name, for the model description and
// for the instances alike.
//
// All numbers of an instance stand in one row. The value reference of a variable is the place of
// its first element there: in FMI 3 it stands for the whole array, in FMI 2 each element has its
// own.
#pragma once

#include <string>
#include <vector>

#include "fmu/recipe.hpp"

namespace manutec_r3::fmu {

// In the order of the row.
enum class Group {
  time,
  parameter,
  input,
  signal,
  energy,
  branch,
  n_events,
  state,
  derivative,
  indicator,
  clock,
};
inline constexpr int n_groups = static_cast<int>(Group::clock) + 1;

struct Variable {
  std::string name, unit, text;
  Group group;
  std::vector<int> shape;  // empty: a scalar
  int first;               // its place in the row
  int size;
  std::vector<double> start = {};    // where an importer may set it
  std::vector<double> nominal = {};  // of states
  int derivative_of = -1;            // the place of the state
};

// Names begin with what a variable belongs to, if it is no signal.
inline constexpr const char* reference_angle_input = "input.reference_angle";
inline constexpr const char* reference_rate_input = "input.reference_rate";
inline constexpr const char* tip_force_input = "input.tip_force";
inline constexpr const char* sampling_time_parameter = "table_1.T";
// rF without a controller, u_c with an external one; nothing otherwise.
std::string axes_input(const robot::Robot& robot);

std::vector<Variable> variables_of(const Recipe& recipe);

}  // namespace manutec_r3::fmu
