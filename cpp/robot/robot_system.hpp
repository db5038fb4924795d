// A robot that follows a motion, as a hybrid system.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "hybrid/system.hpp"
#include "motion/motion.hpp"
#include "robot/elements.hpp"
#include "robot/robot.hpp"

namespace manutec_r3::robot {

// What a result shows of every axis at every instant.
enum Signal {
  joint_angle,         // aq [rad]
  joint_rate,          // aq' [rad/s]
  joint_acceleration,  // aq'' [rad/s^2]
  rotor_angle,         // rq [rad]
  rotor_rate,          // rq' [rad/s]
  reference_angle,     // aq_d [rad]
  reference_rate,      // aq_d' [rad/s]
  control_error,       // aq_d - aq [rad]
  motor_torque,        // rF [N m], motor side
  gear_torque,         // tau, or rF - rM with a rigid gear [N m], motor side
  friction_torque,     // rM [N m], motor side
  joint_torque,        // aF = p tau [N m], joint side
  voltage,             // U [V]
};
inline constexpr std::array<std::string_view, 13> signal_names = {
    "joint_angle",   "joint_rate",      "joint_acceleration", "rotor_angle", "rotor_rate",
    "reference_angle", "reference_rate", "control_error",      "motor_torque", "gear_torque",
    "friction_torque", "joint_torque",   "voltage"};

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
