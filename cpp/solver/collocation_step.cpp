#include "solver/collocation_step.hpp"

#include <algorithm>
#include <array>

namespace manutec_r3::solver {

CollocationStep::CollocationStep(int n_states, const CollocationBlocks& blocks)
    : blocks_(blocks),
      record_(n_states, blocks),
      powers_(n_nodes * blocks.n_inputs()),
      derivatives_(powers_.size()),
      x_(n_states) {}

void CollocationStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const double after = t - step.dense[record_.begin];
  const bool in_series = known_ && step.dense[record_.begin] == begin_ &&
                         step.dense[record_.interval] == interval_ && after >= base_ &&
                         after - base_ < Propagator::length(blocks_.n_rungs() - 1);
  if (!in_series) expand(step, after);

  const double* terms = terms_.data();
  for (const CollocationBlocks::Block& block : blocks_) {
    BlockState of_block;
    block.propagator->sum(terms, after - base_, of_block.data());
    blocks_.scatter(block, of_block.data(), x);
    terms += Propagator::n_terms * block.propagator->padded_states();
  }
}

void CollocationStep::expand(const hybrid::Step& step, double after) {
  known_ = true;
  begin_ = step.dense[record_.begin];
  interval_ = step.dense[record_.interval];
  base_ = 0.0;

  // Coefficients of powers of time in intervals.
  const auto& lagrange = lagrange_coefficients();
  const int m = blocks_.n_inputs();
  const double* at_nodes = &step.dense[record_.inputs];
  std::ranges::fill(powers_, 0.0);
  for (int q = 0; q < n_nodes; ++q) {
    for (int l = 0; l < n_nodes; ++l) {
      for (int i = 0; i < m; ++i) powers_[q * m + i] += lagrange(l, q) * at_nodes[l * m + i];
    }
  }

  std::array<double, most_columns> coefficients;
  std::copy_n(&step.dense[record_.x], x_.size(), x_.begin());
  for (int rung = 0; rung < blocks_.n_rungs(); ++rung) {
    for (; after - base_ >= Propagator::length(rung); base_ += Propagator::length(rung)) {
      find_derivatives_of_inputs(base_, interval_);
      for (const CollocationBlocks::Block& block : blocks_) {
        blocks_.gather(block, x_.data(), derivatives_.data(), n_nodes, coefficients.data());
        BlockState advanced;
        block.propagator->advance(rung, coefficients.data(), advanced.data());
        blocks_.scatter(block, advanced.data(), x_.data());
      }
    }
  }
  find_derivatives_of_inputs(base_, interval_);
  terms_.resize(Propagator::n_terms * most_states * blocks_.size());
  double* terms = terms_.data();
  for (const CollocationBlocks::Block& block : blocks_) {
    blocks_.gather(block, x_.data(), derivatives_.data(), n_nodes, coefficients.data());
    block.propagator->expand(coefficients.data(), terms);
    terms += Propagator::n_terms * block.propagator->padded_states();
  }
}

// Order by order, from the coefficients of their powers.
void CollocationStep::find_derivatives_of_inputs(double after, double interval) {
  const int m = blocks_.n_inputs();
  const double time = after / interval;
  derivatives_ = powers_;
  double factor = 1.0;
  for (int q = 0; q < n_nodes; ++q) {
    // Horner's rule leaves the q-th derivative by q! behind.
    for (int k = input_degree - 1; k >= q; --k) {
      double* lower = &derivatives_[k * m];
      for (int i = 0; i < m; ++i) lower[i] += time * lower[m + i];
    }
    for (int i = 0; i < m; ++i) derivatives_[q * m + i] *= factor;
    factor *= (q + 1) / interval;
  }
}

}  // namespace manutec_r3::solver
