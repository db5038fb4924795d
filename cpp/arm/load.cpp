// The bounds of the load (spec 3).
#include "arm/load.hpp"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace manutec_r3::arm {
namespace {

struct Range {
  double lowest, highest;
};

constexpr Range mass_range = {0, 15};           // mL [kg]
constexpr Range eccentricity_range = {0, 0.1};  // sqrt(rL_1^2 + rL_2^2) [m]
constexpr Range distance_range = {0.15, 0.25};  // rL_3 [m]

// A value on a bound may have been computed: rounding shall not refuse it.
constexpr double roundoff = 1e-12;

[[noreturn]] void refuse(const std::string& field, const std::string& expected, double value,
                         const std::string& unit) {
  std::ostringstream message;
  message.precision(std::numeric_limits<double>::digits10);
  message << field << ": expected " << expected << ", got " << value << ' ' << unit;
  throw std::invalid_argument(message.str());
}

void require(const std::string& field, const Range& range, double value, const std::string& unit) {
  if (value >= range.lowest - roundoff && value <= range.highest + roundoff) return;
  std::ostringstream expected;
  expected << range.lowest << " to " << range.highest << ' ' << unit;
  refuse(field, expected.str(), value, unit);
}

void refuse_nonsense(const Load& load) {
  if (!std::isfinite(load.mass) || load.mass < 0) {
    refuse("load.mass", "a finite value of 0 kg or more", load.mass, "kg");
  }
  for (int i = 0; i < 3; ++i) {
    if (std::isfinite(load.position[i])) continue;
    refuse("load.position[" + std::to_string(i) + "]", "a finite value in m", load.position[i],
           "m");
  }
}

}  // namespace

void check(const Load& load) {
  refuse_nonsense(load);
  if (!load.bounds) return;
  const auto [x, y, z] = load.position;
  require("load.mass", mass_range, load.mass, "kg");
  require("load.position, distance from axis 6", eccentricity_range, std::hypot(x, y), "m");
  require("load.position[2]", distance_range, z, "m");
}

}  // namespace manutec_r3::arm
