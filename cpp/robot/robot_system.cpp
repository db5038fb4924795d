#include "robot/robot_system.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "hybrid/crossing.hpp"
#include "robot/equations.hpp"
#include "robot/stiction.hpp"

namespace manutec_r3::robot {
namespace {

// An axis with an elastic gear whose rotor creeps counts as sticking below this rate; watched once
// the rate has exceeded a higher one, so never right after break-away (spec 8) [rad/s].
constexpr double creep_rate = 1e-9;
constexpr double creep_armed_rate = 1e-8;

constexpr double not_available = std::numeric_limits<double>::quiet_NaN();

// Whether a time event is due at t: the simulation may stop for it a few roundoffs early.
bool has_come(double event, double t) { return t >= event - hybrid::simultaneous(event); }

int sign(double value) { return (value > 0.0) - (value < 0.0); }

// The branches of a mode: per axis those that users see, two that concern friction alone, and the
// piece of the motion.
template <int N>
struct ModeLayout {
  enum Row { friction_piece = n_axis_elements, creep, n_rows };
  static constexpr int motion_piece = n_rows * N;
  static constexpr int size = n_rows * N + 1;
  static constexpr int at(int row, int axis) { return row * N + axis; }
};

// Indicators: two for every axis and row, of which some mean nothing on some robots.
enum IndicatorRow {
  of_dead_zone,
  of_torque_limit,
  of_backlash,
  of_friction,
  of_friction_piece,
  of_creep,
  n_indicator_rows
};

template <int N>
class RobotSystemOf final : public RobotSystem {
 public:
  RobotSystemOf(std::shared_ptr<const Robot> robot, std::shared_ptr<const motion::Motion> motion)
      : robot_(std::move(robot)), motion_(std::move(motion)), equations_(*robot_) {
    for (const StateGroup& group : robot_->states()) {
      nominals_.insert(nominals_.end(), group.nominals.begin(), group.nominals.end());
    }
    mode_.branches.assign(Mode::size, 0);
    if (!robot_->has_controller()) mode_.held.assign(N, 0.0);
    scratch_.resize(robot_->n_states());
    freeze();
  }

  int n_axes() const override { return N; }
  int n_states() const override { return robot_->n_states(); }
  int n_indicators() const override { return n_indicator_rows * 2 * N; }
  std::span<const double> nominals() const override { return nominals_; }

  void derivatives(double t, const double* x, double* derivatives) override {
    equations_.derivatives(t, x, motion_.get(), derivatives);
  }

  // --- indicators -------------------------------------------------------------------------------

  void indicators(double, const double* x, double* z) override {
    std::fill_n(z, n_indicators(), 1.0);
    if (robot_->has_controller()) {
      const ConstView<N> U = voltage(x);
      const ConstView<N> m = pt2_torque(x);
      for (int i = 0; i < N; ++i) {
        edges(branch(dead_zone, i), U[i], drive::dead_zone_half_width[i], slot(z, of_dead_zone, i));
        edges(branch(torque_limit, i), m[i], drive::torque_limit[i], slot(z, of_torque_limit, i));
      }
    }
    if (!robot_->has_real_gears()) return;
    const ConstView<E> delta = equations_.deflection(x);
    for (int i = 0; i < E; ++i) {
      if (!equations_.gear.has_backlash(i)) continue;
      edges(branch(backlash, i), delta[i], equations_.gear.b[i], slot(z, of_backlash, i));
    }
    const PerAxis<N> rate = equations_.rotor_rate(x);
    const PerAxis<N> held = friction_torque(x, rate);
    for (int i = 0; i < N; ++i) {
      const int direction = branch(friction, i);
      double* of_friction_i = slot(z, of_friction, i);
      if (direction == 0) {
        of_friction_i[0] = equations_.friction_of[i].sticking_limit() - held[i];
        of_friction_i[1] = equations_.friction_of[i].sticking_limit() + held[i];
        continue;
      }
      const double speed = direction * rate[i];
      of_friction_i[0] = speed;
      const int piece = mode_.branches[Mode::at(Mode::friction_piece, i)];
      double* of_piece = slot(z, of_friction_piece, i);
      const double upper = equations_.friction_of[i].upper_end(piece);
      const double lower = equations_.friction_of[i].lower_end(piece);
      if (std::isfinite(upper)) of_piece[0] = upper - speed;
      if (std::isfinite(lower)) of_piece[1] = speed - lower;
      if (equations_.is_elastic(i)) {
        const bool armed = mode_.branches[Mode::at(Mode::creep, i)] != 0;
        slot(z, of_creep, i)[0] = armed ? speed - creep_rate : creep_armed_rate - speed;
      }
    }
  }

  hybrid::Element element_of(int indicator) const override {
    constexpr std::array<ElementKind, n_indicator_rows> kinds = {dead_zone, torque_limit, backlash,
                                                                 friction,  friction,     friction};
    return {.axis = indicator / 2 % N + 1, .kind = kinds[indicator / (2 * N)]};
  }

  std::string describe(hybrid::Element element) const override {
    std::string name(element_names[element.kind]);
    std::ranges::replace(name, '_', ' ');
    return name + (element.axis > 0 ? " of axis " + std::to_string(element.axis) : "");
  }

  double next_time_event(double) const override {
    return motion_ ? motion_->end_of(mode_.branches[Mode::motion_piece]) : hybrid::never;
  }

  // --- decisions --------------------------------------------------------------------------------

  void initialise(double t, double* x) override {
    std::ranges::fill(mode_.branches, 0);
    if (motion_) mode_.branches[Mode::motion_piece] = motion_->piece_at(t);
    freeze();
    // U', m' and delta' do not depend on the branches that they decide.
    equations_.derivatives(t, x, motion_.get(), scratch_.data());
    if (robot_->has_controller()) {
      for (int i = 0; i < N; ++i) {
        set(dead_zone, i,
            zone(voltage(x)[i], voltage(scratch_.data())[i], drive::dead_zone_half_width[i]));
        set(torque_limit, i,
            zone(pt2_torque(x)[i], pt2_torque(scratch_.data())[i], drive::torque_limit[i]));
      }
    }
    if (robot_->has_real_gears()) {
      const ConstView<E> delta = equations_.deflection(x);
      const ConstView<E> delta_rate = equations_.deflection(scratch_.data());
      for (int i = 0; i < E; ++i) {
        if (!equations_.gear.has_backlash(i)) continue;
        set(backlash, i, zone(delta[i], delta_rate[i], equations_.gear.b[i]));
      }
      const PerAxis<N> rate = equations_.rotor_rate(x);
      Friction decision;
      for (int i = 0; i < N; ++i) {
        const double speed = std::abs(rate[i]);
        set(friction, i, sign(rate[i]));
        set(Mode::friction_piece, i, equations_.friction_of[i].piece_at(speed));
        set(Mode::creep, i, equations_.is_elastic(i) && speed > creep_armed_rate);
        decision.at_rest[i] = rate[i] == 0.0;
      }
      freeze();
      decide_friction(x, decision);
    }
    freeze();
  }

  void handle_event(double t, double* x, const hybrid::Cause& cause,
                    std::vector<hybrid::Change>& log) override {
    const std::vector<std::int32_t> before = mode_.branches;
    if (cause.time_event) {
      std::int32_t& piece = mode_.branches[Mode::motion_piece];
      while (has_come(motion_->end_of(piece), t)) ++piece;
      freeze();
      log.push_back({{0, reference}, 0, 0});
    }
    equations_.derivatives(t, x, motion_.get(), scratch_.data());

    Friction decision;
    decision.jump = cause.input_changed;
    for (const int indicator : cause.fired) {
      const int row = indicator / (2 * N);
      const int i = indicator / 2 % N;
      const bool lower = indicator % 2 != 0;
      switch (row) {
        case of_dead_zone:
          leave_zone(dead_zone, i, lower, voltage(scratch_.data())[i]);
          break;
        case of_torque_limit:
          leave_zone(torque_limit, i, lower, pt2_torque(scratch_.data())[i]);
          break;
        case of_backlash:
          leave_zone(backlash, i, lower, equations_.deflection(scratch_.data())[i]);
          break;
        case of_friction:
          (branch(friction, i) == 0 ? decision.released : decision.at_rest)[i] = true;
          break;
        case of_friction_piece:
          mode_.branches[Mode::at(Mode::friction_piece, i)] += lower ? -1 : +1;
          break;
        case of_creep:
          if (mode_.branches[Mode::at(Mode::creep, i)] == 0) {
            set(Mode::creep, i, 1);
          } else {
            set(Mode::creep, i, 0);
            decision.creeps[i] = true;
          }
          break;
      }
    }
    freeze();
    if (robot_->has_real_gears()) {
      decide_friction(x, decision);
      freeze();
    }

    for (int i = 0; i < N; ++i) {
      for (int kind = 0; kind < n_axis_elements; ++kind) {
        const int old_branch = before[Mode::at(kind, i)];
        const int new_branch = mode_.branches[Mode::at(kind, i)];
        if (old_branch != new_branch) log.push_back({{i + 1, kind}, old_branch, new_branch});
      }
    }
  }

  const hybrid::Mode& mode() const override { return mode_; }

  void set_mode(const hybrid::Mode& mode) override {
    mode_ = mode;
    freeze();
  }

  int branch(ElementKind kind, int axis) const override {
    return mode_.branches[Mode::at(kind, axis)];
  }

  // --- inputs and outputs -----------------------------------------------------------------------

  void set_motor_torque(std::span<const double> torque) override {
    std::ranges::copy(torque, mode_.held.begin());
    freeze();
  }

  void signals(double t, const double* x, double* values) override {
    const auto signal = [values](Signal which) { return View<N>(values + which * N); };
    const typename Equations<N>::Mechanics now = equations_.mechanics(x);
    signal(joint_angle) = equations_.q(x);
    signal(joint_rate) = equations_.qd(x);
    signal(joint_acceleration) = now.joint_acceleration;
    signal(rotor_angle) = equations_.rotor_angle(x);
    signal(rotor_rate) = equations_.rotor_rate(x) + 0.0;  // rest is 0, not -0, for negative p
    std::array<motion::Reference, N> desired;
    desired.fill({not_available, not_available});
    if (motion_) motion_->reference(equations_.motion_piece, t, desired);
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
      signal(Signal::voltage) = voltage(x);
    } else {
      signal(Signal::voltage).setConstant(not_available);
    }
  }

 private:
  using Mode = ModeLayout<N>;
  static constexpr int E = Equations<N>::E;

  // What a decision about friction starts from, axis by axis.
  struct Friction {
    std::array<bool, N> at_rest{};   // slid and has come to zero rate
    std::array<bool, N> released{};  // stuck and has reached its limit
    std::array<bool, N> creeps{};    // slides so slowly that it sticks if it can
    bool jump = false;               // torques have jumped: look at every sticking axis
  };

  ConstView<N> voltage(const double* x) const {
    return drive::Axes<N>::of(equations_.electrical(x), drive::voltage);
  }
  ConstView<N> pt2_torque(const double* x) const {
    return drive::Axes<N>::of(equations_.electrical(x), drive::pt2_torque);
  }
  static double* slot(double* z, IndicatorRow row, int axis) { return z + row * 2 * N + 2 * axis; }

  void set(int row, int axis, int branch) { mode_.branches[Mode::at(row, axis)] = branch; }

  // Indicators of a zone from -half_width to +half_width: in the zone its upper and lower edge,
  // outside the edge that leads back.
  static void edges(int branch, double value, double half_width, double* z) {
    if (branch == 0) {
      z[0] = half_width - value;
      z[1] = half_width + value;
    } else {
      z[0] = branch * value - half_width;
    }
  }

  // The branch of a value; on an edge it is where its rate leads.
  static int zone(double value, double rate, double half_width) {
    const bool outside =
        std::abs(value) > half_width || (std::abs(value) == half_width && sign(value) * rate > 0.0);
    return outside ? sign(value) : 0;
  }

  // A value has reached an edge: it changes the zone if it goes on, and has only touched the edge
  // if it goes back. With zero rate it has been seen to go on.
  void leave_zone(ElementKind kind, int axis, bool lower_edge, double rate) {
    const bool inside = branch(kind, axis) == 0;
    const int outside = inside ? (lower_edge ? -1 : +1) : branch(kind, axis);
    const bool outward = rate == 0.0 ? inside : outside * rate > 0.0;
    set(kind, axis, outward ? outside : 0);
  }

  // rM, with the friction that holds sticking axes.
  PerAxis<N> friction_torque(const double* x, const PerAxis<N>& rate) const {
    for (int i = E; i < N; ++i) {
      if (equations_.sticking[i]) return equations_.mechanics(x).torques.friction;
    }
    return equations_.torques(x, rate).friction;
  }

  // Coefficients and inputs of the equations, from the mode.
  void freeze() {
    for (int i = 0; i < N; ++i) {
      equations_.axes.motor.NL1.set_dead_zone(i, branch(dead_zone, i),
                                              drive::dead_zone_half_width[i]);
      equations_.axes.motor.NL2.set_saturation(i, branch(torque_limit, i), drive::torque_limit[i]);
    }
    if (robot_->has_real_gears()) {
      for (int i = 0; i < E; ++i) equations_.gear.set_branch(i, branch(backlash, i));
      for (int i = 0; i < N; ++i) {
        const int direction = branch(friction, i);
        equations_.friction_of[i].set(equations_.friction, i, direction,
                                      mode_.branches[Mode::at(Mode::friction_piece, i)]);
        equations_.sticking[i] = direction == 0;
      }
    }
    if (!mode_.held.empty()) equations_.held_torque = ConstView<N>(mode_.held.data());
    equations_.motion_piece = mode_.branches[Mode::motion_piece];
  }

  // Sets the branches of friction, and rates of sticking axes to exactly zero.
  void decide_friction(double* x, Friction decision) {
    const std::array<bool, N> stuck = equations_.sticking;
    bool rigid_concerned = decision.jump;
    for (int i = 0; i < N; ++i) {
      double& rate = x[equations_.index_of_rate(i)];
      // After a jump an axis that was about to slide is as good as one that has just stopped.
      if (decision.jump && !stuck[i] && rate == 0.0) decision.at_rest[i] = true;
      if (decision.at_rest[i]) rate = 0.0;
      rigid_concerned |= i >= E && (decision.at_rest[i] || decision.released[i]);
    }
    decide_elastic_axes(x, decision, stuck);
    if (N > E && rigid_concerned) decide_rigid_axes(x, decision, stuck);
  }

  // Axes 1 to 3, each on its own (spec 5.2).
  void decide_elastic_axes(double* x, const Friction& decision, const std::array<bool, N>& stuck) {
    const typename Equations<N>::Torques torques = equations_.torques(x, equations_.rotor_rate(x));
    for (int i = 0; i < E; ++i) {
      const double driving = torques.motor[i] - torques.gear[i];  // rF - tau
      const bool holds = std::abs(driving) <= equations_.friction_of[i].sticking_limit();
      const bool sticks_already = stuck[i] && !decision.at_rest[i];
      if (decision.creeps[i] && !decision.at_rest[i]) {
        if (holds) set_friction(i, 0, x);
      } else if (decision.released[i] || (decision.at_rest[i] && !holds) ||
                 (sticks_already && decision.jump && !holds)) {
        set_friction(i, sign(driving), x);
      } else if (decision.at_rest[i]) {
        set_friction(i, 0, x);
      }
    }
  }

  // Axes 4 to 6 at zero rate, together (spec 5.3).
  void decide_rigid_axes(double* x, const Friction& decision, const std::array<bool, N>& stuck) {
    std::vector<int> resting;
    for (int i = E; i < N; ++i) {
      if (stuck[i] || decision.at_rest[i]) resting.push_back(i);
    }
    const int n = static_cast<int>(resting.size());
    if (n == 0) return;

    // Accelerations without friction on the resting axes, and how they answer to torques.
    typename Equations<N>::Torques torques = equations_.torques(x, equations_.rotor_rate(x));
    for (const int i : resting) torques.gear[i] = torques.motor[i];
    const arm::EquationsOfMotion<N> eom = equations_.equations_of_motion(x);
    const arm::Matrix<N> inverse = eom.M.inverse();
    const arm::Vector<N> free = inverse * ((equations_.p * torques.gear).matrix() - eom.bias);

    RestingAxes axes;
    axes.W = inverse(resting, resting);
    axes.a0 = free(resting);
    axes.p = equations_.p(resting);
    axes.rM_h.resize(n);
    axes.rM_1.resize(n);
    for (int k = 0; k < n; ++k) {
      const int i = resting[k];
      axes.rM_h[k] = equations_.friction_of[i].sticking_limit();
      axes.rM_1[k] = equations_.friction_of[i].lowest_torque();
      axes.sticks.push_back(stuck[i]);
      axes.released.push_back(decision.released[i]);
    }
    const std::vector<int> branches = consistent_branches(axes);
    for (int k = 0; k < n; ++k) {
      set_friction(resting[k], branches[k], x);
    }
  }

  // An axis begins to slide backward or forward (-1, +1), or sticks (0) from now on.
  void set_friction(int axis, int direction, double* x) {
    if (direction == 0) x[equations_.index_of_rate(axis)] = 0.0;
    set(friction, axis, direction);
    set(Mode::friction_piece, axis, 0);
    set(Mode::creep, axis, 0);
  }

  std::shared_ptr<const Robot> robot_;
  std::shared_ptr<const motion::Motion> motion_;
  Equations<N> equations_;
  std::vector<double> nominals_;
  hybrid::Mode mode_;
  std::vector<double> scratch_;
};

}  // namespace

std::unique_ptr<RobotSystem> make_system(std::shared_ptr<const Robot> robot,
                                         std::shared_ptr<const motion::Motion> motion) {
  if (robot->n_axes() == 6) {
    return std::make_unique<RobotSystemOf<6>>(std::move(robot), std::move(motion));
  }
  return std::make_unique<RobotSystemOf<3>>(std::move(robot), std::move(motion));
}

}  // namespace manutec_r3::robot
