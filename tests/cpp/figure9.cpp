// The run of spec 10 from C++: model 3 carries 15 kg along a quintic. Says nothing if all is well.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "hybrid/simulation.hpp"
#include "motion/motion.hpp"
#include "robot/robot.hpp"
#include "robot/robot_system.hpp"
#include "robot/start.hpp"
#include "solver/method.hpp"

using namespace manutec_r3;

int main() {
  const std::array<double, 6> start = {};
  const std::array<double, 6> end = {1.0, 1.0, 0.6, -0.2, -0.15, -0.1};  // [rad]
  const auto motion = std::make_shared<const motion::Motion>(motion::quintic(start, end, 1.2));
  const auto robot = std::make_shared<const robot::Robot>(
      robot::Model::dlr_3, arm::Load{.mass = 15.0, .position = {0.0, 0.0, 0.25}});

  const auto system = robot::make_system(robot, {.motion = motion});
  const auto integrator = solver::make_integrator(solver::Method::erk, *system,
                                                  solver::default_tolerance(solver::Method::erk));
  hybrid::Simulation simulation(*system, *integrator, 0.0,
                                robot::rest_state(*robot, motion.get(), robot::Start::rotor));

  // Looks every millisecond for the peaks.
  std::array<double, 6> largest_error = {}, largest_torque = {};
  std::vector<double> signals(robot::n_signals * 6);
  for (int k = 1; k <= 1500; ++k) {
    simulation.advance(0.001 * k, hybrid::Simulation::Stop::at_target,
                       hybrid::Simulation::Target::excluded);
    system->signals(simulation.time(), simulation.state().data(), signals.data());
    for (int i = 0; i < 6; ++i) {
      largest_error[i] =
          std::max(largest_error[i], std::abs(signals[robot::control_error * 6 + i]));
      largest_torque[i] =
          std::max(largest_torque[i], std::abs(signals[robot::motor_torque * 6 + i]));
    }
  }

  int failures = 0;
  std::array<int, robot::element_names.size()> count = {};
  for (const hybrid::Event& event : simulation.events()) ++count[event.element.kind];
  const auto expect = [&](robot::ElementKind kind, int expected) {
    if (count[kind] == expected) return;
    ++failures;
    std::printf("%s: %d events, expected %d\n", robot::element_names[kind].data(), count[kind],
                expected);
  };
  expect(robot::dead_zone, 26);
  expect(robot::friction, 20);
  expect(robot::backlash, 13);
  expect(robot::reference, 1);
  expect(robot::torque_limit, 0);

  // As printed in spec 10, to half a unit of the last digit, and what a look every millisecond may
  // miss of a peak: 1e-4 of it.
  constexpr std::array<double, 6> errors = {8.09e-3, 10.06e-3, 6.89e-3, 1.46e-3, 2.07e-3, 1.27e-3};
  constexpr std::array<double, 6> torques = {2.81, 5.43, 7.04, 0.28, 1.20, 0.17};
  for (int i = 0; i < 6; ++i) {
    if (!(std::abs(largest_error[i] - errors[i]) < 0.005e-3 + 1e-4 * errors[i])) {
      ++failures;
      std::printf("axis %d: largest control error %g rad, expected %g\n", i + 1, largest_error[i],
                  errors[i]);
    }
    if (!(std::abs(largest_torque[i] - torques[i]) < 0.005 + 1e-4 * torques[i])) {
      ++failures;
      std::printf("axis %d: largest motor torque %g N m, expected %g\n", i + 1, largest_torque[i],
                  torques[i]);
    }
  }
  return failures;
}
