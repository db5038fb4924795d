// The blocks of a system's linear view (hybrid/linear_view.hpp) in its present mode, with their
// propagators, and where each block's inputs are among those of all: forcing of all blocks first,
// then the remainders.
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
    std::vector<int> watched;  // states among those of the system
    int first_constant = 0, first_forcing = 0, first_remainder = 0;
  };

  explicit CollocationBlocks(hybrid::LinearView& view);

  // Reads blocks and constants from the view: the mode may have changed.
  void refresh();

  int n_forcing() const { return n_forcing_; }
  int n_inputs() const { return n_inputs_; }
  // Where no block's ladder goes on.
  int n_rungs() const { return n_rungs_; }
  auto begin() const { return blocks_.begin(); }
  auto end() const { return blocks_.end(); }
  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t index) const { return blocks_[index]; }

  // The coefficients of a block's columns: its states in x, its constants, and its part of `count`
  // vectors of inputs.
  void gather(const Block& block, const double* x, const double* inputs, int count,
              double* coefficients) const;

  // Puts the states of a block where they belong among those of the system.
  static void scatter(const Block& block, const double* of_block, double* x) {
    for (const int state : block.equations->states) x[state] = *of_block++;
  }

  // The derivatives of all states, for inputs at the same instant.
  void derivatives(const double* x, const double* inputs, double* dx) const;

 private:
  hybrid::LinearView& view_;
  std::vector<Block> blocks_;
  std::map<const hybrid::LinearBlock*, std::shared_ptr<const Propagator>> known_;
  std::vector<double> constants_;
  int n_forcing_ = 0, n_inputs_ = 0, n_rungs_ = 0;
};

}  // namespace manutec_r3::solver
