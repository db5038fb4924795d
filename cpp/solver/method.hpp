// The integration methods that a user can name.
#pragma once

#include <memory>

#include "hybrid/integrator.hpp"
#include "hybrid/system.hpp"

namespace manutec_r3::solver {

enum class Method {
  erk,          // explicit Runge-Kutta
  bdf,          // backward differentiation formulas
  exponential,  // exponential collocation
};

// The loosest tolerance with which control error and motor torque stay within 1e-6 of their range
// (measured in tests/test_accuracy.py).
double default_tolerance(Method method);

std::unique_ptr<hybrid::Integrator> make_integrator(Method method, hybrid::System& system,
                                                    double relative_tolerance);

// The dense output of a method without its integrator, for steps that were taken earlier.
std::unique_ptr<hybrid::DenseOutput> make_dense_output(Method method, hybrid::System& system,
                                                       double relative_tolerance);

}  // namespace manutec_r3::solver
