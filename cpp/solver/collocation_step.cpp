#include "solver/collocation_step.hpp"

#include <algorithm>
#include <cmath>

namespace manutec_r3::solver {
namespace {

// Coefficients of powers of time in intervals, of polynomials through values at the nodes.
void powers_of(const double* at_nodes, int n, std::vector<double>& powers) {
  const auto& lagrange = lagrange_coefficients();
  powers.assign(n_nodes * n, 0.0);
  for (int l = 0; l < n_nodes; ++l) {
    for (int q = 0; q < n_nodes; ++q) {
      for (int i = 0; i < n; ++i) powers[q * n + i] += lagrange(l, q) * at_nodes[l * n + i];
    }
  }
}

// Derivatives of these polynomials, order by order, after a time in intervals of this length.
void derivatives_at(double time, double interval, const std::vector<double>& powers, int n,
                    std::vector<double>& derivatives) {
  derivatives = powers;
  double factor = 1.0;
  for (int q = 0; q < n_nodes; ++q) {
    // Horner's rule leaves the q-th derivative by q! behind.
    for (int m = input_degree - 1; m >= q; --m) {
      for (int i = 0; i < n; ++i) derivatives[m * n + i] += time * derivatives[(m + 1) * n + i];
    }
    for (int i = 0; i < n; ++i) derivatives[q * n + i] *= factor;
    factor *= (q + 1) / interval;
  }
}

}  // namespace

CollocationStep::CollocationStep(int n_states, const CollocationBlocks& blocks)
    : blocks_(blocks), record_(n_states, blocks) {}

void CollocationStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const double* dense = step.dense.data();
  const double* x0 = dense + record_.x;
  const double after = t - dense[record_.begin];
  const double interval = dense[record_.interval];
  powers_of(dense + record_.forcing, blocks_.n_forcing(), powers_[0]);
  powers_of(dense + record_.remainder, blocks_.n_remainder(), powers_[1]);

  std::copy_n(x0, record_.forcing - record_.x, x);
  int rung = 0;
  double passed = 0.0;
  const auto inputs_now = [&] {
    derivatives_at(passed / interval, interval, powers_[0], blocks_.n_forcing(), derivatives_[0]);
    derivatives_at(passed / interval, interval, powers_[1], blocks_.n_remainder(), derivatives_[1]);
  };
  const auto for_each_block = [&](const auto& advance) {
    inputs_now();
    for (const CollocationBlocks::Block& block : blocks_) {
      std::array<double, 128> coefficients;
      std::array<double, 64> of_block{};
      blocks_.gather(block, x, derivatives_[0].data(), derivatives_[1].data(), n_nodes,
                     coefficients.data());
      std::copy_n(coefficients.data(), block.equations->states.size(), of_block.data());
      advance(*block.propagator, coefficients.data(), of_block.data());
      scatter(*block.equations, of_block.data(), x);
    }
  };
  while (rung < blocks_.n_rungs()) {
    const double length = Propagator::length(rung);
    if (after - passed < length) {
      ++rung;
      continue;
    }
    for_each_block([&](const Propagator& propagator, const double* coefficients, double* y) {
      propagator.advance(rung, coefficients, y);
    });
    passed += length;
  }
  if (after > passed) {
    for_each_block([&](const Propagator& propagator, const double* coefficients, double* y) {
      propagator.advance_briefly(after - passed, coefficients, y);
    });
  }
}

}  // namespace manutec_r3::solver
