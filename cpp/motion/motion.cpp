#include "motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace manutec_r3::motion {
namespace {

template <class Value>
[[noreturn]] void refuse(const std::string& field, const std::string& expected, Value got) {
  std::ostringstream message;
  message << field << ": expected " << expected << ", got " << got;
  throw std::invalid_argument(message.str());
}

std::string of_axis(const std::string& field, std::size_t axis) {
  return field + " of axis " + std::to_string(axis + 1);
}

void check_angles(const std::string& field, std::span<const double> angles) {
  if (angles.size() != 3 && angles.size() != 6) {
    refuse(field, "3 or 6 angles [rad]", angles.size());
  }
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!std::isfinite(angles[i])) refuse(of_axis(field, i), "a finite angle [rad]", angles[i]);
  }
}

void check_length(const std::string& field, std::span<const double> values, std::size_t size) {
  if (values.size() == size) return;
  refuse(field, std::to_string(size) + " values, one per axis as in start", values.size());
}

void check_limits(const std::string& field, const std::string& unit,
                  std::span<const double> limits) {
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (!(std::isfinite(limits[i]) && limits[i] > 0.0)) {
      refuse(of_axis(field, i), "a positive finite value [" + unit + "]", limits[i]);
    }
  }
}

// start + (end - start) s(x) on every axis, for a path parameter s given by its coefficients.
Piece along_line(double begin, double length, std::span<const double> start,
                 std::span<const double> end, const std::array<double, 6>& path) {
  Piece piece{begin, length, {}};
  for (std::size_t i = 0; i < start.size(); ++i) {
    std::array<double, 6> coefficients;
    for (std::size_t k = 0; k < path.size(); ++k) coefficients[k] = (end[i] - start[i]) * path[k];
    coefficients[0] += start[i];
    piece.coefficients.push_back(coefficients);
  }
  return piece;
}

// Exactly at rest, exactly at the angles.
Piece at_rest(double begin, std::span<const double> angles) {
  Piece piece{begin, 1.0, {}};
  for (const double angle : angles) piece.coefficients.push_back({angle});
  return piece;
}

std::vector<double> copied(std::span<const double> values) {
  return {values.begin(), values.end()};
}

}  // namespace

Motion::Motion(std::vector<double> start, std::vector<Piece> pieces)
    : start_(std::move(start)), pieces_(std::move(pieces)) {
  for (const Piece& piece : pieces_) knots_.push_back(piece.begin);
}

bool Motion::rests_at_zero(int axis) const {
  return start_[axis] == 0.0 && std::ranges::all_of(pieces_, [axis](const Piece& piece) {
           return std::ranges::all_of(piece.coefficients[axis], [](double c) { return c == 0.0; });
         });
}

int Motion::piece_at(double t) const {
  return static_cast<int>(std::ranges::upper_bound(knots_, t) - knots_.begin()) - 1;
}

double Motion::end_of(int piece) const {
  const std::size_t next = static_cast<std::size_t>(piece + 1);
  return next < knots_.size() ? knots_[next] : std::numeric_limits<double>::infinity();
}

Reference Motion::reference(int piece, double t, int axis) const {
  if (piece < 0) return {start_[axis], 0.0, 0.0};
  const Piece& now = pieces_[piece];
  const std::array<double, 6>& c = now.coefficients[axis];
  const double x = (t - now.begin) / now.length;
  const double first = c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5])));
  const double second = 2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]));
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))), first / now.length,
          second / (now.length * now.length)};
}

Motion quintic(std::span<const double> start, std::span<const double> end, double duration) {
  check_angles("start", start);
  check_length("end", end, start.size());
  check_angles("end", end);
  if (!(std::isfinite(duration) && duration > 0.0)) {
    refuse("duration", "a positive finite time [s]", duration);
  }
  return {copied(start),
          {along_line(0.0, duration, start, end, {0, 0, 0, 10, -15, 6}), at_rest(duration, end)}};
}

Motion trapezoid(std::span<const double> start, std::span<const double> end,
                 std::span<const double> rate, std::span<const double> acceleration) {
  check_angles("start", start);
  check_length("end", end, start.size());
  check_angles("end", end);
  check_length("rate", rate, start.size());
  check_limits("rate", "rad/s", rate);
  check_length("acceleration", acceleration, start.size());
  check_limits("acceleration", "rad/s^2", acceleration);

  // The path parameter s(t) from 0 to 1 is led by the slowest axis.
  double s_rate = std::numeric_limits<double>::infinity();
  double s_acceleration = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double distance = std::abs(end[i] - start[i]);
    s_rate = std::min(s_rate, rate[i] / distance);
    s_acceleration = std::min(s_acceleration, acceleration[i] / distance);
  }
  if (!std::isfinite(s_rate)) return hold(start);
  const double to_full_rate = s_rate / s_acceleration;
  const bool triangular = to_full_rate >= 1.0 / s_rate;
  const double ramp = triangular ? std::sqrt(1.0 / s_acceleration) : to_full_rate;
  const double brake = triangular ? ramp : 1.0 / s_rate;  // when deceleration begins
  const double cruise = brake - ramp;
  const double share = 0.5 * s_acceleration * ramp * ramp;  // of the way, on each ramp

  std::vector<Piece> pieces;
  pieces.push_back(along_line(0.0, ramp, start, end, {0, 0, share, 0, 0, 0}));
  if (!triangular) {
    pieces.push_back(along_line(ramp, cruise, start, end, {share, 1.0 - 2.0 * share, 0, 0, 0, 0}));
  }
  pieces.push_back(
      along_line(brake, ramp, start, end, {1.0 - share, 2.0 * share, -share, 0, 0, 0}));
  pieces.push_back(at_rest(brake + ramp, end));
  return {copied(start), std::move(pieces)};
}

Motion hold(std::span<const double> angles) {
  check_angles("angles", angles);
  return {copied(angles), {}};
}

}  // namespace manutec_r3::motion
