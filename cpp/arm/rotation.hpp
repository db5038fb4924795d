// Rotations about the joint axes, and cross products, as matrices (spec 2).
#pragma once

#include <cmath>

#include "arm/parameters.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

// Where a vector of Eigen keeps its component along an axis: v[component(axis)].
constexpr int component(Axis axis) { return static_cast<int>(axis); }

template <class Number = double>
Vector<3, Number> unit(Axis axis) {
  return Vector<3, Number>::Unit(component(axis));
}

// Of arm j in the frame of arm j-1, about x or z; a positive angle turns by the right-hand rule.
template <class Number>
Matrix<3, Number> rotation(Axis axis, const Number& angle) {
  using std::cos, std::sin;
  const Number c = cos(angle), s = sin(angle);
  Matrix<3, Number> R;
  if (axis == Axis::x) {
    R << 1, 0, 0, 0, c, -s, 0, s, c;
  } else {
    R << c, -s, 0, s, c, 0, 0, 0, 1;
  }
  return R;
}

// [v]x, so that [v]x u = v x u.
inline Matrix<3> cross_matrix(const Vector<3>& v) {
  Matrix<3> V;
  V << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return V;
}

}  // namespace manutec_r3::arm
