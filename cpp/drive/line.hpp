// Piecewise linear elements on one of their pieces, y = gain x + offset, for each axis.
//
// A branch is -1, 0 or +1: below, inside or above the zone between -half_width and +half_width.
#pragma once

#include "drive/per_axis.hpp"

namespace manutec_r3::drive {

template <int N>
struct Line {
  PerAxis<N> gain = PerAxis<N>::Zero();
  PerAxis<N> offset = PerAxis<N>::Zero();

  template <class Value>
  PerAxis<N, typename Value::Scalar> operator()(const Value& x) const {
    return gain * x + offset;
  }

  void set(int axis, double new_gain, double new_offset) {
    gain[axis] = new_gain;
    offset[axis] = new_offset;
  }
  // NL1, NL4: zero inside the zone, the distance from its edge outside. Without a zone it is the
  // value itself.
  void set_dead_zone(int axis, int branch, double half_width) {
    const bool inside = branch == 0 && half_width > 0.0;
    set(axis, inside ? 0.0 : 1.0, -branch * half_width);
  }
  // NL2: the value inside the zone, its edge outside.
  void set_saturation(int axis, int branch, double half_width) {
    set(axis, branch == 0 ? 1.0 : 0.0, branch * half_width);
  }
};

}  // namespace manutec_r3::drive
