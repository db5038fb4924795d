// Three components as plain numbers: vectors of the recursion that the simulator lives in
// (composite.hpp).
//
// Eigen takes the components of its vectors in pairs. The recursion writes and reads them one by
// one, mostly two of the three, and would wait for memory at every change of hands: plain numbers
// make it one and a half times as fast.
#pragma once

#include "arm/parameters.hpp"

namespace manutec_r3::arm {

struct Triple {
  double x, y, z;

  Triple& operator+=(const Triple& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
};

inline Triple operator+(const Triple& a, const Triple& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

inline Triple operator*(double s, const Triple& a) { return {s * a.x, s * a.y, s * a.z}; }

inline Triple cross(const Triple& a, const Triple& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline double dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Component along x or z; of a constant triple, too.
template <Axis axis, class AnyTriple>
auto& along(AnyTriple& a) {
  if constexpr (axis == Axis::x) {
    return a.x;
  } else {
    return a.z;
  }
}

// Adds s (a x e), where e is the unit vector of x or z.
template <Axis axis>
void add_cross_unit(double s, const Triple& a, Triple& sum) {
  if constexpr (axis == Axis::x) {
    sum.y += s * a.z;
    sum.z -= s * a.y;
  } else {
    sum.x += s * a.y;
    sum.y -= s * a.x;
  }
}

}  // namespace manutec_r3::arm
