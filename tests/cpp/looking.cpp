// Where a user stops to look changes nothing, and a run that is saved goes on from there.
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "check.hpp"
#include "run.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Event;

// Friction, three oscillators: reversals, sticking and steps between them.
struct Oscillators {
  static std::vector<double> start() { return {2.03, 1.7, -0.4, 0.0, 0.3, 0.0}; }
  static constexpr double t_end = 12.0;

  CoulombOscillators system{{{3.0, 0.45}, {2.0, 0.3}, {0.7, 0.01}}};
};

// Bit by bit.
void check_same(const std::vector<Event>& left, const std::vector<Event>& right) {
  CHECK_EQUAL(left.size(), right.size());
  for (std::size_t n = 0; n < std::min(left.size(), right.size()); ++n) {
    CHECK_EQUAL(left[n].time, right[n].time);
    CHECK(left[n].element == right[n].element);
    CHECK_EQUAL(left[n].before, right[n].before);
    CHECK_EQUAL(left[n].after, right[n].after);
  }
}

std::vector<double> instants(int seed, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.0, Oscillators::t_end);
  std::vector<double> instants(count);
  for (double& t : instants) t = uniform(random);
  std::ranges::sort(instants);
  instants.push_back(Oscillators::t_end);
  return instants;
}

TEST(WhereAUserLooksDoesNotChangeStepsOrEvents) {
  for (const Method method : {Method::erk, Method::bdf}) {
    Oscillators undisturbed, watched;
    Run straight(undisturbed.system, Oscillators::start(), 1e-8, method);
    straight.to(Oscillators::t_end);
    CHECK(straight.simulation.events().size() > 20);

    Run looks(watched.system, Oscillators::start(), 1e-8, method);
    std::vector<double> targets = instants(5, 300);
    // At events, and next to them.
    for (const Event& event : straight.simulation.events()) {
      for (const double t : {std::nextafter(event.time, 0.0), event.time, event.time,
                             std::nextafter(event.time, 100.0)}) {
        targets.push_back(t);
      }
    }
    std::ranges::sort(targets);
    std::mt19937 random(6);
    for (const double target : targets) {
      looks.simulation.advance(
          target, random() % 2 ? Simulation::Stop::at_target : Simulation::Stop::at_first_event,
          random() % 2 ? Simulation::Target::included : Simulation::Target::excluded);
      CHECK(looks.simulation.time() <= target);
      looks.simulation.state();
    }
    looks.to(Oscillators::t_end);

    check_same(straight.simulation.events(), looks.simulation.events());
    CHECK(straight.trajectory.steps == looks.trajectory.steps);
    CHECK(straight.simulation.state() == looks.simulation.state());
  }
}

TEST(ARunIsTheSameEveryTime) {
  for (const Method method : {Method::erk, Method::bdf}) {
    Oscillators first, second;
    Run one(first.system, Oscillators::start(), 1e-8, method);
    Run two(second.system, Oscillators::start(), 1e-8, method);
    one.to(Oscillators::t_end);
    two.to(Oscillators::t_end);
    check_same(one.simulation.events(), two.simulation.events());
    CHECK(one.trajectory.steps == two.trajectory.steps);
  }
}

TEST(ASavedRunHasTheSameFuture) {
  // With the Runge-Kutta method, bit by bit; BDF forgets its order and past.
  Oscillators undisturbed, other;
  Run straight(undisturbed.system, Oscillators::start(), 1e-8);
  Run continued(other.system, Oscillators::start(), 1e-8);
  std::vector<double> times = instants(8, 40);
  for (const double t : times) {
    straight.to(t);
    const Simulation::Snapshot snapshot = straight.simulation.save();
    const std::size_t events = straight.simulation.events().size();
    const std::size_t events_of_other = continued.simulation.events().size();

    // On another simulation, which has been somewhere else.
    continued.simulation.restore(snapshot);
    CHECK_EQUAL(continued.simulation.time(), t);
    CHECK(continued.simulation.state() == straight.simulation.state());
    continued.to(Oscillators::t_end);

    Oscillators fresh;
    Run reference(fresh.system, Oscillators::start(), 1e-8);
    reference.to(Oscillators::t_end);
    const auto since = [](const Run& run, std::size_t first) {
      return std::vector<Event>(run.simulation.events().begin() + static_cast<long>(first),
                                run.simulation.events().end());
    };
    check_same(since(reference, events), since(continued, events_of_other));
    CHECK(reference.simulation.state() == continued.simulation.state());
  }
}

TEST(ASavedRunOfBackwardDifferencesGoesOnWithinItsTolerance) {
  constexpr double tolerance = 1e-9;
  Oscillators undisturbed;
  Run straight(undisturbed.system, Oscillators::start(), tolerance, Method::bdf);
  straight.to(3.3);
  const Simulation::Snapshot snapshot = straight.simulation.save();
  const std::size_t events_before = straight.simulation.events().size();
  straight.to(Oscillators::t_end);
  const std::vector<Event> events = straight.simulation.events();
  straight.simulation.restore(snapshot);
  straight.to(Oscillators::t_end);
  CHECK_EQUAL(straight.simulation.events().size(), 2 * events.size() - events_before);
  for (std::size_t n = events_before; n < events.size(); ++n) {
    // Two runs with different steps, each with some thousand errors of the tolerance.
    CHECK_NEAR(straight.simulation.events()[events.size() + n - events_before].time, events[n].time,
               1e4 * tolerance);
  }
}

TEST(AfterAReturnTheRecordIsThatOfOneRun) {
  Oscillators oscillators;
  Run run(oscillators.system, Oscillators::start(), 1e-8);
  run.to(3.3);
  const Simulation::Snapshot snapshot = run.simulation.save();
  run.to(7.0);
  const hybrid::Trajectory straight = run.trajectory;
  run.simulation.restore(snapshot);
  run.to(7.0);
  CHECK(run.trajectory.steps == straight.steps);
}

TEST(StatisticsAddUpOverRestarts) {
  for (const Method method : {Method::erk, Method::bdf}) {
    Oscillators oscillators;
    Run run(oscillators.system, Oscillators::start(), 1e-8, method);
    hybrid::Statistics before = run.simulation.statistics();
    CHECK_EQUAL(before.events, 0);
    CHECK_EQUAL(before.restarts, 0);
    for (int k = 1; k <= 100; ++k) {
      run.to(0.01 * k * Oscillators::t_end);
      const hybrid::Statistics now = run.simulation.statistics();
      CHECK(now.work.steps >= before.work.steps);
      CHECK(now.work.evaluations >= before.work.evaluations);
      CHECK(now.work.rejected_steps >= before.work.rejected_steps);
      CHECK(now.locations >= before.locations);
      before = now;
    }
    CHECK_EQUAL(before.events, static_cast<long>(run.simulation.events().size()));
    // Each reversal of one oscillator is one restart here.
    CHECK_EQUAL(before.restarts, static_cast<long>(oscillators.system.calls.size()));
    // Every step that was recorded was taken.
    CHECK_EQUAL(before.work.steps, static_cast<long>(run.trajectory.n_steps()));
    CHECK(before.work.evaluations > before.work.steps);
    CHECK(before.locations >= before.restarts);
  }
}

TEST(ARestartKeepsTheStepSize) {
  // An element that switches and changes nothing else.
  Scripted system(
      2, 1,
      [](double, const double* x, double* dx) {
        dx[0] = x[1];
        dx[1] = -x[0];
      },
      [](double, const double* x, double* z) { z[0] = 0.3 - x[0]; });
  Run run(system, {0.0, 1.0}, 1e-10);
  run.to(3.0);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  const hybrid::Trajectory& trajectory = run.trajectory;
  const std::size_t after = trajectory.step_at(run.simulation.events().at(0).time);
  // The size planned before the event, unless the error is too large with it, once.
  const double size = trajectory.steps[after].t1 - trajectory.steps[after].t0;
  const double before = trajectory.steps[after - 2].t1 - trajectory.steps[after - 2].t0;
  CHECK(size > 0.2 * before);
}

}  // namespace
}  // namespace manutec_r3::testing
