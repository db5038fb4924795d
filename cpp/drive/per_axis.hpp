// One number for each of N axes: the drives of all axes have the same equations and are evaluated
// together.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace manutec_r3::drive {

template <int N>
using PerAxis = Eigen::Array<double, N, 1>;

template <int N>
using ConstView = Eigen::Map<const PerAxis<N>>;

template <int N>
using View = Eigen::Map<PerAxis<N>>;

// The first N entries of a row.
template <int N, std::size_t n>
PerAxis<N> first(const std::array<double, n>& row) {
  static_assert(N <= static_cast<int>(n));
  return ConstView<N>(row.data());
}

}  // namespace manutec_r3::drive
