// Explicit Runge-Kutta steps from ARKODE: Verner 7(6) under error control.
#pragma once

#include <sundials/sundials_adaptcontroller.h>

#include "hybrid/integrator.hpp"
#include "solver/runge_kutta_step.hpp"
#include "solver/sundials.hpp"

namespace manutec_r3::solver {

class ExplicitRungeKutta final : public hybrid::Integrator {
 public:
  ExplicitRungeKutta(hybrid::System& system, double relative_tolerance);
  ~ExplicitRungeKutta() override;

  void restart(double t, const double* x, double size) override;
  void advance(double stop, hybrid::Step& step, double* x1) override;
  double next_size() const override { return next_size_; }
  void derivatives(double t, const double* x, double* derivatives) override;
  void cut(hybrid::Step& step, double t, const double* x) override;
  void evaluate(const hybrid::Step& step, double t, double* x) override;
  void interpolate(const hybrid::Stretch& stretch, double t, double* x) override;
  hybrid::Work work() const override;

 private:
  void check(int flag);

  Context context_;
  RightHandSide f_;
  RungeKuttaStep inside_;
  Vector x_;
  void* arkode_ = nullptr;
  SUNAdaptController controller_ = nullptr;
  double t_ = 0.0;
  double next_size_ = 0.0;
  bool reset_ = true;     // ARKODE is not where the solution is
  long short_steps_ = 0;  // taken without ARKODE
};

}  // namespace manutec_r3::solver
