#include "motion/spline.hpp"

namespace manutec_r3::motion {

std::vector<double> slopes_of_spline(std::span<const double> times,
                                     std::span<const double> values) {
  const std::size_t n = times.size();
  std::vector<double> slope(n, 0.0), upper(n, 0.0);
  // The matrix is tridiagonal and diagonally dominant: elimination needs no pivots.
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double before = 1.0 / (times[k] - times[k - 1]);
    const double after = 1.0 / (times[k + 1] - times[k]);
    const double right = 3.0 * (before * before * (values[k] - values[k - 1]) +
                                after * after * (values[k + 1] - values[k]));
    const double pivot = 2.0 * (before + after) - before * upper[k - 1];
    upper[k] = after / pivot;
    slope[k] = (right - before * slope[k - 1]) / pivot;
  }
  for (std::size_t k = n - 1; k-- > 1;) slope[k] -= upper[k] * slope[k + 1];
  return slope;
}

}  // namespace manutec_r3::motion
