#include "solver/method.hpp"

#include "solver/backward_differences.hpp"
#include "solver/explicit_runge_kutta.hpp"
#include "solver/runge_kutta_step.hpp"

namespace manutec_r3::solver {
namespace {

// A Runge-Kutta step that brings its own right-hand side along.
class RungeKuttaOutput final : public hybrid::DenseOutput {
 public:
  explicit RungeKuttaOutput(hybrid::System& system) : f_(system), inside_(f_) {}
  void evaluate(const hybrid::Step& step, double t, double* x) override {
    inside_.evaluate(step, t, x);
  }

 private:
  RightHandSide f_;
  RungeKuttaStep inside_;
};

}  // namespace

double default_tolerance(Method method) { return method == Method::erk ? 5e-8 : 1e-10; }

std::unique_ptr<hybrid::Integrator> make_integrator(Method method, hybrid::System& system,
                                                    double relative_tolerance) {
  if (method == Method::erk) {
    return std::make_unique<ExplicitRungeKutta>(system, relative_tolerance);
  }
  return std::make_unique<BackwardDifferences>(system, relative_tolerance);
}

std::unique_ptr<hybrid::DenseOutput> make_dense_output(Method method, hybrid::System& system) {
  if (method == Method::erk) return std::make_unique<RungeKuttaOutput>(system);
  return std::make_unique<BackwardDifferencesStep>(system.n_states());
}

}  // namespace manutec_r3::solver
