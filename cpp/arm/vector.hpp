// Vectors and matrices of fixed size: three components of space, or one for each axis; of doubles,
// or of another kind of number (numbers/).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products

#include "arm/triple.hpp"

namespace manutec_r3::arm {

template <int N, class Number = double>
using Vector = Eigen::Matrix<Number, N, 1>;

template <int N, class Number = double>
using Matrix = Eigen::Matrix<Number, N, N>;

// A vector that somebody else keeps, such as a part of a state: it is not copied.
template <int N, class Number = double>
using VectorView = Eigen::Ref<const Vector<N, Number>>;

template <class Number = double>
Vector<3, Number> as_vector(const Triple& v) {
  return {v.x, v.y, v.z};
}

}  // namespace manutec_r3::arm
