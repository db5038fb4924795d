// A robot that follows a motion, as a hybrid system.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "hybrid/system.hpp"
#include "motion/motion.hpp"
#include "robot/elements.hpp"
#include "robot/robot.hpp"
#include "robot/signals.hpp"

namespace manutec_r3::robot {

class RobotSystem : public hybrid::System {
 public:
  virtual int n_axes() const = 0;

  // Input of a robot without controller: rF [N m], motor side, held.
  virtual void set_motor_torque(std::span<const double> torque) = 0;

  // All signals, n_axes values each, in the order of signal_names. What does not exist is NaN:
  // reference and control error without a motion, the voltage without a controller.
  virtual void signals(double t, const double* x, double* values) = 0;

  // The branch of an element on an axis (0-based), 0 if the axis has no such element.
  virtual int branch(ElementKind kind, int axis) const = 0;
};

// `motion` may be null for a robot without controller.
std::unique_ptr<RobotSystem> make_system(std::shared_ptr<const Robot> robot,
                                         std::shared_ptr<const motion::Motion> motion);

}  // namespace manutec_r3::robot
