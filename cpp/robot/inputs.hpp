// What acts on a robot from outside as a function of time.
#pragma once

#include <memory>

#include "motion/input.hpp"
#include "motion/motion.hpp"

namespace manutec_r3::robot {

// Each may be missing. Inputs that are not functions of time are set while the robot moves.
struct Inputs {
  std::shared_ptr<const motion::Motion> motion = {};    // reference of the position controllers
  std::shared_ptr<const motion::Input> of_axes = {};    // rF [N m] without a controller, or u_c [V]
  std::shared_ptr<const motion::Input> tip_force = {};  // in the world [N], acts on the load
};

}  // namespace manutec_r3::robot
