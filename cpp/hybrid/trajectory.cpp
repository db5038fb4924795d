#include "hybrid/trajectory.hpp"

#include <algorithm>

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

}  // namespace manutec_r3::hybrid
