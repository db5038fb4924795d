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
#include "robot/mode.hpp"
#include "robot/soon.hpp"
#include "robot/zones.hpp"

namespace manutec_r3::robot {

template <int N, class Axes>
class ElectricalSwitches;

template <int N>
class ElectricalSwitches<N, drive::ModelicaAxes<N>> {
 public:
  using OfEquations = Equations<N, drive::ModelicaAxes<N>>;

  ElectricalSwitches(const Robot&, OfEquations&, Mode<N>&) {}
  void freeze() {}
  void initialise(const double*, const double*) {}
  void indicators(ElementKind, double, const double*, double*) const {}
  void indicator_rates(ElementKind, double, const double*, const double*, std::span<double>,
                       double*) const {}
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

  // Two indicators for each axis and element.
  void indicators(ElementKind kind, double t, const double* x, double* z) const {
    if (!has_controller_) return;
    for (int i = 0; i < N; ++i, z += 2) {
      const int branch = mode_.branch(kind, i);
      if (kind == dead_zone && a_[i] > 0.0) edges(branch, U(x)[i], a_[i], z);
      if (kind == torque_limit) edges(branch, m(x)[i], b_[i], z);
      if (kind != voltage_limit || std::isinf(U_limit_)) continue;
      if (branch == 0) {
        edges(branch, U(x)[i], U_limit_, z);
      } else {
        z[0] = branch * drive_of_voltage(t, x)[i];  // until it leads back
      }
    }
  }

  // How fast they change along the derivatives dx.
  void indicator_rates(ElementKind kind, double t, const double* x, const double* dx,
                       std::span<double> x_soon, double* rates) const {
    if (!has_controller_) return;
    PerAxis<N> drive_rate = PerAxis<N>::Zero();
    if (kind == voltage_limit && has_axis_at_voltage_limit()) {
      state_soon(x, dx, static_cast<int>(x_soon.size()), x_soon.data());
      drive_rate = (drive_of_voltage(t + soon, x_soon.data()) - drive_of_voltage(t, x)) / soon;
    }
    for (int i = 0; i < N; ++i, rates += 2) {
      const int branch = mode_.branch(kind, i);
      if (kind == dead_zone && a_[i] > 0.0) edge_rates(branch, U(dx)[i], rates);
      if (kind == torque_limit) edge_rates(branch, m(dx)[i], rates);
      if (kind != voltage_limit || std::isinf(U_limit_)) continue;
      if (branch == 0) {
        edge_rates(branch, U(dx)[i], rates);
      } else {
        rates[0] = branch * drive_rate[i];
      }
    }
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
  ConstView<N> U(const double* x) const {
    return Axes::of(equations_.electrical(x), drive::voltage);
  }
  ConstView<N> m(const double* x) const {
    return Axes::of(equations_.electrical(x), drive::pt2_torque);
  }
  PerAxis<N> drive_of_voltage(double t, const double* x) const {
    return equations_.axes.drive_of_voltage(equations_.electrical(x), equations_.command(t, x));
  }

  bool has_axis_at_voltage_limit() const {
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
