#include "solver/propagator.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace manutec_r3::solver {
namespace {

using Eigen::MatrixXd;

// Taylor's series of exp(z) to z^8 has all digits for |z| up to this.
constexpr double brief_enough = 0.05;

// i!
double factorial(int i) {
  static const auto factorials = [] {
    std::array<double, Propagator::n_terms + n_nodes + 1> values;
    values[0] = 1.0;
    for (std::size_t k = 1; k < values.size(); ++k) values[k] = values[k - 1] * k;
    return values;
  }();
  return factorials[i];
}

// The largest eigenvalue of |L|: a bound for those of L, in whatever units the states are.
double largest_eigenvalue(const MatrixXd& absolute) {
  // Six squarings make 64 steps of the power method, more than enough for a bound.
  MatrixXd power = absolute;
  double logarithm = 0.0;
  for (int squaring = 0; squaring <= 6; ++squaring) {
    const double scale = power.maxCoeff();
    if (scale == 0.0) return 0.0;
    power /= scale;
    logarithm += std::ldexp(std::log(scale), -squaring);
    power = power.lazyProduct(power).eval();
  }
  return std::exp(logarithm);
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

const Eigen::Matrix<double, n_nodes, n_nodes>& lagrange_slopes() {
  static const auto slopes = [] {
    Eigen::Matrix<double, n_nodes, n_nodes> slopes_of_powers;
    for (int q = 0; q < n_nodes; ++q) {
      for (int node = 0; node < n_nodes; ++node) {
        slopes_of_powers(q, node) = q == 0 ? 0.0 : q * std::pow(node, q - 1);
      }
    }
    return Eigen::Matrix<double, n_nodes, n_nodes>(lagrange_coefficients() * slopes_of_powers);
  }();
  return slopes;
}

Propagator::Propagator(hybrid::LinearBlock block) : block_(std::move(block)) {
  const int n = n_states();
  columns_ = n + block_.n_constants + n_nodes * (block_.n_forcing + block_.n_remainder);
  if (n > most_states || columns_ > most_columns) {
    throw std::invalid_argument("linear block: expected at most " + std::to_string(most_states) +
                                " states, got " + std::to_string(n));
  }
  Kind& constants = inputs_[0] = {block_.n_constants, 0, n, 1};
  Kind& forcing = inputs_[1] = {block_.n_forcing, constants.count, constants.column(1), n_nodes};
  inputs_[2] = {block_.n_remainder, forcing.first + forcing.count, forcing.column(n_nodes),
                n_nodes};

  MatrixXd L_and_B(n, n + n_inputs());
  L_and_B << block_.L, block_.B;
  equations_ = PacketMatrix(L_and_B);
  fastest_ = largest_eigenvalue(block_.L.cwiseAbs());

  int rungs = 1;
  while (fastest_ * length(rungs - 1) > brief_enough && rungs < lowest_rung) ++rungs;
  exact_.resize(n_above + rungs);
  exact_.back() = brief(length(rungs - 1));
  double d = length(rungs - 1);
  for (auto half = exact_.rbegin(); half + 1 != exact_.rend(); ++half, d *= 2.0) {
    *(half + 1) = sum_of(*half, d, *half);
  }
}

Propagator::~Propagator() {
  for (const auto& step : steps_) delete step.load();
}

double Propagator::length(int rung) {
  static const auto lengths = [] {
    std::array<double, lowest_rung + 1> values;
    for (int k = 0; k <= lowest_rung; ++k) values[k] = std::ldexp(longest, -k);
    return values;
  }();
  return lengths[rung];
}

// --- F and V -------------------------------------------------------------------------------------

// F = sum_{i > 0} L^i d^i/i!,  V_q = sum_i L^i B d^(i+q+1)/(i+q+1)!
Propagator::Exact Propagator::brief(double d) const {
  const int n = n_states();
  Exact exact(n, columns_);
  PacketMatrix term(n, n + n_inputs());  // (L d)^i, (L d)^i B d
  for (int s = 0; s < n; ++s) term(s, s) = 1.0;
  term.add_columns(n, n_inputs(), d, equations_, n);
  for (int i = 0; i < n_terms; ++i) {
    if (i > 0) exact.add_columns(0, n, 1.0 / factorial(i), term, 0);
    for (const Kind& kind : inputs_) {
      double power = 1.0;  // d^q
      for (int q = 0; q < kind.n_orders; ++q, power *= d) {
        exact.add_columns(kind.column(q), kind.count, power / factorial(i + q + 1), term,
                          n + kind.first);
      }
    }
    term = equations_.product(n, term);
    term *= d;
  }
  return exact;
}

// One length after another, the first as long as given: because of tau = d + (tau - d),
//   1 + F = (1 + F_2) (1 + F_1),  V_q = (1 + F_2) V_1q + sum_{i <= q} V_2i d^(q-i)/(q-i)!
Propagator::Exact Propagator::sum_of(const Exact& first, double d, const Exact& second) const {
  Exact both = second.product(n_states(), first);
  both.add_columns(0, columns_, 1.0, first, 0);
  both.add_columns(0, n_states(), 1.0, second, 0);
  for (const Kind& kind : inputs_) {
    for (int q = 0; q < kind.n_orders; ++q) {
      double power = 1.0;
      for (int i = q; i >= 0; --i, power *= d) {
        both.add_columns(kind.column(q), kind.count, power / factorial(q - i), second,
                         kind.column(i));
      }
    }
  }
  return both;
}

Propagator::Exact Propagator::on_ladder(int rung) const {
  return rung < n_rungs() ? exact_[n_above + rung] : brief(length(rung));
}

Propagator::Exact Propagator::exact(double length) const {
  int doublings = 0;
  while (fastest_ * std::ldexp(length, -doublings) > brief_enough) ++doublings;
  Exact exact = brief(std::ldexp(length, -doublings));
  for (; doublings > 0; --doublings) {
    exact = sum_of(exact, std::ldexp(length, -doublings), exact);
  }
  return exact;
}

// The same for polynomials through the nodes, whose q-th derivatives at the beginning are
// q!/d^q sum_l c_lq u_l. Constants are what they are, not values at node 0.
PacketMatrix Propagator::for_nodes(const Exact& exact, double d) const {
  const auto& lagrange = lagrange_coefficients();
  PacketMatrix result(exact.padded_rows(), columns_);
  const int n_common = inputs_[1].first_column;
  result.add_columns(0, n_common, 1.0, exact, 0);
  for (const Kind& kind : {inputs_[1], inputs_[2]}) {
    double power = 1.0;  // d^q
    for (int q = 0; q < n_nodes; ++q, power *= d) {
      for (int l = 0; l < n_nodes; ++l) {
        result.add_columns(kind.column(l), kind.count, lagrange(l, q) * factorial(q) / power, exact,
                           kind.column(q));
      }
    }
  }
  return result;
}

void Propagator::advance(int rung, const double* coefficients, double* x) const {
  if (rung < n_rungs()) {
    exact_[n_above + rung].add_product(0, columns_, coefficients, coefficients, x);
    return;
  }
  std::array<double, n_terms * most_states> terms;
  expand(coefficients, terms.data());
  sum(terms.data(), length(rung), x);
}

void Propagator::expand(const double* coefficients, double* terms) const {
  const int n = n_states(), rows = padded_states();
  const int n_c = block_.n_constants, n_f = block_.n_forcing, n_r = block_.n_remainder;
  const double* constants = coefficients + n;
  const double* forcing = constants + n_c;
  const double* remainder = forcing + n_nodes * n_f;
  std::copy_n(coefficients, n, terms);
  std::fill(terms + n, terms + rows, 0.0);
  // x^(i+1) = L x^(i) + B u^(i)
  std::array<double, most_columns> x_and_u;
  for (int i = 0; i + 1 < n_terms; ++i) {
    const double by_factorial = 1.0 / factorial(i), by_next = 1.0 / (i + 1);
    double* last = std::copy_n(terms + i * rows, n, x_and_u.data());
    if (i < n_nodes) {
      for (int k = 0; k < n_c; ++k) *last++ = i == 0 ? constants[k] : 0.0;
      for (int k = 0; k < n_f; ++k) *last++ = by_factorial * forcing[i * n_f + k];
      for (int k = 0; k < n_r; ++k) *last++ = by_factorial * remainder[i * n_r + k];
    }
    double* next = terms + (i + 1) * rows;
    equations_.add_product_to(
        0, static_cast<int>(last - x_and_u.data()), x_and_u.data(), nullptr,
        [&](int p, const Abreast& sum) { (by_next * sum).store(next + p * packet_size); });
  }
}

void Propagator::sum(const double* terms, double time, double* x) const {
  // Horner's rule, a packet of states at a time.
  const int rows = padded_states();
  for (int row = 0; row < rows; row += packet_size) {
    Abreast sum = Abreast::load(terms + (n_terms - 1) * rows + row);
    for (int i = n_terms - 2; i >= 0; --i) {
      sum = time * sum + Abreast::load(terms + i * rows + row);
    }
    sum.store(x + row);
  }
}

// --- steps ---------------------------------------------------------------------------------------

const StepMatrices& Propagator::step(int rung) const {
  const StepMatrices* step = steps_[rung].load(std::memory_order_acquire);
  if (step != nullptr) return *step;
  const std::lock_guard lock(making_);
  step = steps_[rung].load(std::memory_order_relaxed);
  if (step == nullptr) {
    step = new StepMatrices(
        step_from(on_ladder(rung), on_ladder(rung - 1), on_ladder(rung - 2), length(rung)));
    steps_[rung].store(step, std::memory_order_release);
  }
  return *step;
}

StepMatrices Propagator::step_of(double interval) const {
  return step_from(exact(interval), exact(2 * interval), exact(4 * interval), interval);
}

StepMatrices Propagator::step_from(const Exact& one, const Exact& two, const Exact& four,
                                   double d) const {
  const int n = n_states(), n_watched = static_cast<int>(block_.watched.size());
  PacketMatrix equations_of_watched(n_watched, n + n_inputs());
  for (int c = 0; c < n + n_inputs(); ++c) {
    for (int w = 0; w < n_watched; ++w) {
      equations_of_watched(w, c) = equations_(block_.watched[w], c);
    }
  }

  // First what derivatives of inputs do.
  const Exact three = sum_of(two, 2 * d, one);
  PacketMatrix watched(input_degree * n_watched, columns_), rates = watched;
  int k = 0;
  for (const Exact* to_node : {&one, &two, &three, &four}) {
    PacketMatrix rates_at_node = equations_of_watched.product(n, *to_node);
    rates_at_node.add_columns(0, n, 1.0, equations_of_watched, 0);
    for (int w = 0; w < n_watched; ++w) watched(input_degree * w + k, block_.watched[w]) = 1.0;
    for (int c = 0; c < columns_; ++c) {
      const double *x = &(*to_node)(0, c), *rate = &rates_at_node(0, c);
      double *to_watched = &watched(k, c), *to_rates = &rates(k, c);
      for (int w = 0; w < n_watched; ++w) {
        to_watched[input_degree * w] += x[block_.watched[w]];
        to_rates[input_degree * w] = rate[w];
      }
    }
    ++k;
  }
  StepMatrices step = {.watched = for_nodes(watched, d),
                       .rates = for_nodes(rates, d),
                       .end = for_nodes(four, d),
                       .gains = {}};
  for (int s = 0; s < n; ++s) step.end(s, s) += 1.0;
  for (const Kind& kind : inputs_) {
    for (int node = 1; node < n_nodes; ++node) {
      const int column = kind.n_orders > 1 ? kind.column(node) : kind.first_column;
      for (int i = 0; i < kind.count; ++i) {
        for (int w = 0; w < n_watched; ++w) {
          step.rates(input_degree * w + node - 1, column + i) +=
              equations_of_watched(w, n + kind.first + i);
        }
      }
    }
  }
  const auto& [constants, forcing, remainder] = inputs_;
  step.gains.setZero(most_states, forcing.count + remainder.count);
  for (const Kind& kind : {forcing, remainder}) {
    for (int i = 0; i < kind.count; ++i) {
      for (int s = 0; s < n; ++s) {
        step.gains(s, kind.first + i - constants.count) = std::abs(four(s, kind.first_column + i));
      }
    }
  }
  return step;
}

// --- sharing -------------------------------------------------------------------------------------

namespace {

// Enough for a robot in all its modes, several times: about 25 MB.
constexpr std::size_t most_kept = 256;

std::size_t hash_of(const MatrixXd& matrix) {
  const std::span entries(matrix.data(), matrix.size());
  const auto bytes = std::as_bytes(entries);
  return std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

struct Hash {
  std::size_t operator()(const hybrid::LinearBlock& block) const {
    return hash_of(block.L) + 31 * hash_of(block.B);
  }
};
struct Equal {
  bool operator()(const hybrid::LinearBlock& a, const hybrid::LinearBlock& b) const {
    return a.watched == b.watched && a.n_constants == b.n_constants && a.n_forcing == b.n_forcing &&
           a.n_remainder == b.n_remainder && a.L.rows() == b.L.rows() && a.L == b.L && a.B == b.B;
  }
};

std::mutex using_kept;
std::unordered_map<hybrid::LinearBlock, std::shared_ptr<const Propagator>, Hash, Equal> kept;

}  // namespace

std::shared_ptr<const Propagator> propagator_of(const hybrid::LinearBlock& block) {
  {
    const std::lock_guard lock(using_kept);
    if (const auto found = kept.find(block); found != kept.end()) return found->second;
  }
  const auto made = std::make_shared<const Propagator>(block);
  const std::lock_guard lock(using_kept);
  if (kept.size() == most_kept) kept.clear();
  return kept.try_emplace(block, made).first->second;  // unless somebody else was faster
}

void forget_propagators() {
  const std::lock_guard lock(using_kept);
  kept.clear();
}

}  // namespace manutec_r3::solver
