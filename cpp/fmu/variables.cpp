#include "fmu/variables.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <utility>

#include "fmu/parameters.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::fmu {
namespace {

// Importers take them for absolute tolerances. At a relative tolerance of 1e-8 CVODE then keeps
// control errors and motor torques within 1e-6 of their range, which with those of our own methods
// it misses by a factor of three (tests/test_fmu.py).
constexpr double share_of_nominals = 0.1;

class Row {
 public:
  void add(Variable variable) {
    variable.size = std::accumulate(variable.shape.begin(), variable.shape.end(), 1,
                                    [](int size, int extent) { return size * extent; });
    variable.first = end_;
    end_ += variable.size;
    variables_.push_back(std::move(variable));
  }
  int end() const { return end_; }
  std::vector<Variable> take() { return std::move(variables_); }

 private:
  std::vector<Variable> variables_;
  int end_ = 0;
};

void add_parameters(Row& row, const robot::Robot& robot) {
  arm::Load load = robot.load();
  robot::Tables tables = robot.tables();
  for (const Parameter& parameter : parameters_of(robot.model(), load, tables)) {
    Variable variable{
        parameter.name, parameter.unit, parameter.text, Group::parameter, parameter.shape, 0, 0};
    for (const double* place : parameter.places) variable.start.push_back(*place);
    row.add(std::move(variable));
  }
}

void add_inputs(Row& row, const Recipe& recipe, const std::vector<double>& reference) {
  const int n = recipe.robot->n_axes();
  const auto add = [&](const char* name, const char* unit, const char* text, int size,
                       std::vector<double> start) {
    row.add({name, unit, text, Group::input, {size}, 0, 0, std::move(start)});
  };
  if (recipe.reference_is_input) {
    add(reference_angle_input, "rad", "Desired joint angles `aq_d`", n, reference);
    add(reference_rate_input, "rad/s", "Desired joint rates `aq_d'`", n,
        std::vector<double>(n, 0.0));
  }
  const std::string of_axes = axes_input(*recipe.robot);
  if (recipe.robot->options().controller == robot::Controller::none) {
    add(of_axes.c_str(), "N m", "Motor torques `rF`, motor side", n, recipe.input);
  } else if (!of_axes.empty()) {
    add(of_axes.c_str(), "V", "Commands `u_c` to the rate controllers", n, recipe.input);
  }
  add(tip_force_input, "N", "Force on the load, in the world", 3,
      {recipe.tip_force.begin(), recipe.tip_force.end()});
}

template <std::size_t n>
void add_descriptions(Row& row, Group group, int n_axes,
                      const std::array<robot::SignalDescription, n>& descriptions) {
  for (const auto& [_, name, unit, text] : descriptions) {
    row.add({std::string(name), std::string(unit), std::string(text), group, {n_axes}, 0, 0});
  }
}

// What a branch means, as the table of events tells it.
constexpr std::array<std::string_view, robot::n_axis_elements> texts_of_branches = {
    "Dead zones NL1: 0 inside, +1 above, -1 below",
    "Torque limits NL2: 0 below the limit, +1 at the upper one, -1 at the lower one",
    "Limits on U: 0 below the limit, +1 at the upper one, -1 at the lower one",
    "Backlash: 0 free, +1 and -1 in contact on one side or the other",
    "Friction: 0 sticks, +1 and -1 slides forwards or backwards",
};

void add_states(Row& row, const Recipe& recipe) {
  const robot::Robot& robot = *recipe.robot;
  const auto* start = std::get_if<std::vector<double>>(&recipe.start);
  const int first = row.end();
  for (const robot::StateGroup& group : robot.states()) {
    Variable variable{"state." + group.name,
                      group.unit,
                      "State of the integration: " + group.name,
                      Group::state,
                      {group.size},
                      0,
                      0};
    std::ranges::replace(variable.text, '_', ' ');
    for (const double nominal : group.nominals) {
      variable.nominal.push_back(share_of_nominals * nominal);
    }
    if (start != nullptr) {
      const auto begin = start->begin() + group.first;
      variable.start.assign(begin, begin + group.size);
    }
    row.add(std::move(variable));
  }
  for (const robot::StateGroup& group : robot.states()) {
    Variable variable{"der(state." + group.name + ")",
                      group.unit + (group.unit.ends_with("/s") ? "^2" : "/s"),
                      "Its derivative",
                      Group::derivative,
                      {group.size},
                      0,
                      0};
    variable.derivative_of = first + group.first;
    row.add(std::move(variable));
  }
}

}  // namespace

std::string axes_input(const robot::Robot& robot) {
  switch (robot.options().controller) {
    case robot::Controller::none:
      return "input.motor_torque";
    case robot::Controller::external:
      return "input.command";
    default:
      return "";
  }
}

std::vector<Variable> variables_of(const Recipe& recipe) {
  const robot::Robot& robot = *recipe.robot;
  const int n = robot.n_axes();
  Row row;
  row.add({"time", "s", "Time", Group::time, {}, 0, 0});
  add_parameters(row, robot);
  std::vector<double> reference(n, 0.0);
  if (recipe.motion) std::ranges::copy_n(recipe.motion->start().begin(), n, reference.begin());
  add_inputs(row, recipe, reference);
  add_descriptions(row, Group::signal, n, robot::signal_descriptions);
  add_descriptions(row, Group::energy, n, robot::energy_descriptions);
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    row.add({"branch." + std::string(robot::element_names[kind]),
             "",
             std::string(texts_of_branches[kind]),
             Group::branch,
             {n},
             0,
             0});
  }
  row.add({"n_events", "", "Number of events so far", Group::n_events, {}, 0, 0});
  add_states(row, recipe);
  const auto system = robot::make_system(recipe.robot, {.motion = recipe.motion});
  for (const auto& [name, _] : system->indicator_rows()) {
    row.add(
        {"indicator." + std::string(name),
         "1",
         "Positive on the present branch, scaled; for each axis of its upper and its lower side",
         Group::indicator,
         {n, 2},
         0,
         0});
  }
  if (robot.options().controller == robot::Controller::sampled) {
    row.add({"sampling", "", "Samples of the position controllers", Group::clock, {}, 0, 0});
  }
  return row.take();
}

}  // namespace manutec_r3::fmu
