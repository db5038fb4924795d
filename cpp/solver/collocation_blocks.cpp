#include "solver/collocation_blocks.hpp"

#include <algorithm>

namespace manutec_r3::solver {

CollocationBlocks::CollocationBlocks(hybrid::LinearView& view)
    : view_(view), blocks_(view.n_blocks()) {
  int n_constants = 0;
  for (int b = 0; b < view.n_blocks(); ++b) {
    const hybrid::LinearBlock& block = view.block(b);
    blocks_[b].first_constant = n_constants;
    blocks_[b].first_forcing = n_forcing_;
    blocks_[b].first_remainder = n_remainder_;
    n_constants += block.n_constants;
    n_forcing_ += block.n_forcing;
    n_remainder_ += block.n_remainder;
  }
  constants_.resize(n_constants);
}

void CollocationBlocks::refresh() {
  for (int b = 0; b < view_.n_blocks(); ++b) {
    Block& block = blocks_[b];
    const hybrid::LinearBlock& present = view_.block(b);
    if (block.equations == &present) continue;
    block.equations = &present;
    auto& propagator = known_[&present];
    if (!propagator) propagator = propagator_of(present);
    block.propagator = propagator;
  }
  n_rungs_ = 0;
  for (const Block& block : blocks_) n_rungs_ = std::max(n_rungs_, block.propagator->n_rungs());
  view_.constants(constants_.data());
}

void CollocationBlocks::gather(const Block& block, const double* x, const double* forcing,
                               const double* remainder, int count, double* coefficients) const {
  const hybrid::LinearBlock& equations = *block.equations;
  for (const int state : equations.states) *coefficients++ = x[state];
  const double* constant = &constants_[block.first_constant];
  coefficients = std::copy_n(constant, equations.n_constants, coefficients);
  for (int k = 0; k < count; ++k) {
    const double* first = forcing + k * n_forcing_ + block.first_forcing;
    coefficients = std::copy_n(first, equations.n_forcing, coefficients);
  }
  for (int k = 0; k < count; ++k) {
    const double* first = remainder + k * n_remainder_ + block.first_remainder;
    coefficients = std::copy_n(first, equations.n_remainder, coefficients);
  }
}

}  // namespace manutec_r3::solver
