#include "solver/collocation_step.hpp"

#include <algorithm>
#include <array>

namespace manutec_r3::solver {
namespace {

// By how much the values of an input at the nodes contribute to its derivatives after a time: row
// l for node l, column q for the q-th derivative.
Eigen::Matrix<double, n_nodes, n_nodes> derivatives_of_nodes(double after, double interval) {
  Eigen::Matrix<double, n_nodes, n_nodes> derivatives = lagrange_coefficients();
  const double time = after / interval;
  double factor = 1.0;
  for (int q = 0; q < n_nodes; ++q) {
    // Horner's rule leaves the q-th derivative by q! behind.
    for (int k = input_degree - 1; k >= q; --k) {
      derivatives.col(k) += time * derivatives.col(k + 1);
    }
    derivatives.col(q) *= factor;
    factor *= (q + 1) / interval;
  }
  return derivatives;
}

}  // namespace

void CollocationStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const double after = t - step.dense[CollocationRecord::begin];
  const bool in_series = known_ && step.dense[CollocationRecord::begin] == begin_ &&
                         step.dense[CollocationRecord::interval] == interval_ && after >= base_ &&
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
  begin_ = step.dense[CollocationRecord::begin];
  interval_ = step.dense[CollocationRecord::interval];
  const double* of_step = &step.dense[CollocationRecord::coefficients];
  std::copy_n(of_step, coefficients_.size(), coefficients_.begin());
  base_ = 0.0;
  for (int rung = 0; rung < blocks_.n_rungs(); ++rung) {
    const double length = Propagator::length(rung);
    for (; after - base_ >= length; base_ += length) {
      find_derivatives_of_inputs(of_step);
      for (const CollocationBlocks::Block& block : blocks_) {
        double* of_block = &coefficients_[block.first_state];
        BlockState advanced;
        block.propagator->advance(rung, of_block, advanced.data());
        std::copy_n(advanced.begin(), block.n_states(), of_block);
      }
    }
  }
  find_derivatives_of_inputs(of_step);
  terms_.resize(Propagator::n_terms * most_states * blocks_.size());
  double* terms = terms_.data();
  for (const CollocationBlocks::Block& block : blocks_) {
    block.propagator->expand(&coefficients_[block.first_state], terms);
    terms += Propagator::n_terms * block.propagator->padded_states();
  }
}

// Instead of their values at the nodes, at `base_`.
void CollocationStep::find_derivatives_of_inputs(const double* of_step) {
  const auto derivatives = derivatives_of_nodes(base_, interval_);
  const auto find = [&](const CollocationBlocks::Input& input) {
    Eigen::Matrix<double, n_nodes, 1> values;
    for (int l = 0; l < n_nodes; ++l) values[l] = of_step[input.at(l)];
    for (int q = 0; q < n_nodes; ++q) {
      coefficients_[input.at(q)] = derivatives.col(q).dot(values);
    }
  };
  std::ranges::for_each(blocks_.forcing(), find);
  std::ranges::for_each(blocks_.remainder(), find);
}

}  // namespace manutec_r3::solver
