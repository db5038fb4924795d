// Exponential collocation (solver/exponential_collocation.hpp) on small systems with linear blocks.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "check.hpp"
#include "hybrid/failure.hpp"
#include "hybrid/linear_view.hpp"
#include "run.hpp"
#include "solver/exponential_collocation.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Abreast, hybrid::Event;

// A pendulum that a fast filter pushes: y follows a u that depends on time, and ends at a knot.
//
//   a'' = -G sin a + y,   y'' = w^2 (u(t) - y - k a') - 2 D w y'
//
// States a, a', y, y'. The pendulum swings with 50 rad/s, slowly for the filter.
class PushedPendulum : public Scripted, public hybrid::LinearView {
 public:
  static constexpr double G = 2500.0, w = 3000.0, D = 0.3, k = 0.4;

  explicit PushedPendulum(int n_indicators = 1, Indicators indicators = nothing_fires)
      : Scripted(
            4, n_indicators,
            [this](double t, const double* x, double* dx) {
              dx[0] = x[1];
              dx[1] = -G * std::sin(x[0]) + x[2];
              dx[2] = x[3];
              dx[3] = w * w * (u(t) - x[2] - k * x[1]) - 2.0 * D * w * x[3];
            },
            std::move(indicators)) {
    block_.states = {0, 1, 2, 3};
    block_.watched = {0, 1, 2};
    block_.L.setZero(4, 4);
    block_.L << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -w * w * k, -w * w, -2 * D * w;
    block_.B.setZero(4, 2);
    block_.B(3, 0) = w * w;
    block_.B(1, 1) = 1.0;
    block_.n_constants = 0;
    block_.n_forcing = block_.n_remainder = 1;
  }

  static std::vector<double> start() { return {1.2, 0.0, 0.0, 0.0}; }
  static void nothing_fires(double, const double*, double* z) { z[0] = 1.0; }

  bool extends = true;
  double latest_asked = 0.0;  // for the forcing or the remainder

  hybrid::LinearView* linear_view() override { return this; }
  int n_blocks() const override { return 1; }
  const hybrid::LinearBlock& block(int) override { return block_; }
  void constants(double*) override {}
  void forcing(double t, double* values) override {
    latest_asked = std::max(latest_asked, t);
    values[0] = u(t);
  }
  void remainder(double t, const double* x, double* values) override {
    latest_asked = std::max(latest_asked, t);
    values[0] = -G * std::sin(x[0]);
  }
  void forcing(const Abreast& t, Abreast* values) override {
    for (int k = 0; k < Abreast::size; ++k) forcing(t[k], &values[0][k]);
  }
  void remainder(const Abreast& t, const Abreast* x, Abreast* values) override {
    for (int k = 0; k < Abreast::size; ++k) remainder(t[k], at(x, k).data(), &values[0][k]);
  }
  void indicators(const Abreast& t, const Abreast* x, const Abreast*, Abreast* values) override {
    std::vector<double> z(n_indicators());
    for (int k = 0; k < Abreast::size; ++k) {
      indicators(t[k], at(x, k).data(), z.data());
      for (int i = 0; i < n_indicators(); ++i) values[i][k] = z[i];
    }
  }
  void indicator_rates(const Abreast& t, const Abreast* x, const Abreast* dx, const Abreast*,
                       const Abreast*, Abreast* rates) override {
    std::vector<double> slope(n_indicators());
    for (int k = 0; k < Abreast::size; ++k) {
      std::array<double, 4> rate = at(dx, k);
      rate[3] = 0.0;
      indicator_rates(t[k], at(x, k).data(), rate.data(), slope.data());
      for (int i = 0; i < n_indicators(); ++i) rates[i][k] = slope[i];
    }
  }
  bool extends_beyond_events() const override { return extends; }
  using Scripted::indicator_rates;
  using Scripted::indicators;

 private:
  double u(double t) const { return std::sin(3.0 * t) + input(); }
  // Only what is watched is there.
  static std::array<double, 4> at(const Abreast* x, int k) {
    return {x[0][k], x[1][k], x[2][k], std::nan("")};
  }

  hybrid::LinearBlock block_;
};

double distance(const std::vector<double>& left, const std::vector<double>& right) {
  // The sizes that states reach.
  const std::array<double, 4> nominals = {1.0, 50.0, 20.0, 20.0 * PushedPendulum::w};
  double largest = 0.0;
  for (int s = 0; s < 4; ++s) {
    largest = std::max(largest, std::abs(left[s] - right[s]) / nominals[s]);
  }
  return largest;
}

std::vector<double> after(double t, double tolerance, Method method) {
  PushedPendulum system;
  Run run(system, PushedPendulum::start(), tolerance, method);
  run.to(t);
  return run.simulation.state();
}

TEST(TheSolutionIsThatOfAnotherMethodAndFollowsTheTolerance) {
  const std::vector<double> expected = after(0.5, 1e-13, Method::erk);
  double before = 1.0;
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) {
    const double error = distance(after(0.5, tolerance, Method::exponential), expected);
    CHECK(error < 100.0 * tolerance);  // of all steps together
    CHECK(error < 0.2 * before);
    before = error;
  }
}

TEST(FastStatesHaveNoSayInTheStepsOnceTheyRest) {
  PushedPendulum slow_view, fast_steps;
  const std::vector<double> at_rest(4, 0.0);
  Run exponential(slow_view, at_rest, 1e-6, Method::exponential);
  Run explicit_steps(fast_steps, at_rest, 1e-6, Method::erk);
  exponential.to(4.0);
  explicit_steps.to(4.0);
  // The longest step is 8 ms; explicit ones are bound to some 4/w = 1.3 ms.
  CHECK(exponential.integrator->work().steps < 700);
  CHECK(explicit_steps.integrator->work().steps > 2000);
}

TEST(AStepIsCutOffAtAStopThatItReachesBeyond) {
  for (const bool extends : {true, false}) {
    PushedPendulum system;
    system.extends = extends;
    const auto integrator = solver::make_integrator(Method::exponential, system, 1e-7);
    std::vector<double> x = PushedPendulum::start();
    integrator->restart(0.0, x.data(), 0.0);
    hybrid::Step step;
    double t = 0.0;
    for (const double stop : {0.1, 0.1 + ulp(0.1), 0.1 + 1e-15, 0.1 + 2e-13, 0.1 + 5e-12,
                              0.1 + 7e-7, 1.0 / 3.0, std::nextafter(1.0, 2.0)}) {
      for (int steps = 0; t < stop && steps < 10000; ++steps) {
        system.latest_asked = 0.0;
        integrator->advance(stop, step, x.data());
        CHECK_EQUAL(step.t0, t);
        CHECK(step.t1 > t);
        CHECK(step.t1 <= stop);
        // Inputs that end at the stop are not asked beyond it.
        if (!extends) CHECK(system.latest_asked <= stop + ulp(stop));
        t = step.t1;
      }
      CHECK_EQUAL(t, stop);
    }
    CHECK(distance(x, after(1.0, 1e-12, Method::erk)) < 1e-6);
  }
}

TEST(TheSolutionInsideAStepIsAsAccurateAsAtItsEnds) {
  PushedPendulum system;
  const auto integrator = solver::make_integrator(Method::exponential, system, 1e-9);
  std::vector<double> x0 = PushedPendulum::start(), x1 = x0, inside(4);
  integrator->restart(0.0, x0.data(), 0.0);
  hybrid::Step step;
  for (int k = 0; k < 30; ++k) {
    integrator->advance(hybrid::never, step, x1.data());
    integrator->evaluate(step, step.t0, inside.data());
    CHECK(inside == x0);
    integrator->evaluate(step, step.t1, inside.data());
    CHECK(distance(inside, x1) < 1e-12);  // roundoff on two ways
    x0 = x1;
    if (k % 10 != 9) continue;
    for (const double part : {0.1, 0.37, 0.9}) {
      const double t = step.t0 + part * (step.t1 - step.t0);
      integrator->evaluate(step, t, inside.data());
      CHECK(distance(inside, after(t, 1e-12, Method::erk)) < 1e-8);
      // Close by, from the same series, and from another.
      std::vector<double> near(4), far(4);
      integrator->evaluate(step, std::nextafter(t, 0.0), near.data());
      CHECK(distance(inside, near) < 1e-12);
      integrator->evaluate(step, step.t0, far.data());
      integrator->evaluate(step, t, far.data());
      CHECK(far == inside);
    }
  }
}

TEST(LooksInsideAStepShowTheIndicatorsThere) {
  PushedPendulum system(2, [](double t, const double* x, double* z) {
    z[0] = 5.0 - x[0] + t;
    z[1] = 5.0 - x[2];
  });
  const auto integrator = solver::make_integrator(Method::exponential, system, 1e-8);
  std::vector<double> x = PushedPendulum::start(), inside(4), dx(4);
  integrator->restart(0.0, x.data(), 0.0);
  hybrid::Step step;
  for (int k = 0; k < 20; ++k) {
    const std::vector<double> x0 = x;
    integrator->advance(k == 19 ? step.t1 + 3e-4 : hybrid::never, step, x.data());
    double before = step.t0;
    std::array<double, 2> z0, z1;
    std::vector<int> near;
    system.indicators(step.t0, x0.data(), z0.data());
    CHECK(integrator->glance(z0.data(), nullptr, z1.data(), near));
    CHECK(k == 19 || integrator->n_looks() == 4);
    for (int look = 0; look < integrator->n_looks(); ++look) {
      std::array<double, 2> z, slope, expected, expected_slope;
      const double t = integrator->look(look, z.data(), slope.data());
      CHECK(before < t && t <= step.t1);
      before = t;
      integrator->evaluate(step, t, inside.data());
      system.derivatives(t, inside.data(), dx.data());
      system.indicators(t, inside.data(), expected.data());
      system.indicator_rates(t, inside.data(), dx.data(), expected_slope.data());
      for (int i = 0; i < 2; ++i) {
        CHECK_NEAR(z[i], expected[i], 1e-12);
        CHECK_NEAR(slope[i], expected_slope[i], 1e-5);  // by a difference of 1e-7 s
      }
    }
  }
}

// --- events --------------------------------------------------------------------------------------

// The first instant at which the pendulum's angle comes down to a level.
std::optional<double> arrival(double level, Method method, double tolerance) {
  PushedPendulum system(1, [level](double, const double* x, double* z) { z[0] = x[0] - level; });
  Run run(system, PushedPendulum::start(), tolerance, method);
  run.to(0.1);
  const std::vector<Event>& events = run.simulation.events();
  return events.empty() ? std::nullopt : std::optional(events[0].time);
}

TEST(ADoubleCrossingBetweenNodesIsFound) {
  // The angle has its lowest value after half a period: where a parabola through three looks has.
  PushedPendulum system;
  Run run(system, PushedPendulum::start(), 1e-13, Method::erk);
  std::array<double, 3> angle = {10.0, 10.0, 10.0};
  for (double t = 0.0; !(angle[2] > angle[1] && angle[1] < angle[0]); t += 1e-5) {
    run.to(t);
    angle = {angle[1], angle[2], run.simulation.state()[0]};
  }
  const double slope = 0.5 * (angle[2] - angle[0]), bend = angle[2] - 2.0 * angle[1] + angle[0];
  const double lowest = angle[1] - 0.5 * slope * slope / bend;
  // A curvature of G makes a dip of this depth last 2 sqrt(2 depth/G): from 1.8 ms down to 6 us,
  // far less than an interval.
  for (const double depth : {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8}) {
    const auto found = arrival(lowest + depth, Method::exponential, 1e-12);
    const auto expected = arrival(lowest + depth, Method::erk, 1e-12);
    CHECK(found.has_value() && expected.has_value());
    // Angles that differ by 1e-11 arrive at different times, the more so the lower they graze.
    if (found && expected)
      CHECK_NEAR(*found, *expected, 1e-11 / std::sqrt(2.0 * PushedPendulum::G * depth));
    CHECK(!arrival(lowest - depth, Method::exponential, 1e-12));
  }
}

TEST(AFastTransientThatLeavesItsDomainBetweenNodesIsFound) {
  // A jump of the input makes the filter overshoot to 1 + exp(-pi D/sqrt(1 - D^2)) = 1.37 times it,
  // once, for less than a millisecond: the first interval may be longer.
  for (const double part : {0.9, 0.99, 0.999}) {
    const double peak = 0.01 * 1.3724;
    PushedPendulum system(1, [=](double, const double* x, double* z) {
      z[0] = part * peak - (x[2] + PushedPendulum::k * x[1]);
    });
    Run run(system, {0.0, 0.0, 0.0, 0.0}, 1e-6, Method::exponential);
    run.simulation.change_input([&] { system.set_input(0.01); });
    run.to(0.1);
    CHECK_EQUAL(run.simulation.events().size(), 1u);
    CHECK(run.simulation.events().size() == 1 && run.simulation.events()[0].time < 0.0012);
  }
}

TEST(AStepFarFromZeroIsNotLookedAt) {
  // In how many steps the rates of an indicator at the nodes are asked for.
  class Asked : public PushedPendulum {
   public:
    using PushedPendulum::PushedPendulum;
    int n = 0;
    void indicator_rates(const Abreast& t, const Abreast* x, const Abreast* dx, const Abreast* u,
                         const Abreast* du, Abreast* rates) override {
      ++n;
      PushedPendulum::indicator_rates(t, x, dx, u, du, rates);
    }
    using PushedPendulum::indicator_rates;
  };
  PushedPendulum free;
  Run swings(free, PushedPendulum::start(), 1e-7, Method::exponential);
  double highest = 0.0;
  for (int k = 1; k <= 30000; ++k) {
    swings.to(1e-4 * k);
    highest = std::max(highest, swings.simulation.state()[0]);
  }
  for (const double distance : {1e-4, 0.1}) {
    Asked system(1, [=](double, const double* x, double* z) { z[0] = highest + distance - x[0]; });
    Run run(system, PushedPendulum::start(), 1e-7, Method::exponential);
    run.to(3.0);
    const long steps = run.simulation.statistics().work.steps;
    CHECK(run.simulation.events().empty());
    CHECK(distance > 0.01 ? system.n == 0 : 0 < system.n && system.n < steps);
  }
}

// --- going on ------------------------------------------------------------------------------------

TEST(ARunThatIsSavedGoesOnBitByBit) {
  PushedPendulum system(1, [](double, const double* x, double* z) { z[0] = x[0]; });
  system.decide = [](Scripted& self, double* x, const Scripted::Call& call,
                     std::vector<hybrid::Change>& log) {
    if (!call.fired.empty()) x[1] = -x[1];
    for (const int i : call.fired) self.change(i, 0, log);
  };
  Run run(system, PushedPendulum::start(), 1e-7, Method::exponential);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 0.3);
  for (int k = 0; k < 20; ++k) {
    run.to(run.simulation.time() + uniform(random));
    const auto saved = run.simulation.save();
    const double t = run.simulation.time();
    run.to(t + 0.7);
    const std::vector<double> first = run.simulation.state();
    run.simulation.restore(saved);
    CHECK_EQUAL(run.simulation.time(), t);
    run.to(t + 0.7);
    CHECK(run.simulation.state() == first);
    run.simulation.restore(saved);
  }
}

TEST(WhereAUserLooksDoesNotChangeTheSteps) {
  PushedPendulum undisturbed, watched;
  Run straight(undisturbed, PushedPendulum::start(), 1e-7, Method::exponential);
  Run looks(watched, PushedPendulum::start(), 1e-7, Method::exponential);
  straight.to(3.0);
  for (int k = 1; k <= 777; ++k) looks.to(3.0 * k / 777);
  CHECK(looks.simulation.state() == straight.simulation.state());
  CHECK(looks.trajectory.steps == straight.trajectory.steps);
}

TEST(ASystemWithoutLinearBlocksIsRefused) {
  MassOnBelt system;
  CHECK_THROWS(solver::make_integrator(Method::exponential, system, 1e-6), std::invalid_argument);
}

TEST(ARemainderThatIsNotANumberEndsTheRunAndLosesNothing) {
  class Breaking : public PushedPendulum {
   public:
    void remainder(double t, const double* x, double* values) override {
      PushedPendulum::remainder(t, x, values);
      if (t > 0.5) values[0] = std::nan("");
    }
  };
  Breaking system;
  Run run(system, PushedPendulum::start(), 1e-7, Method::exponential);
  CHECK_THROWS(run.to(1.0), hybrid::SimulationFailure);
  CHECK(run.simulation.time() > 0.49 && run.simulation.time() <= 0.5);
  CHECK(run.trajectory.n_steps() > 0);
}

}  // namespace
}  // namespace manutec_r3::testing
