// The distribution of mass in a rigid body by its moments about the origin of the body's frame:
//
//   m = integral dm,   h = integral r dm = m c,   J = integral r r^T dm.
//
// The tensor of inertia is I = trace(J) 1 - J. The second moment J is kept instead, because moments
// add, turn and shift with less work, and give the wrench of an accelerated body at once (spec 6).
#pragma once

#include <array>

#include "arm/parameters.hpp"
#include "arm/triple.hpp"
#include "arm/vector.hpp"

namespace manutec_r3::arm {

template <class Number>
struct SymmetricTensorOf {
  Number xx, yy, zz, xy, xz, yz;
};

// The mass is the same in all directions and at all times: a plain number.
template <class Number>
struct MomentsOf {
  double m;
  TripleOf<Number> h;
  SymmetricTensorOf<Number> J;

  // The same as numbers of another kind.
  template <class Other>
  operator MomentsOf<Other>() const {
    return {m, {h.x, h.y, h.z}, {J.xx, J.yy, J.zz, J.xy, J.xz, J.yz}};
  }
  MomentsOf& operator+=(const MomentsOf& other) { return *this = *this + other; }
};

template <class A, class B>
MomentsOf<Sum<A, B>> operator+(const MomentsOf<A>& a, const MomentsOf<B>& b) {
  return {a.m + b.m,
          a.h + b.h,
          {a.J.xx + b.J.xx, a.J.yy + b.J.yy, a.J.zz + b.J.zz, a.J.xy + b.J.xy, a.J.xz + b.J.xz,
           a.J.yz + b.J.yz}};
}

using SymmetricTensor = SymmetricTensorOf<double>;
using Moments = MomentsOf<double>;

Moments moments(const Body& body);

Moments point_mass(double mass, const std::array<double, 3>& position);

// I = trace(J) 1 - J, about the origin.
Matrix<3> inertia(const Moments& body);

}  // namespace manutec_r3::arm
