// One number for each of N axes: the drives of all axes have the same equations and are evaluated
// together.
#pragma once

#include <Eigen/Core>
#include <array>

namespace manutec_r3::drive {

template <int N>
using PerAxis = Eigen::Array<double, N, 1>;

template <int N>
using ConstView = Eigen::Map<const PerAxis<N>>;

template <int N>
using View = Eigen::Map<PerAxis<N>>;

// The first N entries of a table of six.
template <int N>
PerAxis<N> first(const std::array<double, 6>& table) {
  return ConstView<N>(table.data());
}

}  // namespace manutec_r3::drive
