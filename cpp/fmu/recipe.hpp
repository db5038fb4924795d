// What an exported robot is made of: a text that lies in the resources of the FMU, written by the
// exporter and read by the instances.
#pragma once

#include <array>
#include <iosfwd>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "motion/motion.hpp"
#include "robot/robot.hpp"
#include "robot/start.hpp"
#include "solver/method.hpp"

namespace manutec_r3::fmu {

struct Recipe {
  std::shared_ptr<const robot::Robot> robot;
  std::shared_ptr<const motion::Motion> motion = {};  // inside the FMU
  bool reference_is_input = false;                    // instead of a motion
  // At rest, or a state.
  std::variant<robot::Start, std::vector<double>> start = robot::Start::rotor;
  std::vector<double> input = {};               // at the start: rF [N m] or u_c [V]
  std::array<double, 3> tip_force = {};         // at the start [N]
  std::vector<bool> brakes = {};                // that are on, all the time
  solver::Method method = solver::Method::erk;  // of the FMU that integrates itself
  double relative_tolerance = 0.0;
};

// Throws std::invalid_argument if the motion is made of functions: they are no text.
std::string as_text(const Recipe& recipe);

// Every number comes back bit by bit. Throws std::invalid_argument.
Recipe recipe_from(std::istream& text);

}  // namespace manutec_r3::fmu
