// The hybrid system of a robot: equations, indicators and decisions in one object, for N moving
// arms with the controllers and motors `Axes`.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "hybrid/crossing.hpp"
#include "robot/electrical_switches.hpp"
#include "robot/equations.hpp"
#include "robot/friction_decision.hpp"
#include "robot/indicators.hpp"
#include "robot/linear_drives.hpp"
#include "robot/mode.hpp"
#include "robot/robot_system.hpp"
#include "robot/watch.hpp"
#include "robot/zones.hpp"

namespace manutec_r3::robot {

inline constexpr double not_available = std::numeric_limits<double>::quiet_NaN();

// Whether an announced instant has come: instants that are one are decided at once.
inline bool has_come(double instant, double t) {
  return t >= instant - hybrid::simultaneous(instant);
}

template <int N, class Axes>
class RobotSystemOf final : public RobotSystem, public hybrid::LinearView {
  using Indicators = robot::Indicators<N>;
  using Abreast = numbers::Abreast;

 public:
  RobotSystemOf(std::shared_ptr<const Robot> robot, const Axes& axes, Inputs inputs)
      : robot_(std::move(robot)),
        inputs_(std::move(inputs)),
        equations_(*robot_, axes, inputs_),
        electrical_(*robot_, equations_, mode_),
        friction_(*robot_, equations_, mode_),
        linear_drives_(*robot_, inputs_, equations_, mode_),
        watch_(*robot_, equations_, mode_, electrical_, friction_, linear_drives_) {
    for (const StateGroup& group : robot_->states()) {
      nominals_.insert(nominals_.end(), group.nominals.begin(), group.nominals.end());
    }
    if (const auto* table_1 = std::get_if<drive::Table1>(&robot_->tables().table_1)) {
      sampling_time_ = table_1->sampling_time;
    }
    scratch_.resize(robot_->n_states());
    freeze();
  }

  int n_axes() const override { return N; }
  int n_states() const override { return robot_->n_states(); }
  int n_indicators() const override { return watch_.n_indicators(); }
  std::span<const double> nominals() const override { return nominals_; }
  // A stiff spring that holds an axis has no damping: 5e5 rad/s.
  bool rings() const override { return robot_->options().stiction == Stiction::stiff_spring; }

  void derivatives(double t, const double* x, double* derivatives) override {
    equations_.derivatives(t, x, derivatives);
  }

  void hold(double* x) const override {
    for (int i = 0; i < N; ++i) {
      if (equations_.sticking[i]) x[equations_.index_of_rate(i)] = 0.0;
    }
  }

  // --- indicators -------------------------------------------------------------------------------

  void indicators(double t, const double* x, double* z) override { watch_.indicators(t, x, z); }
  void indicator_rates(double t, const double* x, const double* dx, double* rates) override {
    watch_.rates(t, x, dx, rates);
  }

  hybrid::Element element_of(int indicator) const override {
    constexpr std::array<ElementKind, Indicators::n_rows> kinds = {
        dead_zone, torque_limit, backlash, friction, friction, friction, voltage_limit};
    const auto place = Indicators::place(indicator);
    return {.axis = place.axis + 1, .kind = kinds[place.row]};
  }

  std::span<const IndicatorRow> indicator_rows() const override {
    static constexpr std::array<IndicatorRow, Indicators::n_rows> rows = {{
        {"dead_zone", 0.1},         // [V]
        {"torque_limit", 10.0},     // [N m]
        {"backlash", 0.1},          // [rad]
        {"friction", 1.0},          // [rad/s], or [N m] of what sticks
        {"friction_piece", 100.0},  // [rad/s]
        {"creep", 1.0},             // [rad/s]
        {"voltage_limit", 10.0},    // [V]
    }};
    return std::span(rows).first(n_indicators() / (Indicators::n_edges * N));
  }

  std::string describe(hybrid::Element element) const override {
    std::string name(element_names[element.kind]);
    std::ranges::replace(name, '_', ' ');
    return name + (element.axis > 0 ? " of axis " + std::to_string(element.axis) : "");
  }

  bool is_routine(hybrid::Element element) const override { return element.kind == sample; }

  double next_time_event(double) const override {
    return std::min({next_knot(), next_sample(), end_of(inputs_.of_axes, Mode<N>::input_piece),
                     end_of(inputs_.tip_force, Mode<N>::force_piece)});
  }

  // --- decisions --------------------------------------------------------------------------------

  void initialise(double t, double* x) override {
    if (inputs_.motion) mode_.set_counter(Mode<N>::motion_piece, inputs_.motion->piece_at(t));
    begin_piece(inputs_.of_axes, Mode<N>::input_piece, t);
    begin_piece(inputs_.tip_force, Mode<N>::force_piece, t);
    if (is_sampled()) take_sample(t, x);
    freeze();
    // U', m' and delta' do not depend on the branches that they decide.
    equations_.derivatives(t, x, scratch_.data());
    electrical_.initialise(x, scratch_.data());
    if (robot_->has_real_gears()) {
      const ConstView<E> delta = equations_.deflection(x);
      const ConstView<E> delta_rate = equations_.deflection(scratch_.data());
      for (int i = 0; i < E; ++i) {
        if (!equations_.gear.has_backlash(i)) continue;
        mode_.set(backlash, i, zone(delta[i], delta_rate[i], equations_.gear.b[i]));
      }
      const PerAxis<N> rate = equations_.rotor_rate(x);
      Occasion occasion;
      for (int i = 0; i < N; ++i) {
        const double speed = std::abs(rate[i]);
        const bool watched = equations_.is_elastic(i) && speed > creep_armed * creep_rate();
        mode_.set(friction, i, friction_.has_friction(i) ? friction_.branch_at(i, rate[i]) : 0);
        mode_.set(Mode<N>::friction_piece, i, friction_.characteristic(i).piece_at(speed));
        mode_.set(Mode<N>::creep, i, watched);
        occasion.at_rest[i] = rate[i] == 0.0;
      }
      freeze();
      friction_.decide(t, x, occasion);
    }
    freeze();
    linear_drives_.choose_inertias(t, x, mode_);
  }

  void handle_event(double t, double* x, const hybrid::Cause& cause,
                    std::vector<hybrid::Change>& log) override {
    const std::vector<std::int32_t> before = mode_.frozen().branches;
    Occasion occasion;
    occasion.jump = cause.input_changed;
    if (cause.time_event) pass_time_events(t, x, occasion, log);
    if (!cause.fired.empty()) {
      equations_.derivatives(t, x, scratch_.data());
      for (const int indicator : cause.fired) cross(indicator, x, occasion);
    }
    if (cause.time_event || cause.input_changed) electrical_.after_jump(t, x);
    freeze();
    if (robot_->has_real_gears() && (occasion.jump || !cause.fired.empty())) {
      friction_.decide(t, x, occasion);
      freeze();
    }
    linear_drives_.choose_inertias(t, x, mode_);

    for (int i = 0; i < N; ++i) {
      for (int kind = 0; kind < n_axis_elements; ++kind) {
        const int old_branch = before[kind * N + i];
        const int new_branch = mode_.branch(kind, i);
        if (old_branch != new_branch) log.push_back({{i + 1, kind}, old_branch, new_branch});
      }
    }
  }

  // What springs and dampers hold shakes between axes as fast as they do: no slow remainder.
  hybrid::LinearView* linear_view() override {
    return robot_->options().stiction == Stiction::exact ? this : nullptr;
  }

  int n_blocks() const override { return N; }
  const hybrid::LinearBlock& block(int axis) override { return linear_drives_.block(axis); }
  void constants(double* values) override { linear_drives_.constants(values); }
  void forcing(double t, double* values) override { linear_drives_.forcing(t, values); }
  void forcing(const Abreast& t, Abreast* values) override { linear_drives_.forcing(t, values); }
  void remainder(double t, const double* x, double* values) override {
    linear_drives_.remainder(t, x, values);
  }
  void remainder(const Abreast& t, const Abreast* x, Abreast* values) override {
    linear_drives_.remainder(t, x, values);
  }

  // The remainder of what sticks is the friction that holds it.
  void indicators(const Abreast& t, const Abreast* x, const Abreast* u, Abreast* z) override {
    watch_.indicators(t, x, u, z);
  }
  void indicator_rates(const Abreast& t, const Abreast* x, const Abreast* dx, const Abreast*,
                       const Abreast* du, Abreast* rates) override {
    watch_.rates(t, x, dx, du, rates);
  }
  bool extends_beyond_events() const override { return linear_drives_.extends_beyond_events(); }

  const hybrid::Mode& mode() const override { return mode_.frozen(); }

  void set_mode(const hybrid::Mode& mode) override {
    mode_.set_frozen(mode);
    freeze();
  }

  int branch(ElementKind kind, int axis) const override { return mode_.branch(kind, axis); }

  // --- inputs and outputs -----------------------------------------------------------------------

  void set_input(std::span<const double> values) override {
    mode_.input() = ConstView<N>(values.data());
    freeze();
  }

  std::span<const double> input() const override { return mode_.input(); }

  void set_tip_force(const std::array<double, 3>& force) override {
    mode_.tip_force() = ConstView<3>(force.data());
    freeze();
  }

  std::span<const double> tip_force() const override { return mode_.tip_force(); }

  void set_brakes(const std::vector<bool>& on) override {
    for (int i = 0; i < N; ++i) mode_.set(Mode<N>::brake, i, on[i]);
  }

  void check_brakes(const std::vector<bool>& on, const double* x) const override {
    for (int i = 0; i < N; ++i) {
      if (!on[i] || mode_.branch(Mode<N>::brake, i)) continue;
      const std::string axis = "brakes of axis " + std::to_string(i + 1);
      if (i < drive::n_elastic) {
        throw std::invalid_argument(axis + ": expected none, only axes 4 to 6 have brakes");
      }
      const double rate = x[equations_.index_of_rate(i)];
      // What springs and dampers of the option hold is at rest as well.
      const bool sticks =
          robot_->has_real_gears() && branch(friction, i) == 0 && friction_.has_friction(i);
      if (rate != 0.0 && !sticks) {
        std::ostringstream message;
        message << axis << ": expected an axis at rest, got a joint rate of " << rate << " rad/s";
        throw std::invalid_argument(message.str());
      }
    }
  }

  std::vector<bool> brakes() const override {
    std::vector<bool> on(N);
    for (int i = 0; i < N; ++i) on[i] = mode_.branch(Mode<N>::brake, i) != 0;
    return on;
  }

  void signals(double t, const double* x, double* values) override {
    const auto signal = [values](Signal which) { return View<N>(values + which * N); };
    const auto now = equations_.mechanics(t, x);
    signal(joint_angle) = equations_.q(x);
    signal(joint_rate) = equations_.qd(x);
    signal(joint_acceleration) = now.joint_acceleration;
    signal(rotor_angle) = equations_.rotor_angle(x);
    signal(rotor_rate) = equations_.rotor_rate(x) + 0.0;  // rest is 0, not -0, for negative p
    std::array<motion::Reference, N> desired;
    desired.fill({not_available, not_available});
    if (inputs_.motion) inputs_.motion->reference(equations_.motion_piece, t, desired);
    for (int i = 0; i < N; ++i) {
      signal(reference_angle)[i] = desired[i].angle;
      signal(reference_rate)[i] = desired[i].rate;
    }
    signal(control_error) = signal(reference_angle) - signal(joint_angle);
    signal(motor_torque) = now.torques.motor;
    signal(gear_torque) = now.torques.gear;
    signal(Signal::friction_torque) = now.torques.friction;
    signal(joint_torque) = equations_.p * now.torques.gear;
    if (robot_->has_controller()) {
      const double* electrical = equations_.electrical(x);
      const auto inside = equations_.axes.voltages(electrical, equations_.command(t, x));
      signal(Signal::command) = inside.command;
      signal(tachogenerator_voltage) = inside.tachogenerator;
      signal(rate_error) = inside.rate_error;
      signal(Signal::voltage) = Axes::voltage_of(electrical);
    } else {
      for (const Signal which :
           {Signal::command, tachogenerator_voltage, rate_error, Signal::voltage}) {
        signal(which).setConstant(not_available);
      }
    }
  }

  void energies(const double* x, const double* signals, double* values) override {
    const auto signal = [signals](Signal which) { return ConstView<N>(signals + which * N); };
    const auto energy = [values](Energy which) { return View<N>(values + which * N); };
    const auto stored = equations_.stored_energies(x);
    energy(kinetic_energy) = stored.kinetic;
    energy(potential_energy) = stored.potential;
    energy(elastic_energy) = stored.elastic;
    // No power is 0, not -0.
    energy(motor_power) = signal(motor_torque) * signal(rotor_rate) + 0.0;
    energy(gear_power) = signal(gear_torque) * signal(rotor_rate) + 0.0;
    energy(joint_power) = signal(joint_torque) * signal(joint_rate) + 0.0;
    energy(friction_loss) = signal(Signal::friction_torque) * signal(rotor_rate) + 0.0;
    energy(damping_loss) = equations_.damping_loss(x);
  }

 private:
  static constexpr int E = Equations<N, Axes>::E;
  using Occasion = typename FrictionDecision<N, Axes>::Occasion;
  using Counter = typename Mode<N>::Counter;

  bool is_sampled() const { return robot_->options().controller == Controller::sampled; }
  double creep_rate() const { return robot_->options().creep_rate; }

  // --- time events ------------------------------------------------------------------------------

  double next_knot() const {
    return inputs_.motion ? inputs_.motion->end_of(mode_.counter(Mode<N>::motion_piece))
                          : hybrid::never;
  }
  double next_sample() const {
    return is_sampled() ? (mode_.counter(Mode<N>::sample_count) + 1) * sampling_time_
                        : hybrid::never;
  }
  double end_of(const std::shared_ptr<const motion::Input>& input, Counter piece) const {
    return input ? input->end_of(mode_.counter(piece)) : hybrid::never;
  }
  void begin_piece(const std::shared_ptr<const motion::Input>& input, Counter piece, double t) {
    if (input) mode_.set_counter(piece, input->piece_at(t));
  }

  void pass_time_events(double t, const double* x, Occasion& occasion,
                        std::vector<hybrid::Change>& log) {
    // Passes whatever ends at this instant, and tells whether something does.
    const auto pass = [&](Counter counter, const auto& next) {
      const int before = mode_.counter(counter);
      while (has_come(next(), t)) mode_.set_counter(counter, mode_.counter(counter) + 1);
      return mode_.counter(counter) > before;
    };
    if (pass(Mode<N>::motion_piece, [&] { return next_knot(); })) {
      log.push_back({{0, reference}, 0, 0});
    }
    const bool inputs_jump =
        pass(Mode<N>::input_piece, [&] { return end_of(inputs_.of_axes, Mode<N>::input_piece); });
    const bool force_jumps =
        pass(Mode<N>::force_piece, [&] { return end_of(inputs_.tip_force, Mode<N>::force_piece); });
    occasion.jump |= (inputs_jump && !robot_->has_controller()) || force_jumps;
    freeze();
    if (pass(Mode<N>::sample_count, [&] { return next_sample(); })) {
      take_sample(t, x);
      log.push_back({{0, sample}, 0, 0});
    }
    freeze();
  }

  // The A/D converter reads the reference and the rotors, the D/A converter holds what the position
  // controllers make of them (spec 4).
  void take_sample(double t, const double* x) {
    equations_.motion_piece = mode_.counter(Mode<N>::motion_piece);
    mode_.input() = equations_.command_from_motion(t, equations_.rotor_angle(x));
  }

  // --- crossings --------------------------------------------------------------------------------

  // An indicator has left its domain.
  void cross(int indicator, double* x, Occasion& occasion) {
    const auto [row, edge, i] = Indicators::place(indicator);
    const bool lower = edge == Indicators::lower;
    const double* rates = scratch_.data();
    switch (row) {
      case Indicators::of_dead_zone:
        electrical_.cross(dead_zone, i, lower, x, rates);
        break;
      case Indicators::of_torque_limit:
        electrical_.cross(torque_limit, i, lower, x, rates);
        break;
      case Indicators::of_voltage_limit:
        electrical_.cross(voltage_limit, i, lower, x, rates);
        break;
      case Indicators::of_backlash:
        mode_.set(backlash, i,
                  zone_beyond(branch(backlash, i), lower, equations_.deflection(rates)[i]));
        // A damper that acts in contact only makes tau jump.
        occasion.jump |= equations_.gear.damping == drive::GearDamping::contact;
        break;
      case Indicators::of_friction:
        (branch(friction, i) == 0 ? occasion.released : occasion.at_rest)[i] = true;
        break;
      case Indicators::of_friction_piece:
        mode_.set(Mode<N>::friction_piece, i,
                  mode_.branch(Mode<N>::friction_piece, i) + (lower ? -1 : +1));
        break;
      case Indicators::of_creep:
        occasion.creeps[i] = mode_.branch(Mode<N>::creep, i) != 0;
        mode_.set(Mode<N>::creep, i, !occasion.creeps[i]);
        break;
      case Indicators::n_rows:
        break;
    }
  }

  // Coefficients and inputs of the equations, from the mode.
  void freeze() {
    electrical_.freeze();
    if (robot_->has_real_gears()) {
      for (int i = 0; i < E; ++i) equations_.gear.set_branch(i, branch(backlash, i));
      friction_.freeze();
    } else {
      for (int i = 0; i < N; ++i) equations_.sticking[i] = mode_.branch(Mode<N>::brake, i) != 0;
    }
    equations_.held_input = mode_.input();
    equations_.held_tip_force = mode_.tip_force().matrix();
    equations_.motion_piece = mode_.counter(Mode<N>::motion_piece);
    equations_.input_piece = mode_.counter(Mode<N>::input_piece);
    equations_.force_piece = mode_.counter(Mode<N>::force_piece);
    linear_drives_.freeze();
    watch_.freeze();
  }

  std::shared_ptr<const Robot> robot_;
  Inputs inputs_;
  Equations<N, Axes> equations_;
  Mode<N> mode_;
  ElectricalSwitches<N, Axes> electrical_;
  FrictionDecision<N, Axes> friction_;
  LinearDrives<N, Axes> linear_drives_;
  Watch<N, Axes> watch_;
  double sampling_time_ = 0.0;
  std::vector<double> nominals_;
  std::vector<double> scratch_;
};

}  // namespace manutec_r3::robot
