// Elements with a zone from -half_width to +half_width: NL1, NL2, NL4 and the limit on U. A branch
// is -1, 0 or +1: below, inside or above.
#pragma once

#include <cmath>

namespace manutec_r3::robot {

inline int sign(double value) { return (value > 0.0) - (value < 0.0); }

// The branch of a value; on an edge it is where its rate leads.
inline int zone(double value, double rate, double half_width) {
  const bool outside =
      std::abs(value) > half_width || (std::abs(value) == half_width && sign(value) * rate > 0.0);
  return outside ? sign(value) : 0;
}

// The branch after a value has reached an edge: it changes the zone if it goes on, and has only
// touched the edge if it goes back. With zero rate it has been seen to go on.
inline int zone_beyond(int branch, bool lower_edge, double rate) {
  const bool inside = branch == 0;
  const int outside = inside ? (lower_edge ? -1 : +1) : branch;
  const bool outward = rate == 0.0 ? inside : outside * rate > 0.0;
  return outward ? outside : 0;
}

}  // namespace manutec_r3::robot
