// The blocks of a system's linear view (hybrid/linear_view.hpp) in its present mode, with their
// propagators, and where each block's coefficients are among those of all blocks.
//
// The coefficients of a block are what the columns of its propagator's matrices are for: states,
// constants, forcing at nodes 0, 1, .. and remainder at nodes 0, 1, ..
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "hybrid/linear_view.hpp"
#include "solver/propagator.hpp"

namespace manutec_r3::solver {

class CollocationBlocks {
 public:
  struct Block {
    const hybrid::LinearBlock* equations = nullptr;
    std::shared_ptr<const Propagator> propagator;
    std::vector<int> states, watched;  // among those of the system
    int n_forcing = 0, n_remainder = 0;
    // Among the coefficients of all blocks, the latter two of node 0.
    int first_state = 0, first_constant = 0, first_forcing = 0, first_remainder = 0;

    int n_states() const { return static_cast<int>(states.size()); }
    int columns() const { return end() - first_state; }
    int end() const { return first_remainder + n_nodes * n_remainder; }
  };

  // Where the values of an input are among the coefficients of all blocks.
  struct Input {
    int block;
    int place_in_block;
    int at_node_0, stride;

    int at(int node) const { return at_node_0 + node * stride; }
  };

  explicit CollocationBlocks(hybrid::LinearView& view);

  // Reads blocks from the view: the mode may have changed.
  void refresh();

  int n_coefficients() const { return n_coefficients_; }
  // In the order in which the system tells them.
  const std::vector<Input>& forcing() const { return forcing_; }
  const std::vector<Input>& remainder() const { return remainder_; }
  // Where no block's ladder goes on.
  int n_rungs() const { return n_rungs_; }
  auto begin() const { return blocks_.begin(); }
  auto end() const { return blocks_.end(); }
  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t index) const { return blocks_[index]; }

  // Coefficients from what systems know.
  void set_states(const double* x, double* coefficients) const;
  void set_constants(double* coefficients);

  // Puts the states of a block where they belong among those of the system.
  static void scatter(const Block& block, const double* of_block, double* x) {
    for (const int state : block.states) x[state] = *of_block++;
  }

  // The derivatives of all states, for inputs at the same instant and the constants set last.
  void derivatives(const double* x, const double* forcing, const double* remainder,
                   double* dx) const;

 private:
  hybrid::LinearView& view_;
  std::vector<Block> blocks_;
  std::map<const hybrid::LinearBlock*, std::shared_ptr<const Propagator>> known_;
  std::vector<Input> forcing_, remainder_;
  std::vector<double> constants_;
  int n_coefficients_ = 0, n_rungs_ = 0;
};

}  // namespace manutec_r3::solver
