// The solution inside a step of exponential collocation (exponential_collocation.hpp).
#pragma once

#include <vector>

#include "hybrid/integrator.hpp"
#include "solver/collocation_blocks.hpp"

namespace manutec_r3::solver {

// What `Step::dense` holds: where the step began, its interval, and the coefficients of all blocks.
struct CollocationRecord {
  enum { begin, interval, coefficients };

  static int size(const CollocationBlocks& blocks) {
    return coefficients + blocks.n_coefficients();
  }
};

// Exact for the step's polynomials: down the ladder, and the last bit by Taylor's series. The
// latest series is kept: a search for an event asks for one instant close to another.
class CollocationStep : public hybrid::DenseOutput {
 public:
  explicit CollocationStep(const CollocationBlocks& blocks)
      : blocks_(blocks), coefficients_(blocks.n_coefficients()) {}

  void mode_changed() override { known_ = false; }
  void evaluate(const hybrid::Step& step, double t, double* x) override;

 private:
  void expand(const hybrid::Step& step, double after);
  void find_derivatives_of_inputs(const double* of_step);

  const CollocationBlocks& blocks_;
  // The series: of which step, from how long after its beginning, and its terms.
  bool known_ = false;
  double begin_ = 0.0, interval_ = 0.0, base_ = 0.0;
  std::vector<double> terms_;         // of one block after another
  std::vector<double> coefficients_;  // on the way there; of inputs their derivatives
};

}  // namespace manutec_r3::solver
