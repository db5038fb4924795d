// The electrical part of every axis of the report: position controller, tachogenerator, rate
// controller, motor (spec 4; report Figure 3). Eight states per axis.
#pragma once

#include <array>

#include "drive/motor.hpp"
#include "drive/per_axis.hpp"
#include "drive/position_controller.hpp"
#include "drive/rate_controller.hpp"
#include "drive/tachogenerator.hpp"

namespace manutec_r3::drive {

// The states of all axes lie in memory one group after another.
enum ElectricalState {
  tachogenerator_1,  // y
  tachogenerator_2,  // u_t
  tachogenerator_3,  // u_t'
  filter,            // f
  controller,        // w
  voltage,           // U
  pt2_torque,        // m
  pt2_torque_rate,   // m'
};

template <int N>
struct Axes {
  PositionController<N> position_controller;
  Tachogenerator<N> tachogenerator;
  RateController<N> rate_controller;
  Motor<N> motor;

  explicit Axes(const Table1& table)
      : position_controller(table), tachogenerator(table), rate_controller(table), motor(table) {}

  // The derivative that is not zero at zero state, by the edges of NL1; states that NL1 and NL2
  // read; further states that drive_of_voltage() reads.
  static constexpr int state_with_constant = pt2_torque_rate;
  static constexpr std::array<int, 2> states_that_switch = {voltage, pt2_torque};
  static constexpr std::array<int, 3> states_that_drive_voltage = {tachogenerator_2, filter,
                                                                   controller};

  template <class Number>
  static ConstView<N, Number> of(const Number* x, ElectricalState state) {
    return ConstView<N, Number>(x + state * N);
  }
  static View<N> of(double* x, ElectricalState state) { return View<N>(x + state * N); }

  // Derivatives of the states, given the command u_c [V] and the rates rq' of the rotors.
  void derivatives(const double* x, const PerAxis<N>& command, const PerAxis<N>& rotor_rate,
                   double* dx) const {
    tachogenerator.derivatives(rotor_rate, of(x, tachogenerator_1), of(x, tachogenerator_2),
                               of(x, tachogenerator_3), of(dx, tachogenerator_1),
                               of(dx, tachogenerator_2), of(dx, tachogenerator_3));
    rate_controller.derivatives(command, of(x, tachogenerator_2), of(x, filter), of(x, controller),
                                of(x, voltage), of(dx, filter), of(dx, controller),
                                of(dx, voltage));
    motor.derivatives(of(x, voltage), of(x, pt2_torque), of(x, pt2_torque_rate), of(dx, pt2_torque),
                      of(dx, pt2_torque_rate));
  }

  // w + K_S T_0 e - U [V].
  template <class Number>
  PerAxis<N, Number> drive_of_voltage(const Number* x, const PerAxis<N, Number>& command) const {
    const PerAxis<N, Number> e =
        rate_controller.rate_error(command, of(x, tachogenerator_2), of(x, filter));
    return rate_controller.drive(e, of(x, controller), of(x, voltage));
  }

  // What leaves the position controllers, the tachogenerators and the comparison of both [V].
  struct Voltages {
    PerAxis<N> command, tachogenerator, rate_error;  // u_c, u_t, e
  };
  Voltages voltages(const double* x, const PerAxis<N>& command) const {
    const ConstView<N> u_t = of(x, tachogenerator_2);
    return {command, u_t, rate_controller.rate_error(command, u_t, of(x, filter))};
  }

  // U [V].
  static ConstView<N> voltage_of(const double* x) { return of(x, voltage); }

  // rF [N m].
  template <class Number>
  PerAxis<N, Number> motor_torque(const Number* x) const {
    return motor.NL2(of(x, pt2_torque));
  }
};

}  // namespace manutec_r3::drive
