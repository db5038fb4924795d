// Cubic splines.
#pragma once

#include <span>
#include <vector>

namespace manutec_r3::motion {

// The slopes at its knots of the cubic spline through `values` that has a continuous second
// derivative and zero slope at both ends:
//
//   s_k-1 / h_k-1 + 2 (1 / h_k-1 + 1 / h_k) s_k + s_k+1 / h_k
//       = 3 ((y_k - y_k-1) / h_k-1^2 + (y_k+1 - y_k) / h_k^2),   h_k = t_k+1 - t_k
std::vector<double> slopes_of_spline(std::span<const double> times, std::span<const double> values);

}  // namespace manutec_r3::motion
