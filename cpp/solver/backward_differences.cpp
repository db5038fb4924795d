#include "solver/backward_differences.hpp"

#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>

#include "hybrid/failure.hpp"

// CVODES does all that CVODE does, by the same calls.
#if __has_include(<cvodes/cvodes.h>)
#include <cvodes/cvodes.h>
#else
#include <cvode/cvode.h>

#endif

namespace manutec_r3::solver {
namespace {

// The formulas of higher order amplify undamped oscillations whose period is a few steps.
constexpr int order_if_it_rings = 2;

}  // namespace

void BackwardDifferencesStep::evaluate(const hybrid::Step& step, double t, double* x) {
  if (t == step.t0) {
    std::copy_n(step.dense.data(), n_, x);
    return;
  }
  // Taylor's polynomial, by Horner's rule.
  const double h = t - step.dense[n_];
  const double* derivatives = &step.dense[n_ + 1];
  std::copy_n(derivatives + bdf_largest_order * n_, n_, x);
  for (int order = bdf_largest_order; order > 0; --order) {
    const double* lower = derivatives + (order - 1) * n_;
    const double factor = h / order;
    for (int s = 0; s < n_; ++s) x[s] = lower[s] + factor * x[s];
  }
}

BackwardDifferences::BackwardDifferences(hybrid::System& system, double relative_tolerance)
    : f_(system),
      inside_(system.n_states()),
      x_(system.n_states(), context_),
      derivative_(system.n_states(), context_) {
  const int n = system.n_states();
  cvode_ = CVodeCreate(CV_BDF, context_);
  if (cvode_ == nullptr) throw hybrid::SimulationFailure(context_.message());
  check(CVodeInit(cvode_, &RightHandSide::call, 0.0, x_));
  Vector absolute(n, context_);
  set_absolute_tolerances(system, relative_tolerance, absolute);
  check(CVodeSVtolerances(cvode_, relative_tolerance, absolute));
  check(CVodeSetUserData(cvode_, &f_));
  if (system.rings()) check(CVodeSetMaxOrd(cvode_, order_if_it_rings));
  jacobian_ = SUNDenseMatrix(n, n, context_);
  linear_solver_ = SUNLinSol_Dense(x_, jacobian_, context_);
  check(CVodeSetLinearSolver(cvode_, linear_solver_, jacobian_));
}

BackwardDifferences::~BackwardDifferences() {
  CVodeFree(&cvode_);
  SUNLinSolFree(linear_solver_);
  SUNMatDestroy(jacobian_);
}

void BackwardDifferences::restart(double t, const double* x, double) {
  const hybrid::Work latest = since_restart();
  before_restart_.steps += latest.steps;
  before_restart_.rejected_steps += latest.rejected_steps;
  f_.forget();
  t_ = t;
  std::copy_n(x, f_.system().n_states(), x_.data());
  check(CVodeReInit(cvode_, t, x_));
}

void BackwardDifferences::advance(double stop, hybrid::Step& step, double* x1) {
  const int n = f_.system().n_states();
  step.t0 = t_;
  step.dense.assign(n + 1 + (bdf_largest_order + 1) * n, 0.0);
  std::copy_n(x_.data(), n, step.dense.data());
  double* kept = &step.dense[n + 1];
  if (stop - t_ < shortest_size) {
    // Over so short a time Euler's rule is exact.
    f_.evaluate(t_, x_.data(), derivative_.data());
    for (int s = 0; s < n; ++s) x1[s] = x_.data()[s] + (stop - t_) * derivative_.data()[s];
    std::copy_n(derivative_.data(), n, kept + n);
    t_ = stop;
    restart(t_, x1, 0.0);
    ++before_restart_.steps;
  } else {
    check(std::isfinite(stop) ? CVodeSetStopTime(cvode_, stop) : CVodeClearStopTime(cvode_));
    const int flag = CVode(cvode_, t_ + 1.0, x_, &t_, CV_ONE_STEP);
    check(flag);
    if (!(t_ > step.t0)) {
      throw hybrid::SimulationFailure("steps have become too short to advance the time");
    }
    f_.system().hold(x_.data());
    std::copy_n(x_.data(), n, x1);
    int order = 0;
    check(CVodeGetLastOrder(cvode_, &order));
    for (int k = 1; k <= order; ++k) {
      check(CVodeGetDky(cvode_, t_, k, derivative_));
      std::copy_n(derivative_.data(), n, kept + k * n);
      f_.system().hold(kept + k * n);
    }
    if (flag == CV_TSTOP_RETURN) t_ = stop;
  }
  std::copy_n(x1, n, kept);
  step.dense[n] = step.t1 = t_;
}

void BackwardDifferences::derivatives(double t, const double* x, double* derivatives) {
  f_.evaluate_and_keep(t, x, derivatives);
}

void BackwardDifferences::evaluate(const hybrid::Step& step, double t, double* x) {
  inside_.evaluate(step, t, x);
}

hybrid::Work BackwardDifferences::since_restart() const {
  hybrid::Work work;
  long convergence_failures = 0;
  CVodeGetNumSteps(cvode_, &work.steps);
  CVodeGetNumErrTestFails(cvode_, &work.rejected_steps);
  CVodeGetNumStepSolveFails(cvode_, &convergence_failures);
  work.rejected_steps += convergence_failures;
  return work;
}

hybrid::Work BackwardDifferences::work() const {
  const hybrid::Work latest = since_restart();
  return {.evaluations = f_.evaluations(),
          .steps = before_restart_.steps + latest.steps,
          .rejected_steps = before_restart_.rejected_steps + latest.rejected_steps};
}

void BackwardDifferences::check(int flag) {
  if (flag >= 0) return;
  f_.rethrow();
  throw hybrid::SimulationFailure(context_.message());
}

}  // namespace manutec_r3::solver
