// The models and their options: in one place, what may differ from model 3 with all defaults.
//
// Where each takes effect, in the equations (E: Equations, equations.hpp) and in decisions
// (F: FrictionDecision, friction_decision.hpp; S: RobotSystemOf, robot_system_of.hpp):
//
//   model          arms and tables: tables.cpp; controllers and motors: E's argument `Axes`
//   controller     u_c to the rate controllers: E::command, without one rF: E::torques;
//                  sampled: S::take_sample
//   coupling       rigid gears: arm/mechanism.hpp; elastic gears: E::dynamics, E::accelerations;
//                  who decides together: E::is_coupled
//   gear_damping   drive/gear.hpp; tau jumps: S::cross
//   stiction, k    E::torques; F::freeze, F::capture; the method: S::rings
//   arm            arm/mechanism.hpp
//   creep_rate     S::indicators, S::cross
//   voltage_limit  drive/rate_controller.hpp; electrical_switches.hpp
//
// Inputs are no options: motor torques, commands and a force on the tip are E's held values or
// functions (inputs.hpp), brakes are sticking limits without end (F::sticking_limit).
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <string_view>

#include "drive/gear.hpp"

namespace manutec_r3::robot {

enum class Model {
  dlr_1 = 1,   // six arms, ideal gears
  dlr_2,       // three arms, joints 4 to 6 blocked, ideal gears
  dlr_3,       // six arms; friction, elasticity, damping, backlash
  dlr_4,       // three arms with such gears
  full_robot,  // Modelica: six arms; friction, elasticity, damping
  one_axis,    // Modelica: axis 2 with an inertia at its joint
};

inline bool is_modelica(Model model) { return model >= Model::full_robot; }
inline int n_axes(Model model) {
  return model == Model::one_axis ? 1 : model == Model::dlr_2 || model == Model::dlr_4 ? 3 : 6;
}
inline bool has_real_gears(Model model) { return model >= Model::dlr_3; }
inline int n_elastic(Model model) {
  return has_real_gears(model) ? std::min(n_axes(model), drive::n_elastic) : 0;
}
// As users write it.
std::string name_of(Model model);

enum class Controller {
  continuous,  // the position loop is evaluated at every instant
  sampled,     // at t_k = k T, its output is held
  external,    // the user's: its output is an input
  none,        // no controller, no motor dynamics: motor torques are inputs
};

// Of a rotor with the arm that carries it (spec 6).
enum class Coupling { full, simplified };

// What holds a sticking axis 4 to 6 (spec 11).
enum class Stiction {
  exact,         // a constraint torque: its rate is exactly zero
  stiff_spring,  // rM = k (rq - rq_stick), k [N m/rad]
  stiff_damper,  // rM = k rq', k [N m s/rad]
};

// Of models with three arms (spec 3).
enum class ArmData {
  lumped,   // the rounded data of R3M2SI
  six_arm,  // those of models 1 and 3
};

// Options as users write them, in the order of their enums; no controller is None.
template <std::size_t n>
using Names = std::array<std::string_view, n>;
inline constexpr Names<3> controller_names = {"continuous", "sampled", "external"};
inline constexpr Names<2> coupling_names = {"full", "simplified"};
inline constexpr Names<2> gear_damping_names = {"parallel", "contact"};
inline constexpr Names<3> stiction_names = {"exact", "stiff-spring", "stiff-damper"};
inline constexpr Names<2> arm_names = {"lumped", "six-arm"};

template <std::size_t n>
std::string_view name_of(auto value, const Names<n>& names) {
  return names.at(static_cast<std::size_t>(value));
}

struct Options {
  Controller controller;
  std::array<Coupling, 6> coupling;
  drive::GearDamping gear_damping;
  Stiction stiction;
  double stiffness;  // k of stiff springs and dampers
  ArmData arm;
  double creep_rate;  // a rotor 1 to 3 that slides more slowly sticks if it can [rad/s]; 0: never
  double voltage_limit;  // of the rate controllers' output U [V]; infinite: none

  bool operator==(const Options&) const = default;
};

// What a model has if nothing else is asked for (spec 11).
Options default_options(Model model);

// Throws std::invalid_argument if the model does not have such an option.
void check(Model model, const Options& options);

}  // namespace manutec_r3::robot
