// Where a function of time leaves its domain, on analytic functions.
#include "hybrid/crossing.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "check.hpp"
#include "run.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Cubic;
using hybrid::leave_domain;
using hybrid::simultaneous;

constexpr double pi = std::numbers::pi;

struct Found {
  double t;
  int evaluations;
};

Found search(const std::function<double(double)>& z, double inside, double outside, double guess) {
  int evaluations = 0;
  const auto counted = [&](double t) {
    CHECK(t > inside && t < outside);  // the function is never asked outside the bracket
    ++evaluations;
    return z(t);
  };
  const double t = leave_domain(counted, inside, z(inside), outside, z(outside), guess);
  return {t, evaluations};
}

// The guess of the simulation: the root of the cubic through both ends.
double guess(const std::function<double(double)>& z, double inside, double outside) {
  const auto slope = [&](double t) { return (z(t + 1e-7) - z(t)) / 1e-7; };
  return Cubic({inside, z(inside), slope(inside)}, {outside, z(outside), slope(outside)})
      .root(inside, outside);
}

TEST(SimultaneousMeansFourUnitsInTheLastPlace) {
  for (const double t : {1.0, 0.3, 1e-9, 1e5}) {
    CHECK_EQUAL(simultaneous(t), 4.0 * ulp(t));
    CHECK_EQUAL(simultaneous(-t), simultaneous(t));
  }
  CHECK(simultaneous(0.0) > 0.0);
}

TEST(ASmoothFunctionLeavesItsDomainWithinAnUlpInFewEvaluations) {
  struct Case {
    std::function<double(double)> z;
    double inside, outside, root;
  };
  // Lengths of integration steps, over which the functions bend a little or much.
  const std::vector<Case> cases = {
      {[](double t) { return 0.5 - t; }, 0.0, 1.0, 0.5},
      {[](double t) { return std::cos(t); }, 1.0, 1.9, pi / 2},
      {[](double t) { return 0.3 - std::sin(t); }, 0.0, 1.0, std::asin(0.3)},
      {[](double t) { return std::exp(-t) - 0.5; }, 0.0, 2.0, std::log(2.0)},
      {[](double t) { return 2.0 - t * t * t; }, 1.0, 1.5, std::cbrt(2.0)},
      {[](double t) { return std::sin(1000.0 * t); }, 1.0, 1.0024, 319 * pi / 1000.0},
      {[](double t) { return -std::tan(t - 1.0); }, 0.5, 1.5, 1.0},
  };
  for (const Case& c : cases) {
    const Found found = search(c.z, c.inside, c.outside, guess(c.z, c.inside, c.outside));
    // Slopes are about 1, so z is known to an ulp of t or two; where the slope is 1000, z has the
    // roundoff of an argument of 1000.
    CHECK_NEAR(found.t, c.root, 2.0 * ulp(c.root));
    CHECK(found.evaluations <= 7);
    CHECK(c.z(found.t) <= 0.0);  // it has left
  }
}

TEST(ABadGuessCostsLittle) {
  const auto z = [](double t) { return 0.3 - std::sin(t); };
  for (const double bad : {0.0, 1e-9, 0.9, 1.0}) {
    const Found found = search(z, 0.0, 1.0, bad);
    CHECK_NEAR(found.t, std::asin(0.3), 2.0 * ulp(0.3));
    CHECK(found.evaluations <= 12);
  }
}

TEST(WhatIsFoundIsOutOfTheDomainAndOneOrTwoUnitsEarlierIsNot) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int k = 0; k < 1000; ++k) {
    const double root = uniform(random), bend = uniform(random) - 0.5;
    const auto z = [&](double t) { return (root - t) * (1.0 + bend * (t - root)); };
    const double outside = root + (1.0 - root) * uniform(random) + 1e-12;
    const Found found = search(z, 0.0, outside, guess(z, 0.0, outside));
    CHECK(z(found.t) <= 0.0);
    CHECK(z(found.t - 2.0 * ulp(outside)) > 0.0);
    CHECK(found.evaluations <= 12);
  }
}

TEST(NastyFunctionsEndToo) {
  constexpr double root = 0.3701;
  const std::vector<std::function<double(double)>> nasty = {
      [](double t) { return t < root ? 1.0 : -1.0; },       // a jump
      [](double t) { return t < root ? 1e-300 : -1e300; },  // of other heights
      [](double t) { return t < root ? 1e300 : -1e-300; },
      [](double t) { return t < root ? 1.0 : 0.0; },                          // to exactly zero
      [](double t) { return std::cbrt(root - t); },                           // vertical
      [](double t) { return std::pow(root - t, 9); },                         // flat
      [](double t) { return t < root ? std::exp(-1.0 / (root - t)) : 0.0; },  // flatter
      [](double t) { return 1.0 / (root - t); },                              // a pole
      [](double t) { return t < root ? 1e-12 : root - t - 1e6; },             // small, then steep
  };
  for (const auto& z : nasty) {
    for (const double from : {0.0, 0.1, 0.3}) {
      const Found found = search(z, from, 1.0, 0.5 * (from + 1.0));
      // At worst every sixth evaluation halves the bracket, of 53 bits.
      CHECK(found.evaluations <= 6 * 55);
      // An ulp of roundoff beside a pole, where the function is infinite.
      CHECK(z(found.t) <= 0.0 || z(std::nextafter(found.t, 1.0)) <= 0.0);
      if (z(root - 1e-9) > 0.0) CHECK_NEAR(found.t, root, 1e-9);
    }
  }
}

TEST(ABracketOfSomeUnitsIsNotDividedFurther) {
  const double t = 0.7, next = std::nextafter(t, 1.0);
  int evaluations = 0;
  const auto z = [&](double) {
    ++evaluations;
    return 1.0;
  };
  CHECK_EQUAL(leave_domain(z, t, 1.0, next, -1.0, next), next);
  CHECK_EQUAL(evaluations, 0);
}

TEST(ARootNextToZeroIsFoundToItsOwnUnits) {
  // Units in the last place of t shrink with it: instants right after t = 0 are far apart in them.
  for (const double root : {1e-6, 1e-12, 1e-20}) {
    const auto z = [root](double t) { return root - t; };
    const Found found = search(z, 0.0, 1e-3, 0.5e-3);
    CHECK_NEAR(found.t, root, 2.0 * ulp(root));
  }
}

// --- the cubic -----------------------------------------------------------------------------------

TEST(ACubicMeetsItsSamples) {
  const Cubic cubic({1.0, 2.0, -3.0}, {1.5, 0.25, 4.0});
  CHECK_NEAR(cubic(1.0), 2.0, 1e-15);  // roundoff of numbers of order one
  CHECK_NEAR(cubic(1.5), 0.25, 1e-15);
  constexpr double h = 1e-6;
  // Truncation of the differences, half of h times the second derivative of some 100.
  CHECK_NEAR((cubic(1.0 + h) - cubic(1.0)) / h, -3.0, 1e-4);
  CHECK_NEAR((cubic(1.5) - cubic(1.5 - h)) / h, 4.0, 1e-4);
}

TEST(ACubicThatIsOneIsItself) {
  // (t - 1)(t - 2)(t - 4) = t^3 - 7 t^2 + 14 t - 8, extrema at (7 -+ sqrt(7))/3
  const auto z = [](double t) { return (t - 1.0) * (t - 2.0) * (t - 4.0); };
  const auto slope = [](double t) { return 3.0 * t * t - 14.0 * t + 14.0; };
  const Cubic cubic({0.0, z(0.0), slope(0.0)}, {5.0, z(5.0), slope(5.0)});
  for (int k = 0; k <= 50; ++k) {  // values to 12, slopes to 19
    CHECK_NEAR(cubic(0.1 * k), z(0.1 * k), 1e-13);
    CHECK_NEAR(cubic.slope(0.1 * k), slope(0.1 * k), 1e-13);
  }
  CHECK(cubic.maximum() && cubic.minimum());
  CHECK_NEAR(*cubic.maximum(), (7.0 - std::sqrt(7.0)) / 3.0, 1e-14);
  CHECK_NEAR(*cubic.minimum(), (7.0 + std::sqrt(7.0)) / 3.0, 1e-14);
  CHECK_NEAR(cubic.root(1.5, 3.0), 2.0, 1e-14);
}

TEST(AnExtremumOutsideTheSamplesIsNone) {
  // (t - 1)^2 from samples on either side of its minimum, and not
  const auto parabola = [](double a, double b) {
    return Cubic({a, (a - 1.0) * (a - 1.0), 2.0 * (a - 1.0)},
                 {b, (b - 1.0) * (b - 1.0), 2.0 * (b - 1.0)});
  };
  CHECK(parabola(0.0, 3.0).minimum().has_value());
  CHECK_NEAR(*parabola(0.0, 3.0).minimum(), 1.0, 1e-15);
  CHECK(!parabola(0.0, 3.0).maximum());
  CHECK(!parabola(1.1, 3.0).minimum());
  CHECK(!parabola(0.0, 0.9).minimum());
  // A straight line, and a cubic that rises all the way.
  CHECK(!Cubic({0.0, 1.0, -1.0}, {1.0, 0.0, -1.0}).minimum());
  CHECK(!Cubic({0.0, 1.0, -1.0}, {1.0, 0.0, -1.0}).maximum());
  CHECK(!Cubic({-1.0, -1.0, 1.5}, {1.0, 1.0, 1.5}).minimum());
  CHECK(!Cubic({-1.0, -1.0, 1.5}, {1.0, 1.0, 1.5}).maximum());
}

}  // namespace
}  // namespace manutec_r3::testing
