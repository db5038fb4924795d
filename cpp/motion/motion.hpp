// Reference motions: joint angles as functions of time, piece by piece.
//
// Between its knots a motion is smooth; each knot is a time event. A simulation freezes the piece
// it is in, so that the equations stay smooth a little beyond the knot.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace manutec_r3::motion {

inline constexpr std::size_t most_axes = 6;

struct Reference {
  double angle;  // [rad], joint side
  double rate;   // [rad/s]
};

class Motion;

// --- what a piece may be -------------------------------------------------------------------------

// One polynomial per axis in the normalised time x = (t - begin) / length of the piece: high powers
// of short times would lose digits.
struct Polynomials {
  double begin;   // [s]
  double length;  // [s], 1 for the last piece, which has no end
  // Of x^0 to x^5, each for all axes, so that they are evaluated together.
  std::array<std::array<double, most_axes>, 6> coefficients = {};
};

// Any function of time: fills in one value for each axis of the motion.
using Function = std::function<void(double t, std::span<double> values)>;

struct Functions {
  Function angle;         // [rad]
  Function rate;          // [rad/s], its derivative
  Function acceleration;  // [rad/s^2]; may be missing: then it is a difference of rates
};

// Functions, asked for times from `begin` to just before `end` only: at `end` they may already give
// what comes next. Beyond, they stay as they are there.
struct PieceOfFunctions {
  double begin, end;  // [s]
  std::shared_ptr<const Functions> functions;
};

// A piece of another motion that begins at `begin` of this one [s].
struct PieceOfMotion {
  double begin;
  std::shared_ptr<const Motion> motion;
  int piece;
};

struct Piece {
  double begin;  // [s]
  std::variant<Polynomials, PieceOfFunctions, PieceOfMotion> law;
};

// --- motions -------------------------------------------------------------------------------------

class Motion {
 public:
  // Pieces in the order of time. Before the first the motion rests at `start`.
  Motion(std::vector<double> start, std::vector<Piece> pieces, double duration);

  int n_axes() const { return static_cast<int>(start_.size()); }
  std::span<const double> start() const { return start_; }  // [rad]
  std::span<const Piece> pieces() const { return pieces_; }
  // Instants [s] at which the motion is not smooth.
  std::span<const double> knots() const { return knots_; }
  // When the motion has come to its end, to rest for good [s].
  double duration() const { return duration_; }

  // Whether its pieces are smooth beyond their ends; of functions nothing is known.
  bool extends_beyond_knots() const;

  // Whether an axis is known to stay exactly at zero for ever; of functions nothing is known.
  bool rests_at_zero(int axis) const;

  // The piece that holds at t and right after it; -1 before the first.
  int piece_at(double t) const;
  // The knot at which the next piece begins; infinity for the last.
  double end_of(int piece) const;

  // What a piece gives at t: of the first axes, as many as there is room for.
  void reference(int piece, double t, std::span<Reference> references) const;
  void acceleration(int piece, double t, std::span<double> accelerations) const;  // [rad/s^2]

 private:
  std::vector<double> start_;
  std::vector<Piece> pieces_;
  std::vector<double> knots_;
  double duration_;
};

// Angles in rad, times in s, for 1, 3 or 6 axes. All throw std::invalid_argument.

// Rest to rest with zero acceleration at both ends: 10 x^3 - 15 x^4 + 6 x^5 of the way.
Motion quintic(std::span<const double> start, std::span<const double> end, double duration);

// A synchronised trapezoid: constant acceleration, constant rate, constant deceleration of one path
// parameter; triangular if the largest rate [rad/s] is not reached within the largest acceleration
// [rad/s^2].
Motion trapezoid(std::span<const double> start, std::span<const double> end,
                 std::span<const double> rate, std::span<const double> acceleration);

// The cubic spline through angles (times.size(), n_axes), row by row, with continuous acceleration
// and zero rate at both ends. Every time is a knot.
Motion spline(std::span<const double> times, std::span<const double> angles);

// Any polynomials up to degree 5, a piece between each two times: coefficients
// (times.size() - 1, n_powers, n_axes), row by row, of x^0, x^1, ... in the normalised time x of a
// piece, from 0 to 1. Each piece begins at the angles at which the one before has ended. At rest
// before and after. Every time is a knot.
Motion polynomials(std::span<const double> times, std::span<const double> coefficients,
                   std::size_t n_powers, std::size_t n_axes);

// Stays at the angles.
Motion hold(std::span<const double> angles, double duration = 0.0);

// One after another, each from the end of the one before, at whose angles it must begin. Knots are
// those of the members, and where two meet.
Motion sequence(std::span<const std::shared_ptr<const Motion>> members);

// Any functions, from 0 to `duration`, that are smooth between `knots`; at rest before and after.
Motion functions(std::size_t n_axes, Functions functions, double duration,
                 std::span<const double> knots);

}  // namespace manutec_r3::motion
