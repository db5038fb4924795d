// The equations of a robot on frozen branches (spec 4 to 6), for 6 or 3 moving arms.
//
// Motor side: rF, tau, rM; joint side: aF. Everything here is a function of time and state; what
// switches is set by the owner in `motor`, `gear` and `friction` lines and in `sticking`.
#pragma once

#include <array>

#include "arm/composite.hpp"
#include "arm/parameters.hpp"
#include "arm/solve.hpp"
#include "drive/axis.hpp"
#include "drive/friction.hpp"
#include "drive/gear.hpp"
#include "motion/motion.hpp"
#include "robot/robot.hpp"

namespace manutec_r3::robot {

using drive::ConstView;
using drive::Line;
using drive::PerAxis;
using drive::View;

template <int N>
class Equations {
 public:
  // Elastic gears are those of axes 1 to 3.
  static constexpr int E = drive::n_elastic;

  explicit Equations(const Robot& robot)
      : elastic_(robot.has_real_gears()),
        controlled_(robot.has_controller()),
        deflection_state_(robot.first_state("deflection")),
        electrical_state_(robot.first_state("tachogenerator_1")),
        mechanism_(std::get<arm::Mechanism<N>>(robot.arm_behind_gears())) {
    for (int i = 0; i < N; ++i) {
      friction_of[i] = {drive::friction[i]};
      rJ[i] = arm::rotors[i].inertia;
    }
  }

  // --- what switches, and inputs ----------------------------------------------------------------

  drive::Axes<N> axes;      // NL1 and NL2 in its motors
  drive::ElasticGear gear;  // NL4
  Line<N> friction;         // rM while sliding
  std::array<bool, N> sticking{};
  int motion_piece = -1;
  PerAxis<N> held_torque = PerAxis<N>::Zero();  // rF of a robot without controller

  // --- constants --------------------------------------------------------------------------------

  PerAxis<N> p = drive::first<N>(drive::gear_ratio);
  PerAxis<N> rJ;
  std::array<drive::Friction, N> friction_of;

  bool is_elastic(int axis) const { return elastic_ && axis < E; }

  // --- views of the state -----------------------------------------------------------------------

  static ConstView<N> q(const double* x) { return ConstView<N>(x); }
  static ConstView<N> qd(const double* x) { return ConstView<N>(x + N); }
  ConstView<E> deflection(const double* x) const { return ConstView<E>(x + deflection_state_); }
  ConstView<E> elastic_rotor_rate(const double* x) const {
    return ConstView<E>(x + deflection_state_ + E);
  }
  const double* electrical(const double* x) const { return x + electrical_state_; }
  double* electrical(double* x) const { return x + electrical_state_; }

  // The state that comes to rest when an axis sticks: the rate of its rotor, or of its joint.
  int index_of_rate(int axis) const {
    return is_elastic(axis) ? deflection_state_ + E + axis : N + axis;
  }

  // rq and rq': with rigid gears p times the joint's (spec 2).
  PerAxis<N> rotor_angle(const double* x) const {
    PerAxis<N> rq = p * q(x);
    if (elastic_) rq.template head<E>() += deflection(x);
    return rq;
  }
  PerAxis<N> rotor_rate(const double* x) const {
    PerAxis<N> rqd = p * qd(x);
    if (elastic_) rqd.template head<E>() = elastic_rotor_rate(x);
    return rqd;
  }
  drive::PerElasticAxis deflection_rate(const double* x) const {
    return elastic_rotor_rate(x) - p.template head<E>() * qd(x).template head<E>();
  }

  // --- torques ----------------------------------------------------------------------------------

  struct Torques {
    PerAxis<N> motor;     // rF
    PerAxis<N> gear;      // tau, or rF - rM with rigid gears
    PerAxis<N> friction;  // rM; of sticking axes with rigid gears not known before accelerations
  };

  Torques torques(const double* x, const PerAxis<N>& rotor_rate) const {
    Torques torques;
    torques.motor = controlled_ ? axes.motor_torque(electrical(x)) : held_torque;
    torques.friction = friction(rotor_rate);
    torques.gear = torques.motor - torques.friction;
    if (elastic_) {
      torques.gear.template head<E>() = gear.torque(deflection(x), deflection_rate(x));
      for (int i = 0; i < E; ++i) {
        if (sticking[i]) torques.friction[i] = torques.motor[i] - torques.gear[i];
      }
    }
    return torques;
  }

  // --- equations of motion ----------------------------------------------------------------------

  arm::EquationsOfMotion<N> equations_of_motion(const double* x) const {
    return arm::equations_of_motion<N>(mechanism_, q(x).matrix(), qd(x).matrix());
  }

  // aq'': joints with rigid gears that stick have exactly none; the others are solved for with
  // these prescribed (spec 5.3).
  PerAxis<N> joint_acceleration(const arm::EquationsOfMotion<N>& eom,
                                const PerAxis<N>& joint_torque) const {
    arm::Matrix<N> M = eom.M;
    arm::Vector<N> right = joint_torque.matrix() - eom.bias;
    for (int i = elastic_ ? E : N; i < N; ++i) {
      if (!sticking[i]) continue;
      M.row(i).setZero();
      M.col(i).setZero();
      M(i, i) = 1.0;
      right[i] = 0.0;
    }
    arm::solve_in_place(M, right);
    for (int i = elastic_ ? E : N; i < N; ++i) {
      if (sticking[i]) right[i] = 0.0;
    }
    return right.array();
  }

  // Torques and accelerations, friction of all sticking axes included.
  struct Mechanics {
    Torques torques;
    PerAxis<N> joint_acceleration;
  };

  Mechanics mechanics(const double* x) const {
    const arm::EquationsOfMotion<N> eom = equations_of_motion(x);
    Mechanics result;
    Torques& torques = result.torques;
    torques = this->torques(x, rotor_rate(x));
    result.joint_acceleration = joint_acceleration(eom, p * torques.gear);
    const PerAxis<N> inertial =
        (eom.M * result.joint_acceleration.matrix() + eom.bias).array() / p;  // aL / p
    for (int i = elastic_ ? E : N; i < N; ++i) {
      if (!sticking[i]) continue;
      torques.friction[i] = torques.motor[i] - inertial[i];
      torques.gear[i] = inertial[i];
    }
    return result;
  }

  // --- the right-hand side
  // -------------------------------------------------------------------------

  void derivatives(double t, const double* x, const motion::Motion* motion, double* dx) const {
    const PerAxis<N> rqd = rotor_rate(x);
    const Torques now = torques(x, rqd);

    View<N>{dx} = qd(x);
    View<N>{dx + N} = joint_acceleration(equations_of_motion(x), p * now.gear);

    if (elastic_) {
      View<E>{dx + deflection_state_} = deflection_rate(x);
      View<E> rotor_acceleration(dx + deflection_state_ + E);
      rotor_acceleration =
          (now.motor - now.gear - now.friction).template head<E>() / rJ.template head<E>();
      for (int i = 0; i < E; ++i) {
        if (sticking[i]) rotor_acceleration[i] = 0.0;
      }
    }

    if (controlled_) {
      std::array<motion::Reference, N> desired;
      motion->reference(motion_piece, t, desired);
      PerAxis<N> aq_d, aqd_d;
      for (int i = 0; i < N; ++i) {
        aq_d[i] = desired[i].angle;
        aqd_d[i] = desired[i].rate;
      }
      const PerAxis<N> command = axes.position_controller.command(aq_d, aqd_d, rotor_angle(x));
      axes.derivatives(electrical(x), command, rqd, electrical(dx));
    }
  }

 private:
  bool elastic_, controlled_;
  int deflection_state_, electrical_state_;  // where these groups begin
  arm::Mechanism<N> mechanism_;
};

}  // namespace manutec_r3::robot
