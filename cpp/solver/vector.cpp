#include "solver/vector.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <new>

namespace manutec_r3::solver {
namespace {

template <int n>
using Block = Eigen::Array<double, n, 1>;
template <int n>
using View = Eigen::Map<const Block<n>>;

// Stages of a step and its beginning, or a history of BDF: more than either has.
constexpr int most_terms = 16;

// --- operations of an N_Vector ------------------------------------------------------------------

SUNErrCode linear_combination(int n, double* factors, N_Vector* x, N_Vector z) {
  if (n > most_terms) return N_VLinearCombination_Serial(n, factors, x, z);
  std::array<Term, most_terms> terms;
  int count = 0;
  for (int k = 0; k < n; ++k) {
    // Tables of Runge-Kutta methods have many zeros.
    if (factors[k] != 0.0 || k == n - 1) terms[count++] = {factors[k], NV_DATA_S(x[k])};
  }
  combine(std::span(terms).first(count), NV_LENGTH_S(z), NV_DATA_S(z));
  return SUN_SUCCESS;
}

void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  combine(std::array{Term{a, NV_DATA_S(x)}, Term{b, NV_DATA_S(y)}}, NV_LENGTH_S(z), NV_DATA_S(z));
}

void scale(double factor, N_Vector x, N_Vector z) {
  combine(std::array{Term{factor, NV_DATA_S(x)}}, NV_LENGTH_S(z), NV_DATA_S(z));
}

void absolute_values(N_Vector x, N_Vector z) {
  in_blocks(NV_LENGTH_S(z), [x = NV_DATA_S(x), z = NV_DATA_S(z)]<int n>(int first) {
    Eigen::Map<Block<n>>(z + first) = View<n>(x + first).abs();
  });
}

// sqrt(1/n sum_i (x_i w_i)^2), in six sums
double weighted_rms_norm(N_Vector x, N_Vector w) {
  constexpr int width = 6;
  const int n = NV_LENGTH_S(x);
  Block<width> sums = Block<width>::Zero();
  int first = 0;
  for (; first + width <= n; first += width) {
    sums += (View<width>(NV_DATA_S(x) + first) * View<width>(NV_DATA_S(w) + first)).square();
  }
  double sum = 0.0;
  for (; first < n; ++first) sum += std::pow(NV_DATA_S(x)[first] * NV_DATA_S(w)[first], 2);
  for (const double part : sums) sum += part;
  return std::sqrt(sum / n);
}

}  // namespace

void combine(std::span<const Term> terms, int size, double* z) {
  in_blocks(size, [terms, z]<int n>(int first) {
    Block<n> sum = terms.front().factor * View<n>(terms.front().x + first);
    for (const Term& term : terms.subspan(1)) sum += term.factor * View<n>(term.x + first);
    Eigen::Map<Block<n>>(z + first) = sum;
  });
}

Vector::Vector(int size, SUNContext context) : vector_(N_VNew_Serial(size, context)) {
  if (vector_ == nullptr) throw std::bad_alloc();
  // Copies that SUNDIALS makes of it inherit them.
  vector_->ops->nvlinearcombination = linear_combination;
  vector_->ops->nvlinearsum = linear_sum;
  vector_->ops->nvscale = scale;
  vector_->ops->nvabs = absolute_values;
  vector_->ops->nvwrmsnorm = weighted_rms_norm;
}

}  // namespace manutec_r3::solver
