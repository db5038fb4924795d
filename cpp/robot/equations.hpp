// The equations of a robot on frozen branches (spec 4 to 6), for N moving arms.
//
// Motor side: rF, tau, rM; joint side: aF. Everything here is a function of time and state; what
// switches is set by the owner in `axes`, `gear`, `friction`, `sticking` and what follows them.
// `Axes` are the controllers and motors: the report's (drive/axis.hpp) or those of the Modelica
// variant (drive/modelica_axis.hpp).
#pragma once

#include <algorithm>
#include <array>

#include "arm/carried_rotors.hpp"
#include "arm/composite.hpp"
#include "arm/energy.hpp"
#include "arm/kinematics.hpp"
#include "arm/solve.hpp"
#include "drive/friction.hpp"
#include "drive/gear.hpp"
#include "drive/line.hpp"
#include "motion/input.hpp"
#include "motion/motion.hpp"
#include "robot/inputs.hpp"
#include "robot/robot.hpp"

namespace manutec_r3::robot {

using drive::ConstView;
using drive::Line;
using drive::PerAxis;
using drive::View;

template <int N, class Axes>
class Equations {
 public:
  // Elastic gears are those of axes 1 to 3.
  static constexpr int E = std::min(N, drive::n_elastic);

  Equations(const Robot& robot, const Axes& of_axes, const Inputs& inputs)
      : axes(of_axes),
        gear(robot.tables().table_2, robot.options().gear_damping),
        p(drive::first<N>(robot.gear_ratio())),
        rJ(drive::first<N>(robot.tables().table_3.rotor_inertia)),
        robot_(robot),
        inputs_(inputs),
        elastic_(robot.has_real_gears()),
        controlled_(robot.has_controller()),
        follows_motion_(robot.options().controller == Controller::continuous),
        deflection_state_(robot.first_state("deflection")),
        electrical_state_(2 * N + 2 * robot.n_elastic()),
        mechanism_(std::get<arm::Mechanism<N>>(robot.arm_behind_gears())) {
    for (int j = 0; j < E; ++j) {
      carried_[j] = robot.carries_elastic_rotor(j);
      any_carried_ |= carried_[j];
    }
  }

  // --- what switches, and inputs ----------------------------------------------------------------

  Axes axes;                                         // with NL1, NL2 and the limit on U
  drive::ElasticGear<E> gear;                        // with NL4
  Line<N> friction;                                  // rM while sliding, or held by a stiff damper
  bool springs_hold = false;                         // stiff springs, some of the sticking axes
  PerAxis<N> spring_stiffness = PerAxis<N>::Zero();  // k, 0 where none holds
  PerAxis<N> spring_rest = PerAxis<N>::Zero();       // rq_stick
  std::array<bool, N> sticking{};                    // with a rate of exactly zero
  int motion_piece = -1;
  int input_piece = 0;
  int force_piece = 0;
  // Held until they are set again: u_c [V], or rF [N m] without a controller; the force on the tip.
  PerAxis<N> held_input = PerAxis<N>::Zero();
  arm::Vector<3> held_tip_force = arm::Vector<3>::Zero();

  // --- constants --------------------------------------------------------------------------------

  PerAxis<N> p, rJ;

  bool is_elastic(int axis) const { return elastic_ && axis < E; }
  // Whether an axis sticks or slides together with others: its friction acts on the arms at once.
  bool is_coupled(int axis) const { return !is_elastic(axis) || carried_[axis]; }
  int n_elastic() const { return elastic_ ? E : 0; }

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
  PerAxis<E> deflection_rate(const double* x) const {
    return elastic_rotor_rate(x) - p.template head<E>() * qd(x).template head<E>();
  }

  // --- command and torques ----------------------------------------------------------------------

  // The output of the position controllers, evaluated now.
  PerAxis<N> command_from_motion(double t, const double* x) const {
    std::array<motion::Reference, N> desired;
    inputs_.motion->reference(motion_piece, t, desired);
    PerAxis<N> aq_d, aqd_d;
    for (int i = 0; i < N; ++i) {
      aq_d[i] = desired[i].angle;
      aqd_d[i] = desired[i].rate;
    }
    return axes.position_controller.command(aq_d, aqd_d, rotor_angle(x));
  }

  // What the rate controllers get: from the position controllers now, or held.
  PerAxis<N> command(double t, const double* x) const {
    return follows_motion_ ? command_from_motion(t, x) : input(t);
  }
  // The same from a reference at zero: what the rotors contribute.
  PerAxis<N> command_from_rotors(const double* x) const {
    const PerAxis<N> zero = PerAxis<N>::Zero();
    if (!follows_motion_) return zero;
    return axes.position_controller.command(zero, zero, rotor_angle(x));
  }
  // What comes from outside the drives: the command, or rF without a controller.
  PerAxis<N> command_or_torque(double t, const double* x) const {
    return controlled_ ? command(t, x) : input(t);
  }

  struct Torques {
    PerAxis<N> motor;     // rF
    PerAxis<N> gear;      // tau, or rF - rM with rigid gears
    PerAxis<N> friction;  // rM; of sticking axes not known before accelerations, if coupled
  };

  // rF of controlled motors; zero without a controller.
  PerAxis<N> motor_torque_from(const double* x) const {
    return controlled_ ? axes.motor_torque(electrical(x)) : PerAxis<N>::Zero();
  }

  Torques torques(double t, const double* x) const {
    return torques_with(controlled_ ? axes.motor_torque(electrical(x)) : input(t), x);
  }
  Torques torques_with(const PerAxis<N>& motor, const double* x) const {
    Torques torques;
    torques.motor = motor;
    torques.friction = friction(rotor_rate(x));
    if (springs_hold) torques.friction += spring_stiffness * (rotor_angle(x) - spring_rest);
    torques.gear = torques.motor - torques.friction;
    if (elastic_) {
      torques.gear.template head<E>() = gear.torque(deflection(x), deflection_rate(x));
      for (int j = 0; j < E; ++j) {
        if (sticking[j]) torques.friction[j] = torques.motor[j] - torques.gear[j];
      }
    }
    return torques;
  }

  // --- equations of motion ----------------------------------------------------------------------

  // Spec 6: aaM aq'' + arM rq'' + bias = aF for the joints, and for rotors behind elastic gears
  // that the arms carry, arM^T aq'' + rJ (rq'' + drift) = rF - tau - rM. Gyroscopic torques and a
  // force on the tip are part of the bias.
  struct Dynamics {
    arm::EquationsOfMotion<N> arms;   // M is aaM
    Eigen::Matrix<double, N, E> arM;  // this and drift: only where rotors are carried
    arm::Vector<E> drift;             // <rn_j, w'_{j-1}> at aq'' = 0
  };

  Dynamics dynamics(double t, const double* x) const {
    const Eigen::Map<const arm::Vector<N>> angle(x), rate(x + N);
    Dynamics dynamics = {arm::equations_of_motion<N>(mechanism_, angle, rate), {}, {}};
    if (any_carried_) {
      const arm::CarriedRotors<N> rotors = arm::carried_rotors<N>(mechanism_, angle, rate);
      for (int j = 0; j < E; ++j) {
        const double inertia = carried_[j] ? rJ[j] : 0.0;
        dynamics.arM.col(j) = inertia * rotors.projection.col(j);
        dynamics.arms.bias += inertia * elastic_rotor_rate(x)[j] * rotors.swing.col(j);
        dynamics.drift[j] = carried_[j] ? rotors.drift[j] : 0.0;
      }
    }
    if (tip_is_pulled()) {
      dynamics.arms.bias -= arm::torques_of_force_on_load<N>(robot_.tables().table_3, robot_.load(),
                                                             angle, tip_force(t));
    }
    return dynamics;
  }

  struct Accelerations {
    arm::Vector<N> joint;  // aq''
    arm::Vector<E> rotor;  // rq'' of rotors behind elastic gears
  };

  // Axes that stick have exactly no acceleration; the others are solved for with these prescribed
  // (spec 5.3).
  Accelerations accelerations(const Dynamics& dynamics, const Torques& torques) const {
    const PerAxis<E> drive = (torques.motor - torques.gear - torques.friction).template head<E>();
    const arm::Vector<N> right = (p * torques.gear).matrix() - dynamics.arms.bias;
    Accelerations result = {any_carried_ || any_joint_sticks()
                                ? constrained_joint_accelerations(dynamics, drive, right)
                                : arm::solution(dynamics.arms.M, right),
                            {}};
    if (!elastic_) return result;
    for (int j = 0; j < E; ++j) {
      result.rotor[j] = drive[j] / rJ[j];
      if (carried_[j]) {
        result.rotor[j] -= dynamics.drift[j] + dynamics.arM.col(j).dot(result.joint) / rJ[j];
      }
      if (sticking[j]) result.rotor[j] = 0.0;
    }
    return result;
  }

  // rM of a sticking axis that others act on at once.
  double held_friction(int axis, const Dynamics& dynamics, const Torques& torques,
                       const Accelerations& a) const {
    if (is_elastic(axis)) {
      return torques.motor[axis] - torques.gear[axis] - dynamics.arM.col(axis).dot(a.joint) -
             rJ[axis] * dynamics.drift[axis];
    }
    // The joint takes from the gear what the arms take from the joint.
    double aF = dynamics.arms.bias[axis];
    for (int j = 0; j < N; ++j) aF += dynamics.arms.M(axis, j) * a.joint[j];
    if (any_carried_) aF += dynamics.arM.row(axis).dot(a.rotor);
    return torques.motor[axis] - aF / p[axis];
  }

  // Torques and accelerations, friction of all sticking axes included.
  struct Mechanics {
    Torques torques;
    PerAxis<N> joint_acceleration;
  };

  Mechanics mechanics(double t, const double* x) const {
    const Dynamics dynamics = this->dynamics(t, x);
    Mechanics result;
    Torques& torques = result.torques;
    torques = this->torques(t, x);
    const Accelerations a = accelerations(dynamics, torques);
    result.joint_acceleration = a.joint.array();
    for (int i = 0; i < N; ++i) {
      if (!sticking[i] || !is_coupled(i)) continue;
      torques.friction[i] = held_friction(i, dynamics, torques, a);
      if (!is_elastic(i)) torques.gear[i] = torques.motor[i] - torques.friction[i];
    }
    return result;
  }

  // --- energy -----------------------------------------------------------------------------------

  struct StoredEnergies {
    PerAxis<N> kinetic, potential, elastic;  // [J]
  };

  // Arms contain rotors frozen. What the spin of one adds is rJ rq'^2 / 2, and if the preceding arm
  // carries it (coupling "full") rJ rq' <rn, w>.
  StoredEnergies stored_energies(const double* x) const {
    const Eigen::Map<const arm::Vector<N>> angle(x), rate(x + N);
    const arm::ArmEnergies<N> arms = arm::energies<N>(mechanism_, angle, rate);
    const PerAxis<N> spin = rotor_rate(x);
    StoredEnergies stored = {arms.kinetic.array() + rJ * spin.square() / 2.0,
                             arms.potential.array(), PerAxis<N>::Zero()};
    for (int j = 0; j < N; ++j) {
      if (robot_.options().coupling[j] != Coupling::full) continue;
      stored.kinetic[j] += rJ[j] * spin[j] * arms.carrier_rate[j];
    }
    if (elastic_) stored.elastic.template head<E>() = gear.energy(deflection(x));
    return stored;
  }

  // d delta'^2 [W].
  PerAxis<N> damping_loss(const double* x) const {
    PerAxis<N> loss = PerAxis<N>::Zero();
    if (elastic_) loss.template head<E>() = gear.acting_d * deflection_rate(x).square();
    return loss;
  }

  // --- the right-hand side ----------------------------------------------------------------------

  // Flattened into one function, which spares copies of everything that goes from one part to
  // another.
  [[gnu::flatten]] void derivatives(double t, const double* x, double* dx) const {
    const Torques torques = this->torques(t, x);
    const PerAxis<N> rotor_rate = this->rotor_rate(x);
    const Accelerations a = accelerations(dynamics(t, x), torques);
    View<N>{dx} = qd(x);
    View<N>{dx + N} = a.joint.array();
    if (elastic_) {
      View<E>{dx + deflection_state_} = deflection_rate(x);
      View<E>{dx + deflection_state_ + E} = a.rotor.array();
    }
    if (controlled_) axes.derivatives(electrical(x), command(t, x), rotor_rate, electrical(dx));
  }

 private:
  // Sticking of axes with elastic gears does not hold their joints.
  bool any_joint_sticks() const {
    bool any = false;
    for (int i = n_elastic(); i < N; ++i) any |= sticking[i];
    return any;
  }

  // Of M aq'' + arM rq'' = right, with `drive` for the rotors that the arms carry: these are
  // eliminated, rq'' = drive / rJ - drift - arM^T aq'' / rJ, and joints that stick are left alone.
  arm::Vector<N> constrained_joint_accelerations(const Dynamics& dynamics, const PerAxis<E>& drive,
                                                 arm::Vector<N> right) const {
    arm::Symmetric<N> M = dynamics.arms.M;
    for (int j = 0; j < E; ++j) {
      if (!carried_[j] || sticking[j]) continue;
      const arm::Vector<N> arM = dynamics.arM.col(j);
      M.subtract_square(arM, rJ[j]);
      right -= arM * (drive[j] / rJ[j] - dynamics.drift[j]);
    }
    for (int i = n_elastic(); i < N; ++i) {
      if (!sticking[i]) continue;
      M.decouple(i);
      right[i] = 0.0;
    }
    arm::Vector<N> joint = arm::solution(M, right);
    for (int i = n_elastic(); i < N; ++i) {
      if (sticking[i]) joint[i] = 0.0;
    }
    return joint;
  }

  // u_c [V], or rF [N m] without a controller: held, or a function of time.
  PerAxis<N> input(double t) const {
    if (!inputs_.of_axes) return held_input;
    PerAxis<N> values;
    inputs_.of_axes->evaluate(input_piece, t, values.data());
    return values;
  }
  bool tip_is_pulled() const { return inputs_.tip_force || (held_tip_force.array() != 0.0).any(); }
  arm::Vector<3> tip_force(double t) const {
    if (!inputs_.tip_force) return held_tip_force;
    arm::Vector<3> force;
    inputs_.tip_force->evaluate(force_piece, t, force.data());
    return force;
  }

  const Robot& robot_;
  const Inputs& inputs_;
  bool elastic_, controlled_, follows_motion_;
  int deflection_state_, electrical_state_;  // where these groups begin
  arm::Mechanism<N> mechanism_;
  std::array<bool, E> carried_{};
  bool any_carried_ = false;
};

}  // namespace manutec_r3::robot
