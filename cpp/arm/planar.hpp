// What the frames of neighbouring arms say to each other, at the price of plane rotations.
//
// Joint j turns arm j about the x or z axis of arm j-1 (spec 2, spec 3): a vector changes in two
// components only. Which two is known at compile time, and so is where joints are displaced, and
// how rotors lie, if the layout is the report's.
#pragma once

#include "arm/moments.hpp"
#include "arm/parameters.hpp"
#include "arm/triple.hpp"

namespace manutec_r3::arm {

// Cosine and sine of a joint angle.
template <class Number>
struct Turn {
  Number c, s;
};

enum class Layout {
  report,    // joints 3 and 5 are displaced, along z; rotors as in `rotor_axes_of_report`
  anything,  // each joint in every direction, rotors along any axis
};

constexpr bool is_displaced_in_report(int j) { return j == 2 || j == 4; }

// Torque about the origin of an arm's frame, and force.
template <class Number>
struct Wrench {
  TripleOf<Number> torque, force;

  friend Wrench operator+(const Wrench& a, const Wrench& b) {
    return {a.torque + b.torque, a.force + b.force};
  }
};

// Angular velocity and acceleration of an arm, and the acceleration of its origin.
template <class Number>
struct ArmMotion {
  TripleOf<Number> w, wd, a;
};

// Components (u, v) of arm j -> components of arm j-1.
template <class Number>
void rotate(const Turn<Number>& turn, Number& u, Number& v) {
  const Number u_j = u;
  u = turn.c * u_j - turn.s * v;
  v = turn.s * u_j + turn.c * v;
}

// Components of arm j-1 -> components (u, v) of arm j.
template <class Number>
void rotate_back(const Turn<Number>& turn, Number& u, Number& v) {
  const Number u_j_1 = u;
  u = turn.c * u_j_1 + turn.s * v;
  v = turn.c * v - turn.s * u_j_1;
}

// The part of a tensor in the plane of rotation; it is rotated from both sides.
template <class Number>
void rotate(const Turn<Number>& turn, Number& uu, Number& vv, Number& uv) {
  const Number t = turn.s * (uu - vv) + 2 * turn.c * uv;
  uu -= turn.s * t;
  vv += turn.s * t;
  uv = turn.c * t - uv;
}

// From the directions of arm j to those of arm j-1, about the same point.
template <int j, class Number>
TripleOf<Number> rotated(const Turn<Number>& turn, TripleOf<Number> v) {
  if constexpr (joint_axes[j] == Axis::x) {
    rotate(turn, v.y, v.z);
  } else {
    rotate(turn, v.x, v.y);
  }
  return v;
}

// From the directions of arm j-1 to those of arm j.
template <int j, class Number>
TripleOf<Number> rotated_back(const Turn<Number>& turn, TripleOf<Number> v) {
  if constexpr (joint_axes[j] == Axis::x) {
    rotate_back(turn, v.y, v.z);
  } else {
    rotate_back(turn, v.x, v.y);
  }
  return v;
}

template <int j, class Number>
Wrench<Number> rotated(const Turn<Number>& turn, const Wrench<Number>& wrench) {
  return {rotated<j>(turn, wrench.torque), rotated<j>(turn, wrench.force)};
}

template <int j, class Number>
MomentsOf<Number> rotated(const Turn<Number>& turn, MomentsOf<Number> body) {
  body.h = rotated<j>(turn, body.h);
  auto& J = body.J;
  if constexpr (joint_axes[j] == Axis::x) {
    rotate(turn, J.xy, J.xz);
    rotate(turn, J.yy, J.zz, J.yz);
  } else {
    rotate(turn, J.xz, J.yz);
    rotate(turn, J.xx, J.yy, J.xy);
  }
  return body;
}

// What is known about the origin of arm j becomes known about the origin of arm j-1, r below it:
// r -> r' + r in h = integral r' dm and J = integral r' r'^T dm.
template <int j, Layout layout, class Number>
void shift(const Triple& r, MomentsOf<Number>& body) {
  auto& [m, h, J] = body;
  if constexpr (layout == Layout::report) {
    if constexpr (is_displaced_in_report(j)) {
      J.xz += r.z * h.x;
      J.yz += r.z * h.y;
      J.zz += r.z * (2 * h.z + r.z * m);
      h.z += r.z * m;
    }
  } else {
    const TripleOf<Number> middle = h + (0.5 * m) * r;
    J.xx += 2 * r.x * middle.x;
    J.yy += 2 * r.y * middle.y;
    J.zz += 2 * r.z * middle.z;
    J.xy += r.x * middle.y + r.y * middle.x;
    J.xz += r.x * middle.z + r.z * middle.x;
    J.yz += r.y * middle.z + r.z * middle.y;
    h += m * r;
  }
}

template <int j, Layout layout, class Number>
void shift(const Triple& r, Wrench<Number>& wrench) {
  if constexpr (layout == Layout::report) {
    if constexpr (is_displaced_in_report(j)) {
      wrench.torque.x -= r.z * wrench.force.y;
      wrench.torque.y += r.z * wrench.force.x;
    }
  } else {
    wrench.torque += cross(r, wrench.force);
  }
}

}  // namespace manutec_r3::arm
