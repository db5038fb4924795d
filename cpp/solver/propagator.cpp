#include "solver/propagator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <list>
#include <span>
#include <string_view>
#include <utility>

namespace manutec_r3::solver {
namespace {

using Eigen::MatrixXd;

// Taylor's series of exp(z) to z^11 has all digits for |z| up to this.
constexpr double brief_enough = 0.15;
constexpr int taylor_terms = 11;

// The eigenvalue of |L| that is largest: a bound for those of L, in whatever units the states are.
double largest_eigenvalue(const MatrixXd& absolute) {
  // Squaring the matrix six times makes 64 steps of the power method, more than enough for a bound.
  MatrixXd power = absolute;
  double logarithm = 0.0;
  for (int squaring = 0; squaring < 6; ++squaring) {
    const double scale = power.maxCoeff();
    if (scale == 0.0) return 0.0;
    power /= scale;
    logarithm += std::ldexp(std::log(scale), -squaring);
    power = MatrixXd(power * power);
  }
  const double rest = power.maxCoeff();
  return rest > 0.0 ? std::exp(logarithm + std::ldexp(std::log(rest), -6)) : 0.0;
}

double factorial(int n) { return std::tgamma(n + 1.0); }

MatrixXd rows_of(const MatrixXd& matrix, const std::vector<int>& rows) {
  MatrixXd part(rows.size(), matrix.cols());
  for (std::size_t r = 0; r < rows.size(); ++r) part.row(r) = matrix.row(rows[r]);
  return part;
}

MatrixXd side_by_side(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

}  // namespace

const Eigen::Matrix<double, n_nodes, n_nodes>& lagrange_coefficients() {
  static const auto coefficients = [] {
    Eigen::Matrix<double, n_nodes, n_nodes> powers;
    for (int q = 0; q < n_nodes; ++q) {
      for (int node = 0; node < n_nodes; ++node) powers(q, node) = std::pow(node, q);
    }
    return Eigen::Matrix<double, n_nodes, n_nodes>(powers.inverse());
  }();
  return coefficients;
}

struct Propagator::Exact {
  MatrixXd E;
  std::array<MatrixXd, n_nodes> V;
};

Propagator::Propagator(hybrid::LinearBlock block) : block_(std::move(block)) {
  const int n = static_cast<int>(block_.states.size());
  columns_ = n + block_.n_constants + n_nodes * (block_.n_forcing + block_.n_remainder);
  fastest_ = largest_eigenvalue(block_.L.cwiseAbs());
  equations_ = PacketMatrix(side_by_side(block_.L, block_.B));

  int rungs = 1;
  while (fastest_ * length(rungs - 1) > brief_enough && rungs < lowest_rung) ++rungs;
  exact_.resize(rungs);
  exact_.back() = brief(length(rungs - 1));
  for (int k = rungs - 2; k >= 0; --k) exact_[k] = doubled(exact_[k + 1], length(k + 1));

  // Constants, then forcing and remainder order by order.
  const int first_forcing = block_.n_constants;
  const int first_remainder = first_forcing + block_.n_forcing;
  for (const Exact& exact : exact_) {
    MatrixXd columns(n, columns_);
    columns.leftCols(n) = exact.E;
    columns.middleCols(n, first_forcing) = exact.V[0].leftCols(first_forcing);
    int forcing = n + first_forcing, remainder = forcing + n_nodes * block_.n_forcing;
    for (int q = 0; q < n_nodes; ++q) {
      columns.middleCols(forcing, block_.n_forcing) =
          exact.V[q].middleCols(first_forcing, block_.n_forcing);
      columns.middleCols(remainder, block_.n_remainder) =
          exact.V[q].middleCols(first_remainder, block_.n_remainder);
      forcing += block_.n_forcing;
      remainder += block_.n_remainder;
    }
    // `advance` adds to what is there.
    columns.leftCols(n).diagonal().array() -= 1.0;
    ladder_.emplace_back(columns);
  }
}

Propagator::~Propagator() {
  for (const auto& step : steps_) delete step.load();
}

double Propagator::length(int rung) { return std::ldexp(longest, -rung); }

// --- E and V -------------------------------------------------------------------------------------

Propagator::Exact Propagator::brief(double length) const {
  // E = sum_i L^i d^i/i!,  V_q = sum_i L^i B d^(i+q+1)/(i+q+1)!
  const int n = static_cast<int>(block_.L.rows());
  Exact exact{.E = MatrixXd::Identity(n, n), .V = {}};
  MatrixXd of_L = MatrixXd::Identity(n, n);  // (L d)^i/i!
  MatrixXd of_B = block_.B * length;         // (L d)^i B d
  for (auto& V : exact.V) V.setZero(n, block_.B.cols());
  for (int i = 0; i < taylor_terms; ++i) {
    for (int q = 0; q < n_nodes; ++q) {
      exact.V[q] += of_B * (std::pow(length, q) / factorial(i + q + 1));
    }
    of_B = block_.L * of_B * length;
    of_L = block_.L * of_L * (length / (i + 1));
    exact.E += of_L;
  }
  return exact;
}

Propagator::Exact Propagator::doubled(const Exact& half, double d) const {
  // V_q(2 d) = E V_q + sum_{i <= q} V_i d^(q-i)/(q-i)!, for tau^q = (d + (tau - d))^q.
  Exact whole{.E = half.E * half.E, .V = {}};
  for (int q = 0; q < n_nodes; ++q) {
    whole.V[q] = half.E * half.V[q];
    for (int i = 0; i <= q; ++i) {
      whole.V[q] += half.V[i] * (std::pow(d, q - i) / factorial(q - i));
    }
  }
  return whole;
}

Propagator::Exact Propagator::exact(double length) const {
  int doublings = 0;
  while (fastest_ * std::ldexp(length, -doublings) > brief_enough) ++doublings;
  Exact exact = brief(std::ldexp(length, -doublings));
  for (; doublings > 0; --doublings) exact = doubled(exact, std::ldexp(length, -doublings));
  return exact;
}

void Propagator::advance_briefly(double length, const double* coefficients, double* x) const {
  const int n = static_cast<int>(block_.states.size());
  const int n_c = block_.n_constants, n_f = block_.n_forcing, n_r = block_.n_remainder;
  const double* forcing = coefficients + n + n_c;
  const double* remainder = forcing + n_nodes * n_f;
  // x^(i+1) = L x^(i) + B u^(i)
  std::array<double, 64> term, next;
  std::copy_n(coefficients, n, term.begin());
  double weight = 1.0;
  for (int i = 0; i < taylor_terms; ++i) {
    next.fill(0.0);
    equations_.add_product(0, n, term.data(), next.data());
    if (i == 0) equations_.add_product(n, n_c, coefficients + n, next.data());
    if (i < n_nodes) {
      equations_.add_product(n + n_c, n_f, forcing + i * n_f, next.data());
      equations_.add_product(n + n_c + n_f, n_r, remainder + i * n_r, next.data());
    }
    weight *= length / (i + 1);
    for (int s = 0; s < n; ++s) x[s] += weight * next[s];
    std::swap(term, next);
  }
}

// --- steps ---------------------------------------------------------------------------------------

const StepMatrices& Propagator::step(int rung) const {
  const StepMatrices* step = steps_[rung].load(std::memory_order_acquire);
  if (step != nullptr) return *step;
  const std::lock_guard lock(making_);
  step = steps_[rung].load(std::memory_order_relaxed);
  if (step == nullptr) {
    const bool on_ladder = rung < n_rungs();
    step = new StepMatrices(on_ladder ? step_from(exact_[rung], length(rung))
                                      : step_from(brief(length(rung)), length(rung)));
    steps_[rung].store(step, std::memory_order_release);
  }
  return *step;
}

StepMatrices Propagator::step_of(double interval) const {
  return step_from(exact(interval), interval);
}

StepMatrices Propagator::step_from(const Exact& interval, double d) const {
  const auto& lagrange = lagrange_coefficients();
  const int n = static_cast<int>(block_.states.size());
  const int n_c = block_.n_constants, n_f = block_.n_forcing, n_r = block_.n_remainder;
  StepMatrices step;
  Exact to_node = interval;
  for (int node = 1; node < n_nodes; ++node) {
    if (node > 1) {
      Exact further{.E = interval.E * to_node.E, .V = {}};
      const double before = (node - 1) * d;
      for (int q = 0; q < n_nodes; ++q) {
        further.V[q] = interval.E * to_node.V[q];
        for (int i = 0; i <= q; ++i) {
          further.V[q] += interval.V[i] * (std::pow(before, q - i) / factorial(q - i));
        }
      }
      to_node = std::move(further);
    }

    // The q-th derivative at the beginning of a polynomial through the nodes.
    MatrixXd columns(n, columns_);
    columns.leftCols(n) = to_node.E;
    columns.middleCols(n, n_c) = to_node.V[0].leftCols(n_c);
    const auto at_nodes = [&](int first_column, int first_input, int inputs) {
      for (int l = 0; l < n_nodes; ++l) {
        MatrixXd of_node = MatrixXd::Zero(n, inputs);
        for (int q = 0; q < n_nodes; ++q) {
          of_node += to_node.V[q].middleCols(first_input, inputs) *
                     (lagrange(l, q) * factorial(q) / std::pow(d, q));
        }
        columns.middleCols(first_column + l * inputs, inputs) = of_node;
      }
    };
    const int forcing = n + n_c, remainder = forcing + n_nodes * n_f;
    at_nodes(forcing, n_c, n_f);
    at_nodes(remainder, n_c + n_f, n_r);

    MatrixXd rates = block_.L * columns;
    rates.middleCols(n, n_c) += block_.B.leftCols(n_c);
    rates.middleCols(forcing + node * n_f, n_f) += block_.B.middleCols(n_c, n_f);
    rates.middleCols(remainder + node * n_r, n_r) += block_.B.rightCols(n_r);
    step.watched[node - 1] = PacketMatrix(rows_of(columns, block_.watched));
    step.rates[node - 1] = PacketMatrix(rows_of(rates, block_.watched));
    if (node == input_degree) step.end = PacketMatrix(columns);
  }
  step.gains = to_node.V[0].rightCols(n_f + n_r).cwiseAbs();
  return step;
}

// --- sharing -------------------------------------------------------------------------------------

namespace {

// Enough for a robot in all its modes, several times: about 25 MB.
constexpr std::size_t most_kept = 256;

bool equal(const hybrid::LinearBlock& a, const hybrid::LinearBlock& b) {
  return a.watched == b.watched && a.n_constants == b.n_constants && a.n_forcing == b.n_forcing &&
         a.n_remainder == b.n_remainder && a.L.rows() == b.L.rows() && a.L == b.L && a.B == b.B;
}

std::size_t hash_of(const MatrixXd& matrix) {
  const std::span entries(matrix.data(), matrix.size());
  const auto bytes = std::as_bytes(entries);
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

struct Kept {
  std::size_t hash;
  std::shared_ptr<const Propagator> propagator;
};

}  // namespace

std::shared_ptr<const Propagator> propagator_of(const hybrid::LinearBlock& block) {
  static std::mutex using_kept;
  static std::list<Kept> kept;  // the latest used first
  const std::size_t hash = hash_of(block.L) + 31 * hash_of(block.B);
  const auto find = [&]() -> std::shared_ptr<const Propagator> {
    const auto found = std::ranges::find_if(kept, [&](const Kept& one) {
      return one.hash == hash && equal(one.propagator->block(), block);
    });
    if (found == kept.end()) return nullptr;
    kept.splice(kept.begin(), kept, found);
    return found->propagator;
  };
  {
    const std::lock_guard lock(using_kept);
    if (auto propagator = find()) return propagator;
  }
  auto made = std::make_shared<const Propagator>(block);
  const std::lock_guard lock(using_kept);
  if (auto propagator = find()) return propagator;  // somebody else was faster
  kept.push_front({hash, made});
  if (kept.size() > most_kept) kept.pop_back();
  return made;
}

}  // namespace manutec_r3::solver
