// What Table 3 must be to describe rigid bodies (spec 3).
#include "arm/parameters.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "arm/moments.hpp"

namespace manutec_r3::arm {
namespace {

template <class Value>
[[noreturn]] void refuse(const std::string& where, const std::string& expected, Value got) {
  std::ostringstream message;
  message << "table_3 " << where << ": expected " << expected << ", got " << got;
  throw std::invalid_argument(message.str());
}

std::string of(const std::string& symbol, const std::string& arm) { return symbol + " of " + arm; }

void require_finite(const std::string& where, double value, const std::string& unit) {
  if (!std::isfinite(value)) refuse(where, "a finite value [" + unit + "]", value);
}

void require_finite(const std::string& where, const std::array<double, 3>& values,
                    const std::string& unit) {
  for (const double value : values) require_finite(where, value, unit);
}

void require_not_negative(const std::string& where, double value, const std::string& unit) {
  if (!std::isfinite(value) || value < 0) {
    refuse(where, "a finite value of 0 " + unit + " or more", value);
  }
}

// Of a body that only turns about z nothing but I33 has a meaning.
void check_body(const Body& body, const std::string& name, bool only_about_z = false) {
  const auto& [mass, centre, I11, I22, I33, I13] = body;
  Body::for_each_number(body, [&name](const char* symbol, const char* unit, const auto& value) {
    require_finite(of(symbol, name), value, unit);
  });
  require_not_negative(of("mass", name), mass, "kg");
  require_not_negative(of("I11", name), I11, "kg m^2");
  require_not_negative(of("I22", name), I22, "kg m^2");
  require_not_negative(of("I33", name), I33, "kg m^2");
  if (only_about_z || (I11 == 0 && I22 == 0 && I13 == 0)) return;

  // The triangle inequality of the principal moments says that no second moment is negative.
  Body about_centre = body;
  about_centre.centre = {0, 0, 0};
  const SymmetricTensor J = moments(about_centre).J;
  const double roundoff = 1e-12 * (I11 + I22 + I33);
  if (J.xx < -roundoff || J.yy < -roundoff || J.zz < -roundoff ||
      J.xx * J.zz - J.xz * J.xz < -roundoff * (J.xx + J.zz)) {
    std::ostringstream got;
    got << "I11 = " << I11 << ", I22 = " << I22 << ", I33 = " << I33 << ", I13 = " << I13
        << " kg m^2";
    refuse(of("inertia", name), "principal moments none of which exceeds the sum of the others",
           got.str());
  }
}

}  // namespace

void check(const Table3& table) {
  for (int j = 0; j < n_axes; ++j) {
    const std::string name = "arm " + std::to_string(j + 1);
    require_finite(of("offset", name), table.arms[j].offset, "m");
    check_body(table.arms[j].body, name, j == 0);
  }
  check_body(table.lumped_arm_3, "lumped_arm_3");
  for (int j = 0; j < n_axes; ++j) {
    const std::string axis = "axis " + std::to_string(j + 1);
    const double rJ = table.rotor_inertia[j];
    if (!(std::isfinite(rJ) && rJ > 0)) refuse(of("rJ", axis), "a positive value [kg m^2]", rJ);
    const double limit = table.joint_limits[j];
    if (!(limit > 0)) refuse(of("joint_limits", axis), "a positive angle [rad]", limit);
  }
  require_finite("gravity", table.gravity, "m/s^2");
  require_finite("shoulder_height", table.shoulder_height, "m");
}

}  // namespace manutec_r3::arm
