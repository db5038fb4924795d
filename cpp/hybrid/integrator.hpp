// What the simulation loop needs of an integrator: one step after another, and the solution inside
// a step. The integrators themselves live in solver/.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace manutec_r3::hybrid {

// A step from t0 to t1, and what it takes to evaluate the solution inside it.
struct Step {
  double t0 = 0.0;
  double t1 = 0.0;
  std::vector<double> dense;  // of one length for all steps of an integrator

  bool operator==(const Step&) const = default;
};

// A step and those before it, the latest first, that follow each other without an event between.
struct Stretch {
  static constexpr std::size_t longest = 4;

  std::array<const Step*, longest> steps{};
  std::size_t size = 0;

  const Step& latest() const { return *steps[0]; }
  bool is_full() const { return size == longest; }
  void append(const Step& step) { steps[size++] = &step; }
};

// The solution inside a step: it depends on the steps and on the system's mode, on nothing else.
class DenseOutput {
 public:
  virtual ~DenseOutput() = default;

  // The system's mode is another than at the last evaluation, or there has been none.
  virtual void mode_changed() {}

  // x (n_states) at t, t0 <= t <= t1, as accurate as at the step's end.
  virtual void evaluate(const Step& step, double t, double* x) = 0;

  // The same inside the latest of some steps: to within the tolerance, for less if the others help.
  virtual void interpolate(const Stretch& stretch, double t, double* x) {
    evaluate(stretch.latest(), t, x);
  }
};

struct Work {
  long evaluations = 0;     // of the derivatives, for whatever purpose
  long steps = 0;           // accepted
  long rejected_steps = 0;  // too inaccurate, or a nonlinear solver did not converge
};

class Integrator : public DenseOutput {
 public:
  // Continues from (t, x), where the system may have changed its mode. `size` is the step to try,
  // 0 if unknown.
  virtual void restart(double t, const double* x, double size) = 0;

  // The step that ended where it continues, if another integrator has taken it.
  virtual void remember(const Step&) {}

  // One step from where the last one ended, not beyond `stop`, which it meets exactly. Gives the
  // step and the state at its end. Throws SimulationFailure, with the solver's own message, and
  // whatever the system throws.
  virtual void advance(double stop, Step& step, double* x1) = 0;

  // The latest step turns out to end at t already, in x.
  virtual void cut(Step& step, double t, const double* /*x*/) { step.t1 = t; }

  // A glance at the latest step, and whether the integrator knows the solution at instants inside
  // it for nothing. Appends the indicators that may come near zero in the step; the others stay
  // further from it than they move. They are z0 at the beginning, with the rates slope0 if these
  // are known, and about z1 at the end.
  virtual bool glance(const double* /*z0*/, const double* /*slope0*/, double* /*z1*/,
                      std::vector<int>& /*near*/) {
    return false;
  }
  // After it, these instants one after the other. Gives the instant, the indicators there and their
  // rates.
  virtual int n_looks() const { return 0; }
  virtual double look(int, double* /*z*/, double* /*slope*/) { return 0.0; }

  // The step size to try next, if nothing happens.
  virtual double next_size() const = 0;

  // The system's derivatives at (t, x), which are kept: the next step begins with them.
  virtual void derivatives(double t, const double* x, double* derivatives) = 0;

  virtual Work work() const = 0;
};

}  // namespace manutec_r3::hybrid
