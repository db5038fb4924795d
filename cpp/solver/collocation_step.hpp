// The solution inside a step of exponential collocation (exponential_collocation.hpp).
#pragma once

#include <array>
#include <vector>

#include "hybrid/integrator.hpp"
#include "solver/collocation_blocks.hpp"

namespace manutec_r3::solver {

// What `Step::dense` holds: where the step began, its interval, the state there, and the inputs at
// its nodes, one node after another.
struct CollocationRecord {
  int begin = 0, interval = 1, x = 2, inputs, size;

  CollocationRecord(int n_states, const CollocationBlocks& blocks)
      : inputs(x + n_states), size(inputs + n_nodes * blocks.n_inputs()) {}
};

// Exact for the step's polynomials: down the ladder, and the last bit by Taylor's series. The
// latest series is kept: a search for an event asks for one instant close to another.
class CollocationStep : public hybrid::DenseOutput {
 public:
  CollocationStep(int n_states, const CollocationBlocks& blocks);

  void mode_changed() override { known_ = false; }
  void evaluate(const hybrid::Step& step, double t, double* x) override;

 private:
  void expand(const hybrid::Step& step, double after);
  void find_derivatives_of_inputs(double after, double interval);

  const CollocationBlocks& blocks_;
  CollocationRecord record_;
  std::vector<double> powers_, derivatives_;  // of inputs
  // The series: of which step, from how long after its beginning, and its terms.
  bool known_ = false;
  double begin_ = 0.0, interval_ = 0.0, base_ = 0.0;
  std::vector<double> terms_;  // of one block after another
  std::vector<double> x_;      // scratch
};

}  // namespace manutec_r3::solver
