// Parameters of controllers, motors and gears, column by axis: Tables 1 and 2 of the report. Rotor
// inertias are in arm/parameters.hpp (Table 3), where they are needed as well.
#pragma once

#include <array>
#include <vector>

namespace manutec_r3::drive {

using Row = std::array<double, 6>;

// What a finite number must be.
enum class Sign { not_zero, not_negative, positive };

// --- Table 1: controllers and motors ------------------------------------------------------------

struct Table1 {
  Row K_V = {0.3, 0.3, 0.3, 0.3, 0.3, 0.3};
  Row K_D = {0.03, 0.03, 0.03, 0.03, 0.03, 0.03};
  Row K_S = {340.8, 340.8, 340.8, 340.8, 340.8, 340.8};
  Row T_0 = {9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3, 9.95e-3};
  Row T_e = {0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3, 0.56e-3};
  Row T_a = {40e-3, 40e-3, 40e-3, 40e-3, 40e-3, 40e-3};
  Row T_b = {20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3, 20.2e-3};
  Row K_T = {0.03, 0.03, 0.03, 0.03, 0.03, 0.03};
  Row w_p = {2014, 2014, 2014, 2014, 2014, 2014};
  Row D_p = {0.294, 0.294, 0.294, 0.294, 0.294, 0.294};
  Row w_e = {1180, 1180, 1180, 1180, 1180, 1180};
  Row K_M = {1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842};
  Row w_i = {4590, 5500, 5500, 6250, 6250, 7400};
  Row D_i = {0.6, 0.6, 0.6, 0.55, 0.55, 0.27};
  Row dead_zone_half_width = {0.094, 0.094, 0.094, 0.022, 0.096, 0.044};  // a
  Row torque_limit = {9, 9, 9, 9, 9, 9};                                  // b of NL2
  Row largest_torque = {9, 9, 9, 9, 9, 9};                                // |rF|_max, short time
  Row nominal_torque = {4, 4, 4, 4, 4, 4};                                // |rF|_nom, for ever
  Row largest_rotor_rate = {315, 315, 315, 335, 335, 366};                // |rq'|_max
  Row gear_ratio = {-105, 210, 60, -99, 79.2, -99};                       // p
  double sampling_time = 0.008;  // T of the digital position controller

  bool operator==(const Table1&) const = default;

  // Calls visit(symbol, unit, sign, row) for each row of a table.
  template <class Table, class Visit>
  static void for_each_row(Table& table, Visit&& visit) {
    visit("K_V", "V/rad", Sign::not_negative, table.K_V);
    visit("K_D", "V s/rad", Sign::not_negative, table.K_D);
    visit("K_S", "1/s", Sign::positive, table.K_S);
    visit("T_0", "s", Sign::positive, table.T_0);
    visit("T_e", "s", Sign::positive, table.T_e);
    visit("T_a", "s", Sign::not_negative, table.T_a);
    visit("T_b", "s", Sign::positive, table.T_b);
    visit("K_T", "V s/rad", Sign::not_negative, table.K_T);
    visit("w_p", "1/s", Sign::positive, table.w_p);
    visit("D_p", "1", Sign::not_negative, table.D_p);
    visit("w_e", "1/s", Sign::positive, table.w_e);
    visit("K_M", "N m/V", Sign::positive, table.K_M);
    visit("w_i", "1/s", Sign::positive, table.w_i);
    visit("D_i", "1", Sign::not_negative, table.D_i);
    visit("a", "V", Sign::not_negative, table.dead_zone_half_width);
    visit("b", "N m", Sign::positive, table.torque_limit);
    visit("rF_max", "N m", Sign::positive, table.largest_torque);
    visit("rF_nom", "N m", Sign::positive, table.nominal_torque);
    visit("rotor_rate_max", "rad/s", Sign::positive, table.largest_rotor_rate);
    visit("p", "1", Sign::not_zero, table.gear_ratio);
    visit("T", "s", Sign::positive, table.sampling_time);
  }
};

// --- Table 2: gears and friction ----------------------------------------------------------------

// Axes 1 to 3 have elastic gears, axes 4 to 6 rigid ones. c, d and b act on the rotor side.
inline constexpr int n_elastic = 3;
using ElasticRow = std::array<double, n_elastic>;

// Sliding friction, motor side, interpolates its points and extends the last segment.
struct FrictionPoint {
  double rate;    // rq' [rad/s]
  double torque;  // rM [N m]

  bool operator==(const FrictionPoint&) const = default;
};
using FrictionPoints = std::vector<FrictionPoint>;

struct Table2 {
  ElasticRow backlash_half_width = {0.01, 0.06, 0.0};         // b
  ElasticRow stiffness = {43, 8.0, 58};                       // c
  ElasticRow damping = {0.005, 0.01, 0.04};                   // d
  Row sticking_limit = {0.40, 0.50, 0.70, 0.27, 0.50, 0.17};  // rM_h
  std::array<FrictionPoints, 6> sliding_friction = {{
      {{0, 0.40}, {160, 0.53}},
      {{0, 0.50}, {130, 0.60}, {360, 0.70}},
      {{0, 0.70}, {130, 0.90}, {360, 1.00}},
      {{0, 0.22}, {300, 0.52}},
      {{0, 0.38}, {100, 0.42}, {300, 0.50}},
      {{0, 0.11}, {360, 0.15}},
  }};

  bool operator==(const Table2&) const = default;

  template <class Table, class Visit>
  static void for_each_row(Table& table, Visit&& visit) {
    visit("b", "rad", Sign::not_negative, table.backlash_half_width);
    visit("c", "N m/rad", Sign::positive, table.stiffness);
    visit("d", "N m s/rad", Sign::not_negative, table.damping);
    visit("rM_h", "N m", Sign::not_negative, table.sticking_limit);
    visit("friction", "N m", Sign::not_negative, table.sliding_friction);
  }
};

// Throw std::invalid_argument, naming table, symbol and axis, unless each number has the sign that
// it must have; friction points begin at rate 0 and go on with increasing rates, the last torque is
// no smaller than the one before, and rM_h >= rM_1.
void check(const Table1& table);
void check(const Table2& table);

}  // namespace manutec_r3::drive
