#include "solver/runge_kutta_step.hpp"

#include <arkode/arkode_butcher_erk.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "solver/hermite.hpp"

namespace manutec_r3::solver {
namespace {

// A polynomial is believed if the next simpler one is within this part of the tolerance of it: what
// decays within a step is met no better by the one than by the other.
constexpr double believed = 0.2;
// Steps that have grown a lot make weights so large that roundoff shows.
constexpr double largest_weight = 100.0;

// What `dense` tells of the end of a step with so many states.
struct End {
  double t;
  const double *x, *rates;

  End(const hybrid::Step& step, int n)
      : t(step.dense[3 * n]), x(&step.dense[n]), rates(&step.dense[2 * n]) {}
};

}  // namespace

RungeKuttaStep::RungeKuttaStep(RightHandSide& f, double relative_tolerance)
    : f_(f),
      tolerance_(relative_tolerance),
      nominals_(f.system().nominals().begin(), f.system().nominals().end()) {
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

void RungeKuttaStep::begin(hybrid::Step& step, double t0, const double* x0) {
  const int n = f_.system().n_states();
  step.t0 = t0;
  step.dense.resize(3 * n + 1);
  std::copy_n(x0, n, step.dense.data());
}

void RungeKuttaStep::end(hybrid::Step& step, double t1, const double* x1) {
  const int n = f_.system().n_states();
  step.t1 = step.dense[3 * n] = t1;
  std::copy_n(x1, n, &step.dense[n]);
  f_.evaluate_and_keep(t1, x1, &step.dense[2 * n]);
}

void RungeKuttaStep::evaluate(const hybrid::Step& step, double t, double* x) {
  const std::size_t n = f_.system().n_states();
  const double h = t - step.t0;
  if (h == 0.0) {
    std::copy_n(step.dense.data(), n, x);
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

void RungeKuttaStep::interpolate(const hybrid::Stretch& stretch, double t, double* x) {
  const hybrid::Step& latest = stretch.latest();
  const int n = f_.system().n_states();
  const End end(latest, n);
  if (t > latest.t0 && t == end.t) {
    std::copy_n(end.x, n, x);
  } else if (t == latest.t0 || !stretch.is_full() || !interpolate_all(stretch, t, x)) {
    evaluate(latest, t, x);
  }
}

// The polynomial of degree 7 through the ends of four steps, where t is inside the latest. It is
// believed if that of degree 5, through the latest three, comes close to it.
bool RungeKuttaStep::interpolate_all(const hybrid::Stretch& stretch, double t, double* x) {
  constexpr std::size_t n_ends = hybrid::Stretch::longest;
  const int n = f_.system().n_states();
  std::array<double, n_ends> instants;
  std::array<const double*, n_ends> states, rates;
  for (std::size_t k = 0; k < n_ends; ++k) {
    const End end(*stretch.steps[k], n);
    instants[k] = end.t;
    states[k] = end.x;
    rates[k] = end.rates;
  }
  const HermiteWeights<n_ends> all(instants, t), latest({instants.data(), n_ends - 1}, t);
  if (all.largest() > largest_weight) return false;

  bool close = true;
  in_blocks(n, [&]<int size>(int first) {
    using Block = Eigen::Array<double, size, 1>;
    using View = Eigen::Map<const Block>;
    // Only differences of states: what is constant stays so to the last bit.
    const Block begin = View(states[1] + first);
    Block sum = begin, doubt = Block::Zero();
    for (std::size_t k = 0; k < n_ends; ++k) {
      const Block difference = View(states[k] + first) - begin;
      const View rate(rates[k] + first);
      sum += all.value[k] * difference + all.rate[k] * rate;
      doubt +=
          (all.value[k] - latest.value[k]) * difference + (all.rate[k] - latest.rate[k]) * rate;
    }
    Eigen::Map<Block>(x + first) = sum;
    const auto allowed = tolerance_ * (View(&nominals_[first]) + sum.abs());
    close = close && (believed * allowed - doubt.abs()).minCoeff() >= 0.0;
  });
  return close;
}

}  // namespace manutec_r3::solver
