#include "hybrid/trajectory.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace manutec_r3::hybrid {

Stretch Trajectory::stretch(std::size_t index) const {
  Stretch stretch;
  for (std::size_t i = index + 1; i > 0 && mode[i - 1] == mode[index] && !stretch.is_full(); --i) {
    stretch.append(steps[i - 1]);
  }
  return stretch;
}

void Trajectory::append(const Step& step, const Mode& present, bool continues) {
  if (continues && !steps.empty()) {
    mode.push_back(mode.back());
  } else {
    mode.push_back(static_cast<int>(modes.size()));
    modes.push_back(present);
  }
  steps.push_back(step);
}

void Trajectory::cut(double t) {
  while (!steps.empty() && steps.back().t1 > t && steps.back().t0 >= t) {
    steps.pop_back();
    mode.pop_back();
  }
  if (!steps.empty()) steps.back().t1 = std::min(end(), t);
}

Trajectory Trajectory::until(double t) const {
  Trajectory before = *this;
  before.cut(t);
  if (before.n_steps() == 0 && n_steps() > 0) {
    Step instant = steps[0];
    instant.t1 = instant.t0;
    before.append(instant, modes[mode[0]], false);
  }
  return before;
}

std::size_t Trajectory::step_at(double t) const {
  const auto later = std::ranges::upper_bound(steps, t, {}, &Step::t0);
  return later == steps.begin() ? 0 : static_cast<std::size_t>(later - steps.begin()) - 1;
}

Trajectory::Instants Trajectory::instants(std::span<const double> event_times,
                                          std::optional<std::span<const double>> times) const {
  std::vector<std::pair<double, std::ptrdiff_t>> found;
  // Before an event comes the end of a step, after it the beginning of the next. (What is found in
  // a finished run may be an event inside a step.)
  for (const double t : event_times) {
    found.emplace_back(t, std::ranges::lower_bound(steps, t, {}, &Step::t1) - steps.begin());
  }
  std::vector<double> after;
  if (times) {
    after.assign(times->begin(), times->end());
  } else {
    std::ranges::transform(steps, std::back_inserter(after), &Step::t0);
    const bool ends_with_step = end() > steps.back().t0;
    if (ends_with_step && !std::ranges::binary_search(event_times, end())) after.push_back(end());
  }
  std::ranges::copy_if(event_times, std::back_inserter(after),
                       [this](double t) { return t < end(); });
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
