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
inline constexpr double gravity = 9.81;  // along -z of the world

enum class Axis { x, z };

// A rigid body in the frame of its arm. The inertia is about the centre of mass; every arm is
// symmetrical to its x-z plane, therefore I12 = I23 = 0.
struct Body {
  double mass;
  std::array<double, 3> centre;
  double I11, I22, I33, I13;
};

// An arm turns about its joint, whose place is given in the frame of the preceding arm. The body
// contains the frozen rotor that sits in the arm.
struct Arm {
  Axis axis;
  std::array<double, 3> offset;
  Body body;
};

// A rotor turns about an axis that is fixed in the preceding arm.
struct Rotor {
  double inertia;
  Axis axis;
};

// Arm 1 is known by I33 only: nothing else moves as long as the robot stands on the earth.
// The published inertia of arm 5 is impossible; 1e-2 of it is taken here. Of arm 6, a small body,
// nothing is known; the inertia p^2 rJ of its rotor is larger by far.
inline constexpr std::array<Arm, n_axes> six_arms = {{
    {Axis::z, {0, 0, 0}, {0, {0, 0, 0}, 0, 0, 1.16, 0}},                              // S, M
    {Axis::x, {0, 0, 0}, {56.5, {0.172, 0, 0.205}, 2.58, 2.73, 0.64, -0.46}},         // S, M
    {Axis::x, {0, 0, 0.5}, {26.4, {0.064, 0, -0.034}, 0.279, 0.413, 0.245, -0.070}},  // M
    {Axis::z, {0, 0, 0}, {28.7, {0, 0, 0.32}, 1.67, 1.67, 0.081, 0}},                 // M
    {Axis::x, {0, 0, 0.73}, {5.2, {0, 0, 0.023}, 0.0125, 0.0153, 0.0081, 0}},         // M, A
    {Axis::z, {0, 0, 0}, {0, {0, 0, 0}, 0, 0, 0, 0}},                                 // A
}};

// Arms 3 to 6 as one body, joints 4 to 6 at zero: the rounded data of models 2 and 4. Source S.
inline constexpr Arm lumped_arm_3 = {
    Axis::x, {0, 0, 0.5}, {60.3, {0.028, 0, 0.202}, 5.41, 5.60, 0.39, 0.33}};

inline constexpr std::array<Rotor, n_axes> rotors = {{
    {1.3e-3, Axis::z},  // inertia R, S; the axis is an assumption without effect: the base rests
    {1.3e-3, Axis::x},  // inertia R, S; axis normal to z by S, along x by A
    {1.3e-3, Axis::x},  // inertia R, S; axis S
    {1.6e-4, Axis::z},  // inertia M; axis A
    {1.8e-4, Axis::x},  // inertia M; axis A
    {4.3e-5, Axis::z},  // inertia M; axis A
}};

// Largest |aq| [rad]; the limits of axes 4 to 6 are lost.
inline constexpr double no_limit = std::numeric_limits<double>::infinity();
inline constexpr std::array<double, n_axes> joint_limits = {2.97,     2.01,     2.86,
                                                            no_limit, no_limit, no_limit};

// H5, the common origin of arms 5 and 6 from which the load is measured, lies on the axis of arm 4,
// this far above joint 3.
inline constexpr double h5_distance = six_arms[4].offset[2];

// From the ground to the origin of arms 1 and 2; for drawing only.
inline constexpr double shoulder_height = 0.675;

}  // namespace manutec_r3::arm
