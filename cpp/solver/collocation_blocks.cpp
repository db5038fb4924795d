#include "solver/collocation_blocks.hpp"

#include <algorithm>
#include <array>

namespace manutec_r3::solver {

CollocationBlocks::CollocationBlocks(hybrid::LinearView& view)
    : view_(view), blocks_(view.n_blocks()) {
  for (int b = 0; b < view.n_blocks(); ++b) n_forcing_ += view.block(b).n_forcing;
  n_inputs_ = n_forcing_;
  int n_constants = 0, n_forcing = 0;
  for (int b = 0; b < view.n_blocks(); ++b) {
    const hybrid::LinearBlock& block = view.block(b);
    blocks_[b].first_constant = n_constants;
    blocks_[b].first_forcing = n_forcing;
    blocks_[b].first_remainder = n_inputs_;
    n_constants += block.n_constants;
    n_forcing += block.n_forcing;
    n_inputs_ += block.n_remainder;
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
      block.watched.clear();
      for (const int place : present.watched) block.watched.push_back(present.states[place]);
    }
    n_rungs_ = std::max(n_rungs_, block.propagator->n_rungs());
  }
  view_.constants(constants_.data());
}

void CollocationBlocks::gather(const Block& block, const double* x, const double* inputs, int count,
                               double* coefficients) const {
  const hybrid::LinearBlock& equations = *block.equations;
  for (const int state : equations.states) *coefficients++ = x[state];
  const double* constants = &constants_[block.first_constant];
  for (int i = 0; i < equations.n_constants; ++i) *coefficients++ = constants[i];
  const auto gather_inputs = [&](const double* input, int n) {
    for (int k = 0; k < count; ++k, input += n_inputs_) {
      for (int i = 0; i < n; ++i) *coefficients++ = input[i];
    }
  };
  gather_inputs(inputs + block.first_forcing, equations.n_forcing);
  gather_inputs(inputs + block.first_remainder, equations.n_remainder);
}

void CollocationBlocks::derivatives(const double* x, const double* inputs, double* dx) const {
  std::array<double, most_columns> coefficients;
  for (const Block& block : blocks_) {
    gather(block, x, inputs, 1, coefficients.data());
    BlockState of_block;
    block.propagator->derivatives(coefficients.data(), of_block.data());
    scatter(block, of_block.data(), dx);
  }
}

}  // namespace manutec_r3::solver
