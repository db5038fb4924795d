// Whole runs whose events are known in closed form. Tolerances are tight enough that the errors of
// integration, about the relative tolerance per unit of time, do not hide what is tested: when
// events are, how many, and in which order.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "check.hpp"
#include "run.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Event;

constexpr double tight = 1e-12;

// --- the mass on a belt --------------------------------------------------------------------------

TEST(AMassOnABeltSticksAndSlipsForHundredsOfCycles) {
  constexpr int cycles = 300;
  MassOnBelt system;
  Run run(system, {0.0, 0.0}, tight);
  const double period = MassOnBelt::sticking_time() + MassOnBelt::sliding_time();
  // Half a sticking phase later than the last re-sticking.
  run.to(MassOnBelt::first_break_away() + cycles * period - 0.5 * MassOnBelt::sticking_time());

  const std::vector<Event>& events = run.simulation.events();
  CHECK_EQUAL(events.size(), 2u * cycles);
  for (int n = 0; n < cycles; ++n) {
    const double break_away = MassOnBelt::first_break_away() + n * period;
    // Each slide begins from the same state, so that errors of its length add up: the tolerance
    // times a hundred for each, which is an error of some steps in units of the states.
    const double error = 100.0 * tight * (n + 1);
    CHECK_NEAR(events[2 * n].time, break_away, error);
    CHECK_EQUAL(events[2 * n].before, 0);
    CHECK_EQUAL(events[2 * n].after, -1);
    CHECK_NEAR(events[2 * n + 1].time, break_away + MassOnBelt::sliding_time(), error);
    CHECK_EQUAL(events[2 * n + 1].before, -1);
    CHECK_EQUAL(events[2 * n + 1].after, 0);
  }
}

TEST(AStickingRateIsExactlyZeroFromTheEventOn) {
  MassOnBelt system;
  Run run(system, {0.0, 0.0});
  run.to(MassOnBelt::first_break_away() + 3.0);
  int sticking = 0;
  std::vector<double> x(2);
  for (std::size_t i = 0; i < run.trajectory.n_steps(); ++i) {
    const hybrid::Mode& mode = run.trajectory.modes[run.trajectory.mode[i]];
    if (mode.branches[0] != 0) continue;
    ++sticking;
    system.set_mode(mode);
    const hybrid::Step step = run.trajectory.steps[i];
    for (const double part : {0.0, 0.3, 0.7, 1.0}) {
      run.integrator->evaluate(step, step.t0 + part * (step.t1 - step.t0), x.data());
      CHECK_EQUAL(x[1], 0.0);
    }
  }
  CHECK(sticking >= 3);  // at the start, and after each of at least two slides
}

TEST(AMassThatIsReleasedBeyondItsLimitNeverSticksAtTheStart) {
  CoulombOscillators system({{2.0, 1.0}});
  Run slides(system, {1.0, 0.0});  // w^2 x = 4 > mu
  CHECK_EQUAL(system.mode().branches[0], -1);
  slides.to(0.1);
  CHECK(slides.simulation.state()[1] < 0.0);
  CHECK(slides.simulation.events().empty());  // the decision at the start is no event
}

TEST(AMassThatIsReleasedWithinItsLimitSticksAtTheStartForEver) {
  CoulombOscillators system({{2.0, 1.0}});
  Run sticks(system, {0.24, 0.0});  // w^2 x = 0.96 < mu
  sticks.to(100.0);
  CHECK_EQUAL(sticks.simulation.state()[0], 0.24);
  CHECK_EQUAL(sticks.simulation.state()[1], 0.0);
  CHECK(sticks.simulation.events().empty());
}

// --- an oscillator with Coulomb friction ---------------------------------------------------------

// Turning points by the equation at the head of CoulombOscillators, until it sticks.
std::vector<double> turning_points(double w, double mu, double X) {
  std::vector<double> points;
  for (double x = X; points.empty() || w * w * std::abs(points.back()) > mu; x = points.back()) {
    points.push_back(-x + (x > 0.0 ? 2.0 : -2.0) * mu / (w * w));
  }
  return points;
}

TEST(AnOscillatorWithCoulombFrictionReversesAtEqualIntervalsAndSticksAtLast) {
  constexpr double w = 3.0, mu = 0.05 * w * w, X = 2.03;  // loses 0.1 of x in each half period
  CoulombOscillators system({{w, mu}});
  Run run(system, {X, 0.0}, tight);
  run.to(100.0);

  const std::vector<double> points = turning_points(w, mu, X);
  CHECK_EQUAL(points.size(), 20u);
  const std::vector<Event>& events = run.simulation.events();
  CHECK_EQUAL(events.size(), points.size());
  for (std::size_t n = 0; n < events.size(); ++n) {
    // The rate at the turning point has the errors of integration so far, about the tolerance per
    // step; divided by the acceleration there, which falls to w^2 0.08, this is an error in time.
    CHECK_NEAR(events[n].time, (n + 1) * std::numbers::pi / w, 20.0 * tight * (n + 1));
    // A reversal without sticking is one event. The last one sticks.
    CHECK_EQUAL(events[n].before, n % 2 == 0 ? -1 : +1);
    CHECK_EQUAL(events[n].after, n + 1 == events.size() ? 0 : -events[n].before);
  }
  CHECK_NEAR(run.simulation.state()[0], points.back(), 100.0 * tight);
  CHECK_EQUAL(run.simulation.state()[1], 0.0);
}

TEST(AResultDoesNotDependOnTheToleranceInItsSequenceOfEvents) {
  constexpr double w = 3.0, mu = 0.05 * w * w, X = 2.03;
  std::vector<double> error_at;  // of the last event's time, per tolerance
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    CoulombOscillators system({{w, mu}});
    Run run(system, {X, 0.0}, tolerance);
    run.to(100.0);
    const std::vector<Event>& events = run.simulation.events();
    CHECK_EQUAL(events.size(), 20u);
    error_at.push_back(std::abs(events.back().time - 20.0 * std::numbers::pi / w));
    CHECK(error_at.back() <= 1e3 * tolerance);
  }
  // Times converge: by two digits of the tolerance at least one digit of the time is won.
  for (std::size_t i = 1; i < error_at.size(); ++i) CHECK(error_at[i] <= 0.1 * error_at[i - 1]);
}

TEST(RungeKuttaAndBackwardDifferencesAgreeOnEvents) {
  const auto events_of = [](Method method, double tolerance) {
    CoulombOscillators system({{3.0, 0.45}, {2.0, 0.3}, {0.7, 0.01}});
    Run run(system, {2.03, 1.7, -0.4, 0.0, 0.0, 0.0}, tolerance, method);
    run.to(20.0);
    return run.simulation.events();
  };
  const std::vector<Event> exact = events_of(Method::erk, tight);
  double error_before = 1.0;
  for (const double tolerance : {1e-6, 1e-8, 1e-10}) {
    const std::vector<Event> events = events_of(Method::bdf, tolerance);
    CHECK_EQUAL(events.size(), exact.size());
    double error = 0.0;
    for (std::size_t n = 0; n < std::min(events.size(), exact.size()); ++n) {
      CHECK(events[n].element == exact[n].element);
      CHECK_EQUAL(events[n].before, exact[n].before);
      CHECK_EQUAL(events[n].after, exact[n].after);
      error = std::max(error, std::abs(events[n].time - exact[n].time));
    }
    // BDF controls the error of a step, and takes thousands here.
    CHECK(error <= 1e4 * tolerance);
    CHECK(error < 0.1 * error_before);
    error_before = error;
  }
}

// --- between two walls ---------------------------------------------------------------------------

void check_backlash(double w, double D, int contacts, double tolerance, double time_error) {
  constexpr double b = 0.01;
  Backlash system(b, w, D);
  double speed = 0.5;
  Run run(system, {0.0, speed}, tolerance);
  double end = b / speed;
  std::vector<double> times;
  for (int n = 0; n < contacts; ++n) {
    times.push_back(end);
    times.push_back(end += system.contact_time());
    speed *= system.restitution();
    end += 2.0 * b / speed;
  }
  run.to(times.back() + b / speed);

  const std::vector<Event>& events = run.simulation.events();
  CHECK_EQUAL(events.size(), times.size());
  for (std::size_t n = 0; n < std::min(events.size(), times.size()); ++n) {
    const int wall = n / 2 % 2 == 0 ? +1 : -1;
    CHECK_NEAR(events[n].time, times[n], time_error * times[n]);
    CHECK_EQUAL(events[n].before, n % 2 == 0 ? 0 : wall);
    CHECK_EQUAL(events[n].after, n % 2 == 0 ? wall : 0);
  }
}

TEST(AMassBouncesInABacklashAtTimesInClosedForm) {
  // Relative errors of the speed, about the tolerance per step, are those of times of flight.
  check_backlash(200.0, 0.05, 25, tight, 1e3 * tight);
}

TEST(AnElasticBacklashKeepsItsRhythmForHundredsOfContacts) {
  check_backlash(200.0, 0.0, 300, tight, 1e5 * tight);  // ten thousands of steps
}

TEST(AWallAMillionTimesFasterThanTheFlightIsNoObstacle) {
  // In the gap every step is exact, so that steps grow without bounds; in the wall they must be
  // some 1e-7 s. Rejections on the way down may not end the run.
  check_backlash(1e6, 0.1, 10, 1e-9, 1e-6);
}

// --- a ball --------------------------------------------------------------------------------------

TEST(ABallBouncesAtTimesInClosedForm) {
  constexpr double X = 1.3, e = 0.8;
  const double g = BouncingBall::g;
  BouncingBall system(e);
  Run run(system, {X, 0.0});
  constexpr double t_end = 4.5;
  run.to(t_end);
  const std::vector<Event>& events = run.simulation.events();
  double t = std::sqrt(2.0 * X / g), u = std::sqrt(2.0 * g * X);
  std::size_t n = 0;
  for (; t < t_end && n < events.size(); ++n) {
    // Runge-Kutta is exact for a parabola, but for the roundoff of its coefficients: they are as
    // large as 100, so that a step has some 1e-14 of the rise in it.
    CHECK_NEAR(events[n].time, t, 1e-14 * (n + 1));
    u *= e;
    t += 2.0 * u / g;
  }
  CHECK_EQUAL(events.size(), n);
  CHECK(t >= t_end);
  CHECK(n > 15);
}

}  // namespace
}  // namespace manutec_r3::testing
