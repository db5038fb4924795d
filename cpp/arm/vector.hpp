// Vectors and matrices of fixed size: three components of space, or one for each axis.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

namespace manutec_r3::arm {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;

template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

}  // namespace manutec_r3::arm
