#include "robot/start.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>

#include "arm/composite.hpp"
#include "drive/gear.hpp"
#include "drive/modelica_axis.hpp"

namespace manutec_r3::robot {
namespace {

// A torque below this counts as zero; otherwise roundoff puts an axis on one edge of its dead zone
// or backlash (spec 4) [N m].
constexpr double zero_torque = 1e-12;
// The sagging arms of axes 1 to 3 converge by a factor of more than ten per iteration.
constexpr int most_iterations = 100;
// They have converged if they move by roundoff only [rad].
constexpr double converged_angle = 1e-15;
// A rotor's angle or rate that is given as well may differ from p times its joint's by rounding.
constexpr double rigid_tolerance = 1e-9;

std::vector<double> gravity_torques(const Robot& robot, const std::vector<double>& q) {
  return std::visit(
      [&q]<int N>(const arm::Mechanism<N>& mechanism) {
        const arm::Vector<N> h =
            arm::gravity_torques<N>(mechanism, Eigen::Map<const arm::Vector<N>>(q.data()));
        return std::vector<double>(h.begin(), h.end());
      },
      robot.arm());
}

// The part of a state vector that holds a group; empty if the robot has no such states.
std::span<double> group(const Robot& robot, std::vector<double>& x, std::string_view name) {
  for (const StateGroup& states : robot.states()) {
    if (states.name == name) return std::span(x).subspan(states.first, states.size);
  }
  return {};
}

void check_per_axis(const Robot& robot, const std::string& name, const std::string& unit,
                    const std::vector<double>& values) {
  if (static_cast<int>(values.size()) != robot.n_axes()) {
    throw std::invalid_argument(name + ": expected " + std::to_string(robot.n_axes()) +
                                " values, one per axis, got " + std::to_string(values.size()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    std::ostringstream message;
    message << name << " of axis " << i + 1 << ": expected a finite value [" << unit << "], got "
            << values[i];
    throw std::invalid_argument(message.str());
  }
}

void require_at_most(const std::string& what, int axis, double value, double limit,
                     const std::string& unit) {
  if (std::abs(value) <= limit) return;
  std::ostringstream message;
  message << "start: " << what << " of axis " << axis + 1 << " would need " << value << ' ' << unit
          << " to hold the arm at rest; expected at most " << limit << ' ' << unit;
  throw std::invalid_argument(message.str());
}

void check_rigid(const Robot& robot, const std::string& name, const std::string& unit,
                 const std::vector<double>& rotor, const std::vector<double>& joint) {
  const drive::Row& p = robot.gear_ratio();
  for (int i = robot.n_elastic(); i < robot.n_axes(); ++i) {
    const double expected = p[i] * joint[i];
    if (std::abs(rotor[i] - expected) <= rigid_tolerance * (1.0 + std::abs(expected))) continue;
    std::ostringstream message;
    message << name << " of axis " << i + 1 << ": the gear is rigid, expected p times the joint's, "
            << expected << " " << unit << ", got " << rotor[i] << " " << unit;
    throw std::invalid_argument(message.str());
  }
}

// Electrical states that hold these torques [N m] (spec 4).
void hold_by_report_axes(const Robot& robot, const drive::Table1& table,
                         const std::vector<double>& torque, std::vector<double>& x) {
  for (int i = 0; i < robot.n_axes(); ++i) {
    require_at_most("the motor", i, torque[i], table.torque_limit[i], "N m");
    const double v = torque[i] / table.K_M[i];
    const double U = v + (v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0) * table.dead_zone_half_width[i];
    require_at_most("the rate controller", i, U, robot.options().voltage_limit, "V");
    group(robot, x, "controller")[i] = U;
    group(robot, x, "voltage")[i] = U;
    group(robot, x, "pt2_torque")[i] = torque[i];
  }
}

// The same of the Modelica variant: k i = torque, i' = v' = 0, but x moves if a rate is asked for.
void hold_by_modelica_axes(const Robot& robot, const drive::ModelicaTable1& table,
                           const std::vector<double>& torque,
                           const std::vector<double>& rate_asked_for, std::vector<double>& x) {
  for (int i = 0; i < robot.n_axes(); ++i) {
    const double current = torque[i] / table.k[i];
    group(robot, x, "current")[i] = current;
    group(robot, x, "voltage")[i] =
        -drive::modelica_resistance / drive::modelica_amplification * current;
    group(robot, x, "controller")[i] = current / table.ks[i] - rate_asked_for[i];
  }
}

}  // namespace

Start default_start(Model model) { return is_modelica(model) ? Start::arm : Start::rotor; }

std::vector<double> rest_state(const Robot& robot, const motion::Motion* motion, Start start) {
  const int n = robot.n_axes();
  const drive::Row& p = robot.gear_ratio();
  const drive::ElasticGear<drive::n_elastic> gear(robot.tables().table_2,
                                                  robot.options().gear_damping);
  std::vector<double> reference(n, 0.0);
  if (motion) {
    std::vector<motion::Reference> desired(n);
    motion->reference(motion->piece_at(0.0), 0.0, desired);
    for (int i = 0; i < n; ++i) reference[i] = desired[i].angle;
  }

  // Torques depend on where the arms sag to, and where they sag to on the torques.
  std::vector<double> q = reference, torque(n), deflection(robot.n_elastic());
  bool converged = false;
  for (int iteration = 0; iteration < most_iterations && !converged; ++iteration) {
    torque = gravity_torques(robot, q);
    for (int i = 0; i < n; ++i) {
      torque[i] /= p[i];
      if (std::abs(torque[i]) < zero_torque) torque[i] = 0.0;
    }
    converged = true;
    for (int i = 0; i < robot.n_elastic(); ++i) {
      deflection[i] = gear.deflection_under(i, torque[i]);
      const double sagged = start == Start::rotor ? reference[i] - deflection[i] / p[i] : q[i];
      converged &= std::abs(sagged - q[i]) <= converged_angle * (1.0 + std::abs(q[i]));
      q[i] = sagged;
    }
  }
  if (!converged) {
    throw std::invalid_argument(
        "start: the arms sag without end, expected stiffer gears, table_2 c");
  }

  std::vector<double> x(robot.n_states(), 0.0);
  std::ranges::copy(q, group(robot, x, "joint_angle").begin());
  std::ranges::copy(deflection, group(robot, x, "deflection").begin());
  if (!robot.has_controller()) return x;
  if (const auto* table_1 = std::get_if<drive::Table1>(&robot.tables().table_1)) {
    hold_by_report_axes(robot, *table_1, torque, x);
  } else {
    std::vector<double> rate_asked_for(n);  // by the position controllers
    const auto& modelica = std::get<drive::ModelicaTable1>(robot.tables().table_1);
    for (int i = 0; i < n; ++i) {
      const double rq = p[i] * q[i] + (i < robot.n_elastic() ? deflection[i] : 0.0);
      rate_asked_for[i] = modelica.kp[i] * (p[i] * reference[i] - rq);
    }
    hold_by_modelica_axes(robot, modelica, torque, rate_asked_for, x);
  }
  return x;
}

std::vector<double> state_from(const Robot& robot, const Posture& posture) {
  const int n = robot.n_axes();
  const auto given_or = [&](const std::optional<std::vector<double>>& given, const char* name,
                            const char* unit, const std::vector<double>& otherwise) {
    if (!given) return otherwise;
    check_per_axis(robot, name, unit, *given);
    return *given;
  };
  const std::vector<double> zero(n, 0.0);
  check_per_axis(robot, "joint_angle", "rad", posture.joint_angle);
  const std::vector<double> joint_rate = given_or(posture.joint_rate, "joint_rate", "rad/s", zero);
  const drive::Row& p = robot.gear_ratio();
  std::vector<double> rotor_angle(n), rotor_rate(n);
  for (int i = 0; i < n; ++i) {
    rotor_angle[i] = p[i] * posture.joint_angle[i];
    rotor_rate[i] = p[i] * joint_rate[i];
  }
  rotor_angle = given_or(posture.rotor_angle, "rotor_angle", "rad", rotor_angle);
  rotor_rate = given_or(posture.rotor_rate, "rotor_rate", "rad/s", rotor_rate);
  check_rigid(robot, "rotor_angle", "rad", rotor_angle, posture.joint_angle);
  check_rigid(robot, "rotor_rate", "rad/s", rotor_rate, joint_rate);
  const std::vector<double> torque = given_or(posture.motor_torque, "motor_torque", "N m", zero);
  if (posture.motor_torque && !robot.has_controller()) {
    throw std::invalid_argument(
        "motor_torque: without a controller it is an input of the simulator, not a state");
  }

  std::vector<double> x(robot.n_states(), 0.0);
  std::ranges::copy(posture.joint_angle, group(robot, x, "joint_angle").begin());
  std::ranges::copy(joint_rate, group(robot, x, "joint_rate").begin());
  for (int i = 0; i < robot.n_elastic(); ++i) {
    group(robot, x, "deflection")[i] = rotor_angle[i] - p[i] * posture.joint_angle[i];
    group(robot, x, "rotor_rate")[i] = rotor_rate[i];
  }
  if (const auto* modelica = std::get_if<drive::ModelicaTable1>(&robot.tables().table_1)) {
    for (int i = 0; robot.has_controller() && i < n; ++i) {
      group(robot, x, "current")[i] = torque[i] / modelica->k[i];
    }
  } else if (robot.has_controller()) {
    std::ranges::copy(torque, group(robot, x, "pt2_torque").begin());
  }
  return x;
}

void check_state(const Robot& robot, std::span<const double> x) {
  if (static_cast<int>(x.size()) != robot.n_states()) {
    throw std::invalid_argument("start: expected a state vector of " +
                                std::to_string(robot.n_states()) + " values, got " +
                                std::to_string(x.size()));
  }
  for (const StateGroup& states : robot.states()) {
    const double limit = states.name == "voltage" ? robot.options().voltage_limit : arm::no_limit;
    for (int i = 0; i < states.size; ++i) {
      const double value = x[states.first + i];
      if (std::isfinite(value) && std::abs(value) <= limit) continue;
      std::ostringstream message;
      message << "start: expected a finite " << states.name << " of axis " << i + 1 << " ["
              << states.unit << "]";
      if (std::isfinite(limit)) message << " within its limit " << limit;
      message << ", got " << value;
      throw std::invalid_argument(message.str());
    }
  }
}

}  // namespace manutec_r3::robot
