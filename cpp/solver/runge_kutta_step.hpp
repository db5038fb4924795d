// One explicit Runge-Kutta step of any size, with the coefficients that ARKODE has.
//
//   k_i = f(t0 + c_i h, x0 + h sum_j a_ij k_j),   x = x0 + h sum_i b_i k_i
//
// Inside an accepted step it gives the solution with the method's own accuracy, and it has no
// smallest size. Far from events the polynomial through the ends of some steps, and the rates
// there, does so as well: it takes no evaluation.
#pragma once

#include <vector>

#include "hybrid/integrator.hpp"
#include "solver/sundials.hpp"

namespace manutec_r3::solver {

// Verner's "most efficient" pair of order 7(6), ten stages, of which the last serves the estimate
// of the error alone: here it is left out. Among ARKODE's tables of order 5 to 8 it reaches a given
// accuracy with the fewest evaluations: steps are limited by stability.
//
// `step.dense` is the state x0 at the step's beginning; and, for the polynomial, state and rates at
// its end, and the instant of that, for a step may be cut off later.
class RungeKuttaStep : public hybrid::DenseOutput {
 public:
  RungeKuttaStep(RightHandSide& f, double relative_tolerance);

  // Fill in a step from x0 at t0 to x1 at t1.
  void begin(hybrid::Step& step, double t0, const double* x0);
  void end(hybrid::Step& step, double t1, const double* x1);

  // By a step from its beginning.
  void evaluate(const hybrid::Step& step, double t, double* x) override;
  // By the polynomial, if it can be believed; else as `evaluate`.
  void interpolate(const hybrid::Stretch& stretch, double t, double* x) override;

 private:
  // The coefficients that are not zero, and the stages they belong to.
  struct Weight {
    double weight;
    int stage;
  };
  using Row = std::vector<Weight>;

  static Row row(const double* weights, int count);
  bool interpolate_all(const hybrid::Stretch& stretch, double t, double* x);

  RightHandSide& f_;
  std::vector<Row> a_;
  Row b_;
  std::vector<double> c_;
  std::vector<double> k_;  // stage by stage
  std::vector<Term> terms_;
  double tolerance_;  // relative, also to the nominal values
  std::vector<double> nominals_;
};

}  // namespace manutec_r3::solver
