#include "hybrid/crossing.hpp"

namespace manutec_r3::hybrid {

Cubic::Cubic(Sample a, Sample b) : t0_(a.t), h_(b.t - a.t) {
  const double rise = b.z - a.z;
  c0_ = a.z;
  c1_ = h_ * a.slope;
  c2_ = 3.0 * rise - h_ * (2.0 * a.slope + b.slope);
  c3_ = h_ * (a.slope + b.slope) - 2.0 * rise;
}

double Cubic::operator()(double t) const {
  const double s = (t - t0_) / h_;
  return c0_ + s * (c1_ + s * (c2_ + s * c3_));
}

double Cubic::slope(double t) const {
  const double s = (t - t0_) / h_;
  return (c1_ + s * (2.0 * c2_ + s * 3.0 * c3_)) / h_;
}

std::optional<double> Cubic::extremum(double curvature_sign) const {
  // c1 + 2 c2 s + 3 c3 s^2 = 0 with second derivative 2 c2 + 6 c3 s of the sign asked for.
  const double discriminant = c2_ * c2_ - 3.0 * c3_ * c1_;
  if (discriminant < 0.0) return {};
  const double root = curvature_sign * std::sqrt(discriminant);
  // The form without cancellation.
  const double s = c2_ * curvature_sign > 0.0 ? -c1_ / (c2_ + root) : (root - c2_) / (3.0 * c3_);
  if (!(s > 0.0 && s < 1.0)) return {};
  return t0_ + s * h_;
}

double Cubic::root(double inside, double outside) const {
  // Bisection: sixty halvings of a polynomial cost less than one evaluation of the system.
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = 0.5 * (inside + outside);
    ((*this)(middle) > 0.0 ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

CubicWeights::CubicWeights(double a, double b, double t) {
  const double h = b - a, s = (t - a) / h, r = 1.0 - s;
  z_a_ = r * r * (1.0 + 2.0 * s);
  z_b_ = s * s * (1.0 + 2.0 * r);
  slope_a_ = h * s * r * r;
  slope_b_ = -h * s * s * r;
}

}  // namespace manutec_r3::hybrid
