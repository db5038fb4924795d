// The load: a point mass mL at rL, given in the frame of arm 6, whose origin is H5 (spec 3).
#pragma once

#include <array>

namespace manutec_r3::arm {

struct Load {
  double mass = 0;                                // [kg]
  std::array<double, 3> position = {0, 0, 0.25};  // [m]
  bool bounds = true;                             // false: only nonsense is refused

  bool operator==(const Load&) const = default;
};

// Throws std::invalid_argument unless the robot may carry this load:
//   0 <= mL <= 15 kg, 0 <= sqrt(rL_1^2 + rL_2^2) <= 0.1 m, 0.15 <= rL_3 <= 0.25 m.
void check(const Load& load);

}  // namespace manutec_r3::arm
