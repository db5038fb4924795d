// Dry friction NL3 on the rotor (spec 5.1; report Figures 5 and 6, Table 2):
//
//   sliding    rM = sign(rq') f(|rq'|),  f through the points of Table 2
//   sticking   rM is whatever keeps rq'' = 0, as long as |rM| <= rM_h
//
// A branch is -1 sliding backward, 0 sticking, +1 sliding forward. A piece is a segment of f.
#pragma once

#include <limits>

#include "drive/line.hpp"
#include "drive/parameters.hpp"

namespace manutec_r3::drive {

struct Friction {
  double sticking_limit;  // rM_h [N m]
  FrictionPoints points;

  // Sliding friction right after break-away, rM_1.
  double lowest_torque() const { return points.front().torque; }

  // The piece of f for a rate of this magnitude.
  int piece_at(double magnitude) const {
    int piece = 0;
    while (magnitude >= upper_end(piece)) ++piece;
    return piece;
  }
  // The rates between which a piece holds; the last one has no upper end, the first one no lower.
  double upper_end(int piece) const {
    return piece + 2 < static_cast<int>(points.size()) ? points[piece + 1].rate
                                                       : std::numeric_limits<double>::infinity();
  }
  double lower_end(int piece) const {
    return piece > 0 ? points[piece].rate : -std::numeric_limits<double>::infinity();
  }

  // rM from rq' while sliding; zero while sticking, when rM follows from the motion.
  template <int N>
  void set(Line<N>& torque, int axis, int branch, int piece) const {
    if (branch == 0) return torque.set(axis, 0.0, 0.0);
    const FrictionPoint& a = points[piece];
    const FrictionPoint& b = points[piece + 1];
    const double slope = (b.torque - a.torque) / (b.rate - a.rate);
    torque.set(axis, slope, branch * (a.torque - slope * a.rate));
  }
};

}  // namespace manutec_r3::drive
