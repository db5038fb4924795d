// What a run leaves behind: its steps with their dense output, and the modes they were taken in.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "hybrid/integrator.hpp"
#include "hybrid/system.hpp"

namespace manutec_r3::hybrid {

struct Trajectory {
  // Step i covers [t0, t1) in mode modes[mode[i]]; the next begins where it ends. At an event both
  // sides are there: the end of one step, the beginning of the next, which counts as another mode.
  std::vector<Step> steps;
  std::vector<int> mode;
  std::vector<Mode> modes;

  std::size_t n_steps() const { return steps.size(); }
  double end() const { return steps.back().t1; }
  // A step and those that it continues.
  Stretch stretch(std::size_t index) const;

  // Whether the step `continues` the one before, or there has been an event.
  void append(const Step& step, const Mode& mode, bool continues);
  // Forgets what lies beyond t.
  void cut(double t);
  // What lies before t, and t itself: at least the first instant.
  Trajectory until(double t) const;
  // The step that t falls into, the later one at an instant that two steps share.
  std::size_t step_at(double t) const;

  // Instants and the steps that they belong to, in the order of time.
  struct Instants {
    std::vector<double> time;
    std::vector<std::ptrdiff_t> step;
  };
  // What is worth to be recorded of a run: `times`, or else the ends of all steps; and the instants
  // of events, which increase, on both sides: in the step before and in the one after.
  Instants instants(std::span<const double> event_times,
                    std::optional<std::span<const double>> times) const;
};

}  // namespace manutec_r3::hybrid
