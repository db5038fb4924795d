// What is frozen between the events of a robot, by name: its branches and held values in a mode of
// the hybrid system.
#pragma once

#include <cstdint>
#include <span>

#include "drive/per_axis.hpp"
#include "hybrid/system.hpp"
#include "robot/elements.hpp"

namespace manutec_r3::robot {

template <int N>
class Mode {
 public:
  // For each axis those that users see (ElementKind), and these:
  enum Row {
    friction_piece = n_axis_elements,  // of the friction characteristic
    creep,                             // 1: the rotor has broken away, its creep is watched
    brake,                             // 1: the brake is on
    inertia,                           // of the axis, nearly: see linear_drives.hpp
    n_rows
  };
  // For the whole robot:
  enum Counter {
    motion_piece = n_rows * N,
    input_piece,  // of motor torques or commands as functions of time
    force_piece,  // of a force on the tip as a function of time
    sample_count,
    n_branches
  };

  Mode() {
    frozen_.branches.assign(n_branches, 0);
    frozen_.held.assign(n_held, 0.0);
  }

  const hybrid::Mode& frozen() const { return frozen_; }
  void set_frozen(const hybrid::Mode& frozen) { frozen_ = frozen; }

  int branch(int row, int axis) const { return frozen_.branches[row * N + axis]; }
  void set(int row, int axis, int branch) { frozen_.branches[row * N + axis] = branch; }

  int counter(Counter which) const { return frozen_.branches[which]; }
  void set_counter(Counter which, int value) { frozen_.branches[which] = value; }

  // u_c [V], or motor torques [N m] without a controller.
  drive::View<N> input() { return drive::View<N>(frozen_.held.data()); }
  std::span<const double> input() const { return std::span(frozen_.held).first(N); }
  // Where springs that hold sticking axes are at rest, rq_stick [rad].
  drive::View<N> spring_rest() { return drive::View<N>(frozen_.held.data() + N); }
  // In the world [N].
  drive::View<3> tip_force() { return drive::View<3>(frozen_.held.data() + 2 * N); }
  std::span<const double> tip_force() const { return std::span(frozen_.held).last(3); }

 private:
  static constexpr int n_held = 2 * N + 3;

  hybrid::Mode frozen_;
};

}  // namespace manutec_r3::robot
