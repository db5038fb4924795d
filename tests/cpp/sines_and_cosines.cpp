// arm/sines_and_cosines.hpp against the mathematical library in extended precision.
#include "arm/sines_and_cosines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "check.hpp"

namespace manutec_r3::testing {
namespace {

using arm::largest_reduced_angle;
using arm::sines_and_cosines;

// What the header promises, in units of the last place; 1.7 have been seen in 2e7 angles.
constexpr double promised = 2.0;

double error_in_ulp(double computed, long double exact) {
  if (computed == exact) return 0.0;
  int exponent;
  std::frexp(static_cast<double>(exact), &exponent);
  const long double ulp = std::ldexp(1.0L, exponent - std::numeric_limits<double>::digits);
  return static_cast<double>(std::abs(computed - exact) / ulp);
}

// Of five angles, as a mechanism of six arms asks for.
double largest_error(const std::array<double, 5>& angles) {
  const auto [sine, cosine] = sines_and_cosines<5>(angles);
  double largest = 0.0;
  for (int i = 0; i < 5; ++i) {
    const long double angle = angles[i];
    largest = std::max({largest, error_in_ulp(sine[i], std::sin(angle)),
                        error_in_ulp(cosine[i], std::cos(angle))});
  }
  return largest;
}

TEST(SinesAndCosinesAreWithinTwoUnitsInTheLastPlace) {
  std::mt19937_64 random(1);
  for (const double range : {0.01, 0.8, 3.2, 30.0, largest_reduced_angle / 5.0}) {
    std::uniform_real_distribution<double> angle(-range, range);
    double largest = 0.0;
    for (int k = 0; k < 100'000; ++k) {
      largest = std::max(largest, largest_error({angle(random), angle(random), angle(random),
                                                 angle(random), angle(random)}));
    }
    CHECK(largest < promised);
  }
}

// There one of the two is tiny, and all its digits come from the last part of pi/2.
TEST(SinesAndCosinesNearMultiplesOfARightAngleKeepTheirDigits) {
  const double last = largest_reduced_angle / 5.0;
  for (int k = 1; k * std::numbers::pi / 2.0 < last - 1.0; ++k) {
    const double multiple = k * (std::numbers::pi / 2.0);
    CHECK(largest_error({multiple, -multiple, std::nextafter(multiple, 0.0),
                         std::nextafter(multiple, last), multiple * (1.0 + 1e-9)}) < promised);
  }
}

TEST(SinesAndCosinesOfZeroAreExact) {
  const auto [sine, cosine] = sines_and_cosines<2>({0.0, -0.0});
  CHECK(sine[0] == 0.0 && cosine[0] == 1.0);
  CHECK(sine[1] == 0.0 && cosine[1] == 1.0);
}

// One such angle leaves all of them to the library.
TEST(SinesAndCosinesOfAnglesOutOfRangeAreThoseOfTheLibrary) {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
  for (const double far : {1.01 * largest_reduced_angle, -1e6, 1e22, infinite, not_a_number}) {
    const std::array<double, 3> angles = {0.3, far, -2.0};
    const auto [sine, cosine] = sines_and_cosines<3>(angles);
    for (int i = 0; i < 3; ++i) {
      CHECK(sine[i] == std::sin(angles[i]) || std::isnan(angles[i]) || std::isinf(angles[i]));
      CHECK(cosine[i] == std::cos(angles[i]) || std::isnan(angles[i]) || std::isinf(angles[i]));
    }
    CHECK(std::isfinite(far) == std::isfinite(sine[1]));
    CHECK(std::isfinite(far) == std::isfinite(cosine[1]));
  }
}

}  // namespace
}  // namespace manutec_r3::testing
