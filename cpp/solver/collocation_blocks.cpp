#include "solver/collocation_blocks.hpp"

#include <algorithm>
#include <array>

namespace manutec_r3::solver {

CollocationBlocks::CollocationBlocks(hybrid::LinearView& view)
    : view_(view), blocks_(view.n_blocks()) {
  int n_constants = 0;
  for (int b = 0; b < view.n_blocks(); ++b) {
    const hybrid::LinearBlock& equations = view.block(b);
    Block& block = blocks_[b];
    block.states = equations.states;
    for (const int place : equations.watched) block.watched.push_back(equations.states[place]);
    block.n_forcing = equations.n_forcing;
    block.n_remainder = equations.n_remainder;
    block.first_state = n_coefficients_;
    block.first_constant = block.first_state + block.n_states();
    block.first_forcing = block.first_constant + equations.n_constants;
    block.first_remainder = block.first_forcing + n_nodes * block.n_forcing;
    for (int i = 0; i < block.n_forcing; ++i) {
      forcing_.push_back({b, i, block.first_forcing + i, block.n_forcing});
    }
    for (int i = 0; i < block.n_remainder; ++i) {
      remainder_.push_back({b, block.n_forcing + i, block.first_remainder + i, block.n_remainder});
    }
    n_coefficients_ = block.end();
    n_constants += equations.n_constants;
  }
  constants_.resize(n_constants);
}

void CollocationBlocks::refresh() {
  n_rungs_ = 0;
  for (int b = 0; b < view_.n_blocks(); ++b) {
    Block& block = blocks_[b];
    const hybrid::LinearBlock& present = view_.block(b);
    if (block.equations != &present) {
      block.equations = &present;
      auto& propagator = known_[&present];
      if (!propagator) propagator = propagator_of(present);
      block.propagator = propagator;
    }
    n_rungs_ = std::max(n_rungs_, block.propagator->n_rungs());
  }
}

void CollocationBlocks::set_states(const double* x, double* coefficients) const {
  for (const Block& block : blocks_) {
    double* of_block = coefficients + block.first_state;
    for (const int state : block.states) *of_block++ = x[state];
  }
}

void CollocationBlocks::set_constants(double* coefficients) {
  view_.constants(constants_.data());
  const double* constant = constants_.data();
  for (const Block& block : blocks_) {
    for (int i = block.first_constant; i < block.first_forcing; ++i) coefficients[i] = *constant++;
  }
}

void CollocationBlocks::derivatives(const double* x, const double* forcing, const double* remainder,
                                    double* dx) const {
  const double* constant = constants_.data();
  std::array<double, most_columns> coefficients;
  for (const Block& block : blocks_) {
    double* next = coefficients.data();
    for (const int state : block.states) *next++ = x[state];
    for (int i = block.first_constant; i < block.first_forcing; ++i) *next++ = *constant++;
    for (int i = 0; i < block.n_forcing; ++i) *next++ = *forcing++;
    for (int i = 0; i < block.n_remainder; ++i) *next++ = *remainder++;
    BlockState of_block;
    block.propagator->derivatives(coefficients.data(), of_block.data());
    scatter(block, of_block.data(), dx);
  }
}

}  // namespace manutec_r3::solver
