// States to start from (spec 4, "Start at rest").
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/motion.hpp"
#include "robot/robot.hpp"

namespace manutec_r3::robot {

enum class Start {
  rotor,  // rotors on the reference, arms 1 to 3 sag: the equilibrium of the controller
  arm,    // arms on the reference, rotors 1 to 3 deflected
};

// What is on the reference if nothing else is asked for: the rotors, in the Modelica variant the
// arms.
Start default_start(Model model);

// At rest at the beginning of the motion, friction torques zero, motors balance gravity; without a
// motion at zero angles. Without a controller the balancing torques are not part of the state.
// Throws std::invalid_argument if a motor would need more than its torque limit, or a rate
// controller more than its limit on U.
std::vector<double> rest_state(const Robot& robot, const motion::Motion* motion, Start start);

// Per axis, n_axes values each, joint side or motor side as the names say. What is not given is
// zero; rotors follow their joints. Throws std::invalid_argument if an angle or rate of a rotor
// contradicts its rigid gear, or if a value is not finite.
struct Posture {
  std::vector<double> joint_angle;                  // [rad]
  std::optional<std::vector<double>> joint_rate;    // [rad/s]
  std::optional<std::vector<double>> rotor_angle;   // [rad]
  std::optional<std::vector<double>> rotor_rate;    // [rad/s]
  std::optional<std::vector<double>> motor_torque;  // rF [N m]
};
std::vector<double> state_from(const Robot& robot, const Posture& posture);

// Refuses a state vector of wrong length or with values that are not finite.
void check_state(const Robot& robot, std::span<const double> x);

}  // namespace manutec_r3::robot
