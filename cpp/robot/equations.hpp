// The equations of a robot on frozen branches (spec 4 to 6), for N moving arms.
//
// Motor side: rF, tau, rM; joint side: aF. Everything here is a function of time and state; what
// switches is set by the owner in `axes`, `gear`, `friction`, `sticking` and what follows them.
// `Axes` are the controllers and motors: the report's (drive/axis.hpp) or those of the Modelica
// variant (drive/modelica_axis.hpp). A `Number` is a double, or four abreast (numbers/abreast.hpp):
// the same equations at four instants at once.
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

  template <class Number>
  static ConstView<N, Number> q(const Number* x) {
    return ConstView<N, Number>(x);
  }
  template <class Number>
  static ConstView<N, Number> qd(const Number* x) {
    return ConstView<N, Number>(x + N);
  }
  template <class Number>
  ConstView<E, Number> deflection(const Number* x) const {
    return ConstView<E, Number>(x + deflection_state_);
  }
  template <class Number>
  ConstView<E, Number> elastic_rotor_rate(const Number* x) const {
    return ConstView<E, Number>(x + deflection_state_ + E);
  }
  template <class Number>
  Number* electrical(Number* x) const {
    return x + electrical_state_;
  }

  // The state that comes to rest when an axis sticks: the rate of its rotor, or of its joint.
  int index_of_rate(int axis) const {
    return is_elastic(axis) ? deflection_state_ + E + axis : N + axis;
  }

  // rq and rq': with rigid gears p times the joint's (spec 2).
  template <class Number>
  PerAxis<N, Number> rotor_angle(const Number* x) const {
    PerAxis<N, Number> rq = p * q(x);
    if (elastic_) rq.template head<E>() += deflection(x);
    return rq;
  }
  template <class Number>
  PerAxis<N, Number> rotor_rate(const Number* x) const {
    PerAxis<N, Number> rqd = p * qd(x);
    if (elastic_) rqd.template head<E>() = elastic_rotor_rate(x);
    return rqd;
  }
  template <class Number>
  PerAxis<E, Number> deflection_rate(const Number* x) const {
    return elastic_rotor_rate(x) - p.template head<E>() * qd(x).template head<E>();
  }

  // --- command and torques ----------------------------------------------------------------------

  // The output of the position controllers, evaluated now.
  template <class Number>
  PerAxis<N, Number> command_from_motion(const Number& t, const PerAxis<N, Number>& rq) const {
    const auto desired = at_each_instant<2 * N>(t, [&](double instant, double* values) {
      std::array<motion::Reference, N> references;
      inputs_.motion->reference(motion_piece, instant, references);
      for (int i = 0; i < N; ++i) {
        values[i] = references[i].angle;
        values[N + i] = references[i].rate;
      }
    });
    return axes.position_controller.command(desired.template head<N>(), desired.template tail<N>(),
                                            rq);
  }

  // What comes from outside the rate controllers, or the motors if there are none: from the
  // position controllers now, or held; or rF.
  template <class Number>
  PerAxis<N, Number> command_or_torque(const Number& t, const PerAxis<N, Number>& rq) const {
    return follows_motion_ ? command_from_motion(t, rq) : input(t);
  }
  template <class Number>
  PerAxis<N, Number> command(const Number& t, const Number* x) const {
    return command_or_torque(t, rotor_angle(x));
  }
  // The command from a reference at zero: what the rotors contribute.
  PerAxis<N> command_from_rotors(const double* x) const {
    const PerAxis<N> zero = PerAxis<N>::Zero();
    if (!follows_motion_) return zero;
    return axes.position_controller.command(zero, zero, rotor_angle(x));
  }

  template <class Number>
  struct Torques {
    PerAxis<N, Number> motor;     // rF
    PerAxis<N, Number> gear;      // tau, or rF - rM with rigid gears
    PerAxis<N, Number> friction;  // rM; of sticking axes not known before accelerations, if coupled
  };

  // rF of controlled motors; zero without a controller.
  PerAxis<N> motor_torque_from(const double* x) const {
    return controlled_ ? axes.motor_torque(electrical(x)) : PerAxis<N>::Zero();
  }

  template <class Number>
  Torques<Number> torques(const Number& t, const Number* x) const {
    return torques_with<Number>(controlled_ ? axes.motor_torque(electrical(x)) : input(t), x);
  }
  template <class Number>
  Torques<Number> torques_with(const PerAxis<N, Number>& motor, const Number* x) const {
    Torques<Number> torques;
    torques.motor = motor;
    torques.friction = friction(rotor_rate(x));
    if (springs_hold) torques.friction += spring_stiffness * (rotor_angle(x) - spring_rest);
    torques.gear = torques.motor - torques.friction;
    if (elastic_) {
      const PerAxis<E, Number> delta = deflection(x);
      torques.gear.template head<E>() = gear.torque(delta, deflection_rate(x));
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
  template <class Number>
  struct Dynamics {
    arm::EquationsOfMotion<N, Number> arms;  // M is aaM
    Eigen::Matrix<Number, N, E> arM;         // this and drift: only where rotors are carried
    arm::Vector<E, Number> drift;            // <rn_j, w'_{j-1}> at aq'' = 0
  };

  template <class Number>
  Dynamics<Number> dynamics(const Number& t, const Number* x) const {
    const Eigen::Map<const arm::Vector<N, Number>> angle(x), rate(x + N);
    Dynamics<Number> dynamics = {
        arm::equations_of_motion<N, Number>(mechanism_, angle, rate), {}, {}};
    if (any_carried_) {
      const auto rotors = arm::carried_rotors<N, Number>(mechanism_, angle, rate);
      for (int j = 0; j < E; ++j) {
        const double inertia = carried_[j] ? rJ[j] : 0.0;
        dynamics.arM.col(j) = inertia * rotors.projection.col(j);
        dynamics.arms.bias += inertia * elastic_rotor_rate(x)[j] * rotors.swing.col(j);
        dynamics.drift[j] = carried_[j] ? rotors.drift[j] : 0.0;
      }
    }
    if (tip_is_pulled()) {
      dynamics.arms.bias -= arm::torques_of_force_on_load<N, Number>(
          robot_.tables().table_3, robot_.load(), angle, tip_force(t));
    }
    return dynamics;
  }

  template <class Number>
  struct Accelerations {
    arm::Vector<N, Number> joint;  // aq''
    arm::Vector<E, Number> rotor;  // rq'' of rotors behind elastic gears
  };

  // Axes that stick have exactly no acceleration; the others are solved for with these prescribed
  // (spec 5.3).
  template <class Number>
  Accelerations<Number> accelerations(const Dynamics<Number>& dynamics,
                                      const Torques<Number>& torques) const {
    const PerAxis<E, Number> drive =
        (torques.motor - torques.gear - torques.friction).template head<E>();
    const arm::Vector<N, Number> right = (p * torques.gear).matrix() - dynamics.arms.bias;
    Accelerations<Number> result = {any_carried_ || any_joint_sticks()
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
  template <class Number>
  Number held_friction(int axis, const Dynamics<Number>& dynamics, const Torques<Number>& torques,
                       const Accelerations<Number>& a) const {
    if (is_elastic(axis)) {
      return torques.motor[axis] - torques.gear[axis] - dynamics.arM.col(axis).dot(a.joint) -
             rJ[axis] * dynamics.drift[axis];
    }
    // The joint takes from the gear what the arms take from the joint.
    Number aF = dynamics.arms.bias[axis];
    for (int j = 0; j < N; ++j) aF += dynamics.arms.M(axis, j) * a.joint[j];
    if (any_carried_) aF += dynamics.arM.row(axis).dot(a.rotor);
    return torques.motor[axis] - aF / p[axis];
  }

  // Torques and accelerations, friction of all sticking axes included.
  template <class Number>
  struct Mechanics {
    Torques<Number> torques;
    PerAxis<N, Number> joint_acceleration;
  };

  template <class Number>
  Mechanics<Number> mechanics(const Number& t, const Number* x) const {
    const Dynamics<Number> dynamics = this->dynamics(t, x);
    Mechanics<Number> result;
    Torques<Number>& torques = result.torques;
    torques = this->torques(t, x);
    const Accelerations<Number> a = accelerations(dynamics, torques);
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
    const Torques<double> torques = this->torques(t, x);
    const PerAxis<N> rotor_rate = this->rotor_rate(x);
    const Accelerations<double> a = accelerations(dynamics(t, x), torques);
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
  template <class Number>
  arm::Vector<N, Number> constrained_joint_accelerations(const Dynamics<Number>& dynamics,
                                                         const PerAxis<E, Number>& drive,
                                                         arm::Vector<N, Number> right) const {
    arm::Symmetric<N, Number> M = dynamics.arms.M;
    for (int j = 0; j < E; ++j) {
      if (!carried_[j] || sticking[j]) continue;
      const arm::Vector<N, Number> arM = dynamics.arM.col(j);
      M.subtract_square(arM, rJ[j]);
      right -= arM * (drive[j] / rJ[j] - dynamics.drift[j]);
    }
    for (int i = n_elastic(); i < N; ++i) {
      if (!sticking[i]) continue;
      M.decouple(i);
      right[i] = 0.0;
    }
    arm::Vector<N, Number> joint = arm::solution(M, right);
    for (int i = n_elastic(); i < N; ++i) {
      if (sticking[i]) joint[i] = 0.0;
    }
    return joint;
  }

  // Of time alone: what writes n values at an instant, at each of those that a Number is.
  template <int n, class Number, class Function>
  static PerAxis<n, Number> at_each_instant(const Number& t, const Function& function) {
    constexpr int size = numbers::n_abreast<Number>;
    if constexpr (size == 1) {
      PerAxis<n> values;
      function(t, values.data());
      return values;
    }
    std::array<double, size> instants;
    numbers::store(t, instants.data());
    Eigen::Array<double, size, n> values;
    for (int k = 0; k < size; ++k) {
      PerAxis<n> at_instant;
      function(instants[k], at_instant.data());
      values.row(k) = at_instant;
    }
    PerAxis<n, Number> numbers;
    for (int i = 0; i < n; ++i) numbers[i] = numbers::load<Number>(values.col(i).data());
    return numbers;
  }

  // u_c [V], or rF [N m] without a controller: held, or a function of time.
  template <class Number>
  PerAxis<N, Number> input(const Number& t) const {
    if (!inputs_.of_axes) return held_input.template cast<Number>();
    return at_each_instant<N>(t, [&](double instant, double* values) {
      inputs_.of_axes->evaluate(input_piece, instant, values);
    });
  }
  bool tip_is_pulled() const { return inputs_.tip_force || (held_tip_force.array() != 0.0).any(); }
  template <class Number>
  arm::Vector<3, Number> tip_force(const Number& t) const {
    if (!inputs_.tip_force) return held_tip_force.template cast<Number>();
    return at_each_instant<3>(t, [&](double instant, double* force) {
      inputs_.tip_force->evaluate(force_piece, instant, force);
    });
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
