// The polynomial of degree 2n - 1 through a function and its rates at n instants:
//
//   x(t) = sum_k value_k x(t_k) + rate_k x'(t_k),
//   value_k = (1 - 2 (t - t_k) sum_j 1/(t_k - t_j)) L_k^2,   rate_k = (t - t_k) L_k^2
//
// with Lagrange's polynomials L_k = prod_j (t - t_j)/(t_k - t_j), j other than k.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace manutec_r3::solver {

template <std::size_t n>
struct HermiteWeights {
  std::array<double, n> value{}, rate{};  // zero beyond the instants that there are

  HermiteWeights(std::span<const double> instants, double t) {
    for (std::size_t k = 0; k < instants.size(); ++k) {
      double lagrange = 1.0, slope = 0.0;
      for (std::size_t j = 0; j < instants.size(); ++j) {
        if (j == k) continue;
        const double inverse = 1.0 / (instants[k] - instants[j]);
        lagrange *= (t - instants[j]) * inverse;
        slope += inverse;
      }
      const double distance = t - instants[k];
      value[k] = (1.0 - 2.0 * distance * slope) * lagrange * lagrange;
      rate[k] = distance * lagrange * lagrange;
    }
  }

  // By how much roundoff of the values may be enlarged.
  double largest() const {
    const auto [least, most] = std::ranges::minmax(value);
    return std::max(-least, most);
  }
};

}  // namespace manutec_r3::solver
