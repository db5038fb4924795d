// Controller and motor of every axis of the Modelica variant. Three states per axis, nothing
// switches. Symbols of the variant's specification; phi_m = rq, w_m = rq', r = p:
//
//   controller      u      = r q_ref' + kp (r q_ref - phi_m) - w_m
//                   x'     = u / Ts,   i_ref = ks (x + u)
//   motor circuit   v'     = (i - i_ref) w / (0.04 D)
//                   i'     = -(2 D w / 250) (5 v + 250 i + k w_m)
//                   rF     = k i
#pragma once

#include <array>
#include <limits>

#include "drive/modelica_parameters.hpp"
#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

// Of the motor circuit: v weighs in i' so many times, and i [Ohm].
inline constexpr double modelica_amplification = 5.0;
inline constexpr double modelica_resistance = 250.0;

// The states of all axes lie in memory one group after another.
enum ModelicaState {
  modelica_controller,  // x
  modelica_voltage,     // v, of the capacitor
  modelica_current,     // i, of the armature
};

template <int N>
struct ModelicaPositionController {
  PerAxis<N> r, kp;

  explicit ModelicaPositionController(const ModelicaTable1& table)
      : r(first<N>(table.gear_ratio)), kp(first<N>(table.kp)) {}

  // The rotor rate that is asked for, u + w_m [rad/s].
  template <class Angle, class Rate, class RotorAngle>
  PerAxis<N, typename RotorAngle::Scalar> command(const Angle& q_ref, const Rate& qd_ref,
                                                  const RotorAngle& phi_m) const {
    return r * qd_ref + kp * (r * q_ref - phi_m);
  }
};

template <int N>
struct ModelicaAxes {
  ModelicaPositionController<N> position_controller;
  PerAxis<N> ks, one_by_Ts, k, w_by_D, two_D_w;

  explicit ModelicaAxes(const ModelicaTable1& table)
      : position_controller(table),
        ks(first<N>(table.ks)),
        one_by_Ts(first<N>(table.Ts).inverse()),
        k(first<N>(table.k)),
        w_by_D(first<N>(table.w) / first<N>(table.D)),
        two_D_w(2.0 * first<N>(table.D) * first<N>(table.w)) {}

  // As of drive::Axes: nothing is constant; what makes the torque.
  static constexpr int state_with_constant = -1;
  static constexpr std::array<int, 1> states_that_switch = {modelica_current};
  static constexpr std::array<int, 0> states_that_drive_voltage = {};

  template <class Number>
  static ConstView<N, Number> of(const Number* x, ModelicaState state) {
    return ConstView<N, Number>(x + state * N);
  }
  static View<N> of(double* x, ModelicaState state) { return View<N>(x + state * N); }

  // Derivatives of the states, given the rotor rates that are asked for and the actual ones.
  void derivatives(const double* x, const PerAxis<N>& command, const PerAxis<N>& w_m,
                   double* dx) const {
    const PerAxis<N> u = command - w_m;
    const ConstView<N> v = of(x, modelica_voltage), i = of(x, modelica_current);
    const PerAxis<N> i_ref = ks * (of(x, modelica_controller) + u);
    of(dx, modelica_controller) = one_by_Ts * u;
    of(dx, modelica_voltage) = (i - i_ref) * w_by_D / 0.04;
    of(dx, modelica_current) = -(two_D_w / modelica_resistance) *
                               (modelica_amplification * v + modelica_resistance * i + k * w_m);
  }

  // What is commanded and compared are rates, and there is no tachogenerator: not a number.
  struct Voltages {
    PerAxis<N> command, tachogenerator, rate_error;
  };
  Voltages voltages(const double*, const PerAxis<N>&) const {
    const PerAxis<N> none = PerAxis<N>::Constant(std::numeric_limits<double>::quiet_NaN());
    return {none, none, none};
  }

  // v [V].
  static ConstView<N> voltage_of(const double* x) { return of(x, modelica_voltage); }

  // rF [N m].
  template <class Number>
  PerAxis<N, Number> motor_torque(const Number* x) const {
    return k * of(x, modelica_current);
  }
};

}  // namespace manutec_r3::drive
