// A robot as linear blocks (hybrid/linear_view.hpp), one for each axis: controllers, motor, rotor,
// gear and joint.
//
// On frozen branches an axis is linear (spec 4, spec 5) but for what the arms do to it:
//
//   elastic gear   rq'' = (rF - tau - rM)/rJ,   aq'' = a
//   rigid gear     aq'' = p tau/A + r
//
// with the acceleration a of the joint as the arms' equations give it, and r = a - p tau/A: A is
// about the inertia that the motor moves, so that r is small and slow. Elastic rotors that the arms
// carry have a remainder as well. A is one of a few values, four to an octave, so that robots with
// different loads have blocks in common; it is chosen anew at every event.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "hybrid/linear_view.hpp"
#include "robot/equations.hpp"
#include "robot/mode.hpp"

namespace manutec_r3::robot {

// Values of A to an octave.
inline constexpr double inertias_per_octave = 4.0;

template <int N, class Axes>
class LinearDrives {
  using OfEquations = Equations<N, Axes>;
  static constexpr int E = OfEquations::E;

 public:
  LinearDrives(const Robot& robot, const Inputs& inputs, const OfEquations& equations,
               const Mode<N>& mode)
      : robot_(robot),
        inputs_(inputs),
        equations_(equations),
        mode_(mode),
        n_electrical_((robot.n_states() - 2 * N - 2 * equations.n_elastic()) / N),
        zero_(robot.n_states(), 0.0),
        rates_(robot.n_states()) {
    for (int i = 0; i < N; ++i) {
      const std::vector<int> of_axis = states_with_constants(i);
      states_with_constants_.insert(states_with_constants_.end(), of_axis.begin(), of_axis.end());
    }
  }

  // Reads A from the mode. An elastic gear moves its joint slowly: no A.
  void freeze() {
    for (int i = equations_.n_elastic(); i < N; ++i) {
      const double octaves = mode_.branch(Mode<N>::inertia, i) / inertias_per_octave;
      p_by_A_[i] = equations_.p[i] * std::exp2(-octaves);
    }
  }

  const hybrid::LinearBlock& block(int axis) {
    return robot_.linear_blocks().find_or(axis, key(axis), [&] { return make_block(axis); });
  }

  // Where the drives' equations are not zero at zero state: edges of NL1 in m'', edges of NL2 and
  // NL4 and dry friction in the acceleration of the rotor.
  void constants(double* values) {
    drive_rates(zero_.data(), PerAxis<N>::Zero(), PerAxis<N>::Zero(), rates_.data());
    for (const int state : states_with_constants_) *values++ = rates_[state];
  }

  // The command at the reference, as if the rotors were at zero; or the motor torques.
  template <class Number>
  void forcing(const Number& t, Number* values) const {
    drive::View<N, Number>{values} =
        equations_.command_or_torque(t, PerAxis<N, Number>::Zero().eval());
  }

  // Of what sticks it is the friction that holds it, which moves nothing.
  template <class Number>
  void remainder(const Number& t, const Number* x, Number* values) const {
    const auto torques = equations_.torques(t, x);
    const auto dynamics = equations_.dynamics(t, x);
    const auto a = equations_.accelerations(dynamics, torques);
    for (int i = 0; i < N; ++i) {
      if (holds(i)) {
        *values++ = equations_.held_friction(i, dynamics, torques, a);
      } else {
        *values++ = a.joint[i] - p_by_A_[i] * torques.gear[i];
      }
      if (!robot_.carries_elastic_rotor(i)) continue;
      if (equations_.sticking[i]) {
        *values++ = equations_.held_friction(i, dynamics, torques, a);
      } else {
        const Number drive = torques.motor[i] - torques.gear[i] - torques.friction[i];
        *values++ = a.rotor[i] - drive / equations_.rJ[i];
      }
    }
  }

  // What a remainder, or its rate, says of the friction of coupled axes that stick.
  template <class Number>
  void read_held_friction(const Number* remainder, PerAxis<N, Number>& friction) const {
    for (int i = 0; i < N; ++i) {
      if (holds(i)) friction[i] = *remainder;
      ++remainder;
      if (!robot_.carries_elastic_rotor(i)) continue;
      if (equations_.sticking[i]) friction[i] = *remainder;
      ++remainder;
    }
  }

  // Polynomials are; functions of a user are not asked beyond their knots.
  bool extends_beyond_events() const {
    return !inputs_.of_axes && !inputs_.tip_force &&
           (!inputs_.motion || inputs_.motion->extends_beyond_knots());
  }

  // Chooses A for the rigid axes of a state.
  void choose_inertias(double t, const double* x, Mode<N>& mode) {
    const arm::Symmetric<N> M = equations_.dynamics(t, x).arms.M;
    for (int i = equations_.n_elastic(); i < N; ++i) {
      const arm::Vector<N> a = arm::solution(M, arm::Vector<N>::Unit(i).eval());
      const double octaves = -std::log2(a[i]);
      mode.set(Mode<N>::inertia, i, static_cast<int>(std::lround(inertias_per_octave * octaves)));
    }
    freeze();
  }

 private:
  // The joint is at rest for as long as the axis sticks.
  bool holds(int axis) const { return equations_.sticking[axis] && !equations_.is_elastic(axis); }

  // All that a block depends on in a robot.
  std::uint64_t key(int axis) const {
    std::uint64_t key = static_cast<std::uint32_t>(mode_.branch(Mode<N>::inertia, axis));
    const auto append = [&](int values, int value) { key = key * values + value; };
    for (const int kind : {dead_zone, torque_limit, voltage_limit, backlash, friction}) {
      append(2, mode_.branch(kind, axis) != 0);
    }
    append(2, equations_.sticking[axis]);
    append(64, mode_.branch(Mode<N>::friction_piece, axis));
    return key;
  }

  // --- the states of an axis
  // -----------------------------------------------------------------------

  int electrical_state(int axis, int row) const {
    return static_cast<int>(equations_.electrical(zero_.data()) - zero_.data()) + row * N + axis;
  }
  int state_of_deflection(int axis) const { return 2 * N + axis; }

  std::vector<int> states_of(int axis) const {
    std::vector<int> states = {axis, N + axis};
    if (equations_.is_elastic(axis)) {
      states.push_back(state_of_deflection(axis));
      states.push_back(equations_.index_of_rate(axis));
    }
    for (int row = 0; row < n_electrical_; ++row) states.push_back(electrical_state(axis, row));
    return states;
  }

  std::vector<int> states_with_constants(int axis) const {
    std::vector<int> states = {equations_.index_of_rate(axis)};
    if (n_electrical_ > 0 && Axes::state_with_constant >= 0) {
      states.push_back(electrical_state(axis, Axes::state_with_constant));
    }
    return states;
  }

  std::vector<int> watched_states(int axis) const {
    std::vector<int> states = {axis, N + axis};
    if (equations_.is_elastic(axis)) {
      states.push_back(state_of_deflection(axis));
      states.push_back(equations_.index_of_rate(axis));
    }
    if (n_electrical_ == 0) return states;
    for (const int row : Axes::states_that_switch) states.push_back(electrical_state(axis, row));
    if (std::isinf(robot_.options().voltage_limit)) return states;
    for (const int row : Axes::states_that_drive_voltage) {
      states.push_back(electrical_state(axis, row));
    }
    return states;
  }

  // --- blocks ------------------------------------------------------------------------------------

  // The derivatives of a state that the drives make, given command and motor torques from outside
  // beside what follows from the state.
  void drive_rates(const double* x, const PerAxis<N>& command, const PerAxis<N>& torque,
                   double* dx) const {
    const PerAxis<N> motor = equations_.motor_torque_from(x) + torque;
    const auto torques = equations_.torques_with(motor, x);
    drive::View<N>{dx} = equations_.qd(x);
    for (int i = 0; i < N; ++i) {
      dx[N + i] = holds(i) ? 0.0 : p_by_A_[i] * torques.gear[i];
      if (!equations_.is_elastic(i)) continue;
      const double drive = torques.motor[i] - torques.gear[i] - torques.friction[i];
      dx[state_of_deflection(i)] = equations_.deflection_rate(x)[i];
      dx[equations_.index_of_rate(i)] = equations_.sticking[i] ? 0.0 : drive / equations_.rJ[i];
    }
    if (n_electrical_ > 0) {
      equations_.axes.derivatives(equations_.electrical(x),
                                  equations_.command_from_rotors(x) + command,
                                  equations_.rotor_rate(x), equations_.electrical(dx));
    }
  }

  hybrid::LinearBlock make_block(int axis) const {
    hybrid::LinearBlock block;
    block.states = states_of(axis);
    const auto place = [&](int state) {
      return static_cast<int>(std::ranges::find(block.states, state) - block.states.begin());
    };
    for (const int state : watched_states(axis)) block.watched.push_back(place(state));
    const std::vector<int> with_constants = states_with_constants(axis);
    const bool carried = robot_.carries_elastic_rotor(axis);
    block.n_constants = static_cast<int>(with_constants.size());
    block.n_forcing = 1;
    block.n_remainder = carried ? 2 : 1;

    // Derivatives are linear but for what they are at zero: those at plus and at minus one give one
    // column. It is the same, to the last bit, on branches in the mirror.
    const int n = static_cast<int>(block.states.size());
    std::vector<double> x = zero_, plus = zero_, minus = zero_;
    const PerAxis<N> none = PerAxis<N>::Zero();
    const auto half_difference = [&] {
      Eigen::VectorXd column(n);
      for (int k = 0; k < n; ++k) {
        column[k] = 0.5 * (plus[block.states[k]] - minus[block.states[k]]);
      }
      return column;
    };
    block.L.resize(n, n);
    for (int k = 0; k < n; ++k) {
      x[block.states[k]] = 1.0;
      drive_rates(x.data(), none, none, plus.data());
      x[block.states[k]] = -1.0;
      drive_rates(x.data(), none, none, minus.data());
      block.L.col(k) = half_difference();
      x[block.states[k]] = 0.0;
    }
    block.B.setZero(n, block.n_constants + block.n_forcing + block.n_remainder);
    int column = 0;
    for (const int state : with_constants) block.B(place(state), column++) = 1.0;
    PerAxis<N> unit = none;
    unit[axis] = 1.0;
    const PerAxis<N> command = n_electrical_ > 0 ? unit : none, torque = unit - command;
    drive_rates(x.data(), command, torque, plus.data());
    drive_rates(x.data(), -command, -torque, minus.data());
    block.B.col(column++) = half_difference();
    if (!holds(axis)) block.B(place(N + axis), column) = 1.0;
    ++column;
    if (carried && !equations_.sticking[axis]) {
      block.B(place(equations_.index_of_rate(axis)), column) = 1.0;
    }
    return block;
  }

  const Robot& robot_;
  const Inputs& inputs_;
  const OfEquations& equations_;
  const Mode<N>& mode_;
  int n_electrical_;                        // states of an axis
  PerAxis<N> p_by_A_ = PerAxis<N>::Zero();  // of rigid gears
  std::vector<int> states_with_constants_;
  std::vector<double> zero_;   // a state
  std::vector<double> rates_;  // scratch
};

}  // namespace manutec_r3::robot
