// The solution of a run at any instants, without Python.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hybrid/integrator.hpp"
#include "hybrid/trajectory.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::bindings {

// Where to write it for n instants.
struct Solution {
  double* states;         // (n, n_states)
  double* signals;        // (n_signals, n, n_axes)
  std::int8_t* branches;  // (n_elements, n, n_axes)
};

// At times[k] inside the step steps[k] of a recorded run. The system is left in the mode of the
// last.
void evaluate(robot::RobotSystem& system, hybrid::DenseOutput& inside,
              const hybrid::Trajectory& trajectory, std::span<const double> times,
              std::span<const std::ptrdiff_t> steps, const Solution& solution);

}  // namespace manutec_r3::bindings
