// The event semantics at the head of hybrid/simulation.hpp, one by one.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "check.hpp"
#include "hybrid/failure.hpp"
#include "run.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

using hybrid::Change;
using hybrid::Event;

// x' = 1: the state is the time, so that indicators are functions of a state that integration
// gives to roundoff.
void clock(double, const double*, double* dx) { dx[0] = 1.0; }

// x = sin t, v = cos t from (0, 1).
void swing(double, const double* x, double* dx) {
  dx[0] = x[1];
  dx[1] = -x[0];
}

// --- 1: crossings --------------------------------------------------------------------------------

TEST(ACrossingIsFoundOnceAndWithinRoundoff) {
  for (const double where : {1e-9, 1e-3, 0.1, 1.0 / 3.0, 0.7, 5.0, 77.7}) {
    Scripted system(1, 1, clock,
                    [where](double, const double* x, double* z) { z[0] = where - x[0]; });
    Run run(system, {0.0});
    run.to(100.0);
    CHECK_EQUAL(run.simulation.events().size(), 1u);
    CHECK_EQUAL(system.calls.size(), 1u);
    // The state is a sum of steps, each rounded: t and x may differ by one unit for each.
    CHECK_NEAR(system.calls[0].time, where, 8.0 * ulp(where));
    // It has been reached.
    CHECK(system.calls[0].x[0] >= where);
    CHECK_NEAR(system.calls[0].x[0], where, 2.0 * ulp(where));
  }
}

TEST(ACrossingIsFoundInBothDirections) {
  // On above 1/2, off below it: |sin t| = 1/2 at pi/6, 5 pi/6 and so on, by a two-way switch.
  Scripted* self = nullptr;
  Scripted system(2, 1, swing, [&](double, const double* x, double* z) {
    z[0] = self->branch(0) == 0 ? 0.5 - x[0] : x[0] - 0.5;
  });
  self = &system;
  system.decide = [](Scripted& self, double*, const Scripted::Call&, std::vector<Change>& log) {
    self.change(0, 1 - self.branch(0), log);
  };
  Run run(system, {0.0, 1.0}, 1e-12);
  run.to(200.0 * std::numbers::pi);
  const std::vector<Event>& events = run.simulation.events();
  CHECK_EQUAL(events.size(), 200u);
  for (std::size_t n = 0; n < events.size(); ++n) {
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(n / 2);
    // The phase drifts by about the tolerance per radian.
    CHECK_NEAR(events[n].time, turn + (n % 2 == 0 ? 1.0 : 5.0) * std::numbers::pi / 6.0, 1e-9);
    CHECK_EQUAL(events[n].after, n % 2 == 0 ? 1 : 0);
  }
}

TEST(AnExactZeroAtTheEndOfAStepIsFoundOnce) {
  // A step ends at 1 exactly, where z = (1 - x)(3 - x) is exactly zero.
  Scripted system(1, 1, clock,
                  [](double, const double* x, double* z) { z[0] = (1.0 - x[0]) * (3.0 - x[0]); });
  system.time_events = {1.0};
  Run run(system, {0.0});
  run.to(2.0);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  // The state has come to 1 within roundoff of x; then the time event is the same instant.
  CHECK_EQUAL(run.simulation.events()[0].time, 1.0);
  CHECK_EQUAL(system.calls.size(), 1u);
  CHECK(system.calls[0].time_event);
  CHECK_EQUAL(system.calls[0].fired.size(), 1u);
}

TEST(WhoWantsToHandleAnEventHimselfIsStoppedBeforeIt) {
  Scripted* self = nullptr;
  Scripted system(1, 1, clock, [&](double, const double* x, double* z) {
    z[0] = self->branch(0) == 0 ? 0.5 - x[0] : x[0] - 0.5;
  });
  self = &system;
  system.decide = [](Scripted& self, double*, const Scripted::Call&, std::vector<Change>& log) {
    self.change(0, 1, log);
  };
  Run run(system, {0.0});
  const auto go_on = [&run] {
    run.simulation.advance(1.0, Simulation::Stop::before_event, Simulation::Target::included);
    return run.simulation.time();
  };
  CHECK_NEAR(go_on(), 0.5, 8.0 * ulp(0.5));
  CHECK(run.simulation.events().empty());
  CHECK_EQUAL(system.branch(0), 0);
  // The next call handles it first, and goes on.
  CHECK_EQUAL(go_on(), 1.0);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  CHECK_EQUAL(system.branch(0), 1);
}

TEST(ADoubleCrossingInsideAStepIsFound) {
  // z = (x - 1)^2 - depth: out of the domain and back at 1 -+ sqrt(depth). Steps of a clock grow as
  // they like: one leads from near 0 to the time event at 5.
  for (const double depth : {0.1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10}) {
    Scripted system(1, 1, clock, [depth](double, const double* x, double* z) {
      z[0] = (x[0] - 1.0) * (x[0] - 1.0) - depth;
    });
    system.time_events = {5.0};
    Run run(system, {0.0});
    run.to(4.0);
    CHECK_EQUAL(run.simulation.events().size(), 1u);
    if (run.simulation.events().empty()) continue;
    // z is rounded to 1e-16, and its slope there is 2 sqrt(depth).
    CHECK_NEAR(run.simulation.events()[0].time, 1.0 - std::sqrt(depth),
               4e-16 + 4e-16 / (2.0 * std::sqrt(depth)));
  }
}

TEST(TheFirstOfThreeCrossingsInAStepIsTheEvent) {
  // z = (1 - x)(x - 1.5)(x - 2): out of the domain at 1, back at 1.5, and out again at 2, all in
  // one step to the time event at 5.
  Scripted system(1, 1, clock, [](double, const double* x, double* z) {
    z[0] = (1.0 - x[0]) * (x[0] - 1.5) * (x[0] - 2.0);
  });
  system.time_events = {5.0};
  Run run(system, {0.0});
  run.to(4.0);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  CHECK_NEAR(run.simulation.events()[0].time, 1.0, 8.0 * ulp(1.0));
}

TEST(NoPeakOfAnOscillationIsMissed) {
  // sin t rises above a threshold close to its peak. At these tolerances steps are from 0.1 to
  // 0.7, so that both crossings lie well inside one, wherever it begins.
  for (const double tolerance : {1e-5, 1e-7, 1e-9, 1e-11}) {
    // From what the tolerance leaves in doubt after a turn up to what is easy.
    for (double depth = 100.0 * tolerance; depth < 0.1; depth *= 10.0) {
      for (int k = 0; k < 50; ++k) {
        Scripted system(2, 1, swing, [depth](double, const double* x, double* z) {
          z[0] = (1.0 - depth) - x[0];
        });
        const double begin = 2.0 + 0.1 * k;  // beyond the peak at pi/2, up to the next but one
        Run run(system, {std::sin(begin), std::cos(begin)}, tolerance, Method::erk, begin);
        run.to(14.0);
        const double peak = (begin < 2.5 * std::numbers::pi - 0.5 ? 2.5 : 4.5) * std::numbers::pi;
        CHECK_EQUAL(run.simulation.events().size(), 1u);
        if (run.simulation.events().empty()) continue;
        // The phase is right to the tolerance; the slope at the threshold is sqrt(2 depth).
        CHECK_NEAR(run.simulation.events()[0].time, peak - std::acos(1.0 - depth),
                   20.0 * tolerance / std::sqrt(2.0 * depth));
      }
    }
  }
}

TEST(WhenManyThingsHappenEachHappensOnceAndInItsPlace) {
  // Two hundred indicators at random instants, many within some units in the last place of each
  // other or of a time event.
  std::mt19937 random(1993);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::uniform_int_distribution<int> ulps(-12, 12);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> clusters(20), instants;
    for (double& cluster : clusters) cluster = 3.0 * uniform(random);
    std::ranges::sort(clusters);
    for (int i = 0; i < 200; ++i) {
      const double cluster = clusters[static_cast<std::size_t>(20.0 * uniform(random))];
      instants.push_back(cluster + ulps(random) * ulp(cluster));
    }
    const int n = static_cast<int>(instants.size());
    Scripted system(1, n, clock, [&instants](double t, const double*, double* z) {
      for (std::size_t i = 0; i < instants.size(); ++i) z[i] = instants[i] - t;
    });
    for (int k = 0; k < 20; k += 3) system.time_events.push_back(clusters[k]);
    Run run(system, {0.0});
    run.to(4.0);

    std::vector<int> fired(n);
    std::size_t announced = 0;
    double latest = 0.0;
    for (const Scripted::Call& call : system.calls) {
      CHECK(call.time > latest);
      latest = call.time;
      if (call.time_event) CHECK_EQUAL(call.time, system.time_events[announced++]);
      CHECK(std::ranges::is_sorted(call.fired));
      for (const int i : call.fired) {
        ++fired[i];
        // Instants within four units are merged, and those of a chain one by one.
        CHECK_NEAR(call.time, instants[i], 16.0 * ulp(call.time));
      }
    }
    CHECK_EQUAL(announced, system.time_events.size());
    CHECK(std::ranges::all_of(fired, [](int times) { return times == 1; }));
  }
}

// --- 2: right after an event ---------------------------------------------------------------------

TEST(AnIndicatorThatIsZeroAtTheStartCountsAsInside) {
  // z = x (1 - x): zero at the start, then inside, then out at 1.
  Scripted system(1, 1, clock,
                  [](double, const double* x, double* z) { z[0] = x[0] * (1.0 - x[0]); });
  Run run(system, {0.0});
  run.to(2.0);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  CHECK_NEAR(run.simulation.events()[0].time, 1.0, 4.0 * ulp(1.0));
}

// It belongs to the decision about the start, of which nothing is logged.
TEST(AnIndicatorThatIsZeroAtTheStartAndLeavesAtOnceFiresThere) {
  for (const double power : {1.0, 2.0, 3.0}) {
    // z = -x^power, that is with slope -1, or without one
    Scripted system(1, 1, clock,
                    [power](double, const double* x, double* z) { z[0] = -std::pow(x[0], power); });
    Run run(system, {0.0});
    run.to(2.0);
    CHECK_EQUAL(system.calls.size(), 1u);
    CHECK_EQUAL(system.calls[0].time, 0.0);
    CHECK_EQUAL(system.branch(0), 1);
    CHECK_EQUAL(run.simulation.events().size(), 0u);
  }
}

TEST(TheSameRootIsNeverSearchedAgain) {
  // On the way up the switch is put at the threshold exactly: its indicator begins with zero.
  Scripted* self = nullptr;
  Scripted system(2, 1, swing, [&](double, const double* x, double* z) {
    z[0] = self->branch(0) == 0 ? 0.5 - x[0] : x[0] - 0.5;
  });
  self = &system;
  system.decide = [](Scripted& self, double* x, const Scripted::Call&, std::vector<Change>& log) {
    x[0] = 0.5;
    self.change(0, 1 - self.branch(0), log);
  };
  Run run(system, {0.0, 1.0});
  run.to(100.0 * 2.0 * std::numbers::pi);
  CHECK_EQUAL(run.simulation.events().size(), 200u);
}

TEST(AnIndicatorThatStaysExactlyZeroCostsNothing) {
  // Where a decision has left it is where it is: no event, and no search for one.
  Scripted system(2, 1, swing, [](double, const double*, double* z) { z[0] = 0.0; });
  Run run(system, {0.0, 1.0});
  run.to(100.0);
  CHECK(system.calls.empty());
  CHECK_EQUAL(run.simulation.statistics().locations, 0);
}

// --- 3: on a true integration step ---------------------------------------------------------------

TEST(TheStateAtAnEventIsAsAccurateAsAnIntegrationStep) {
  for (const Method method : {Method::erk, Method::bdf}) {
    Scripted system(2, 1, swing, [](double, const double* x, double* z) { z[0] = 0.3 - x[0]; });
    const double tolerance = 1e-10;
    Run run(system, {0.0, 1.0}, tolerance, method);
    run.to(1.0);
    const Scripted::Call& call = system.calls.at(0);
    CHECK_NEAR(call.x[0], std::sin(call.time), 100.0 * tolerance);
    CHECK_NEAR(call.x[1], std::cos(call.time), 100.0 * tolerance);
    CHECK(call.x[0] >= 0.3);
    CHECK_NEAR(call.x[0], 0.3, 2.0 * ulp(0.3));  // the event is located to roundoff all the same
    // The step ends where it happens.
    CHECK(std::ranges::find(run.trajectory.steps, call.time, &hybrid::Step::t1) !=
          run.trajectory.steps.end());
  }
}

// --- 4: one instant, one decision ----------------------------------------------------------------

TEST(ElementsThatSwitchAtTheSameInstantAreOneDecision) {
  // Same frequency, so the same turning points; different amplitudes and friction, so different
  // roundoff. From the first reversal on all indicators begin with exactly zero.
  constexpr double w = 3.0;
  CoulombOscillators system({{w, 0.02}, {w, 0.03}, {w, 0.01}});
  Run run(system, {2.03, 1.1, -0.7, 0.0, 0.0, 0.0}, 1e-12);
  run.to(60.0 * std::numbers::pi / w);
  int k = 0;
  for (const CoulombOscillators::Call& call : system.calls) {
    // The same solution up to a factor, and the same steps: the three rates reach zero within
    // roundoff of the rates, 1e-16 w X over an acceleration of w^2 X in each step.
    CHECK_NEAR(call.time, ++k * std::numbers::pi / w, 1e-9);
    if (k < 40) CHECK_EQUAL(call.fired.size(), 3u);
  }
}

TEST(InstantsWithinFourUnitsInTheLastPlaceAreOne) {
  // Two indicators fire some units apart, either of them first, at an instant without round
  // figures, in the first step; at its beginning they are inside their domains, or at their edge.
  for (const bool from_zero : {false, true}) {
    for (int order = -20; order <= 20; ++order) {
      const int apart = std::abs(order);
      const double first = 0.7123e-4, second = first + apart * ulp(first);
      Scripted system(1, 2, clock, [&](double t, const double*, double* z) {
        z[order > 0 ? 0 : 1] = (second - t) * (from_zero ? t : 1.0);
        z[order > 0 ? 1 : 0] = (first - t) * (from_zero ? t : 1.0);
      });
      Run run(system, {0.0});
      run.to(1.0);
      CHECK_EQUAL(run.simulation.events().size(), 2u);
      if (apart <= 3) CHECK_EQUAL(system.calls.size(), 1u);
      if (apart >= 8) CHECK_EQUAL(system.calls.size(), 2u);
      if (system.calls.size() == 1) {
        CHECK_EQUAL(system.calls[0].fired.size(), 2u);
        CHECK_EQUAL(run.simulation.events()[0].time, run.simulation.events()[1].time);
      } else {
        CHECK(system.calls[1].time > system.calls[0].time);
        CHECK_EQUAL(system.calls[0].fired.at(0), order > 0 ? 1 : 0);
      }
    }
  }
}

TEST(AStateEventAtATimeEventIsOneInstant) {
  // From below, at and above an announced instant, by units in the last place.
  constexpr double announced = 0.8;
  for (int apart = -20; apart <= 20; ++apart) {
    const double root = announced + apart * ulp(announced);
    Scripted system(1, 1, clock, [root](double t, const double*, double* z) { z[0] = root - t; });
    system.time_events = {announced};
    Run run(system, {0.0});
    run.to(1.0);
    CHECK_EQUAL(run.simulation.events().size(), 1u);
    if (std::abs(apart) <= 3) {
      CHECK_EQUAL(system.calls.size(), 1u);
      CHECK_EQUAL(system.calls[0].time, announced);
      CHECK(system.calls[0].time_event);
      CHECK_EQUAL(system.calls[0].fired.size(), 1u);
    }
    if (std::abs(apart) >= 7) {
      CHECK_EQUAL(system.calls.size(), 2u);
      const Scripted::Call& state_event = system.calls[apart < 0 ? 0 : 1];
      const Scripted::Call& time_event = system.calls[apart < 0 ? 1 : 0];
      CHECK_EQUAL(time_event.time, announced);
      CHECK(time_event.time_event && time_event.fired.empty());
      CHECK_NEAR(state_event.time, root, ulp(root));
      CHECK(!state_event.time_event);
    }
  }
}

// --- 5: touching ---------------------------------------------------------------------------------

TEST(AnIndicatorThatOnlyTouchesZeroIsNoEvent) {
  // z = (x - 1)^2 is zero at 1 and nowhere else.
  for (const bool ends_there : {false, true}) {
    Scripted system(1, 1, clock,
                    [](double, const double* x, double* z) { z[0] = (x[0] - 1.0) * (x[0] - 1.0); });
    // By physics: nothing crosses.
    system.decide = [](Scripted&, double*, const Scripted::Call&, std::vector<Change>&) {};
    if (ends_there) system.time_events = {1.0};
    Run run(system, {0.0});
    run.to(3.0);
    CHECK(run.simulation.events().empty());
    CHECK_EQUAL(run.simulation.time(), 3.0);
    CHECK(system.calls.size() <= 1u);
  }
}

TEST(AnIndicatorThatTheSystemDeclinesIsNotAskedForEver) {
  // It reaches zero, stays below by 1e-12 for a while, and comes back: the system knows better.
  Scripted system(1, 1, clock, [](double, const double* x, double* z) {
    z[0] = (x[0] - 1.0) * (x[0] - 1.0) - 1e-12;
  });
  system.decide = [](Scripted&, double*, const Scripted::Call&, std::vector<Change>&) {};
  Run run(system, {0.0});
  run.to(3.0);
  CHECK(run.simulation.events().empty());
  CHECK_EQUAL(run.simulation.time(), 3.0);
}

// --- time events ---------------------------------------------------------------------------------

TEST(ATimeEventIsMetExactlyAndNoStepPassesIt) {
  for (const Method method : {Method::erk, Method::bdf}) {
    for (const double begin : {0.0, 1000.0}) {
      Scripted system(2, 1, swing, [](double, const double*, double* z) { z[0] = 1.0; });
      std::mt19937 random(3);
      std::uniform_real_distribution<double> exponent(-13.0, 0.0);
      double t = begin;
      for (int k = 1; k <= 300; ++k) {
        // Samples, thirds, and distances from seconds down to the roundoff of t.
        t = std::max(std::nextafter(t, 1e9) + 16.0 * ulp(t),
                     k % 3 == 0   ? begin + k * 0.008
                     : k % 3 == 1 ? t + 1.0 / 3.0
                                  : t + std::pow(10.0, exponent(random)));
        system.time_events.push_back(t);
      }
      Run run(system, {0.0, 1.0}, 1e-8, method, begin);
      run.to(t);
      CHECK_EQUAL(system.calls.size(), system.time_events.size());
      for (std::size_t k = 0; k < system.calls.size(); ++k) {
        CHECK_EQUAL(system.calls[k].time, system.time_events[k]);
        CHECK(system.calls[k].time_event);
      }
      for (std::size_t i = 0; i < run.trajectory.n_steps(); ++i) {
        CHECK(system.next_time_event(run.trajectory.steps[i].t0) >= run.trajectory.steps[i].t1);
      }
      // An error of about the tolerance per step, and BDF begins anew with order one 300 times.
      CHECK_NEAR(run.simulation.state()[0], std::sin(t - begin), 1e-4);
    }
  }
}

// --- chattering ----------------------------------------------------------------------------------

TEST(ASystemThatSwitchesForEverAtOneInstantEndsWithTheNameOfItsElement) {
  // Both branches push towards the other: at x = 0 there is no way on.
  Scripted* self = nullptr;
  Scripted system(
      1, 2, [&](double, const double*, double* dx) { dx[0] = self->branch(1) == 0 ? -1.0 : +1.0; },
      [&](double, const double* x, double* z) {
        z[0] = 1.0;
        z[1] = self->branch(1) == 0 ? x[0] : -x[0];
      });
  self = &system;
  system.decide = [](Scripted& self, double*, const Scripted::Call&, std::vector<Change>& log) {
    self.change(1, 1 - self.branch(1), log);
  };
  Run run(system, {0.5});
  const std::string message = CHECK_THROWS(run.to(1.0), hybrid::SimulationFailure);
  CHECK(message.find("element 2") != std::string::npos);
  CHECK_NEAR(run.simulation.time(), 0.5, 4.0 * ulp(0.5));
  CHECK(run.simulation.events().size() > 100);
  CHECK(run.simulation.events().size() <= 1000);
}

TEST(AnAccumulationOfEventsEndsWithTheNameOfItsElement) {
  constexpr double X = 1.0, e = 0.95;
  const double last = std::sqrt(2.0 * X / BouncingBall::g) * (1.0 + e) / (1.0 - e);
  BouncingBall system(e);
  Run run(system, {X, 0.0});
  const std::string message = CHECK_THROWS(run.to(2.0 * last), hybrid::SimulationFailure);
  CHECK(message.find("element 1") != std::string::npos);
  // Not before, and not beyond the accumulation but for the roundoff of some hundred bounces.
  CHECK_NEAR(run.simulation.time(), last, 1e-3);
}

TEST(AThousandEventsInAMillisecondAreTheLimit) {
  for (const double per_second : {990e3, 1010e3}) {
    // A switch at sin(w t) = 0.
    const double w = per_second * std::numbers::pi;
    Scripted* self = nullptr;
    Scripted system(1, 1, clock, [&](double t, const double*, double* z) {
      z[0] = self->branch(0) == 0 ? std::sin(w * t) : -std::sin(w * t);
    });
    self = &system;
    system.decide = [](Scripted& self, double*, const Scripted::Call& call,
                       std::vector<Change>& log) {
      if (!call.fired.empty()) self.change(0, 1 - self.branch(0), log);
    };
    // A step for each: the system has no other reason to take short ones.
    for (int k = 1; k <= 5000; ++k) system.time_events.push_back((k + 0.5) / per_second);
    Run run(system, {0.0});
    if (per_second < 1e6) {
      run.to(5000.25 / per_second);
      CHECK_EQUAL(run.simulation.events().size(), 5000u);
    } else {
      const std::string message =
          CHECK_THROWS(run.to(5000.25 / per_second), hybrid::SimulationFailure);
      CHECK(message.find("element 1") != std::string::npos);
      CHECK_EQUAL(run.simulation.events().size(), 1001u);
    }
  }
}

// --- the target ----------------------------------------------------------------------------------

TEST(AnEventAtTheTargetIsHandledOrNotAsTheTargetSays) {
  constexpr double at = 0.75;
  for (const bool announced : {false, true}) {
    Scripted system(1, 1, clock, [announced](double t, const double*, double* z) {
      z[0] = announced ? 1.0 : at - t;
    });
    if (announced) system.time_events = {at};
    Run run(system, {0.0});
    const auto advance = [&](Simulation::Target target) {
      run.simulation.advance(at, Simulation::Stop::at_target, target);
      CHECK_EQUAL(run.simulation.time(), at);
    };
    advance(Simulation::Target::excluded);
    CHECK(system.calls.empty());
    advance(Simulation::Target::excluded);
    CHECK(system.calls.empty());
    advance(Simulation::Target::included);
    CHECK_EQUAL(system.calls.size(), 1u);
    advance(Simulation::Target::included);
    CHECK_EQUAL(system.calls.size(), 1u);
    CHECK_EQUAL(system.calls[0].time, at);
    CHECK_EQUAL(system.calls[0].time_event, announced);
  }
}

TEST(AdvancingToTheFirstEventStopsThere) {
  CoulombOscillators system({{3.0, 0.45}});
  Run run(system, {2.03, 0.0});
  for (int k = 1; k <= 5; ++k) {
    run.simulation.advance(100.0, Simulation::Stop::at_first_event, Simulation::Target::excluded);
    CHECK_EQUAL(run.simulation.events().size(), static_cast<std::size_t>(k));
    CHECK_EQUAL(run.simulation.time(), run.simulation.events().back().time);
    CHECK_EQUAL(run.simulation.state()[1], 0.0);  // after the event
  }
}

// --- inputs --------------------------------------------------------------------------------------

TEST(AnInputHoldsFromTheInstantAtWhichItIsSet) {
  // x'' = input: the integration may be ahead when the input changes, but not with the new one.
  for (const Method method : {Method::erk, Method::bdf}) {
    Scripted* self = nullptr;
    Scripted system(
        2, 1,
        [&](double, const double* x, double* dx) {
          dx[0] = x[1];
          dx[1] = self->input();
        },
        [](double, const double*, double* z) { z[0] = 1.0; });
    self = &system;
    system.decide = [](Scripted&, double*, const Scripted::Call&, std::vector<Change>&) {};
    Run run(system, {0.0, 0.0}, 1e-10, method);
    double x = 0.0, v = 0.0;
    for (const double input : {1.0, -2.0, 0.5, 3.0}) {
      constexpr double h = 0.37;
      run.to(run.simulation.time() + h);
      x += v * h + 0.5 * system.input() * h * h;
      v += system.input() * h;
      run.simulation.change_input([&] { system.set_input(input); });
      // Polynomials of low order are exact but for roundoff; BDF begins with order one, at the
      // tolerance.
      CHECK_NEAR(run.simulation.state()[0], x, 1e-8);
      CHECK_NEAR(run.simulation.state()[1], v, 1e-8);
      CHECK(system.calls.back().input_changed);
      CHECK_EQUAL(system.calls.back().time, run.simulation.time());
    }
  }
}

TEST(AnInputAtTheInstantOfAnEventDoesNotLoseTheEvent) {
  for (const bool announced : {false, true}) {
    Scripted system(1, 1, clock, [announced](double t, const double*, double* z) {
      z[0] = announced ? 1.0 : 0.75 - t;
    });
    if (announced) system.time_events = {0.75};
    Run run(system, {0.0});
    run.simulation.advance(0.75, Simulation::Stop::at_target, Simulation::Target::excluded);
    run.simulation.change_input([] {});
    run.to(2.0);
    int time_events = 0, fired = 0;
    for (const Scripted::Call& call : system.calls) {
      time_events += call.time_event;
      fired += static_cast<int>(call.fired.size());
      if (call.time_event || !call.fired.empty()) CHECK_EQUAL(call.time, 0.75);
    }
    CHECK_EQUAL(time_events, announced ? 1 : 0);
    CHECK_EQUAL(fired, announced ? 0 : 1);
  }
}

}  // namespace
}  // namespace manutec_r3::testing
