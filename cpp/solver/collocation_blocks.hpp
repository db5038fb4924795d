// The blocks of a system's linear view (hybrid/linear_view.hpp) in its present mode, with their
// propagators, and where each block's inputs are among those of all.
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
    int first_constant = 0, first_forcing = 0, first_remainder = 0;
  };

  explicit CollocationBlocks(hybrid::LinearView& view);

  // Reads blocks and constants from the view: the mode may have changed.
  void refresh();

  // Where no block's ladder goes on.
  int n_rungs() const { return n_rungs_; }
  int n_forcing() const { return n_forcing_; }
  int n_remainder() const { return n_remainder_; }
  auto begin() const { return blocks_.begin(); }
  auto end() const { return blocks_.end(); }
  std::size_t size() const { return blocks_.size(); }
  const Block& operator[](std::size_t index) const { return blocks_[index]; }

  // The coefficients of a block's matrices: its states in x, its constants, and its part of
  // `count` vectors of forcing and of remainder.
  void gather(const Block& block, const double* x, const double* forcing, const double* remainder,
              int count, double* coefficients) const;

 private:
  hybrid::LinearView& view_;
  std::vector<Block> blocks_;
  std::map<const hybrid::LinearBlock*, std::shared_ptr<const Propagator>> known_;
  std::vector<double> constants_;
  int n_forcing_ = 0, n_remainder_ = 0, n_rungs_ = 0;
};

// Puts the states of a block where they belong in the state of the system.
inline void scatter(const hybrid::LinearBlock& block, const double* of_block, double* x) {
  for (std::size_t k = 0; k < block.states.size(); ++k) x[block.states[k]] = of_block[k];
}
inline void scatter_watched(const hybrid::LinearBlock& block, const double* of_block, double* x) {
  for (std::size_t k = 0; k < block.watched.size(); ++k) {
    x[block.states[block.watched[k]]] = of_block[k];
  }
}

}  // namespace manutec_r3::solver
