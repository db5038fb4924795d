#include "hybrid/trajectory.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace manutec_r3::hybrid {

Step Trajectory::step(std::size_t index) const { return {begin[index], end[index], dense[index]}; }

void Trajectory::append(const Step& step, const Mode& present) {
  if (modes.empty() || modes.back() != present) modes.push_back(present);
  begin.push_back(step.t0);
  end.push_back(step.t1);
  mode.push_back(static_cast<int>(modes.size()) - 1);
  dense.push_back(step.dense);
}

void Trajectory::cut(double t) {
  if (end.empty() || end.back() <= t) return;
  while (!begin.empty() && begin.back() >= t) {
    begin.pop_back();
    end.pop_back();
    mode.pop_back();
    dense.pop_back();
  }
  if (!end.empty()) end.back() = std::min(end.back(), t);
}

Trajectory Trajectory::until(double t) const {
  Trajectory before = *this;
  before.cut(t);
  if (before.n_steps() == 0 && n_steps() > 0) {
    Step instant = step(0);
    instant.t1 = instant.t0;
    before.append(instant, modes[mode[0]]);
  }
  return before;
}

std::size_t Trajectory::step_at(double t) const {
  const auto later = std::upper_bound(begin.begin(), begin.end(), t);
  return later == begin.begin() ? 0 : static_cast<std::size_t>(later - begin.begin()) - 1;
}

Trajectory::Instants Trajectory::instants(std::span<const double> event_times,
                                          std::optional<std::span<const double>> times) const {
  std::vector<std::pair<double, std::ptrdiff_t>> found;
  // Before an event comes the end of a step, after it the beginning of the next. (What is found in
  // a finished run may be an event inside a step.)
  for (const double t : event_times) {
    found.emplace_back(t, std::ranges::lower_bound(end, t) - end.begin());
  }
  std::vector<double> after = times ? std::vector(times->begin(), times->end()) : begin;
  const bool ends_with_step = end.back() > begin.back();
  if (!times && ends_with_step && !std::ranges::binary_search(event_times, end.back())) {
    after.push_back(end.back());
  }
  std::ranges::copy_if(event_times, std::back_inserter(after),
                       [this](double t) { return t < end.back(); });
  std::ranges::sort(after);
  const auto doubles = std::ranges::unique(after);
  after.erase(doubles.begin(), doubles.end());
  for (const double t : after) found.emplace_back(t, static_cast<std::ptrdiff_t>(step_at(t)));
  std::ranges::sort(found);

  Instants instants;
  for (const auto& [t, step] : found) {
    instants.time.push_back(t);
    instants.step.push_back(step);
  }
  return instants;
}

}  // namespace manutec_r3::hybrid
