// One number for each of N axes: the drives of all axes have the same equations and are evaluated
// together. They are doubles, or of another kind: four abreast (numbers/abreast.hpp).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace manutec_r3::drive {

template <int N, class Number = double>
using PerAxis = Eigen::Array<Number, N, 1>;

template <int N, class Number = double>
using ConstView = Eigen::Map<const PerAxis<N, Number>>;

template <int N, class Number = double>
using View = Eigen::Map<PerAxis<N, Number>>;

// The first N entries of a row.
template <int N, std::size_t n>
PerAxis<N> first(const std::array<double, n>& row) {
  static_assert(N <= static_cast<int>(n));
  return ConstView<N>(row.data());
}

}  // namespace manutec_r3::drive
