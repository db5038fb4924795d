#include "motion/motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "motion/input.hpp"
#include "motion/spline.hpp"

namespace manutec_r3::motion {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Angles of two motions that follow each other may differ by roundoff of whatever made them [rad].
constexpr double meeting_tolerance = 1e-9;
// Between the knots of functions there must be room to ask them at different times: [s] in the
// first second, later a part of the time.
constexpr double shortest_piece = 1e-9;
// Accelerations are differences of rates over this time, in which hardly anything changes and ten
// digits of the difference survive [s].
constexpr double difference_time = 1e-5;

template <class Value>
[[noreturn]] void refuse(const std::string& field, const std::string& expected, Value got) {
  std::ostringstream message;
  message.precision(12);
  message << field << ": expected " << expected << ", got " << got;
  throw std::invalid_argument(message.str());
}

std::string of_axis(const std::string& field, std::size_t axis) {
  return field + " of axis " + std::to_string(axis + 1);
}

std::string entry(const std::string& field, std::size_t index) {
  return field + "[" + std::to_string(index) + "]";
}

std::string in_seconds(double t) {
  std::ostringstream text;
  text.precision(12);
  text << t << " s";
  return text.str();
}

void check_number_of_axes(const std::string& field, std::size_t n) {
  if (n != 1 && n != 3 && n != most_axes) refuse(field, "1, 3 or 6 angles [rad]", n);
}

void check_angles(const std::string& field, std::span<const double> angles) {
  check_number_of_axes(field, angles.size());
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

void check_duration(double duration) {
  if (!(std::isfinite(duration) && duration > 0.0)) {
    refuse("duration", "a positive finite time [s]", duration);
  }
}

// start + (end - start) s(x) on every axis, for a path parameter s given by its coefficients.
Piece along_line(double begin, double length, std::span<const double> start,
                 std::span<const double> end, const std::array<double, 6>& path) {
  Polynomials line{begin, length};
  for (std::size_t i = 0; i < start.size(); ++i) {
    for (std::size_t k = 0; k < path.size(); ++k) {
      line.coefficients[k][i] = (end[i] - start[i]) * path[k];
    }
    line.coefficients[0][i] += start[i];
  }
  return {begin, line};
}

void check_times(std::span<const double> times) {
  const std::size_t n = times.size();
  if (n < 2) refuse("times", "at least 2 instants [s]", n);
  if (!(times[0] >= 0.0)) refuse("times[0]", "a finite time from 0 s on", times[0]);
  for (std::size_t k = 1; k < n; ++k) {
    if (std::isfinite(times[k]) && times[k] > times[k - 1]) continue;
    refuse(entry("times", k), "a finite time after " + in_seconds(times[k - 1]), times[k]);
  }
}

// Angles at which something begins must be those at which what was before has ended.
void check_meeting(const std::string& field, std::span<const double> here,
                   std::span<const double> before, const std::string& field_before, double t) {
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (std::abs(here[i] - before[i]) <= meeting_tolerance) continue;
    std::ostringstream expected;
    expected.precision(12);
    expected << "to begin on axis " << i + 1 << " at " << before[i] << " rad, where "
             << field_before << " ends at " << in_seconds(t);
    refuse(field, expected.str(), here[i]);
  }
}

// Exactly at rest, exactly at the angles.
Piece at_rest(double begin, std::span<const double> angles) {
  Polynomials rest{begin, 1.0};
  std::ranges::copy(angles, rest.coefficients[0].begin());
  return {begin, rest};
}

std::vector<double> copied(std::span<const double> values) {
  return {values.begin(), values.end()};
}

std::vector<double> angles_at(const Motion& motion, double t) {
  std::array<Reference, most_axes> references;
  motion.reference(motion.piece_at(t), t, std::span(references).first(motion.n_axes()));
  std::vector<double> angles;
  for (int i = 0; i < motion.n_axes(); ++i) angles.push_back(references[i].angle);
  return angles;
}

// --- what the laws of pieces give ----------------------------------------------------------------

using Values = std::array<double, most_axes>;

void reference_of(const Polynomials& law, double t, int, std::span<Reference> references) {
  const double per_second = 1.0 / law.length;
  const double x = per_second * (t - law.begin);
  const auto& c = law.coefficients;
  // Of all axes, also of those that nobody asks for: together they cost less.
  Values angle, rate;
  for (std::size_t i = 0; i < most_axes; ++i) {
    angle[i] =
        c[0][i] + x * (c[1][i] + x * (c[2][i] + x * (c[3][i] + x * (c[4][i] + x * c[5][i]))));
    rate[i] =
        per_second *
        (c[1][i] + x * (2 * c[2][i] + x * (3 * c[3][i] + x * (4 * c[4][i] + x * (5 * c[5][i])))));
  }
  for (std::size_t i = 0; i < references.size(); ++i) references[i] = {angle[i], rate[i]};
}

void acceleration_of(const Polynomials& law, double t, int, std::span<double> accelerations) {
  const double x = (t - law.begin) / law.length;
  const auto& c = law.coefficients;
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    const double second = 2 * c[2][i] + x * (6 * c[3][i] + x * (12 * c[4][i] + x * 20 * c[5][i]));
    accelerations[i] = second / (law.length * law.length);
  }
}

Values values_of(const Function& function, double t, int n_axes) {
  Values values;
  function(t, std::span(values).first(n_axes));
  return values;
}

void reference_of(const PieceOfFunctions& law, double t, int n_axes,
                  std::span<Reference> references) {
  const double inside = std::clamp(t, law.begin, just_before(law.end));
  const Values angle = values_of(law.functions->angle, inside, n_axes);
  const Values rate = values_of(law.functions->rate, inside, n_axes);
  for (std::size_t i = 0; i < references.size(); ++i) references[i] = {angle[i], rate[i]};
}

void acceleration_of(const PieceOfFunctions& law, double t, int n_axes,
                     std::span<double> accelerations) {
  const double last = just_before(law.end);
  const double inside = std::clamp(t, law.begin, last);
  const Functions& functions = *law.functions;
  if (functions.acceleration) {
    const Values acceleration = values_of(functions.acceleration, inside, n_axes);
    std::copy_n(acceleration.begin(), accelerations.size(), accelerations.begin());
    return;
  }
  // The slope of the parabola through the rates at three instants of the piece: in their middle it
  // is the central difference, towards the ends of the piece it is as accurate.
  const double h = std::min(difference_time, 0.25 * (last - law.begin));
  const double middle = std::clamp(inside, law.begin + h, last - h);
  const double left = middle - h, right = middle + h;
  const Values a = values_of(functions.rate, left, n_axes);
  const Values b = values_of(functions.rate, middle, n_axes);
  const Values c = values_of(functions.rate, right, n_axes);
  const double off_middle = (inside - middle) / h;
  for (std::size_t i = 0; i < accelerations.size(); ++i) {
    const double bend = (c[i] - b[i]) - (b[i] - a[i]);
    accelerations[i] = (c[i] - a[i]) / (right - left) + off_middle * bend / h;
  }
}

void reference_of(const PieceOfMotion& law, double t, int, std::span<Reference> references) {
  law.motion->reference(law.piece, t - law.begin, references);
}

void acceleration_of(const PieceOfMotion& law, double t, int, std::span<double> accelerations) {
  law.motion->acceleration(law.piece, t - law.begin, accelerations);
}

bool extends_beyond_end(const Polynomials&) { return true; }

bool extends_beyond_end(const PieceOfFunctions&) { return false; }

bool extends_beyond_end(const PieceOfMotion& law) { return law.motion->extends_beyond_knots(); }

bool rests_at_zero(const Polynomials& law, int axis) {
  return std::ranges::all_of(law.coefficients,
                             [axis](const auto& of_axes) { return of_axes[axis] == 0.0; });
}

bool rests_at_zero(const PieceOfFunctions&, int) { return false; }

bool rests_at_zero(const PieceOfMotion& law, int axis) { return law.motion->rests_at_zero(axis); }

}  // namespace

// --- a motion ------------------------------------------------------------------------------------

Motion::Motion(std::vector<double> start, std::vector<Piece> pieces, double duration)
    : start_(std::move(start)), pieces_(std::move(pieces)), duration_(duration) {
  for (const Piece& piece : pieces_) knots_.push_back(piece.begin);
}

bool Motion::extends_beyond_knots() const {
  return std::ranges::all_of(pieces_, [](const Piece& piece) {
    return std::visit([](const auto& law) { return extends_beyond_end(law); }, piece.law);
  });
}

bool Motion::rests_at_zero(int axis) const {
  return start_[axis] == 0.0 && std::ranges::all_of(pieces_, [axis](const Piece& piece) {
           return std::visit([axis](const auto& law) { return motion::rests_at_zero(law, axis); },
                             piece.law);
         });
}

int Motion::piece_at(double t) const {
  return static_cast<int>(std::ranges::upper_bound(knots_, t) - knots_.begin()) - 1;
}

double Motion::end_of(int piece) const {
  const std::size_t next = piece + 1;
  return next < knots_.size() ? knots_[next] : infinity;
}

void Motion::reference(int piece, double t, std::span<Reference> references) const {
  if (piece < 0) {
    for (std::size_t i = 0; i < references.size(); ++i) references[i] = {start_[i], 0.0};
    return;
  }
  std::visit([&](const auto& law) { reference_of(law, t, n_axes(), references); },
             pieces_[piece].law);
}

void Motion::acceleration(int piece, double t, std::span<double> accelerations) const {
  if (piece < 0) {
    std::ranges::fill(accelerations, 0.0);
    return;
  }
  std::visit([&](const auto& law) { acceleration_of(law, t, n_axes(), accelerations); },
             pieces_[piece].law);
}

// --- the kinds of motions ------------------------------------------------------------------------

Motion quintic(std::span<const double> start, std::span<const double> end, double duration) {
  check_angles("start", start);
  check_length("end", end, start.size());
  check_angles("end", end);
  check_duration(duration);
  return {copied(start),
          {along_line(0.0, duration, start, end, {0, 0, 0, 10, -15, 6}), at_rest(duration, end)},
          duration};
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
  double s_rate = infinity;
  double s_acceleration = infinity;
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
  return {copied(start), std::move(pieces), brake + ramp};
}

Motion spline(std::span<const double> times, std::span<const double> angles) {
  check_times(times);
  const std::size_t n = times.size();
  const std::size_t n_axes = angles.size() / n;
  const auto row = [&](std::size_t k) { return angles.subspan(k * n_axes, n_axes); };
  for (std::size_t k = 0; k < n; ++k) check_angles(entry("angles", k), row(k));

  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < n; ++k) {
    pieces.push_back({times[k], Polynomials{times[k], times[k + 1] - times[k]}});
  }
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n_axes; ++i) {
    for (std::size_t k = 0; k < n; ++k) values[k] = row(k)[i];
    const std::vector<double> slopes = slopes_of_spline(times, values);
    for (const double slope : slopes) {
      if (!std::isfinite(slope)) refuse(of_axis("angles", i), "finite rates [rad/s]", slope);
    }
    for (std::size_t k = 0; k + 1 < n; ++k) {
      Polynomials& law = std::get<Polynomials>(pieces[k].law);
      const double way = values[k + 1] - values[k];
      const double first = law.length * slopes[k], last = law.length * slopes[k + 1];
      law.coefficients[0][i] = values[k];
      law.coefficients[1][i] = first;
      law.coefficients[2][i] = 3.0 * way - 2.0 * first - last;
      law.coefficients[3][i] = first + last - 2.0 * way;
    }
  }
  pieces.push_back(at_rest(times.back(), row(n - 1)));
  return {copied(row(0)), std::move(pieces), times.back()};
}

Motion polynomials(std::span<const double> times, std::span<const double> coefficients,
                   std::size_t n_powers, std::size_t n_axes) {
  check_times(times);
  check_number_of_axes("coefficients of a power", n_axes);
  constexpr std::size_t most_powers = std::tuple_size_v<decltype(Polynomials::coefficients)>;
  if (n_powers < 1 || n_powers > most_powers) {
    refuse("coefficients of a piece", "1 to 6 powers, x^0 to x^5", n_powers);
  }
  std::vector<Piece> pieces;
  std::vector<double> start, end(n_axes);
  for (std::size_t k = 0; k + 1 < times.size(); ++k) {
    Polynomials law{times[k], times[k + 1] - times[k]};
    const std::string piece = entry("coefficients", k);
    std::vector<double> begin(n_axes), end_of_piece(n_axes), magnitude(n_axes);
    for (std::size_t power = 0; power < n_powers; ++power) {
      for (std::size_t i = 0; i < n_axes; ++i) {
        const double value = coefficients[(k * n_powers + power) * n_axes + i];
        if (!std::isfinite(value)) {
          refuse(of_axis(piece + " of x^" + std::to_string(power), i), "a finite value [rad]",
                 value);
        }
        law.coefficients[power][i] = value;
        if (power == 0) begin[i] = value;
        end_of_piece[i] += value;
        magnitude[i] += std::abs(value);
      }
    }
    for (std::size_t i = 0; i < n_axes; ++i) {
      // No angle, rate or acceleration is larger: the second derivative of x^5 is at most 20.
      const double bound = magnitude[i] + 20.0 * magnitude[i] / (law.length * law.length);
      if (!std::isfinite(bound)) {
        refuse(of_axis(piece, i), "finite angles [rad], rates and accelerations", bound);
      }
    }
    if (k == 0) {
      start = begin;
    } else {
      check_meeting(piece, begin, end, entry("coefficients", k - 1), times[k]);
    }
    end = end_of_piece;
    pieces.push_back({times[k], law});
  }
  pieces.push_back(at_rest(times.back(), end));
  return {std::move(start), std::move(pieces), times.back()};
}

Motion hold(std::span<const double> angles, double duration) {
  check_angles("angles", angles);
  if (!(std::isfinite(duration) && duration >= 0.0)) {
    refuse("duration", "a finite time that is not negative [s]", duration);
  }
  return {copied(angles), {}, duration};
}

Motion sequence(std::span<const std::shared_ptr<const Motion>> members) {
  if (members.empty()) refuse("motions", "at least one motion", 0);
  const int n_axes = members[0]->n_axes();
  std::vector<double> angles = angles_at(*members[0], 0.0);
  std::vector<double> start = angles;
  std::vector<Piece> pieces;
  double begin = 0.0;
  const auto add = [&](const std::shared_ptr<const Motion>& member, double knot, int piece) {
    // Later knots of the same instant prevail: motions without duration leave no trace.
    while (!pieces.empty() && pieces.back().begin >= begin + knot) pieces.pop_back();
    Piece& added = pieces.emplace_back();
    added.begin = begin + knot;
    added.law = PieceOfMotion{begin, member, piece};
  };

  for (std::size_t m = 0; m < members.size(); ++m) {
    const std::shared_ptr<const Motion>& member = members[m];
    if (member->n_axes() != n_axes) {
      refuse(entry("motions", m), std::to_string(n_axes) + " axes as in motions[0]",
             member->n_axes());
    }
    if (m > 0) {
      check_meeting(entry("motions", m), angles_at(*member, 0.0), angles, entry("motions", m - 1),
                    begin);
      add(member, 0.0, member->piece_at(0.0));
    }
    for (std::size_t k = 0; k < member->knots().size(); ++k) {
      add(member, member->knots()[k], static_cast<int>(k));
    }
    begin += member->duration();
    angles = angles_at(*member, member->duration());
  }
  return {std::move(start), std::move(pieces), begin};
}

Motion functions(std::size_t n_axes, Functions functions, double duration,
                 std::span<const double> knots) {
  check_number_of_axes("angle(0 s)", n_axes);
  check_duration(duration);
  std::vector<double> begins = {0.0};
  begins.insert(begins.end(), knots.begin(), knots.end());
  begins.push_back(duration);
  for (std::size_t k = 1; k < begins.size(); ++k) {
    const double length = begins[k] - begins[k - 1];
    if (length >= shortest_piece * std::max(1.0, begins[k])) continue;
    refuse(k <= knots.size() ? entry("knots", k - 1) : "duration",
           "a time after " + in_seconds(begins[k - 1]) + " by a 1e-9th or more", begins[k]);
  }
  // Whatever is wrong with a function shall be seen before it is used.
  std::vector<double> start(n_axes), end(n_axes), derivative(n_axes);
  functions.angle(0.0, start);
  functions.angle(duration, end);
  functions.rate(0.0, derivative);
  if (functions.acceleration) functions.acceleration(0.0, derivative);

  const auto shared = std::make_shared<const Functions>(std::move(functions));
  std::vector<Piece> pieces;
  for (std::size_t k = 0; k + 1 < begins.size(); ++k) {
    pieces.push_back({begins[k], PieceOfFunctions{begins[k], begins[k + 1], shared}});
  }
  pieces.push_back(at_rest(duration, end));
  return {std::move(start), std::move(pieces), duration};
}

}  // namespace manutec_r3::motion
