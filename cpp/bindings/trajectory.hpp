// The solution of a run at any instants, without Python.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hybrid/integrator.hpp"
#include "hybrid/trajectory.hpp"
#include "robot/robot_system.hpp"

namespace manutec_r3::bindings {

// At instants times[k] (n,) inside the steps steps[k] of a recorded run.
struct Instants {
  const hybrid::Trajectory& trajectory;
  std::span<const double> times;
  std::span<const std::ptrdiff_t> steps;
};

// The functions below leave the system in the mode of the last instant.

// States (n, n_states), branches (n_elements, n, n_axes).
void evaluate(robot::RobotSystem& system, hybrid::DenseOutput& inside, const Instants& instants,
              double* states, std::int8_t* branches);

// From the states: signals (n_signals, n, n_axes).
void evaluate_signals(robot::RobotSystem& system, const Instants& instants, const double* states,
                      double* signals);
// From states and signals: energies (n_energies, n, n_axes).
void evaluate_energies(robot::RobotSystem& system, const Instants& instants, const double* states,
                       const double* signals, double* energies);

}  // namespace manutec_r3::bindings
