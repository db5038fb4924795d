// What switches in the controllers and motors of the report's axes (spec 4): the dead zone NL1, the
// torque limit NL2 and, as an option, the limit on U. In the Modelica variant nothing does.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <variant>

#include "drive/axis.hpp"
#include "drive/modelica_axis.hpp"
#include "robot/equations.hpp"
#include "robot/indicators.hpp"
#include "robot/mode.hpp"
#include "robot/soon.hpp"
#include "robot/zones.hpp"

namespace manutec_r3::robot {

// Without the controllers and motors of the report.
template <int N, class Watched>
void set_nothing_to_watch(Watched& values) {
  values[Indicators<N>::of_dead_zone].setZero();
  values[Indicators<N>::of_torque_limit].setZero();
  values[Indicators<N>::of_voltage_limit].setZero();
}

template <int N, class Axes>
class ElectricalSwitches;

template <int N>
class ElectricalSwitches<N, drive::ModelicaAxes<N>> {
 public:
  using OfEquations = Equations<N, drive::ModelicaAxes<N>>;

  ElectricalSwitches(const Robot&, OfEquations&, Mode<N>&) {}
  void freeze() {}
  void initialise(const double*, const double*) {}
  void set_indicators(Indicators<N>&) const {}
  template <class Number, class Watched>
  void watch(const Number&, const Number*, Watched& values) const {
    set_nothing_to_watch<N>(values);
  }
  template <class Number, class Watched>
  void watch_rates(const Number&, const Number*, const Number*, std::span<Number>,
                   Watched& rates) const {
    set_nothing_to_watch<N>(rates);
  }
  void cross(ElementKind, int, bool, double*, const double*) {}
  void after_jump(double, const double*) {}
};

template <int N>
class ElectricalSwitches<N, drive::Axes<N>> {
 public:
  using Axes = drive::Axes<N>;
  using OfEquations = Equations<N, Axes>;

  ElectricalSwitches(const Robot& robot, OfEquations& equations, Mode<N>& mode)
      : equations_(equations),
        mode_(mode),
        has_controller_(robot.has_controller()),
        U_limit_(robot.options().voltage_limit) {
    const auto& table_1 = std::get<drive::Table1>(robot.tables().table_1);
    a_ = drive::first<N>(table_1.dead_zone_half_width);
    b_ = drive::first<N>(table_1.torque_limit);
  }

  // Sets what the equations read, from the mode.
  void freeze() {
    for (int i = 0; i < N; ++i) {
      equations_.axes.motor.NL1.set_dead_zone(i, mode_.branch(dead_zone, i), a_[i]);
      equations_.axes.motor.NL2.set_saturation(i, mode_.branch(torque_limit, i), b_[i]);
      equations_.axes.rate_controller.set_branch(i, mode_.branch(voltage_limit, i));
    }
  }

  // The branches of a state x with the derivatives `rates`.
  void initialise(const double* x, const double* rates) {
    if (!has_controller_) return;
    for (int i = 0; i < N; ++i) {
      if (a_[i] > 0.0) mode_.set(dead_zone, i, zone(U(x)[i], U(rates)[i], a_[i]));
      mode_.set(torque_limit, i, zone(m(x)[i], m(rates)[i], b_[i]));
      mode_.set(voltage_limit, i, zone(U(x)[i], U(rates)[i], U_limit_));
    }
  }

  // The lines that indicators are on the present branches.
  void set_indicators(Indicators<N>& indicators) const {
    if (!has_controller_) return;
    for (int i = 0; i < N; ++i) {
      const auto set_zone = [&](auto row, ElementKind kind, double half_width) {
        indicators.set_zone(row, i, mode_.branch(kind, i), half_width);
      };
      if (a_[i] > 0.0) set_zone(Indicators<N>::of_dead_zone, dead_zone, a_[i]);
      set_zone(Indicators<N>::of_torque_limit, torque_limit, b_[i]);
      if (std::isinf(U_limit_)) continue;
      // At its limit the voltage stays until it is driven back.
      const bool at_limit = mode_.branch(voltage_limit, i) != 0;
      set_zone(Indicators<N>::of_voltage_limit, voltage_limit, at_limit ? 0.0 : U_limit_);
    }
  }

  // What they watch.
  template <class Number, class Watched>
  void watch(const Number& t, const Number* x, Watched& values) const {
    if (!has_controller_) return set_nothing_to_watch<N>(values);
    values[Indicators<N>::of_dead_zone] = U(x);
    values[Indicators<N>::of_torque_limit] = m(x);
    watch_voltage_limit(U(x), [&] { return drive_of_voltage(t, x); }, values);
  }

  // How fast it changes along the derivatives dx.
  template <class Number, class Watched>
  void watch_rates(const Number& t, const Number* x, const Number* dx, std::span<Number> x_soon,
                   Watched& rates) const {
    if (!has_controller_) return set_nothing_to_watch<N>(rates);
    rates[Indicators<N>::of_dead_zone] = U(dx);
    rates[Indicators<N>::of_torque_limit] = m(dx);
    const auto drive_rate = [&]() -> PerAxis<N, Number> {
      state_soon(x, dx, static_cast<int>(x_soon.size()), x_soon.data());
      return (drive_of_voltage<Number>(t + soon, x_soon.data()) - drive_of_voltage(t, x)) / soon;
    };
    watch_voltage_limit(U(dx), drive_rate, rates);
  }

  // An indicator has left its domain; U may be set onto its limit.
  void cross(ElementKind kind, int axis, bool lower_edge, double* x, const double* rates) {
    const int branch = mode_.branch(kind, axis);
    if (kind == voltage_limit && branch != 0) {
      mode_.set(kind, axis, 0);
      return;
    }
    const double rate = kind == torque_limit ? m(rates)[axis] : U(rates)[axis];
    const int next = zone_beyond(branch, lower_edge, rate);
    mode_.set(kind, axis, next);
    if (kind == voltage_limit && next != 0) {
      Axes::of(equations_.electrical(x), drive::voltage)[axis] = next * U_limit_;
    }
  }

  // Where the command has jumped, U may leave its limit at once, or stay at it from now on.
  void after_jump(double t, const double* x) {
    if (!has_controller_ || std::isinf(U_limit_)) return;
    const PerAxis<N> outward = drive_of_voltage(t, x);
    for (int i = 0; i < N; ++i) {
      mode_.set(voltage_limit, i, zone(U(x)[i], outward[i], U_limit_));
    }
  }

 private:
  template <class Number>
  ConstView<N, Number> U(const Number* x) const {
    return Axes::of(equations_.electrical(x), drive::voltage);
  }
  template <class Number>
  ConstView<N, Number> m(const Number* x) const {
    return Axes::of(equations_.electrical(x), drive::pt2_torque);
  }
  template <class Number>
  PerAxis<N, Number> drive_of_voltage(const Number& t, const Number* x) const {
    return equations_.axes.drive_of_voltage(equations_.electrical(x), equations_.command(t, x));
  }

  // Axes at the limit watch what drives the voltage, the others the voltage itself.
  template <class Voltage, class Drive, class Watched>
  void watch_voltage_limit(const Voltage& U, const Drive& drive, Watched& values) const {
    auto& watched = values[Indicators<N>::of_voltage_limit];
    watched = U;
    if (!has_axis_at_voltage_limit()) return;
    const auto of_drive = drive();
    for (int i = 0; i < N; ++i) {
      if (mode_.branch(voltage_limit, i) != 0) watched[i] = of_drive[i];
    }
  }

  bool has_axis_at_voltage_limit() const {
    if (std::isinf(U_limit_)) return false;
    for (int i = 0; i < N; ++i) {
      if (mode_.branch(voltage_limit, i) != 0) return true;
    }
    return false;
  }

  OfEquations& equations_;
  Mode<N>& mode_;
  bool has_controller_;
  double U_limit_;
  PerAxis<N> a_, b_;  // half widths of NL1 and NL2
};

}  // namespace manutec_r3::robot
