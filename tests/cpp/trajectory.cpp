// The record of a run, and the solution inside its steps.
#include "hybrid/trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "check.hpp"
#include "run.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Mode;
using hybrid::Step;
using hybrid::Trajectory;

// Three steps, [0, 1), [1, 2) and after an event [2, 4).
Trajectory three_steps() {
  Trajectory trajectory;
  const Mode first{{0}, {}}, second{{1}, {}};
  trajectory.append({0.0, 1.0, {10.0, 11.0}}, first, false);
  trajectory.append({1.0, 2.0, {20.0, 21.0}}, first, true);
  trajectory.append({2.0, 4.0, {30.0, 31.0}}, second, false);
  return trajectory;
}

TEST(AStepIsFoundAndTheLaterOneWhereTwoMeet) {
  const Trajectory trajectory = three_steps();
  CHECK_EQUAL(trajectory.step_at(0.0), 0u);
  CHECK_EQUAL(trajectory.step_at(std::nextafter(1.0, 0.0)), 0u);
  CHECK_EQUAL(trajectory.step_at(1.0), 1u);
  CHECK_EQUAL(trajectory.step_at(1.5), 1u);
  CHECK_EQUAL(trajectory.step_at(2.0), 2u);
  CHECK_EQUAL(trajectory.step_at(4.0), 2u);
  // Outside, the nearest.
  CHECK_EQUAL(trajectory.step_at(-1.0), 0u);
  CHECK_EQUAL(trajectory.step_at(9.0), 2u);
}

TEST(AStepComesBackAsItWasPutIn) {
  const Trajectory trajectory = three_steps();
  CHECK_EQUAL(trajectory.n_steps(), 3u);
  const Step step = trajectory.steps[1];
  CHECK_EQUAL(step.t0, 1.0);
  CHECK_EQUAL(step.t1, 2.0);
  CHECK(step.dense == std::vector<double>({20.0, 21.0}));
  // A mode is kept once as long as it lasts.
  CHECK_EQUAL(trajectory.modes.size(), 2u);
  CHECK(trajectory.mode == std::vector<int>({0, 0, 1}));
}

TEST(WhatLiesBeyondACutIsForgotten) {
  Trajectory trajectory = three_steps();
  trajectory.cut(3.0);
  CHECK_EQUAL(trajectory.n_steps(), 3u);
  CHECK_EQUAL(trajectory.end(), 3.0);
  trajectory.cut(5.0);  // ahead of its end: nothing is there
  CHECK_EQUAL(trajectory.end(), 3.0);
  trajectory.cut(2.0);  // where the last one begins
  CHECK_EQUAL(trajectory.n_steps(), 2u);
  CHECK_EQUAL(trajectory.end(), 2.0);
  trajectory.append({2.0, 2.5, {40.0, 41.0}}, Mode{{0}, {}}, false);
  CHECK(trajectory.modes[trajectory.mode.back()] == (Mode{{0}, {}}));
  CHECK(trajectory.steps[2].dense == std::vector<double>({40.0, 41.0}));
  trajectory.cut(0.0);
  CHECK_EQUAL(trajectory.n_steps(), 0u);
}

TEST(WhatLiesBeforeAnInstantIsACopyWithItsFirstInstantAtLeast) {
  const Trajectory trajectory = three_steps();
  Trajectory cut = trajectory;
  cut.cut(1.5);
  CHECK(trajectory.until(1.5).steps == cut.steps);
  const Trajectory instant = trajectory.until(0.0);
  CHECK_EQUAL(instant.n_steps(), 1u);
  CHECK_EQUAL(instant.steps[0].t0, 0.0);
  CHECK_EQUAL(instant.steps[0].t1, 0.0);
  CHECK(instant.steps[0].dense == std::vector<double>({10.0, 11.0}));
  CHECK(instant.modes[instant.mode[0]] == (Mode{{0}, {}}));
  CHECK_EQUAL(trajectory.n_steps(), 3u);
}

// x of a single oscillator with Coulomb friction, by the equation at the head of the system.
struct Exact {
  double w, mu, X;

  double operator()(double t) const {
    const double half = std::numbers::pi / w;
    double turning = X;
    for (;; t -= half) {
      if (w * w * std::abs(turning) <= mu) return turning;
      const double centre = std::copysign(mu / (w * w), turning);
      if (t < half) return centre + (turning - centre) * std::cos(w * t);
      turning = 2.0 * centre - turning;
    }
  }
};

TEST(TheSolutionInsideStepsIsAsAccurateAsAtTheirEnds) {
  // From a record alone, on a system of its own, across events and sticking.
  const Exact exact{3.0, 0.45, 1.02};
  for (const Method method : {Method::erk, Method::bdf}) {
    for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
      CoulombOscillators system({{exact.w, exact.mu}}), other({{exact.w, exact.mu}});
      Run run(system, {exact.X, 0.0}, tolerance, method);
      run.to(20.0);
      CHECK_EQUAL(run.trajectory.steps.front().t0, 0.0);
      const auto dense = solver::make_dense_output(method, other, tolerance);
      double at_ends = 0.0, inside = 0.0;
      std::vector<double> x(2);
      for (std::size_t i = 0; i < run.trajectory.n_steps(); ++i) {
        // No gaps.
        if (i > 0) CHECK_EQUAL(run.trajectory.steps[i].t0, run.trajectory.steps[i - 1].t1);
        const Step& step = run.trajectory.steps[i];
        CHECK(step.t1 > step.t0);
        other.set_mode(run.trajectory.modes[run.trajectory.mode[i]]);
        for (int part = 0; part <= 20; ++part) {
          const double t = step.t0 + 0.05 * part * (step.t1 - step.t0);
          dense->interpolate(run.trajectory.stretch(i), t, x.data());
          const double error = std::abs(x[0] - exact(t));
          (part % 20 == 0 ? at_ends : inside) = std::max(part % 20 == 0 ? at_ends : inside, error);
        }
      }
      // Errors at the ends add up, some hundred to some thousand of the tolerance.
      CHECK(at_ends < 1e4 * tolerance);
      CHECK(inside < 1.5 * at_ends + tolerance);
    }
  }
}

TEST(BothSidesOfAnEventAreRecorded) {
  for (const Method method : {Method::erk, Method::bdf}) {
    BouncingBall system(0.8);
    Run run(system, {1.0, 0.0}, 1e-9, method);
    run.to(1.0);
    CHECK(run.simulation.events().size() >= 1);
    const double t = run.simulation.events().at(0).time;
    const std::size_t after = run.trajectory.step_at(t);
    CHECK_EQUAL(run.trajectory.steps[after].t0, t);
    CHECK_EQUAL(run.trajectory.steps[after - 1].t1, t);
    std::vector<double> x(2);
    const double speed = std::sqrt(2.0 * BouncingBall::g);
    run.integrator->evaluate(run.trajectory.steps[after - 1], t, x.data());
    CHECK_NEAR(x[1], -speed, 1e-7);  // a hundred times the tolerance
    run.integrator->evaluate(run.trajectory.steps[after], t, x.data());
    CHECK_NEAR(x[1], 0.8 * speed, 1e-7);
    CHECK_EQUAL(x[0], 0.0);  // as the system put it
  }
}

TEST(AnInputCutsOffWhatWasIntegratedAhead) {
  for (const Method method : {Method::erk, Method::bdf}) {
    Scripted* self = nullptr;
    Scripted system(
        1, 1, [&](double, const double*, double* dx) { dx[0] = self->input(); },
        [](double, const double*, double* z) { z[0] = 1.0; });
    self = &system;
    system.decide = [](Scripted&, double*, const Scripted::Call&, std::vector<hybrid::Change>&) {};
    Run run(system, {0.0}, 1e-8, method);
    run.to(1.0);
    run.simulation.change_input([&] { system.set_input(2.0); });
    run.to(2.0);
    const Trajectory& trajectory = run.trajectory;
    for (std::size_t i = 1; i < trajectory.n_steps(); ++i) {
      CHECK_EQUAL(trajectory.steps[i].t0, trajectory.steps[i - 1].t1);
    }
    // Zero before, with slope two after; each with the input that it was integrated with.
    double x = 0.0;
    for (const double t : {0.5, 1.0, 1.5, 2.0}) {
      const std::size_t i = trajectory.step_at(t);
      system.set_mode(trajectory.modes[trajectory.mode[i]]);
      run.integrator->evaluate(trajectory.steps[i], t, &x);
      CHECK_NEAR(x, std::max(0.0, 2.0 * (t - 1.0)), 1e-12);  // straight lines: roundoff
    }
  }
}

}  // namespace
}  // namespace manutec_r3::testing
