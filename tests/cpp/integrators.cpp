// What the simulation relies on in an integrator, of both methods (solver/).
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "check.hpp"
#include "run.hpp"
#include "solver/hermite.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Step;

constexpr Method methods[] = {Method::erk, Method::bdf};

// x = sin t, v = cos t from (0, 1).
Scripted swing() {
  return Scripted(
      2, 1,
      [](double, const double* x, double* dx) {
        dx[0] = x[1];
        dx[1] = -x[0];
      },
      [](double, const double*, double* z) { z[0] = 1.0; });
}

TEST(AStepEndsAtTheStopExactlyAndNeverBeyondIt) {
  for (const Method method : methods) {
    Scripted system = swing();
    const auto integrator = solver::make_integrator(method, system, 1e-8);
    std::vector<double> x = {0.0, 1.0};
    integrator->restart(0.0, x.data(), 0.0);
    Step step;
    double t = 0.0;
    // Distances down to an ulp, and what no step in between reaches.
    for (const double stop : {0.1, 0.1 + 1e-17 + ulp(0.1), 0.1 + 1e-15, 0.1 + 2e-13, 0.1 + 5e-12,
                              1.0 / 3.0, 5.0, std::nextafter(5.0, 6.0), 7.7}) {
      for (int steps = 0; t < stop; ++steps) {
        CHECK(steps < 10000);
        integrator->advance(stop, step, x.data());
        CHECK_EQUAL(step.t0, t);
        CHECK(step.t1 > t);
        CHECK(step.t1 <= stop);
        t = step.t1;
      }
      CHECK_EQUAL(t, stop);
    }
    CHECK_NEAR(x[0], std::sin(7.7), 1e-5);  // thousand errors of the tolerance
  }
}

TEST(TheSolutionInsideAStepBeginsAndEndsWithIt) {
  for (const Method method : methods) {
    Scripted system = swing();
    const auto integrator = solver::make_integrator(method, system, 1e-8);
    std::vector<double> x0 = {0.0, 1.0}, x1 = x0, inside(2);
    integrator->restart(0.0, x0.data(), 0.0);
    Step step;
    for (int k = 0; k < 50; ++k) {
      integrator->advance(hybrid::never, step, x1.data());
      integrator->evaluate(step, step.t0, inside.data());
      CHECK(inside == x0);
      integrator->evaluate(step, step.t1, inside.data());
      // Roundoff of states of order one: a Runge-Kutta step is taken again.
      for (int s = 0; s < 2; ++s) CHECK_NEAR(inside[s], x1[s], 1e-14);
      x0 = x1;
    }
  }
}

TEST(ThePolynomialThroughValuesAndRatesIsExactForItsDegree) {
  const std::array instants = {0.3, -0.1, 0.8, 1.0};
  for (const double t : {0.3, 0.35, 0.9, 1.5}) {
    const solver::HermiteWeights<4> weights(instants, t);
    for (int degree = 0; degree < 8; ++degree) {
      double value = 0.0;
      for (std::size_t k = 0; k < instants.size(); ++k) {
        value += weights.value[k] * std::pow(instants[k], degree);
        if (degree > 0) value += weights.rate[k] * degree * std::pow(instants[k], degree - 1);
      }
      CHECK_NEAR(value, std::pow(t, degree), 1e-10);  // weights of up to 1e5
    }
  }
}

TEST(FarFromEventsRungeKuttaTakesNoEvaluationToLookInsideSteps) {
  Scripted system = swing();
  const auto integrator = solver::make_integrator(Method::erk, system, 1e-8);
  std::array<Step, 5> steps;
  std::vector<double> x = {0.0, 1.0}, inside(2), exactly(2);
  integrator->restart(0.0, x.data(), 0.02);
  hybrid::Stretch stretch;
  for (int k = 0; k < 5; ++k) integrator->advance(0.02 * (k + 1), steps[k], x.data());
  for (int k = 4; k > 0; --k) stretch.append(steps[k]);
  const Step& latest = stretch.latest();
  for (const double part : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    const double t = latest.t0 + part * (latest.t1 - latest.t0);
    integrator->evaluate(latest, t, exactly.data());
    const long evaluations = integrator->work().evaluations;
    integrator->interpolate(stretch, t, inside.data());
    CHECK_EQUAL(integrator->work().evaluations, evaluations);
    for (int s = 0; s < 2; ++s) CHECK_NEAR(inside[s], exactly[s], 1e-8);  // the tolerance
  }
  // With too few steps before it, it takes a step.
  stretch.size = 3;
  const double middle = 0.5 * (latest.t0 + latest.t1);
  integrator->interpolate(stretch, middle, inside.data());
  integrator->evaluate(latest, middle, exactly.data());
  CHECK(inside == exactly);
}

TEST(ARestartContinuesWithTheStepSizeItIsGiven) {
  Scripted system = swing();
  const auto integrator = solver::make_integrator(Method::erk, system, 1e-8);
  std::vector<double> x = {0.0, 1.0};
  Step step;
  for (const double size : {1e-3, 3e-2}) {
    integrator->restart(0.0, x.data(), size);
    CHECK_EQUAL(integrator->next_size(), size);
    integrator->advance(hybrid::never, step, x.data());
    CHECK_NEAR(step.t1, size, 2.0 * ulp(size));  // as ARKODE rounds it
  }
  // A step that a stop has cut short is no reason for short steps.
  const double planned = integrator->next_size();
  integrator->advance(step.t1 + 1e-4, step, x.data());
  CHECK(integrator->next_size() >= planned);
}

TEST(WorkIsCountedOverRestarts) {
  for (const Method method : methods) {
    Scripted system = swing();
    const auto integrator = solver::make_integrator(method, system, 1e-8);
    std::vector<double> x = {0.0, 1.0};
    Step step;
    long evaluations = 0;
    for (int k = 1; k <= 20; ++k) {
      if (k % 5 == 1) integrator->restart(step.t1, x.data(), 0.0);
      // Some of them too short for SUNDIALS.
      integrator->advance(k % 7 == 3 ? step.t1 + 1e-14 : hybrid::never, step, x.data());
      CHECK_EQUAL(integrator->work().steps, k);
      CHECK(integrator->work().evaluations > evaluations);
      evaluations = integrator->work().evaluations;
    }
  }
}

TEST(TolerancesAreScaledByNominalValues) {
  // The same oscillation in other units: the same steps.
  class Scaled : public SmallSystem {
   public:
    explicit Scaled(double unit) : SmallSystem(2, 1, 1), nominals_(2, unit) {}
    std::span<const double> nominals() const override { return nominals_; }
    void derivatives(double, const double* x, double* dx) override {
      dx[0] = x[1];
      dx[1] = -x[0];
    }
    void indicators(double, const double*, double* z) override { z[0] = 1.0; }
    void handle_event(double, double*, const hybrid::Cause&,
                      std::vector<hybrid::Change>&) override {}

   private:
    std::vector<double> nominals_;
  };
  for (const Method method : methods) {
    // A power of two: not even roundoff differs.
    Scaled small(1.0 / 1024.0), large(1.0);
    Run one(small, {0.0, 1.0 / 1024.0}, 1e-8, method), other(large, {0.0, 1.0}, 1e-8, method);
    one.to(10.0);
    other.to(10.0);
    CHECK(
        std::ranges::equal(one.trajectory.steps, other.trajectory.steps, {}, &Step::t1, &Step::t1));
    CHECK_EQUAL(1024.0 * one.simulation.state()[0], other.simulation.state()[0]);
  }
}

TEST(TheErrorFollowsTheTolerance) {
  for (const Method method : methods) {
    double before = 1.0;
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
      Scripted system = swing();
      Run run(system, {0.0, 1.0}, tolerance, method);
      run.to(20.0);
      const double error = std::abs(run.simulation.state()[0] - std::sin(20.0));
      CHECK(error < 1e4 * tolerance);  // of all steps together
      CHECK(error < 0.2 * before);     // two digits of the tolerance, most of one of the error
      before = error;
    }
  }
}

}  // namespace
}  // namespace manutec_r3::testing
