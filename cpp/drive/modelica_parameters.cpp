#include "drive/modelica_parameters.hpp"

#include <cmath>

namespace manutec_r3::drive {
namespace {

constexpr Row Rv0 = {0.4, 0.5, 0.7, 21.8, 30.1, 10.9};                    // [N m]
constexpr Row Rv1 = {0.13 / 160, 0.1 / 130, 0.2 / 130, 9.8, 0.03, 3.92};  // [N m s/rad]
constexpr Row peak = {1, 1, 1, 26.7 / 21.8, 39.6 / 30.1, 16.8 / 10.9};

// A straight line is known by two points; the second one is as far out as rotors turn.
constexpr double far_rate = 400;  // rad/s

}  // namespace

Table2 modelica_table_2() {
  const ModelicaTable1 table_1;
  Table2 table_2;
  table_2.backlash_half_width = {0, 0, 0};
  for (int i = 0; i < 6; ++i) {
    const double r = i < n_elastic ? 1.0 : std::abs(table_1.gear_ratio[i]);
    table_2.sticking_limit[i] = peak[i] * Rv0[i] / r;
    table_2.sliding_friction[i] = {{0, Rv0[i] / r},
                                   {far_rate, (Rv0[i] + Rv1[i] * far_rate / r) / r}};
  }
  return table_2;
}

}  // namespace manutec_r3::drive
