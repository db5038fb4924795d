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
  int begin = 0, interval = 1, x = 2, forcing, remainder, size;

  CollocationRecord(int n_states, const CollocationBlocks& blocks)
      : forcing(x + n_states),
        remainder(forcing + n_nodes * blocks.n_forcing()),
        size(remainder + n_nodes * blocks.n_remainder()) {}
};

class CollocationStep : public hybrid::DenseOutput {
 public:
  CollocationStep(int n_states, const CollocationBlocks& blocks);

  // Exact for the step's polynomials: down the ladder, and the last bit by Taylor's series.
  void evaluate(const hybrid::Step& step, double t, double* x) override;

 private:
  const CollocationBlocks& blocks_;
  CollocationRecord record_;
  std::array<std::vector<double>, 2> powers_;  // of forcing, of remainder
  std::array<std::vector<double>, 2> derivatives_;
};

}  // namespace manutec_r3::solver
