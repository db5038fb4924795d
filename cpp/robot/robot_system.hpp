// A robot with its inputs as a hybrid system.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "hybrid/system.hpp"
#include "robot/elements.hpp"
#include "robot/inputs.hpp"
#include "robot/robot.hpp"
#include "robot/signals.hpp"

namespace manutec_r3::robot {

class RobotSystem : public hybrid::System {
 public:
  virtual int n_axes() const = 0;

  // Held inputs; to be set inside Simulation::change_input. What the robot gets from outside
  // without a motion to follow, rF [N m] without a controller, u_c [V] with an external one:
  virtual void set_input(std::span<const double> values) = 0;
  virtual std::span<const double> input() const = 0;
  // On the load, in the world [N]:
  virtual void set_tip_force(const std::array<double, 3>& force) = 0;
  virtual std::span<const double> tip_force() const = 0;
  // The axes whose brakes are on.
  virtual void set_brakes(const std::vector<bool>& on) = 0;
  // Throws std::invalid_argument if brakes are to be put on an axis that has none (axes 4 to 6 have
  // some) or that moves in the state x: that would be a blow to the whole arm.
  virtual void check_brakes(const std::vector<bool>& on, const double* x) const = 0;
  virtual std::vector<bool> brakes() const = 0;

  // All signals, n_axes values each, in the order of Signal. What does not exist is NaN:
  // reference and control error without a motion, voltages without a controller.
  virtual void signals(double t, const double* x, double* values) = 0;
  // The same of Energy, from the signals in the same state; never missing.
  virtual void energies(const double* x, const double* signals, double* values) = 0;

  // What indicators are about, in their order: for each axis two, upper and lower side.
  struct IndicatorRow {
    std::string_view name;
    double magnitude;  // what they are divided by to be of the order of 1
  };
  virtual std::span<const IndicatorRow> indicator_rows() const = 0;

  // The branch of an element on an axis (0-based), 0 if the axis has no such element.
  virtual int branch(ElementKind kind, int axis) const = 0;
};

// The motion may be missing unless the position controllers follow it.
std::unique_ptr<RobotSystem> make_system(std::shared_ptr<const Robot> robot, Inputs inputs);

}  // namespace manutec_r3::robot
