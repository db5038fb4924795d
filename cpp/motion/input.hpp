// An input that a user gives as a function of time: motor torques, commands, a force on the tip.
//
// Between its knots it is smooth; each knot is a time event. Within a piece the function is never
// asked beyond the piece's ends: at a knot it may already give what comes after.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

namespace manutec_r3::motion {

// The latest instant that lies before t however t has been rounded.
inline double just_before(double t) {
  return t - 4.0 * (t - std::nextafter(t, -std::numeric_limits<double>::infinity()));
}

class Input {
 public:
  // Writes `size` values at t [s]. May throw.
  using Function = std::function<void(double t, double* values)>;

  // Throws std::invalid_argument unless knots [s] are finite and increase.
  Input(int size, Function function, std::vector<double> knots);

  int size() const { return size_; }
  // The piece that holds at t and right after it: the number of knots until t.
  int piece_at(double t) const;
  // When a piece ends; infinity for the last.
  double end_of(int piece) const;
  void evaluate(int piece, double t, double* values) const;

 private:
  int size_;
  Function function_;
  std::vector<double> knots_;
};

}  // namespace manutec_r3::motion
