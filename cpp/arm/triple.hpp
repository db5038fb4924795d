// Three components as plain numbers: vectors of the recursion that the simulator lives in
// (composite.hpp).
//
// Eigen takes the components of its vectors in pairs. The recursion writes and reads them one by
// one, mostly two of the three, and would wait for memory at every change of hands: plain numbers
// make it one and a half times as fast.
//
// The numbers are doubles, or of another kind: four abreast (numbers/abreast.hpp).
#pragma once

#include "arm/parameters.hpp"

namespace manutec_r3::arm {

template <class Number>
struct TripleOf {
  Number x, y, z;

  template <class Other>
  TripleOf& operator+=(const TripleOf<Other>& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
};

using Triple = TripleOf<double>;

// Of two kinds of numbers, such as a constant and what it meets.
template <class A, class B>
using Sum = decltype(A() + B());

template <class A, class B>
TripleOf<Sum<A, B>> operator+(const TripleOf<A>& a, const TripleOf<B>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class S, class A>
TripleOf<Sum<S, A>> operator*(const S& s, const TripleOf<A>& a) {
  return {s * a.x, s * a.y, s * a.z};
}

template <class A, class B>
TripleOf<Sum<A, B>> cross(const TripleOf<A>& a, const TripleOf<B>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class A, class B>
Sum<A, B> dot(const TripleOf<A>& a, const TripleOf<B>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

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
template <Axis axis, class S, class Number>
void add_cross_unit(const S& s, const TripleOf<Number>& a, TripleOf<Number>& sum) {
  if constexpr (axis == Axis::x) {
    sum.y += s * a.z;
    sum.z -= s * a.y;
  } else {
    sum.x += s * a.y;
    sum.y -= s * a.x;
  }
}

}  // namespace manutec_r3::arm
