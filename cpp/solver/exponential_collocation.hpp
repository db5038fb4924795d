// Exponential collocation: linear blocks are propagated exactly, their slow inputs are polynomials
// through the nodes of a step.
//
// For a system with a linear view (hybrid/linear_view.hpp) a step from t with intervals d finds
// remainders v_0, .., v_4 at the nodes t + j d such that
//
//   v_j = remainder(t + j d, x_j),    x_j: the exact solution of x' = L x + B u at t + j d,
//
// where inputs u are polynomials of degree 4 through their values at the nodes. It begins with the
// polynomials of the step before and repeats until nothing changes, which takes one or two sweeps.
// Steps are as long as inputs allow; the fast states have no say in it.
//
// Intervals are lengths of the ladder of propagator.hpp. A step may reach beyond an announced
// instant, at which it is cut off, if inputs extend beyond it; if not, its interval is made to
// measure.
#pragma once

#include <vector>

#include "hybrid/integrator.hpp"
#include "hybrid/system.hpp"
#include "solver/collocation_blocks.hpp"
#include "solver/collocation_step.hpp"
#include "solver/propagator.hpp"

namespace manutec_r3::solver {

class ExponentialCollocation final : public hybrid::Integrator {
 public:
  // Throws std::invalid_argument if the system has no linear view.
  ExponentialCollocation(hybrid::System& system, double relative_tolerance);

  void restart(double t, const double* x, double size) override;
  void remember(const hybrid::Step& step) override;
  void advance(double stop, hybrid::Step& step, double* x1) override;
  int n_looks() const override { return n_looks_; }
  double look(int k, double* z, double* slope) override;
  bool glance(const double* z0, const double* slope0, double* z1, std::vector<int>& near) override;
  double next_size() const override;
  void derivatives(double t, const double* x, double* derivatives) override;
  void mode_changed() override;
  void evaluate(const hybrid::Step& step, double t, double* x) override {
    inside_.evaluate(step, t, x);
  }
  hybrid::Work work() const override { return work_; }

 private:
  // Of one interval, of every block.
  using Matrices = std::vector<const StepMatrices*>;
  using Block = CollocationBlocks::Block;
  using Input = CollocationBlocks::Input;

  void find_step(double stop);
  double attempt();
  void write_record(hybrid::Step& step) const;
  void use_rung(int rung);
  void use_length(double interval);
  void set_forcing();
  void set_sensitivities();
  void predict();
  void prepare_states();
  void find_states();
  double sweep();
  void look_at_nodes();
  double interpolation_error() const;
  const double* remainder_at(double t, const double* x);

  hybrid::System& system_;
  hybrid::LinearView& view_;
  double tolerance_;
  CollocationBlocks blocks_;
  CollocationStep inside_;

  // Where the solution is, and the interval to try next.
  double t_ = 0.0;
  std::vector<double> x_;
  int rung_ = 0;
  bool continues_ = false;  // from node 4 of the latest step, with its coefficients

  // The step in work, or the latest.
  double begin_ = 0.0;
  double interval_ = Propagator::longest;
  Matrices matrices_;
  std::vector<StepMatrices> made_to_measure_;
  std::vector<double> coefficients_;  // of all blocks, and room for the states of one more
  // Of the states of each block, beyond them infinity: nominal values and 1/tolerance.
  using OfStates = Eigen::Array<double, most_states, 1>;
  std::vector<OfStates> nominals_, by_tolerance_;
  // Of each forcing and each remainder.
  std::vector<double> sensitivity_to_forcing_, sensitivity_to_remainder_;
  // The watched states of each block at nodes 1 to 4, without the remainders there.
  std::vector<BlockAtNodes> settled_;
  // At nodes 1 to 4 abreast: times; forcing; whole states, of which the watched are set, and their
  // rates; remainders and theirs; indicators and theirs.
  struct {
    Abreast t;
    std::vector<Abreast> forcing, x, dx, u, du, z, dz;
  } at_nodes_;
  std::vector<double> no_slopes_;
  std::vector<double> scratch_forcing_;
  int n_looks_ = 0;

  // The latest step, from which the next begins its search.
  struct {
    bool known = false;
    double begin = 0.0, interval = 1.0;
    std::vector<double> coefficients;
  } before_;

  // What the remainder was when somebody has asked for derivatives.
  struct {
    bool known = false;
    double t;
    std::vector<double> x, remainder;
  } kept_;

  hybrid::Work work_;
};

}  // namespace manutec_r3::solver
