// Which axes stick, and how the others slide, at one instant (spec 5.2, 5.3).
//
// Rotors behind elastic gears decide each on its own, unless the arms carry them; axes with rigid
// gears and carried rotors act on each other at once and decide together.
#pragma once

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "drive/friction.hpp"
#include "robot/equations.hpp"
#include "robot/mode.hpp"
#include "robot/options.hpp"
#include "robot/soon.hpp"
#include "robot/stiction.hpp"
#include "robot/zones.hpp"

namespace manutec_r3::robot {

template <int N, class Axes>
class FrictionDecision {
 public:
  // What a decision starts from, axis by axis.
  struct Occasion {
    std::array<bool, N> at_rest{};   // slid and has come to zero rate
    std::array<bool, N> released{};  // stuck and has reached its limit
    std::array<bool, N> creeps{};    // slides so slowly that it sticks if it can
    bool jump = false;               // torques have jumped: look at every sticking axis
  };

  FrictionDecision(const Robot& robot, Equations<N, Axes>& equations, Mode<N>& mode)
      : robot_(robot),
        equations_(equations),
        mode_(mode),
        stiction_(robot.options().stiction),
        k_(robot.options().stiffness) {
    const drive::Table2& table = robot.tables().table_2;
    for (int i = 0; i < N; ++i) {
      friction_[i] = {table.sticking_limit[i], table.sliding_friction[i]};
      side_[i] = robot.friction_side(i);
    }
  }

  const drive::Friction& characteristic(int axis) const { return friction_[axis]; }

  // The largest |rM| at rest: a brake has no limit.
  double sticking_limit(int axis) const {
    return mode_.branch(Mode<N>::brake, axis) ? std::numeric_limits<double>::infinity()
                                              : friction_[axis].sticking_limit;
  }
  // Whether there is anything to decide about an axis.
  bool has_friction(int axis) const {
    return friction_[axis].sticking_limit > 0.0 || mode_.branch(Mode<N>::brake, axis);
  }
  // How the rotor slides, -1, 0 or +1.
  int rotor_direction(int axis) const { return side_[axis] * mode_.branch(friction, axis); }
  // The branch of an axis whose rotor has this rate.
  int branch_at(int axis, double rotor_rate) const { return side_[axis] * sign(rotor_rate); }

  // Sets what the equations read of friction, from the mode.
  void freeze() {
    equations_.springs_hold = false;
    for (int i = 0; i < N; ++i) freeze(i, !is_soft(i));
  }

  // Sets the branches of friction, and rates of sticking axes to exactly zero.
  void decide(double t, double* x, Occasion occasion) {
    std::array<bool, N> stuck{};
    bool together = false;
    for (int i = 0; i < N; ++i) {
      stuck[i] = mode_.branch(friction, i) == 0;
      double& rate = x[equations_.index_of_rate(i)];
      // After a jump an axis that was about to slide is as good as one that has just stopped.
      if (occasion.jump && !stuck[i] && rate == 0.0) occasion.at_rest[i] = true;
      if (occasion.at_rest[i]) rate = 0.0;
      const bool concerned =
          occasion.at_rest[i] || occasion.released[i] || occasion.creeps[i] || occasion.jump;
      together |= equations_.is_coupled(i) && concerned;
    }
    decide_one_by_one(t, x, occasion, stuck);
    if (together) decide_together(t, x, occasion, stuck);
  }

 private:
  // Held by a spring or damper of the option, and not by a brake.
  bool is_soft(int axis) const {
    return stiction_ != Stiction::exact && !equations_.is_elastic(axis) &&
           !mode_.branch(Mode<N>::brake, axis);
  }

  void freeze(int axis, bool exact) {
    const int direction = rotor_direction(axis);
    friction_[axis].set(equations_.friction, axis, direction,
                        mode_.branch(Mode<N>::friction_piece, axis));
    const bool sticks = direction == 0 && has_friction(axis);
    const bool soft = sticks && !exact;
    equations_.sticking[axis] = sticks && exact;
    const bool spring = soft && stiction_ == Stiction::stiff_spring;
    equations_.springs_hold |= spring;
    equations_.spring_stiffness[axis] = spring ? k_ : 0.0;
    equations_.spring_rest[axis] = spring ? mode_.spring_rest()[axis] : 0.0;
    if (soft && !spring) equations_.friction.set(axis, k_, 0.0);
  }

  void decide_one_by_one(double t, double* x, const Occasion& occasion,
                         const std::array<bool, N>& stuck) {
    const auto torques = equations_.torques(t, x);
    for (int i = 0; i < N; ++i) {
      if (equations_.is_coupled(i) || !has_friction(i)) continue;
      const double driving = torques.motor[i] - torques.gear[i];  // rF - tau
      const bool holds = std::abs(driving) <= sticking_limit(i);
      const bool sticks_already = stuck[i] && !occasion.at_rest[i];
      if (occasion.creeps[i] && !occasion.at_rest[i]) {
        if (holds) set(i, 0, x);
      } else if (occasion.released[i] || (occasion.at_rest[i] && !holds) ||
                 (sticks_already && occasion.jump && !holds)) {
        set(i, sign(driving), x);
      } else if (occasion.at_rest[i]) {
        set(i, 0, x);
      }
    }
  }

  // Coordinates are the joints and, behind them, the rotors behind elastic gears.
  static constexpr int E = Equations<N, Axes>::E;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, N + E, N + E>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, N + E, 1>;

  void decide_together(double t, double* x, const Occasion& occasion,
                       const std::array<bool, N>& stuck) {
    std::vector<int> resting;
    for (int i = 0; i < N; ++i) {
      const bool rests = stuck[i] || occasion.at_rest[i] || occasion.creeps[i];
      if (equations_.is_coupled(i) && has_friction(i) && rests) resting.push_back(i);
    }
    if (resting.empty()) return;

    // Without friction on the resting axes.
    auto torques = equations_.torques(t, x);
    for (const int i : resting) {
      torques.friction[i] = 0.0;
      if (!equations_.is_elastic(i)) torques.gear[i] = torques.motor[i];
    }
    const auto dynamics = equations_.dynamics(t, x);
    const int n_rotors = equations_.n_elastic();
    Matrix M = Matrix::Zero(N + n_rotors, N + n_rotors);
    Vector force(N + n_rotors);
    M.template topLeftCorner<N, N>() = dynamics.arms.M.full();
    force.head(N) = (equations_.p * torques.gear).matrix() - dynamics.arms.bias;
    for (int j = 0; j < n_rotors; ++j) {
      M(N + j, N + j) = equations_.rJ[j];
      force[N + j] = torques.motor[j] - torques.gear[j] - torques.friction[j];
      if (!equations_.is_coupled(j)) continue;
      M.col(N + j).head(N) = dynamics.arM.col(j);
      M.row(N + j).head(N) = dynamics.arM.col(j).transpose();
      force[N + j] -= equations_.rJ[j] * dynamics.drift[j];
    }
    const Matrix inverse = M.inverse();
    const Vector free = inverse * force;

    // The coordinate of an axis, and what its friction torque does to it.
    const auto coordinate = [&](int i) { return equations_.is_elastic(i) ? N + i : i; };
    const int n = static_cast<int>(resting.size());
    RestingAxes axes;
    axes.W.resize(n, n);
    axes.a0.resize(n);
    axes.p.resize(n);
    axes.rM_h.resize(n);
    axes.rM_1.resize(n);
    for (int k = 0; k < n; ++k) {
      const int i = resting[k];
      for (int l = 0; l < n; ++l) {
        axes.W(k, l) = inverse(coordinate(i), coordinate(resting[l]));
      }
      axes.a0[k] = free[coordinate(i)];
      axes.p[k] = side_[i] * (equations_.is_elastic(i) ? 1.0 : equations_.p[i]);
      axes.rM_h[k] = sticking_limit(i);
      axes.rM_1[k] = friction_[i].lowest_torque();
      axes.sticks.push_back(stuck[i]);
      axes.released.push_back(occasion.released[i]);
    }
    const std::vector<int> branches = consistent_branches(axes);
    for (int k = 0; k < n; ++k) {
      // One that creeps goes on as it did, if it cannot be held.
      const bool goes_on = occasion.creeps[resting[k]] && branches[k] != 0;
      if (!goes_on) set(resting[k], branches[k], x);
    }
    capture(t, x, resting);
  }

  // Springs and dampers that hold sticking axes begin with the exact constraint torque, so that
  // nothing jumps (spec 11), and with the rate at which it changes, so that the undamped spring
  // does not ring.
  void capture(double t, double* x, const std::vector<int>& resting) {
    if (stiction_ == Stiction::exact) return;
    equations_.springs_hold = false;
    for (int i = 0; i < N; ++i) freeze(i, true);
    const PerAxis<N> held = equations_.mechanics(t, x).torques.friction;
    std::vector<double> rates(robot_.n_states()), later(robot_.n_states());
    equations_.derivatives(t, x, rates.data());
    state_soon(x, rates.data(), robot_.n_states(), later.data());
    const PerAxis<N> held_later = equations_.mechanics(t + soon, later.data()).torques.friction;
    for (const int i : resting) {
      if (mode_.branch(friction, i) != 0 || !is_soft(i)) continue;
      double& joint_rate = x[equations_.index_of_rate(i)];
      if (stiction_ == Stiction::stiff_spring) {
        mode_.spring_rest()[i] = equations_.rotor_angle(x)[i] - held[i] / k_;
        joint_rate = (held_later[i] - held[i]) / soon / (k_ * equations_.p[i]);
      } else {
        joint_rate = held[i] / (k_ * equations_.p[i]);
      }
    }
  }

  // An axis begins to slide backward or forward (-1, +1), or sticks (0) from now on.
  void set(int axis, int branch, double* x) {
    double& rate = x[equations_.index_of_rate(axis)];
    const bool stays_soft = branch == 0 && mode_.branch(friction, axis) == 0 && is_soft(axis);
    mode_.set(friction, axis, branch);
    mode_.set(Mode<N>::friction_piece, axis, 0);
    mode_.set(Mode<N>::creep, axis, 0);
    // What springs and dampers held has a rate, which must not be opposite to how it slides.
    const bool opposite = rotor_direction(axis) * equations_.rotor_rate(x)[axis] < 0.0;
    if ((branch == 0 && !stays_soft) || opposite) rate = 0.0;
  }

  const Robot& robot_;
  Equations<N, Axes>& equations_;
  Mode<N>& mode_;
  Stiction stiction_;
  double k_;  // of stiff springs and dampers
  std::array<drive::Friction, N> friction_;
  std::array<int, N> side_;
};

}  // namespace manutec_r3::robot
