// What every use of SUNDIALS here shares: a context that prints nothing, and a right-hand side that
// lets no exception pass through C.
#pragma once

#include <sundials/sundials_context.h>

#include <exception>
#include <string>
#include <vector>

#include "hybrid/system.hpp"
#include "solver/vector.hpp"

namespace manutec_r3::solver {

// ARKODE and CVODE refuse distances near the roundoff of t; shorter steps than this are taken
// without them [s].
inline constexpr double shortest_size = 1e-12;

// One per integrator, so that integrators may run in different threads.
class Context {
 public:
  Context();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  operator SUNContext() const { return context_; }
  // What SUNDIALS said last; empty if it has not complained.
  const std::string& message() const { return message_; }

 private:
  SUNContext context_ = nullptr;
  std::string message_;
};

// The derivatives of a system as SUNDIALS calls them, counted. The latest derivatives that
// somebody has asked for by name are kept, because the next step begins with the same ones.
class RightHandSide {
 public:
  explicit RightHandSide(hybrid::System& system);

  // For SUNDIALS: `self` is the RightHandSide.
  static int call(sunrealtype t, N_Vector x, N_Vector derivatives, void* self);

  void evaluate(double t, const double* x, double* derivatives);
  void evaluate_and_keep(double t, const double* x, double* derivatives);
  // The mode has changed: what was kept is no longer true.
  void forget() { kept_ = false; }

  // Throws what the system threw inside SUNDIALS, if it did.
  void rethrow();

  hybrid::System& system() { return system_; }
  long evaluations() const { return evaluations_; }

 private:
  hybrid::System& system_;
  long evaluations_ = 0;
  bool kept_ = false;
  double kept_t_ = 0.0;
  std::vector<double> kept_x_, kept_derivatives_;
  std::exception_ptr thrown_;
};

// Absolute tolerances: the relative one, scaled by the nominal values.
void set_absolute_tolerances(const hybrid::System& system, double relative, Vector& absolute);

}  // namespace manutec_r3::solver
