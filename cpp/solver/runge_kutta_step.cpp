#include "solver/runge_kutta_step.hpp"

#include <arkode/arkode_butcher_erk.h>

#include <algorithm>

namespace manutec_r3::solver {

RungeKuttaStep::RungeKuttaStep(RightHandSide& f) : f_(f) {
  ARKodeButcherTable table = ARKodeButcherTable_LoadERK(ARKODE_VERNER_10_6_7);
  const int stages = table->stages;
  for (int i = 0; i < stages; ++i) a_.insert(a_.end(), table->A[i], table->A[i] + stages);
  b_.assign(table->b, table->b + stages);
  c_.assign(table->c, table->c + stages);
  ARKodeButcherTable_Free(table);
  k_.resize(stages * f.system().n_states());
}

void RungeKuttaStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const int n = static_cast<int>(step.dense.size());
  const int stages = static_cast<int>(b_.size());
  const double h = t - step.t0;
  const auto sum = [&](const double* weights, int count) {
    std::ranges::copy(step.dense, x);
    for (int j = 0; j < count; ++j) {
      if (weights[j] == 0.0) continue;
      const double weight = h * weights[j];
      const double* k = &k_[j * n];
      for (int s = 0; s < n; ++s) x[s] += weight * k[s];
    }
  };
  if (h == 0.0) return sum(nullptr, 0);
  for (int i = 0; i < stages; ++i) {
    sum(&a_[i * stages], i);
    f_.evaluate(step.t0 + c_[i] * h, x, &k_[i * n]);
  }
  sum(b_.data(), stages);
}

}  // namespace manutec_r3::solver
