// What goes wrong ends with an exception, the simulation stays where it got to, and nothing is
// printed.
#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "check.hpp"
#include "hybrid/failure.hpp"
#include "run.hpp"
#include "systems.hpp"

namespace manutec_r3::testing {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

constexpr Method methods[] = {Method::erk, Method::bdf};

void always_inside(double, const double*, double* z) { z[0] = 1.0; }

// What a run that has failed must show: time and state are those of a last good instant, where
// x = exp(-t), and asking again changes nothing.
void check_last_good_state(Run& run, double before) {
  const double t = run.simulation.time();
  CHECK(t > 0.0);
  CHECK(t <= before);
  CHECK_NEAR(run.simulation.state()[0], std::exp(-t), 1e-7);  // a hundred times the tolerance
}

TEST(DerivativesThatAreNotANumberEndTheRunAtTheLastGoodState) {
  for (const Method method : methods) {
    Scripted system(
        1, 1, [](double t, const double* x, double* dx) { dx[0] = t > 1.0 ? nan : -x[0]; },
        always_inside);
    Run run(system, {1.0}, 1e-9, method);
    const std::string message = CHECK_THROWS(run.to(2.0), hybrid::SimulationFailure);
    CHECK(!message.empty());
    check_last_good_state(run, 1.0);
    CHECK_THROWS(run.to(2.0), hybrid::SimulationFailure);
    check_last_good_state(run, 1.0);
  }
}

TEST(AStateThatGrowsWithoutBoundsEndsTheRun) {
  // x' = x^2 from 1 is 1/(1 - t).
  for (const Method method : methods) {
    Scripted system(
        1, 1, [](double, const double* x, double* dx) { dx[0] = x[0] * x[0]; }, always_inside);
    Run run(system, {1.0}, 1e-9, method);
    CHECK_THROWS(run.to(2.0), hybrid::SimulationFailure);
    CHECK(run.simulation.time() <= 1.0 + 1e-6);
    CHECK(std::isfinite(run.simulation.state()[0]));
    CHECK_THROWS(run.to(2.0), hybrid::SimulationFailure);
    CHECK(std::isfinite(run.simulation.state()[0]));
  }
}

TEST(AnIndicatorThatIsNotANumberEndsTheRun) {
  for (const Method method : methods) {
    Scripted system(
        1, 1, [](double, const double* x, double* dx) { dx[0] = -x[0]; },
        [](double t, const double*, double* z) { z[0] = t > 1.0 ? nan : 1.0; });
    Run run(system, {1.0}, 1e-9, method);
    CHECK_THROWS(run.to(2.0), hybrid::SimulationFailure);
    check_last_good_state(run, 1.0);
  }
}

struct Interruption : std::runtime_error {
  using std::runtime_error::runtime_error;
};

TEST(WhatTheSystemThrowsArrivesAndTheRunCanGoOn) {
  // Thrown once, wherever the derivatives are being evaluated: in a step, at its end for the rates
  // of the indicators, or inside it in search of the event at ln 2. Afterwards all goes on as if
  // nothing had been.
  for (const Method method : methods) {
    const auto run_to_end = [&](int throw_at) {
      int evaluations = 0;
      Scripted system(
          1, 1,
          [&](double, const double* x, double* dx) {
            if (++evaluations == throw_at) throw Interruption("by the test");
            dx[0] = -x[0];
          },
          [](double, const double* x, double* z) { z[0] = x[0] - 0.5; });
      Run run(system, {1.0}, 1e-9, method);
      if (throw_at > 0) {
        CHECK_EQUAL(CHECK_THROWS(run.to(1.0), Interruption), std::string("by the test"));
        CHECK_NEAR(run.simulation.state()[0], std::exp(-run.simulation.time()), 1e-7);
      }
      run.to(1.0);
      const int evaluations_of_run = evaluations;
      CHECK_EQUAL(run.simulation.events().size(), 1u);
      if (!run.simulation.events().empty()) {
        CHECK_NEAR(run.simulation.events()[0].time, std::log(2.0), 1e-7);
      }
      CHECK_NEAR(run.simulation.state()[0], std::exp(-1.0), 1e-7);
      return evaluations_of_run;
    };
    const int evaluations = run_to_end(0);
    CHECK(evaluations > 50);
    // The first evaluation is the constructor's.
    for (int throw_at = 2; throw_at <= evaluations; ++throw_at) run_to_end(throw_at);
  }
}

TEST(ADecisionThatFailsLeavesTheStateBeforeIt) {
  Scripted system(
      1, 1, [](double, const double* x, double* dx) { dx[0] = -x[0]; },
      [](double, const double* x, double* z) { z[0] = x[0] - 0.5; });
  system.decide = [](Scripted&, double* x, const Scripted::Call&, std::vector<hybrid::Change>&) {
    x[0] = 77.0;
    throw hybrid::SimulationFailure("no decision");
  };
  Run run(system, {1.0});
  for (int attempt = 0; attempt < 2; ++attempt) {
    CHECK_EQUAL(CHECK_THROWS(run.to(1.0), hybrid::SimulationFailure), std::string("no decision"));
    CHECK_NEAR(run.simulation.time(), std::log(2.0), 1e-7);
    CHECK_NEAR(run.simulation.state()[0], 0.5, 1e-12);  // located to roundoff
    CHECK(run.simulation.events().empty());
  }
}

TEST(ADecisionAfterWhichTheEquationsFailIsTakenAgain) {
  for (const Method method : methods) {
    int decisions = 0;
    bool fail = false;
    Scripted system(
        1, 1,
        [&](double, const double* x, double* dx) {
          if (std::exchange(fail, false)) throw Interruption("by the test");
          dx[0] = -x[0];
        },
        [](double, const double* x, double* z) { z[0] = x[0] - 0.5; });
    system.decide = [&](Scripted&, double* x, const Scripted::Call&,
                        std::vector<hybrid::Change>& log) {
      x[0] = 2.0;
      log.push_back({{1, 0}, 0, 1});
      fail = ++decisions == 1;
    };
    Run run(system, {1.0}, 1e-9, method);
    CHECK_THROWS(run.to(1.0), Interruption);
    CHECK_NEAR(run.simulation.time(), std::log(2.0), 1e-7);
    CHECK_NEAR(run.simulation.state()[0], 0.5, 1e-7);
    CHECK_EQUAL(run.simulation.events().size(), 0u);
    run.to(1.0);
    CHECK_EQUAL(decisions, 2);
    CHECK_EQUAL(run.simulation.events().size(), 1u);
    CHECK_NEAR(run.simulation.state()[0], 4.0 * std::exp(-1.0), 1e-6);
  }
}

TEST(WhatLooksUpMayThrowAndTheRunGoesOnFromThere) {
  Scripted system(
      1, 1, [](double, const double* x, double* dx) { dx[0] = -x[0]; },
      [](double, const double* x, double* z) { z[0] = x[0] - 0.5; });
  Run run(system, {1.0});
  int calls = 0;
  const auto look_up = [&](double) {
    if (++calls % 2 == 1) throw Interruption("stop");
  };
  while (run.simulation.time() < 1.0) {
    try {
      run.simulation.advance(1.0, Simulation::Stop::at_target, Simulation::Target::included,
                             look_up);
    } catch (const Interruption&) {
    }
  }
  CHECK(calls > 2);
  CHECK_EQUAL(run.simulation.events().size(), 1u);
  CHECK_NEAR(run.simulation.state()[0], std::exp(-1.0), 1e-7);
}

// Both streams of the process, as C and C++ write to them, to a file meanwhile.
class Silence {
 public:
  Silence() : out_(dup(1)), err_(dup(2)), file_(std::tmpfile()) {
    flush();
    dup2(fileno(file_), 1);
    dup2(fileno(file_), 2);
  }
  ~Silence() {
    end();
    std::fclose(file_);
  }
  long end() {
    flush();
    if (out_ >= 0) {
      dup2(out_, 1);
      dup2(err_, 2);
      close(out_);
      close(err_);
      out_ = -1;
    }
    std::fseek(file_, 0, SEEK_END);
    return std::ftell(file_);
  }

 private:
  static void flush() {
    std::cout.flush();
    std::fflush(nullptr);
  }

  int out_, err_;
  std::FILE* file_;
};

TEST(AFailurePrintsNothing) {
  for (const Method method : methods) {
    Scripted system(
        1, 1, [](double t, const double* x, double* dx) { dx[0] = t > 1.0 ? nan : -x[0]; },
        always_inside);
    Scripted grows(
        1, 1, [](double, const double* x, double* dx) { dx[0] = x[0] * x[0]; }, always_inside);
    int thrown = 0;
    Silence silence;
    for (Scripted* fails : {&system, &grows}) {
      Run run(*fails, {1.0}, 1e-9, method);
      try {
        run.to(2.0);
      } catch (const hybrid::SimulationFailure&) {
        ++thrown;
      }
    }
    CHECK_EQUAL(silence.end(), 0);
    CHECK_EQUAL(thrown, 2);
  }
}

}  // namespace
}  // namespace manutec_r3::testing
