// One explicit Runge-Kutta step of any size, with the coefficients that ARKODE has.
//
//   k_i = f(t0 + c_i h, x0 + h sum_j a_ij k_j),   x = x0 + h sum_i b_i k_i
//
// Inside an accepted step it gives the solution with the method's own accuracy, where an
// interpolant of lower degree would not; and it has no smallest size.
#pragma once

#include <vector>

#include "hybrid/integrator.hpp"
#include "solver/sundials.hpp"

namespace manutec_r3::solver {

// Verner's "most efficient" pair of order 7(6), ten stages, of which the last serves the estimate
// of the error alone: here it is left out. Among ARKODE's tables of order 5 to 8 it reaches a given
// accuracy with the fewest evaluations: steps are limited by stability.
class RungeKuttaStep : public hybrid::DenseOutput {
 public:
  explicit RungeKuttaStep(RightHandSide& f);

  // `step.dense` is the state at the step's beginning.
  void evaluate(const hybrid::Step& step, double t, double* x) override;

 private:
  // The coefficients that are not zero, and the stages they belong to.
  struct Weight {
    double weight;
    int stage;
  };
  using Row = std::vector<Weight>;

  static Row row(const double* weights, int count);

  RightHandSide& f_;
  std::vector<Row> a_;
  Row b_;
  std::vector<double> c_;
  std::vector<double> k_;  // stage by stage
  std::vector<Term> terms_;
};

}  // namespace manutec_r3::solver
