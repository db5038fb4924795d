// What a result shows of every axis at every instant: names, units and meanings, here and nowhere
// else.
#pragma once

#include <array>
#include <string_view>

namespace manutec_r3::robot {

struct SignalDescription {
  int signal;  // Signal or Energy: each in its place
  std::string_view name, unit, text;
};

// Motion, torques and voltages.
enum Signal {
  joint_angle,
  joint_rate,
  joint_acceleration,
  rotor_angle,
  rotor_rate,
  reference_angle,
  reference_rate,
  control_error,
  motor_torque,
  gear_torque,
  friction_torque,
  joint_torque,
  command,
  tachogenerator_voltage,
  rate_error,
  voltage,
};
inline constexpr int n_signals = voltage + 1;
inline constexpr std::array<SignalDescription, n_signals> signal_descriptions = {{
    {joint_angle, "joint_angle", "rad", "Joint angles `aq`"},
    {joint_rate, "joint_rate", "rad/s", "Joint rates `aq'`"},
    {joint_acceleration, "joint_acceleration", "rad/s^2", "Joint accelerations `aq''`"},
    {rotor_angle, "rotor_angle", "rad", "Rotor angles `rq`, motor side"},
    {rotor_rate, "rotor_rate", "rad/s", "Rotor rates `rq'`, motor side"},
    {reference_angle, "reference_angle", "rad", "Desired joint angles `aq_d`"},
    {reference_rate, "reference_rate", "rad/s", "Desired joint rates `aq_d'`"},
    {control_error, "control_error", "rad", "Desired minus actual joint angles"},
    {motor_torque, "motor_torque", "N m", "Motor torques `rF` after NL2, motor side"},
    {gear_torque, "gear_torque", "N m",
     "Torques that gears take from rotors, `tau` or, rigid, `rF - rM`, motor side"},
    {friction_torque, "friction_torque", "N m", "Friction torques `rM`, motor side"},
    {joint_torque, "joint_torque", "N m", "Torques at the joints `aF`, joint side"},
    {command, "command", "V",
     "Commands `u_c` to the rate controllers, from the position controllers or the user; none in "
     "the Modelica variant, which commands rates"},
    {tachogenerator_voltage, "tachogenerator_voltage", "V",
     "Output of the tachogenerators `u_t`; none in the Modelica variant"},
    {rate_error, "rate_error", "V",
     "Rate errors `e = u_c - y` that the rate controllers integrate, `y` from the feedback filter; "
     "none in the Modelica variant"},
    {voltage, "voltage", "V",
     "Output of the rate controllers `U`; in the Modelica variant the capacitor's `v`"},
}};

// Energies, powers and losses. They take the kinematics of all arms, and are evaluated apart, from
// the signals above.
//
//   d/dt (kinetic + potential + elastic) = motor_power - friction_loss - damping_loss
//
// summed over the axes, and with the power of a force on the tip.
enum Energy {
  kinetic_energy,
  potential_energy,
  elastic_energy,
  motor_power,
  gear_power,
  joint_power,
  friction_loss,
  damping_loss,
};
inline constexpr int n_energies = damping_loss + 1;
inline constexpr std::array<SignalDescription, n_energies> energy_descriptions = {{
    {kinetic_energy, "kinetic_energy", "J",
     "Kinetic energies of each arm, the last one with the load, and of the spin of the rotor that "
     "moves it"},
    {potential_energy, "potential_energy", "J",
     "Energies of each arm against gravity, the last one with the load; zero at the world's "
     "origin"},
    {elastic_energy, "elastic_energy", "J", "Energies of the springs of elastic gears"},
    {motor_power, "motor_power", "W", "Powers `rF rq'` of motors on their rotors"},
    {gear_power, "gear_power", "W",
     "Powers that gears take from rotors, `tau rq'` or, rigid, `(rF - rM) rq'`"},
    {joint_power, "joint_power", "W", "Powers `aF aq'` of gears on the joints"},
    {friction_loss, "friction_loss", "W",
     "What friction takes, `rM rq'`; a stiff spring that holds a sticking axis also gives back"},
    {damping_loss, "damping_loss", "W", "What the dampers of elastic gears take, `d delta'^2`"},
}};

template <std::size_t n>
constexpr bool each_in_its_place(const std::array<SignalDescription, n>& descriptions) {
  for (std::size_t k = 0; k < n; ++k) {
    if (descriptions[k].signal != static_cast<int>(k)) return false;
  }
  return true;
}
static_assert(each_in_its_place(signal_descriptions) && each_in_its_place(energy_descriptions));

}  // namespace manutec_r3::robot
