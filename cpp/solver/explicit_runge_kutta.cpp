#include "solver/explicit_runge_kutta.hpp"

#include <arkode/arkode.h>
#include <arkode/arkode_erkstep.h>
#include <sunadaptcontroller/sunadaptcontroller_soderlind.h>

#include <algorithm>
#include <cmath>

#include "hybrid/crossing.hpp"
#include "hybrid/failure.hpp"

namespace manutec_r3::solver {
namespace {

// The first step of a run, if nothing is known: shorter than the fastest time constant here.
constexpr double first_size = 1e-4;
// Steps may grow as much after a restart as at any other time: a restart is no reason for caution,
// and a run that is saved and continued takes the same steps.
constexpr double largest_growth = 20.0;
// In one step; each makes it shorter by a factor of three or more.
constexpr int most_rejections = 100;

}  // namespace

ExplicitRungeKutta::ExplicitRungeKutta(hybrid::System& system, double relative_tolerance)
    : f_(system), inside_(f_, relative_tolerance), x_(system.n_states(), context_) {
  arkode_ = ERKStepCreate(&RightHandSide::call, 0.0, x_, context_);
  if (arkode_ == nullptr) throw hybrid::SimulationFailure(context_.message());
  Vector absolute(system.n_states(), context_);
  set_absolute_tolerances(system, relative_tolerance, absolute);
  check(ARKodeSVtolerances(arkode_, relative_tolerance, absolute));
  check(ARKodeSetUserData(arkode_, &f_));
  check(ERKStepSetTableNum(arkode_, ARKODE_VERNER_10_6_7));
  check(ARKodeSetInterpolantType(arkode_, ARK_INTERP_NONE));
  // An integral controller with this safety factor avoids most of the rejections that steps at the
  // limit of stability suffer otherwise. Defaults of these differ between versions of SUNDIALS.
  controller_ = SUNAdaptController_I(context_);
  check(SUNAdaptController_SetErrorBias(controller_, 1.0));
  check(ARKodeSetAdaptController(arkode_, controller_));
  check(ARKodeSetSafetyFactor(arkode_, 0.8));
  check(ARKodeSetFixedStepBounds(arkode_, 1.0, 1.0));
  check(ARKodeSetMaxGrowth(arkode_, largest_growth));
  check(ARKodeSetMaxFirstGrowth(arkode_, largest_growth));
  // An event may make the system faster by many orders of magnitude: as many rejections as it
  // takes.
  check(ARKodeSetMaxErrTestFails(arkode_, most_rejections));
}

ExplicitRungeKutta::~ExplicitRungeKutta() {
  ARKodeFree(&arkode_);
  SUNAdaptController_Destroy(controller_);
}

void ExplicitRungeKutta::restart(double t, const double* x, double size) {
  f_.forget();
  t_ = t;
  std::copy_n(x, f_.system().n_states(), x_.data());
  next_size_ = size > 0.0 ? size : first_size;
  reset_ = true;
}

void ExplicitRungeKutta::advance(double stop, hybrid::Step& step, double* x1) {
  const int n = f_.system().n_states();
  inside_.begin(step, t_, x_.data());
  if (stop - t_ < shortest_size) {
    inside_.evaluate(step, stop, x1);
    inside_.end(step, stop, x1);
    t_ = stop;
    std::copy_n(x1, n, x_.data());
    reset_ = true;
    ++short_steps_;
    return;
  }
  // ARKODE would plan the step before a stop shorter than it is: what remains is left to us, so
  // that a run that is saved and continued takes the same steps.
  const bool reaches_stop = next_size_ >= stop - t_;
  if (reset_ || reaches_stop) {
    check(ARKodeReset(arkode_, t_, x_));
    check(ARKodeSetInitStep(arkode_, reaches_stop ? stop - t_ : next_size_));
    reset_ = false;
  }
  const int flag = ARKodeEvolve(arkode_, t_ + 1.0, x_, &t_, ARK_ONE_STEP);
  if (flag < 0) {
    restart(step.t0, step.dense.data(), next_size_);
    check(flag);
  }
  if (!(t_ > step.t0)) {
    throw hybrid::SimulationFailure("steps have become too short to advance the time");
  }
  double size = 0.0;
  check(ARKodeGetCurrentStep(arkode_, &size));
  if (t_ >= stop - hybrid::simultaneous(stop)) {
    // The step was cut short; the size planned before says more than what it was cut to.
    t_ = stop;
    next_size_ = std::max(next_size_, size);
    reset_ = true;
  } else {
    next_size_ = size;
  }
  std::copy_n(x_.data(), n, x1);
  inside_.end(step, t_, x1);
}

void ExplicitRungeKutta::cut(hybrid::Step& step, double t, const double* x) {
  inside_.end(step, t, x);
}

void ExplicitRungeKutta::derivatives(double t, const double* x, double* derivatives) {
  f_.evaluate_and_keep(t, x, derivatives);
}

void ExplicitRungeKutta::evaluate(const hybrid::Step& step, double t, double* x) {
  inside_.evaluate(step, t, x);
}

void ExplicitRungeKutta::interpolate(const hybrid::Stretch& stretch, double t, double* x) {
  inside_.interpolate(stretch, t, x);
}

hybrid::Work ExplicitRungeKutta::work() const {
  hybrid::Work work{.evaluations = f_.evaluations()};
  ARKodeGetNumSteps(arkode_, &work.steps);
  ARKodeGetNumErrTestFails(arkode_, &work.rejected_steps);
  work.steps += short_steps_;
  return work;
}

void ExplicitRungeKutta::check(int flag) {
  if (flag >= 0) return;
  f_.rethrow();
  throw hybrid::SimulationFailure(context_.message());
}

}  // namespace manutec_r3::solver
