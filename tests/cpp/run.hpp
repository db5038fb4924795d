// A simulation with its integrator and its record.
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "hybrid/simulation.hpp"
#include "solver/method.hpp"

namespace manutec_r3::testing {

using hybrid::Simulation;
using solver::Method;

struct Run {
  // The system first: it must outlive the run.
  Run(hybrid::System& system, std::vector<double> x, double tolerance = 1e-9,
      Method method = Method::erk, double t = 0.0)
      : integrator(solver::make_integrator(method, system, tolerance)),
        simulation(system, *integrator, t, std::move(x), &trajectory) {}

  // Events at t included.
  void to(double t) {
    simulation.advance(t, Simulation::Stop::at_target, Simulation::Target::included);
  }

  std::unique_ptr<hybrid::Integrator> integrator;
  hybrid::Trajectory trajectory;
  Simulation simulation;
};

// One unit in the last place of t.
inline double ulp(double t) {
  return std::nextafter(std::abs(t), std::numeric_limits<double>::infinity()) - std::abs(t);
}

}  // namespace manutec_r3::testing
