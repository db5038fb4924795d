// The data of the arms and of their rotors: Table 3, reconstructed (spec 3), in the frames of
// spec 2.
//
// SI units. Axis j of the report is number j - 1 here. Sources of the numbers, as in spec 3:
//   R  the report's own text            M  the Modelica package "r3" (Otter, 2000)
//   S  the routine R3M2SI (1988)        A  an assumption of this project
#pragma once

#include <array>
#include <limits>

namespace manutec_r3::arm {

inline constexpr int n_axes = 6;

enum class Axis { x, y, z };

// Joint j turns arm j about this axis of the preceding arm, in every variant of the robot.
inline constexpr std::array<Axis, n_axes> joint_axes = {Axis::z, Axis::x, Axis::x,
                                                        Axis::z, Axis::x, Axis::z};
// Rotor j turns about this axis of the preceding arm. The first one has no effect, because the base
// rests; the second is normal to z by S and along x by A; the third S, the others A.
inline constexpr std::array<Axis, n_axes> rotor_axes_of_report = {Axis::z, Axis::x, Axis::x,
                                                                  Axis::z, Axis::x, Axis::z};

// A rigid body in the frame of its arm. The inertia is about the centre of mass; every arm is
// symmetrical to its x-z plane, therefore I12 = I23 = 0.
struct Body {
  double mass;                   // [kg]
  std::array<double, 3> centre;  // [m]
  double I11, I22, I33, I13;     // [kg m^2]

  bool operator==(const Body&) const = default;

  // Calls visit(symbol, unit, value) for each number.
  template <class AnyBody, class Visit>
  static void for_each_number(AnyBody& body, Visit&& visit) {
    visit("mass", "kg", body.mass);
    visit("centre_of_mass", "m", body.centre);
    visit("I11", "kg m^2", body.I11);
    visit("I22", "kg m^2", body.I22);
    visit("I33", "kg m^2", body.I33);
    visit("I13", "kg m^2", body.I13);
  }
};

// An arm turns about its joint, whose place is given in the frame of the preceding arm. The body
// contains the frozen rotor that sits in the arm.
struct Arm {
  std::array<double, 3> offset;  // [m]
  Body body;

  bool operator==(const Arm&) const = default;

  template <class AnyArm, class Visit>
  static void for_each_number(AnyArm& arm, Visit&& visit) {
    visit("offset", "m", arm.offset);
    Body::for_each_number(arm.body, visit);
  }
};

inline constexpr double no_limit = std::numeric_limits<double>::infinity();

struct Table3 {
  // Arm 1 is known by I33 only: nothing else moves as long as the robot stands on the earth.
  // The published inertia of arm 5 is impossible; 1e-2 of it is taken here. Of arm 6, a small body,
  // nothing is known; the inertia p^2 rJ of its rotor is larger by far.
  std::array<Arm, n_axes> arms = {{
      {{0, 0, 0}, {0, {0, 0, 0}, 0, 0, 1.16, 0}},                              // S, M
      {{0, 0, 0}, {56.5, {0.172, 0, 0.205}, 2.58, 2.73, 0.64, -0.46}},         // S, M
      {{0, 0, 0.5}, {26.4, {0.064, 0, -0.034}, 0.279, 0.413, 0.245, -0.070}},  // M
      {{0, 0, 0}, {28.7, {0, 0, 0.32}, 1.67, 1.67, 0.081, 0}},                 // M
      {{0, 0, 0.73}, {5.2, {0, 0, 0.023}, 0.0125, 0.0153, 0.0081, 0}},         // M, A
      {{0, 0, 0}, {0, {0, 0, 0}, 0, 0, 0, 0}},                                 // A
  }};
  // Arms 3 to 6 as one body in the frame of arm 3, joints 4 to 6 at zero: the rounded data of
  // models 2 and 4. Source S.
  Body lumped_arm_3 = {60.3, {0.028, 0, 0.202}, 5.41, 5.60, 0.39, 0.33};
  // rJ [kg m^2]: 1 to 3 R and S, 4 to 6 M.
  std::array<double, n_axes> rotor_inertia = {1.3e-3, 1.3e-3, 1.3e-3, 1.6e-4, 1.8e-4, 4.3e-5};
  std::array<Axis, n_axes> rotor_axes = rotor_axes_of_report;  // rn
  // Largest |aq| [rad]; the limits of axes 4 to 6 are lost.
  std::array<double, n_axes> joint_limits = {2.97, 2.01, 2.86, no_limit, no_limit, no_limit};
  double gravity = 9.81;  // along -z of the world [m/s^2]
  // From the ground to the origin of arms 1 and 2; for drawing only [m].
  double shoulder_height = 0.675;

  bool operator==(const Table3&) const = default;

  // Calls visit(symbol, unit, row) for each row of a table; arms have units of their own.
  template <class Table, class Visit>
  static void for_each_row(Table& table, Visit&& visit) {
    visit("arms", "", table.arms);
    visit("lumped_arm_3", "", table.lumped_arm_3);
    visit("rJ", "kg m^2", table.rotor_inertia);
    visit("rn", "", table.rotor_axes);
    visit("joint_limits", "rad", table.joint_limits);
    visit("gravity", "m/s^2", table.gravity);
    visit("shoulder_height", "m", table.shoulder_height);
  }
};

// Throws std::invalid_argument, naming table, symbol and arm, unless these are rigid bodies: masses
// and moments of inertia that are not negative and fulfil the triangle inequality. Of a body that
// only turns about z, such as arm 1, I33 alone may be known.
void check(const Table3& table);

}  // namespace manutec_r3::arm
