// Backward differentiation formulas (BDF) of variable order from CVODE, dense Newton iteration.
#pragma once

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <vector>

#include "hybrid/integrator.hpp"
#include "solver/sundials.hpp"

namespace manutec_r3::solver {

inline constexpr int bdf_largest_order = 5;

// The polynomial through which BDF itself sees a step: derivatives at its end, up to its order.
class BackwardDifferencesStep : public hybrid::DenseOutput {
 public:
  explicit BackwardDifferencesStep(int n_states) : n_(n_states) {}

  // `step.dense` holds the state at the step's beginning, which the polynomial meets only within
  // the tolerance; the end of the step as BDF took it (it may be cut off later); and there x, x',
  // ..., x^(5), zero above the step's order.
  void evaluate(const hybrid::Step& step, double t, double* x) override;

 private:
  int n_;
};

class BackwardDifferences final : public hybrid::Integrator {
 public:
  BackwardDifferences(hybrid::System& system, double relative_tolerance);
  ~BackwardDifferences() override;

  void restart(double t, const double* x, double size) override;
  void advance(double stop, hybrid::Step& step, double* x1) override;
  double next_size() const override { return 0.0; }
  void derivatives(double t, const double* x, double* derivatives) override;
  void evaluate(const hybrid::Step& step, double t, double* x) override;
  hybrid::Work work() const override;

 private:
  hybrid::Work since_restart() const;
  void check(int flag);

  Context context_;
  RightHandSide f_;
  BackwardDifferencesStep inside_;
  Vector x_, derivative_;
  void* cvode_ = nullptr;
  SUNMatrix jacobian_ = nullptr;
  SUNLinearSolver linear_solver_ = nullptr;
  double t_ = 0.0;
  hybrid::Work before_restart_;  // CVODE counts anew after each restart
};

}  // namespace manutec_r3::solver
