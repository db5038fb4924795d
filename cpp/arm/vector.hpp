// Vectors and matrices of fixed size: three components of space, or one for each axis.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

#include "arm/triple.hpp"

namespace manutec_r3::arm {

template <int N>
using Vector = Eigen::Matrix<double, N, 1>;

template <int N>
using Matrix = Eigen::Matrix<double, N, N>;

// A vector that somebody else keeps, such as a part of a state: it is not copied.
template <int N>
using VectorView = Eigen::Ref<const Vector<N>>;

inline Vector<3> as_vector(const Triple& v) { return {v.x, v.y, v.z}; }

}  // namespace manutec_r3::arm
