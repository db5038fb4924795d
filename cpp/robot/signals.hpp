// What a result shows of every axis at every instant, by name.
#pragma once

#include <array>
#include <string_view>

namespace manutec_r3::robot {

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
    "joint_angle",  "joint_rate",      "joint_acceleration", "rotor_angle",
    "rotor_rate",   "reference_angle", "reference_rate",     "control_error",
    "motor_torque", "gear_torque",     "friction_torque",    "joint_torque",
    "voltage"};

}  // namespace manutec_r3::robot
