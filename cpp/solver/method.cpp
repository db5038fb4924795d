#include "solver/method.hpp"

#include "solver/backward_differences.hpp"
#include "solver/explicit_runge_kutta.hpp"
#include "solver/exponential_collocation.hpp"
#include "solver/runge_kutta_step.hpp"

namespace manutec_r3::solver {
namespace {

// A Runge-Kutta step that brings its own right-hand side along.
class RungeKuttaOutput final : public hybrid::DenseOutput {
 public:
  RungeKuttaOutput(hybrid::System& system, double relative_tolerance)
      : f_(system), inside_(f_, relative_tolerance) {}
  void evaluate(const hybrid::Step& step, double t, double* x) override {
    inside_.evaluate(step, t, x);
  }
  void interpolate(const hybrid::Stretch& stretch, double t, double* x) override {
    inside_.interpolate(stretch, t, x);
  }

 private:
  RightHandSide f_;
  RungeKuttaStep inside_;
};

// A step of exponential collocation that brings its own blocks along.
class CollocationOutput final : public hybrid::DenseOutput {
 public:
  explicit CollocationOutput(hybrid::System& system)
      : blocks_(*system.linear_view()), inside_(blocks_) {}
  void mode_changed() override {
    blocks_.refresh();
    inside_.mode_changed();
  }
  void evaluate(const hybrid::Step& step, double t, double* x) override {
    inside_.evaluate(step, t, x);
  }

 private:
  CollocationBlocks blocks_;
  CollocationStep inside_;
};

}  // namespace

double default_tolerance(Method method) {
  switch (method) {
    case Method::bdf:
      return 1e-10;
    default:
      return 5e-8;
  }
}

std::unique_ptr<hybrid::Integrator> make_integrator(Method method, hybrid::System& system,
                                                    double relative_tolerance) {
  switch (method) {
    case Method::erk:
      return std::make_unique<ExplicitRungeKutta>(system, relative_tolerance);
    case Method::bdf:
      return std::make_unique<BackwardDifferences>(system, relative_tolerance);
    default:
      return std::make_unique<ExponentialCollocation>(system, relative_tolerance);
  }
}

std::unique_ptr<hybrid::DenseOutput> make_dense_output(Method method, hybrid::System& system,
                                                       double relative_tolerance) {
  switch (method) {
    case Method::erk:
      return std::make_unique<RungeKuttaOutput>(system, relative_tolerance);
    case Method::bdf:
      return std::make_unique<BackwardDifferencesStep>(system.n_states());
    default:
      return std::make_unique<CollocationOutput>(system);
  }
}

}  // namespace manutec_r3::solver
