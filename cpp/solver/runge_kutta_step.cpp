#include "solver/runge_kutta_step.hpp"

#include <arkode/arkode_butcher_erk.h>

#include <algorithm>

namespace manutec_r3::solver {

RungeKuttaStep::RungeKuttaStep(RightHandSide& f) : f_(f) {
  ARKodeButcherTable table = ARKodeButcherTable_LoadERK(ARKODE_VERNER_10_6_7);
  b_ = row(table->b, table->stages);
  const int stages = b_.back().stage + 1;
  for (int i = 0; i < stages; ++i) a_.push_back(row(table->A[i], i));
  c_.assign(table->c, table->c + stages);
  ARKodeButcherTable_Free(table);
  k_.resize(stages * f.system().n_states());
  terms_.reserve(stages + 1);
}

RungeKuttaStep::Row RungeKuttaStep::row(const double* weights, int count) {
  Row row;
  for (int j = 0; j < count; ++j) {
    if (weights[j] != 0.0) row.push_back({weights[j], j});
  }
  return row;
}

void RungeKuttaStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const std::size_t n = step.dense.size();
  const double h = t - step.t0;
  if (h == 0.0) {
    std::ranges::copy(step.dense, x);
    return;
  }
  // x = x0 + h sum_j weight_j k_j
  const auto move = [&](const Row& row) {
    terms_.assign(1, {1.0, step.dense.data()});
    for (const auto [weight, stage] : row) terms_.push_back({h * weight, &k_[stage * n]});
    combine(terms_, static_cast<int>(n), x);
  };
  for (std::size_t i = 0; i < a_.size(); ++i) {
    move(a_[i]);
    f_.evaluate(step.t0 + c_[i] * h, x, &k_[i * n]);
  }
  move(b_);
}

}  // namespace manutec_r3::solver
