// Small hybrid systems, most with a closed form, on which the simulation is tested.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hybrid/system.hpp"

namespace manutec_r3::testing {

inline int sign(double value) { return (value > 0.0) - (value < 0.0); }

// What they have in common: nominal values are 1, nothing is announced, and indicator i belongs to
// the element of axis i + 1.
class SmallSystem : public hybrid::System {
 public:
  SmallSystem(int n_states, int n_indicators, int n_branches)
      : n_indicators_(n_indicators), nominals_(n_states, 1.0) {
    mode_.branches.assign(n_branches, 0);
  }

  int n_states() const override { return static_cast<int>(nominals_.size()); }
  int n_indicators() const override { return n_indicators_; }
  std::span<const double> nominals() const override { return nominals_; }
  double next_time_event(double) const override { return hybrid::never; }
  void initialise(double, double*) override {}
  const hybrid::Mode& mode() const override { return mode_; }
  void set_mode(const hybrid::Mode& mode) override { mode_ = mode; }
  hybrid::Element element_of(int indicator) const override { return {indicator + 1, 0}; }
  std::string describe(hybrid::Element element) const override {
    return "element " + std::to_string(element.axis);
  }

 protected:
  int branch(int element) const { return mode_.branches[element]; }
  // Switches and logs.
  void change(int element, int after, std::vector<hybrid::Change>& log) {
    log.push_back({{element + 1, 0}, branch(element), after});
    mode_.branches[element] = after;
  }

  hybrid::Mode mode_;

 private:
  int n_indicators_;
  std::vector<double> nominals_;
};

// A mass that a spring holds on a moving belt. Friction on the belt: at most F_s while it sticks,
// F_c < F_s while it slides. States: x, deflection of the spring; v, rate relative to the belt.
//
//   sticking (branch 0):  x' = V, v = 0;  breaks away at k x = F_s
//   sliding (branch -1):  x' = V + v, m v' = -k x + F_c;  sticks again at v = 0
//
// With w^2 = k/m and d = (F_s - F_c)/k, sliding from break-away at t_b:
//
//   x = F_c/k + d cos w(t - t_b) + (V/w) sin w(t - t_b)
//
// until x' = V again, after a time (2 pi - 2 atan(d w/V))/w, at x = F_c/k - d. Then it sticks for
// 2 d/V. From x = 0, v = 0 the first break-away is at F_s/(k V).
class MassOnBelt final : public SmallSystem {
 public:
  static constexpr double m = 0.5, k = 8.0, F_s = 3.0, F_c = 2.0, V = 0.25;

  MassOnBelt() : SmallSystem(2, 1, 1) {}

  static double first_break_away() { return F_s / (k * V); }
  static double sliding_time() {
    const double w = std::sqrt(k / m), d = (F_s - F_c) / k;
    return (2.0 * std::numbers::pi - 2.0 * std::atan(d * w / V)) / w;
  }
  static double sticking_time() { return 2.0 * (F_s - F_c) / (k * V); }

  void derivatives(double, const double* x, double* dx) override {
    dx[0] = V + x[1];
    dx[1] = branch(0) == 0 ? 0.0 : (-k * x[0] - branch(0) * F_c) / m;
  }
  void indicators(double, const double* x, double* z) override {
    z[0] = branch(0) == 0 ? F_s - k * std::abs(x[0]) : branch(0) * x[1];
  }
  void handle_event(double, double* x, const hybrid::Cause&,
                    std::vector<hybrid::Change>& log) override {
    const int before = branch(0);
    if (before == 0) {
      change(0, -sign(x[0]), log);
    } else {
      x[1] = 0.0;
      change(0, k * std::abs(x[0]) <= F_s ? 0 : -sign(x[0]), log);
    }
  }
};

// Oscillators with Coulomb friction, each on its own: x'' = -w^2 x - mu sign(x'), friction as
// large while sticking. States: all x, then all v; branches: the sign of v.
//
//   Between turning points x swings about -mu sign(v)/w^2, so the turning points have magnitudes
//   X, X - 2 mu/w^2, X - 4 mu/w^2, ... at 0, pi/w, 2 pi/w, ...; at the first one with
//   w^2 |x| <= mu it sticks.
class CoulombOscillators final : public SmallSystem {
 public:
  struct Oscillator {
    double w, mu;
  };
  struct Call {
    double time;
    std::vector<int> fired;
  };

  explicit CoulombOscillators(std::vector<Oscillator> oscillators)
      : SmallSystem(2 * static_cast<int>(oscillators.size()), static_cast<int>(oscillators.size()),
                    static_cast<int>(oscillators.size())),
        oscillators_(std::move(oscillators)) {}

  std::vector<Call> calls;  // of handle_event

  void derivatives(double, const double* x, double* dx) override {
    for (int i = 0; i < n_indicators(); ++i) {
      const auto [w, mu] = oscillators_[i];
      dx[i] = rate(x, i);
      dx[n_indicators() + i] = branch(i) == 0 ? 0.0 : -w * w * x[i] - branch(i) * mu;
    }
  }
  // A sticking one stays where it is for ever.
  void indicators(double, const double* x, double* z) override {
    for (int i = 0; i < n_indicators(); ++i) z[i] = branch(i) == 0 ? 1.0 : branch(i) * rate(x, i);
  }
  void initialise(double, double* x) override {
    for (int i = 0; i < n_indicators(); ++i) {
      mode_.branches[i] = rate(x, i) != 0.0 ? sign(rate(x, i)) : direction_from_rest(x, i);
    }
  }
  void handle_event(double t, double* x, const hybrid::Cause& cause,
                    std::vector<hybrid::Change>& log) override {
    calls.push_back({t, {cause.fired.begin(), cause.fired.end()}});
    for (const int i : cause.fired) {
      x[n_indicators() + i] = 0.0;
      if (direction_from_rest(x, i) != branch(i)) change(i, direction_from_rest(x, i), log);
    }
  }

 private:
  double rate(const double* x, int i) const { return x[n_indicators() + i]; }
  int direction_from_rest(const double* x, int i) const {
    const auto [w, mu] = oscillators_[i];
    return w * w * std::abs(x[i]) <= mu ? 0 : -sign(x[i]);
  }

  std::vector<Oscillator> oscillators_;
};

// A mass that flies freely between two walls at x = -b and b, which are springs with dampers:
//
//   in the gap (branch 0):  x'' = 0
//   in a wall (branch s):   x'' = -w^2 (x - s b) - 2 D w x', also while the damper pulls
//
// It enters a wall with a speed u and leaves it after pi/(w sqrt(1 - D^2)) with the speed
// u exp(-pi D/sqrt(1 - D^2)); through the gap it takes 2 b/u. States: x, x'.
class Backlash final : public SmallSystem {
 public:
  Backlash(double b, double w, double D) : SmallSystem(2, 2, 1), b_(b), w_(w), D_(D) {}

  double contact_time() const { return std::numbers::pi / (w_ * std::sqrt(1.0 - D_ * D_)); }
  double restitution() const { return std::exp(-std::numbers::pi * D_ / std::sqrt(1.0 - D_ * D_)); }

  void derivatives(double, const double* x, double* dx) override {
    const int s = branch(0);
    dx[0] = x[1];
    dx[1] = s == 0 ? 0.0 : -w_ * w_ * (x[0] - s * b_) - 2.0 * D_ * w_ * x[1];
  }
  void indicators(double, const double* x, double* z) override {
    z[0] = branch(0) == 0 ? b_ - x[0] : branch(0) * x[0] - b_;
    z[1] = branch(0) == 0 ? b_ + x[0] : 1.0;
  }
  hybrid::Element element_of(int) const override { return {1, 0}; }
  void handle_event(double, double* x, const hybrid::Cause&,
                    std::vector<hybrid::Change>& log) override {
    change(0, branch(0) == 0 ? sign(x[1]) : 0, log);
  }

 private:
  double b_, w_, D_;
};

// A ball that falls on the floor and leaves it with e times the speed. States: x, x'.
//
//   Dropped from X it hits the floor at sqrt(2 X/g) with the speed u = sqrt(2 g X); flights last
//   2 u e/g, 2 u e^2/g, ...: infinitely many before sqrt(2 X/g) (1 + e)/(1 - e).
class BouncingBall final : public SmallSystem {
 public:
  explicit BouncingBall(double e) : SmallSystem(2, 1, 1), e_(e) {}
  static constexpr double g = 9.81;

  void derivatives(double, const double* x, double* dx) override {
    dx[0] = x[1];
    dx[1] = -g;
  }
  void indicators(double, const double* x, double* z) override { z[0] = x[0]; }
  void handle_event(double, double* x, const hybrid::Cause&,
                    std::vector<hybrid::Change>& log) override {
    x[0] = 0.0;
    x[1] = -e_ * x[1];
    change(0, 0, log);
  }

 private:
  double e_;
};

// Whatever a test says. Every call of handle_event is kept; unless told otherwise an indicator that
// fires switches its element on for good, and a positive constant takes its place.
class Scripted : public SmallSystem {
 public:
  struct Call {
    double time;
    std::vector<double> x;
    std::vector<int> fired;
    bool time_event, input_changed;
  };
  using Derivatives = std::function<void(double t, const double* x, double* dx)>;
  using Indicators = std::function<void(double t, const double* x, double* z)>;
  using Decision =
      std::function<void(Scripted&, double* x, const Call&, std::vector<hybrid::Change>&)>;

  Scripted(int n_states, int n_indicators, Derivatives derivatives, Indicators indicators)
      : SmallSystem(n_states, n_indicators, n_indicators),
        derivatives_(std::move(derivatives)),
        indicators_(std::move(indicators)) {
    mode_.held.assign(1, 0.0);
  }

  std::vector<double> time_events;  // ascending
  Decision decide;
  std::vector<Call> calls;

  using SmallSystem::branch;
  using SmallSystem::change;
  // A held value that the equations may read.
  double input() const { return mode_.held[0]; }
  void set_input(double value) { mode_.held[0] = value; }

  void derivatives(double t, const double* x, double* dx) override { derivatives_(t, x, dx); }
  void indicators(double t, const double* x, double* z) override {
    indicators_(t, x, z);
    if (decide) return;
    for (int i = 0; i < n_indicators(); ++i) {
      if (branch(i) != 0) z[i] = 1.0;
    }
  }
  double next_time_event(double t) const override {
    for (const double time_event : time_events) {
      if (time_event > t) return time_event;
    }
    return hybrid::never;
  }
  void handle_event(double t, double* x, const hybrid::Cause& cause,
                    std::vector<hybrid::Change>& log) override {
    calls.push_back({t,
                     {x, x + n_states()},
                     {cause.fired.begin(), cause.fired.end()},
                     cause.time_event,
                     cause.input_changed});
    if (decide) return decide(*this, x, calls.back(), log);
    for (const int i : cause.fired) change(i, 1, log);
  }

 private:
  Derivatives derivatives_;
  Indicators indicators_;
};

}  // namespace manutec_r3::testing
