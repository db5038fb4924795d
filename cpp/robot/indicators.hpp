// The indicators of a robot: on frozen branches each is a line in a value that it watches,
//
//   z = gain value + offset,
//
// two of them for every axis and row, one beside the other: a robot in the mirror has the same
// order. One that means nothing in the present branches, or on this robot, is the constant 1.
#pragma once

#include <array>

#include "drive/per_axis.hpp"

namespace manutec_r3::robot {

template <int N>
class Indicators {
 public:
  // What they watch:
  enum Row {
    of_dead_zone,       // U
    of_torque_limit,    // m, before NL2
    of_backlash,        // delta
    of_friction,        // rq', while sticking the friction that holds
    of_friction_piece,  // rq'
    of_creep,           // rq'
    of_voltage_limit,   // U, at its limit what drives it
    n_rows
  };
  template <class Number>
  using WatchedOf = std::array<drive::PerAxis<N, Number>, n_rows>;

  enum Edge { upper, lower, n_edges };

  // The last rows are there if options need them.
  Indicators(bool watches_creep, bool limits_voltage)
      : n_rows_(limits_voltage  ? n_rows
                : watches_creep ? of_voltage_limit
                                : of_creep) {
    clear();
  }

  int size() const { return n_rows_ * n_edges * N; }

  struct Place {
    Row row;
    Edge edge;
    int axis;
  };
  static Place place(int indicator) {
    return {static_cast<Row>(indicator / n_edges / N), static_cast<Edge>(indicator % n_edges),
            indicator / n_edges % N};
  }

  // None means anything.
  void clear() {
    gain_.fill(Pairs::Zero());
    offset_.fill(Pairs::Ones());
  }
  void set(Row row, Edge edge, int axis, double gain, double offset) {
    gain_[row](edge, axis) = gain;
    offset_[row](edge, axis) = offset;
  }
  // Of a value on a branch of a zone: in the zone its two edges, outside the edge that leads back.
  void set_zone(Row row, int axis, int branch, double half_width) {
    if (branch == 0) {
      set(row, upper, axis, -1.0, half_width);
      set(row, lower, axis, +1.0, half_width);
    } else {
      set(row, upper, axis, branch, -half_width);
    }
  }

  template <class Number>
  void evaluate(const WatchedOf<Number>& values, Number* z) const {
    for (int row = 0; row < n_rows_; ++row) {
      for (int axis = 0; axis < N; ++axis) {
        const Number& value = values[row][axis];
        for (int edge = 0; edge < n_edges; ++edge) {
          *z++ = gain_[row](edge, axis) * value + offset_[row](edge, axis);
        }
      }
    }
  }
  template <class Number>
  void evaluate_rates(const WatchedOf<Number>& value_rates, Number* rates) const {
    for (int row = 0; row < n_rows_; ++row) {
      for (int axis = 0; axis < N; ++axis) {
        const Number& rate = value_rates[row][axis];
        for (int edge = 0; edge < n_edges; ++edge) *rates++ = gain_[row](edge, axis) * rate;
      }
    }
  }

 private:
  using Pairs = Eigen::Array<double, n_edges, N>;

  int n_rows_;
  std::array<Pairs, n_rows> gain_, offset_;
};

}  // namespace manutec_r3::robot
