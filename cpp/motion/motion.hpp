// Reference motions: joint angles as polynomials of time, piece by piece.
//
// Between its knots a motion is smooth; each knot is a time event. A simulation freezes the piece
// it is in, so that the equations stay smooth a little beyond the knot.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace manutec_r3::motion {

struct Reference {
  double angle;         // [rad], joint side
  double rate;          // [rad/s]
  double acceleration;  // [rad/s^2]
};

// One polynomial per axis in the normalised time x = (t - begin) / length of the piece,
// coefficients from x^0 to x^5: high powers of short times would lose digits.
struct Piece {
  double begin;   // [s]
  double length;  // [s], 1 for the last piece, which has no end
  std::vector<std::array<double, 6>> coefficients;
};

class Motion {
 public:
  // Pieces in the order of time. Before the first the motion rests at `start`.
  Motion(std::vector<double> start, std::vector<Piece> pieces);

  int n_axes() const { return static_cast<int>(start_.size()); }
  // Instants [s] at which the motion is not smooth.
  std::span<const double> knots() const { return knots_; }
  // When the motion has come to rest for good [s].
  double duration() const { return knots_.empty() ? 0.0 : knots_.back(); }

  // Whether an axis stays exactly at zero for ever.
  bool rests_at_zero(int axis) const;

  // The piece that holds at t and right after it; -1 before the first.
  int piece_at(double t) const;
  // When a piece ends; infinity for the last.
  double end_of(int piece) const;
  Reference reference(int piece, double t, int axis) const;

 private:
  std::vector<double> start_;
  std::vector<Piece> pieces_;
  std::vector<double> knots_;
};

// Rest to rest with zero acceleration at both ends: 10 x^3 - 15 x^4 + 6 x^5 of the way. Angles in
// rad, duration in s. These and the following throw std::invalid_argument.
Motion quintic(std::span<const double> start, std::span<const double> end, double duration);

// A synchronised trapezoid: constant acceleration, constant rate, constant deceleration of one path
// parameter; triangular if the largest rate [rad/s] is not reached within the largest acceleration
// [rad/s^2].
Motion trapezoid(std::span<const double> start, std::span<const double> end,
                 std::span<const double> rate, std::span<const double> acceleration);

// Stays at the angles [rad].
Motion hold(std::span<const double> angles);

}  // namespace manutec_r3::motion
