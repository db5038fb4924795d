// Parameters of the robot's descendant in the Modelica Standard Library, RobotR3 (its FullRobot
// and OneAxis), column by axis. It has the same gears without backlash and other arms; its
// controller and its motor are simpler.
//
// Sources: the specification of the variant, which takes the numbers from the library.
#pragma once

#include "drive/parameters.hpp"

namespace manutec_r3::drive {

// In place of Table 1.
struct ModelicaTable1 {
  Row kp = {5, 5, 5, 5, 5, 5};                               // of the position controller
  Row ks = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5};                   // of the rate controller
  Row Ts = {0.05, 0.05, 0.05, 0.05, 0.05, 0.05};             // its integral time
  Row w = {4590, 5500, 5500, 6250, 6250, 7400};              // of the current loop
  Row D = {0.6, 0.6, 0.6, 0.55, 0.55, 0.27};                 // its damping
  Row k = {1.1616, 1.1616, 1.1616, 0.2365, 0.2608, 0.0842};  // torque per current
  Row gear_ratio = {-105, 210, 60, -99, 79.2, -99};          // r there, p here

  bool operator==(const ModelicaTable1&) const = default;

  template <class Table, class Visit>
  static void for_each_row(Table& table, Visit&& visit) {
    visit("kp", "1/s", Sign::not_negative, table.kp);
    visit("ks", "A s/rad", Sign::positive, table.ks);
    visit("Ts", "s", Sign::positive, table.Ts);
    visit("w", "1/s", Sign::positive, table.w);
    visit("D", "1", Sign::positive, table.D);
    visit("k", "N m/A", Sign::positive, table.k);
    visit("p", "1", Sign::not_zero, table.gear_ratio);
  }
};

void check(const ModelicaTable1& table);

// Friction as the library has it: R = s Rv0 + Rv1 w while sliding, |R| <= peak Rv0 at rest; on the
// rotor's side on axes 1 to 3, on the joint's on axes 4 to 6. Rotor side here: R / r over r q'.
Table2 modelica_table_2();

}  // namespace manutec_r3::drive
