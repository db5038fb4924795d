// What the indicators of a robot watch in its present mode (indicators.hpp), and how fast it
// changes: voltages and torques of the motors, deflections of the gears, rates of the rotors, and
// of what sticks the friction that holds it.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "numbers/abreast.hpp"
#include "robot/electrical_switches.hpp"
#include "robot/equations.hpp"
#include "robot/friction_decision.hpp"
#include "robot/indicators.hpp"
#include "robot/linear_drives.hpp"
#include "robot/mode.hpp"
#include "robot/soon.hpp"

namespace manutec_r3::robot {

// A rotor that creeps below the threshold counts as sticking; it is watched once its rate has
// exceeded so many times the threshold, so never right after break-away (spec 8).
inline constexpr double creep_armed = 10.0;

template <int N, class Axes>
class Watch {
  using Abreast = numbers::Abreast;
  using Indicators = robot::Indicators<N>;
  template <class Number>
  using WatchedOf = typename Indicators::template WatchedOf<Number>;
  static constexpr int E = Equations<N, Axes>::E;

 public:
  Watch(const Robot& robot, const Equations<N, Axes>& equations, const Mode<N>& mode,
        const ElectricalSwitches<N, Axes>& electrical, const FrictionDecision<N, Axes>& friction,
        const LinearDrives<N, Axes>& linear_drives)
      : robot_(robot),
        equations_(equations),
        mode_(mode),
        electrical_(electrical),
        friction_(friction),
        linear_drives_(linear_drives),
        creep_rate_(robot.options().creep_rate),
        indicators_(creep_rate_ > 0.0, std::isfinite(robot.options().voltage_limit)),
        x_soon_(robot.n_states()),
        x_abreast_(robot.n_states()) {}

  int n_indicators() const { return indicators_.size(); }

  // The lines that indicators are on the present branches.
  void freeze() {
    indicators_.clear();
    electrical_.set_indicators(indicators_);
    slides_.setConstant(true);
    if (!robot_.has_real_gears()) return;
    for (int i = 0; i < E; ++i) {
      if (!equations_.gear.has_backlash(i)) continue;
      indicators_.set_zone(Indicators::of_backlash, i, mode_.branch(backlash, i),
                           equations_.gear.b[i]);
    }
    for (int i = 0; i < N; ++i) {
      if (friction_.has_friction(i)) set_indicators_of_friction(i);
    }
  }

  void indicators(double t, const double* x, double* z) const {
    indicators_.evaluate(watched(t, x, friction_torque(t, x)), z);
  }

  // Along the derivatives dx.
  void rates(double t, const double* x, const double* dx, double* rates) {
    PerAxis<N> held_rate = PerAxis<N>::Zero();
    if (some_axis_sticks()) {
      // Now and soon abreast.
      Abreast times = t;
      times[1] = t + soon;
      for (std::size_t s = 0; s < x_abreast_.size(); ++s) {
        x_abreast_[s] = x[s];
        x_abreast_[s][1] = x[s] + soon * dx[s];
      }
      const PerAxis<N, Abreast> held = friction_torque<Abreast>(times, x_abreast_.data());
      for (int i = 0; i < N; ++i) held_rate[i] = (held[i][1] - held[i][0]) / soon;
    }
    indicators_.evaluate_rates(watched_rates<double>(t, x, dx, held_rate, x_soon_), rates);
  }

  // The same where the remainders u, or their rates du, tell what holds axes that stick together.
  void indicators(const Abreast& t, const Abreast* x, const Abreast* u, Abreast* z) const {
    PerAxis<N, Abreast> held = PerAxis<N, Abreast>::Zero();
    if (some_axis_sticks()) {
      held = equations_.torques(t, x).friction;
      linear_drives_.read_held_friction(u, held);
    }
    indicators_.evaluate(watched(t, x, held), z);
  }

  void rates(const Abreast& t, const Abreast* x, const Abreast* dx, const Abreast* du,
             Abreast* rates) {
    PerAxis<N, Abreast> held_rate = PerAxis<N, Abreast>::Zero();
    if (some_axis_sticks()) {
      state_soon(x, dx, robot_.n_states(), x_abreast_.data());
      const Abreast* x_soon = x_abreast_.data();
      held_rate =
          (equations_.torques(t + soon, x_soon).friction - equations_.torques(t, x).friction) /
          soon;
      linear_drives_.read_held_friction(du, held_rate);
    }
    indicators_.evaluate_rates(watched_rates<Abreast>(t, x, dx, held_rate, x_abreast_), rates);
  }

 private:
  // `held` is the friction torque of axes that stick.
  template <class Number>
  WatchedOf<Number> watched(const Number& t, const Number* x,
                            const PerAxis<N, Number>& held) const {
    WatchedOf<Number> values;
    electrical_.watch(t, x, values);
    return watch_gears(x, held, values);
  }

  template <class Number>
  WatchedOf<Number> watched_rates(const Number& t, const Number* x, const Number* dx,
                                  const PerAxis<N, Number>& held_rate,
                                  std::span<Number> x_soon) const {
    WatchedOf<Number> rates;
    electrical_.watch_rates(t, x, dx, x_soon, rates);
    return watch_gears(dx, held_rate, rates);  // linear in x
  }

  template <class Number>
  WatchedOf<Number>& watch_gears(const Number* x, const PerAxis<N, Number>& held,
                                 WatchedOf<Number>& values) const {
    values[Indicators::of_backlash].setZero();
    if (robot_.has_real_gears()) {
      values[Indicators::of_backlash].template head<E>() = equations_.deflection(x);
    }
    const PerAxis<N, Number> rate = equations_.rotor_rate(x);
    values[Indicators::of_friction] = slides_.select(rate, held);
    values[Indicators::of_friction_piece] = rate;
    values[Indicators::of_creep] = rate;
    return values;
  }

  void set_indicators_of_friction(int axis) {
    const int direction = friction_.rotor_direction(axis);
    slides_[axis] = direction != 0;
    if (direction == 0) {
      if (mode_.branch(Mode<N>::brake, axis)) return;
      indicators_.set_zone(Indicators::of_friction, axis, 0, friction_.sticking_limit(axis));
      return;
    }
    // The speed is the rate in the direction of sliding.
    const auto set = [&](auto row, auto edge, double sign, double offset) {
      indicators_.set(row, edge, axis, sign * direction, offset);
    };
    set(Indicators::of_friction, Indicators::upper, +1.0, 0.0);
    const int piece = mode_.branch(Mode<N>::friction_piece, axis);
    const double fastest = friction_.characteristic(axis).upper_end(piece);
    const double slowest = friction_.characteristic(axis).lower_end(piece);
    if (std::isfinite(fastest)) {
      set(Indicators::of_friction_piece, Indicators::upper, -1.0, fastest);
    }
    if (std::isfinite(slowest)) {
      set(Indicators::of_friction_piece, Indicators::lower, +1.0, -slowest);
    }
    if (!equations_.is_elastic(axis) || !(creep_rate_ > 0.0)) return;
    if (mode_.branch(Mode<N>::creep, axis) != 0) {
      set(Indicators::of_creep, Indicators::upper, +1.0, -creep_rate_);
    } else {
      set(Indicators::of_creep, Indicators::upper, -1.0, creep_armed * creep_rate_);
    }
  }

  bool some_axis_sticks() const {
    if (!robot_.has_real_gears()) return false;
    for (int i = 0; i < N; ++i) {
      if (friction_.has_friction(i) && mode_.branch(friction, i) == 0) return true;
    }
    return false;
  }

  // rM, with the friction that holds sticking axes.
  template <class Number>
  PerAxis<N, Number> friction_torque(const Number& t, const Number* x) const {
    for (int i = 0; i < N; ++i) {
      if (equations_.sticking[i] && equations_.is_coupled(i)) {
        return equations_.mechanics(t, x).torques.friction;
      }
    }
    return equations_.torques(t, x).friction;
  }

  const Robot& robot_;
  const Equations<N, Axes>& equations_;
  const Mode<N>& mode_;
  const ElectricalSwitches<N, Axes>& electrical_;
  const FrictionDecision<N, Axes>& friction_;
  const LinearDrives<N, Axes>& linear_drives_;
  double creep_rate_;
  Indicators indicators_;
  Eigen::Array<bool, N, 1> slides_;  // as opposed to what sticks
  std::vector<double> x_soon_;       // scratch
  std::vector<Abreast> x_abreast_;
};

}  // namespace manutec_r3::robot
