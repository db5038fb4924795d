// What the frames of neighbouring arms say to each other, at the price of plane rotations.
//
// Joint j turns arm j about the x or z axis of arm j-1, and its offset, if any, points along z
// (spec 2, spec 3): a vector changes in two components only. Which two is known at compile time.
#pragma once

#include <cmath>

#include "arm/moments.hpp"
#include "arm/parameters.hpp"
#include "arm/triple.hpp"

namespace manutec_r3::arm {

// Cosine and sine of a joint angle.
struct Turn {
  double c, s;

  Turn inverse() const { return {c, -s}; }
};

inline Turn turn(double angle) { return {std::cos(angle), std::sin(angle)}; }

// How far joint j is above the origin of arm j-1.
template <int j>
constexpr double height() {
  static_assert(six_arms[j].offset[0] == 0 && six_arms[j].offset[1] == 0);
  return six_arms[j].offset[2];
}

// Torque about the origin of an arm's frame, and force.
struct Wrench {
  Triple torque, force;

  Wrench& operator+=(const Wrench& other) {
    torque += other.torque;
    force += other.force;
    return *this;
  }
};

// Angular velocity and acceleration of an arm, and the acceleration of its origin.
struct ArmMotion {
  Triple w, wd, a;
};

// Components (u, v) of arm j -> components of arm j-1.
inline void rotate(const Turn& turn, double& u, double& v) {
  const double u_j = u;
  u = turn.c * u_j - turn.s * v;
  v = turn.s * u_j + turn.c * v;
}

// The part of a tensor in the plane of rotation; it is rotated from both sides.
inline void rotate(const Turn& turn, double& uu, double& vv, double& uv) {
  const double t = turn.s * (uu - vv) + 2 * turn.c * uv;
  uu -= turn.s * t;
  vv += turn.s * t;
  uv = turn.c * t - uv;
}

// From arm j to arm j-1, about the same point.
template <int j>
Triple rotated(const Turn& turn, Triple v) {
  if constexpr (six_arms[j].axis == Axis::x) {
    rotate(turn, v.y, v.z);
  } else {
    rotate(turn, v.x, v.y);
  }
  return v;
}

template <int j>
Moments seen_from_inner_arm(const Turn& turn, const Moments& outer) {
  Moments inner = outer;
  inner.h = rotated<j>(turn, outer.h);
  SymmetricTensor& J = inner.J;
  if constexpr (six_arms[j].axis == Axis::x) {
    rotate(turn, J.xy, J.xz);
    rotate(turn, J.yy, J.zz, J.yz);
  } else {
    rotate(turn, J.xz, J.yz);
    rotate(turn, J.xx, J.yy, J.xy);
  }
  // r -> r + l e_z in h = integral r dm and J = integral r r^T dm.
  if constexpr (constexpr double l = height<j>(); l != 0) {
    J.xz += l * inner.h.x;
    J.yz += l * inner.h.y;
    J.zz += l * (2 * inner.h.z + l * inner.m);
    inner.h.z += l * inner.m;
  }
  return inner;
}

template <int j>
Wrench seen_from_inner_arm(const Turn& turn, const Wrench& outer) {
  Wrench inner = {rotated<j>(turn, outer.torque), rotated<j>(turn, outer.force)};
  if constexpr (constexpr double l = height<j>(); l != 0) {
    inner.torque.x -= l * inner.force.y;
    inner.torque.y += l * inner.force.x;
  }
  return inner;
}

}  // namespace manutec_r3::arm
