// Parameters of controllers, motors, rotors and gears: Tables 1 and 2 of the report, column by
// axis. Rotor inertias are in arm/parameters.hpp (Table 3), where they are needed as well.
#pragma once

#include <array>

namespace manutec_r3::drive {

using Row = std::array<double, 6>;

// --- Table 1 ------------------------------------------------------------------------------------

inline constexpr Row K_V = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3};                          // [V/rad]
inline constexpr Row K_D = {0.03, 0.03, 0.03, 0.03, 0.03, 0.03};                    // [V s/rad]
inline constexpr Row K_S = {340.8, 340.8, 340.8, 340.8, 340.8, 340.8};              // [1/s]
inline constexpr Row T_0 = {9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3};  // [s]
inline constexpr Row T_e = {0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3};  // [s]
inline constexpr Row T_a = {40e-3, 40e-3, 40e-3, 40e-3, 40e-3, 40e-3};              // [s]
inline constexpr Row T_b = {20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3};  // [s]
inline constexpr Row K_T = {0.03, 0.03, 0.03, 0.03, 0.03, 0.03};                    // [V s/rad]
inline constexpr Row w_p = {2014, 2014, 2014, 2014, 2014, 2014};                    // [1/s]
inline constexpr Row D_p = {0.294, 0.294, 0.294, 0.294, 0.294, 0.294};
inline constexpr Row w_e = {1180, 1180, 1180, 1180, 1180, 1180};              // [1/s]
inline constexpr Row K_M = {1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842};  // [N m/V]
inline constexpr Row w_i = {4590, 5500, 5500, 6250, 6250, 7400};              // [1/s]
inline constexpr Row D_i = {0.6, 0.6, 0.6, 0.55, 0.55, 0.27};
inline constexpr Row dead_zone_half_width = {0.094, 0.094, 0.094, 0.022, 0.096, 0.044};  // a [V]
inline constexpr Row torque_limit = {9, 9, 9, 9, 9, 9};    // b of NL2 [N m]
inline constexpr Row largest_torque = {9, 9, 9, 9, 9, 9};  // |rF|_max, short time [N m]
inline constexpr Row nominal_torque = {4, 4, 4, 4, 4, 4};  // |rF|_nom, for ever [N m]
inline constexpr Row largest_rotor_rate = {315, 315, 315, 335, 335, 366};  // |rq'|_max [rad/s]
inline constexpr Row gear_ratio = {-105, 210, 60, -99, 79.2, -99};         // p

inline constexpr double sampling_time = 0.008;  // T of the digital position controller [s]

// --- Table 2 ------------------------------------------------------------------------------------

// Axes 1 to 3 have elastic gears, axes 4 to 6 rigid ones. c, d and b act on the rotor side.
inline constexpr int n_elastic = 3;
inline constexpr std::array<double, n_elastic> backlash_half_width = {0.01, 0.06, 0.0};  // b [rad]
inline constexpr std::array<double, n_elastic> stiffness = {43, 8.0, 58};      // c [N m/rad]
inline constexpr std::array<double, n_elastic> damping = {0.005, 0.01, 0.04};  // d [N m s/rad]

// Friction, motor side: rM_h holds while an axis sticks; sliding friction interpolates the points
// (rq', rM) and extends the last segment.
struct FrictionPoint {
  double rate;    // rq' [rad/s]
  double torque;  // rM [N m]
};
struct FrictionCharacteristic {
  double sticking_limit;  // rM_h [N m]
  int n_points;
  std::array<FrictionPoint, 3> points;
};
inline constexpr std::array<FrictionCharacteristic, 6> friction = {{
    {0.40, 2, {{{0, 0.40}, {160, 0.53}}}},
    {0.50, 3, {{{0, 0.50}, {130, 0.60}, {360, 0.70}}}},
    {0.70, 3, {{{0, 0.70}, {130, 0.90}, {360, 1.00}}}},
    {0.27, 2, {{{0, 0.22}, {300, 0.52}}}},
    {0.50, 3, {{{0, 0.38}, {100, 0.42}, {300, 0.50}}}},
    {0.17, 2, {{{0, 0.11}, {360, 0.15}}}},
}};

}  // namespace manutec_r3::drive
