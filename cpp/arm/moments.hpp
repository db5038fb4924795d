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

struct SymmetricTensor {
  double xx, yy, zz, xy, xz, yz;
};

struct Moments {
  double m;
  Triple h;
  SymmetricTensor J;

  friend Moments operator+(const Moments& a, const Moments& b) {
    return {a.m + b.m,
            a.h + b.h,
            {a.J.xx + b.J.xx, a.J.yy + b.J.yy, a.J.zz + b.J.zz, a.J.xy + b.J.xy, a.J.xz + b.J.xz,
             a.J.yz + b.J.yz}};
  }
  Moments& operator+=(const Moments& other) { return *this = *this + other; }
};

Moments moments(const Body& body);

Moments point_mass(double mass, const std::array<double, 3>& position);

// I = trace(J) 1 - J, about the origin.
Matrix<3> inertia(const Moments& body);

}  // namespace manutec_r3::arm
