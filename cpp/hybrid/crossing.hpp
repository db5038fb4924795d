// Where a smooth function of time crosses zero, given few and expensive evaluations of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace manutec_r3::hybrid {

// Instants closer than this are one instant.
inline double simultaneous(double t) {
  return 4.0 * (std::nextafter(std::abs(t), std::numeric_limits<double>::infinity()) - std::abs(t));
}

struct Sample {
  double t, z, slope;
};

// The cubic polynomial through two samples and their slopes.
class Cubic {
 public:
  Cubic(Sample a, Sample b);

  double operator()(double t) const;
  double slope(double t) const;
  // The instant inside (a.t, b.t) where the cubic has its minimum or maximum, if it is there.
  std::optional<double> minimum() const { return extremum(+1.0); }
  std::optional<double> maximum() const { return extremum(-1.0); }
  // A sign change between a point where it is positive and a later one where it is not.
  double root(double inside, double outside) const;

 private:
  std::optional<double> extremum(double curvature_sign) const;

  double t0_, h_;
  double c0_, c1_, c2_, c3_;  // in s = (t - t0) / h
};

// The same polynomial at one instant t, for many functions known at a and b with their slopes.
class CubicWeights {
 public:
  CubicWeights(double a, double b, double t);

  template <class Values>
  auto operator()(const Values& z_a, const Values& slope_a, const Values& z_b,
                  const Values& slope_b) const {
    return z_a_ * z_a + slope_a_ * slope_a + z_b_ * z_b + slope_b_ * slope_b;
  }

 private:
  double z_a_, slope_a_, z_b_, slope_b_;
};

// The first instant found at which z(t) <= 0, within roundoff of t, of a function that is positive
// at `inside` and not positive at the later `outside`. `guess` lies between them. z is evaluated
// about four times if it is smooth and the guess is good; the bracket never fails to shrink.
template <class Function>
double leave_domain(Function&& z, double inside, double z_inside, double outside, double z_outside,
                    double guess) {
  double t = guess;
  double width_before = std::numeric_limits<double>::infinity();
  for (int evaluations = 1;; ++evaluations) {
    const double width = outside - inside;
    const double resolution = 0.25 * simultaneous(outside);
    if (width <= 2.0 * resolution) return outside;
    // From the estimate's own error the secant ends on one side of the root: a step of the size of
    // the resolution to the other side closes the bracket.
    t = std::clamp(t, inside + resolution, outside - resolution);
    const double value = z(t);
    const double z_near = value > 0.0 ? z_inside : z_outside;
    const double t_near = value > 0.0 ? inside : outside;
    (value > 0.0 ? inside : outside) = t;
    (value > 0.0 ? z_inside : z_outside) = value;
    // Secant through the two latest points on one side, if it stays in the bracket; else through
    // both sides.
    double next = t - value * (t - t_near) / (value - z_near);
    if (!(next > inside && next < outside)) {
      next = inside + (outside - inside) * z_inside / (z_inside - z_outside);
    }
    if (!std::isfinite(next)) next = 0.5 * (inside + outside);
    // Bisection if three evaluations have not halved the bracket.
    if (evaluations % 3 == 0) {
      if (outside - inside > 0.5 * width_before) next = 0.5 * (inside + outside);
      width_before = outside - inside;
    }
    t = next;
  }
}

}  // namespace manutec_r3::hybrid
