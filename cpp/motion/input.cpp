#include "motion/input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace manutec_r3::motion {

Input::Input(int size, Function function, std::vector<double> knots)
    : size_(size), function_(std::move(function)), knots_(std::move(knots)) {
  for (std::size_t k = 0; k < knots_.size(); ++k) {
    if (std::isfinite(knots_[k]) && (k == 0 || knots_[k] > knots_[k - 1])) continue;
    std::ostringstream message;
    message << "knots: expected finite instants [s] that increase, got " << knots_[k];
    throw std::invalid_argument(message.str());
  }
}

int Input::piece_at(double t) const {
  return static_cast<int>(std::ranges::upper_bound(knots_, t) - knots_.begin());
}

double Input::end_of(int piece) const {
  return piece < static_cast<int>(knots_.size()) ? knots_[piece]
                                                 : std::numeric_limits<double>::infinity();
}

void Input::evaluate(int piece, double t, double* values) const {
  if (piece > 0) t = std::max(t, knots_[piece - 1]);
  if (const double end = end_of(piece); std::isfinite(end)) t = std::min(t, just_before(end));
  function_(t, values);
}

}  // namespace manutec_r3::motion
