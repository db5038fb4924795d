#include "hybrid/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "hybrid/crossing.hpp"
#include "hybrid/failure.hpp"

namespace manutec_r3::hybrid {
namespace {

// A double crossing counts if the indicator gets so far out of its domain, relative to its values
// at the ends of the step: well above roundoff, far below what tolerances resolve.
constexpr double shallowest_dip = 1e-12;
// A step is halved so often in search of an instant at which an indicator was inside its domain.
constexpr int most_halvings = 50;
// A minimum is evaluated if the cubic predicts it below this part of the smaller end: in steps that
// the tolerances allow, cubics err by less.
constexpr double doubtful = 0.25;
constexpr int most_searches = 10;
// Rates of indicators come from a difference over this time [s]: much shorter than a step, and long
// enough for ten digits of the difference to survive.
constexpr double ahead = 1e-7;

}  // namespace

Simulation::Simulation(System& system, Integrator& integrator, double t, std::vector<double> x,
                       Trajectory* trajectory, Routine routine)
    : system_(system),
      integrator_(integrator),
      trajectory_(trajectory),
      routine_(routine),
      start_(t),
      scratch_x_(system.n_states()),
      scratch_z_(system.n_indicators()),
      dip_z_(system.n_indicators()),
      dip_slope_(system.n_indicators()),
      scratch_derivatives_(system.n_states()) {
  now_.time = now_.step.t0 = now_.step.t1 = t;
  now_.x = std::move(x);
  now_.z.resize(system.n_indicators());
  now_.slope.resize(system.n_indicators());
  system_.initialise(t, now_.x.data());
  restart(0.0);
}

void Simulation::advance(double target, Stop stop, Target at_target,
                         const std::function<void(double)>& look_up) {
  for (;;) {
    if (now_.event && now_.time == now_.step.t1) {
      if (now_.time >= target && at_target == Target::excluded) return;
      const std::size_t events_before = events_.size();
      handle_event(false);
      if (stop == Stop::at_first_event && events_.size() > events_before) return;
    } else if (now_.time >= target) {
      return;
    } else {
      if (now_.time == now_.step.t1) advance_front();
      now_.time = std::min(now_.step.t1, target);
      if (look_up) look_up(now_.time);
    }
  }
}

void Simulation::change_input(const std::function<void()>& set) {
  const Snapshot before = save();
  try {
    now_.x = state();  // with the old input
    // An event that is due at this very instant is part of the same decision.
    const bool due = now_.event && now_.time == now_.step.t1;
    if (!due) {
      now_.fired.clear();
      now_.time_event = false;
    }
    now_.step.t0 = now_.step.t1 = now_.time;
    set();
    handle_event(true);
  } catch (...) {
    now_ = before.front;
    system_.set_mode(before.mode);
    integrator_.restart(now_.step.t1, now_.x.data(), before.next_size);
    throw;
  }
  if (trajectory_) trajectory_->cut(now_.time);
}

std::vector<double> Simulation::state() {
  if (now_.time == now_.step.t1) return now_.x;
  std::vector<double> x(now_.x.size());
  integrator_.evaluate(now_.step, now_.time, x.data());
  return x;
}

Statistics Simulation::statistics() const {
  return {.work = integrator_.work(),
          .events = static_cast<long>(events_.size()),
          .restarts = restarts_,
          .routine_events = routine_events_,
          .routine_evaluations = routine_evaluations_,
          .locations = locations_};
}

Simulation::Snapshot Simulation::save() const {
  return {.front = now_, .next_size = integrator_.next_size(), .mode = system_.mode()};
}

void Simulation::restore(const Snapshot& snapshot) {
  const Mode& mode = system_.mode();
  if (snapshot.front.x.size() != now_.x.size() || snapshot.front.z.size() != now_.z.size() ||
      snapshot.mode.branches.size() != mode.branches.size() ||
      snapshot.mode.held.size() != mode.held.size()) {
    throw std::invalid_argument("snapshot: expected one of the same system");
  }
  now_ = snapshot.front;
  system_.set_mode(snapshot.mode);
  if (trajectory_) {
    trajectory_->cut(now_.step.t0);
    if (now_.step.t1 > now_.step.t0) trajectory_->append(now_.step, snapshot.mode);
  }
  integrator_.restart(now_.step.t1, now_.x.data(), snapshot.next_size);
}

// --- one step -----------------------------------------------------------------------------------

void Simulation::advance_front() {
  const double stop = system_.next_time_event(now_.step.t1);
  x0_ = now_.x;
  z0_ = now_.z;
  slope0_ = now_.slope;
  try {
    integrator_.advance(stop, now_.step, now_.x.data());
    if (!std::ranges::all_of(now_.x, [](double value) { return std::isfinite(value); })) {
      throw SimulationFailure("the state has grown beyond all bounds");
    }
    measure(now_.step.t1, now_.x, now_.z, now_.slope);
    locate_event(stop);
  } catch (...) {
    // Back to the beginning of the step, where all was well: the run can be continued.
    now_.x = x0_;
    now_.z = z0_;
    now_.slope = slope0_;
    now_.step.t0 = now_.step.t1 = now_.time;
    now_.event = false;
    integrator_.restart(now_.time, now_.x.data(), integrator_.next_size());
    // A run that cannot even begin leaves its beginning behind.
    if (trajectory_ && trajectory_->n_steps() == 0) trajectory_->append(now_.step, system_.mode());
    throw;
  }
  if (trajectory_ && now_.step.t1 > now_.step.t0) trajectory_->append(now_.step, system_.mode());
}

// Indicators and their rates along the solution.
void Simulation::measure(double t, const std::vector<double>& x, std::vector<double>& z,
                         std::vector<double>& slope) {
  integrator_.derivatives(t, x.data(), scratch_derivatives_.data());
  for (std::size_t s = 0; s < x.size(); ++s) scratch_x_[s] = x[s] + ahead * scratch_derivatives_[s];
  system_.indicators(t, x.data(), z.data());
  system_.indicators(t + ahead, scratch_x_.data(), slope.data());
  for (std::size_t i = 0; i < z.size(); ++i) {
    check_indicator(static_cast<int>(i), z[i]);
    slope[i] = (slope[i] - z[i]) / ahead;
  }
}

double Simulation::indicator_inside(int indicator, double t) {
  ++locations_;
  integrator_.evaluate(now_.step, t, scratch_x_.data());
  system_.indicators(t, scratch_x_.data(), scratch_z_.data());
  check_indicator(indicator, scratch_z_[indicator]);
  return scratch_z_[indicator];
}

void Simulation::check_indicator(int indicator, double z) const {
  if (std::isfinite(z)) return;
  throw SimulationFailure("an indicator of " + system_.describe(system_.element_of(indicator)) +
                          " is not a finite number");
}

// An instant between a and b at which the indicator is out of its domain though the cubic begins
// inside, if there is one: where its minimum is, better known with each evaluation.
std::optional<Sample> Simulation::dip(int indicator, Sample a, Sample b) {
  const double deep = -shallowest_dip * std::max(a.z, b.z);
  for (int search = 0; search < most_searches; ++search) {
    if (!(a.z > 0.0 && a.slope < 0.0)) return {};
    const Cubic cubic(a, b);
    const std::optional<double> lowest = cubic.minimum();
    if (!lowest || cubic(*lowest) > doubtful * std::min(a.z, std::abs(b.z))) return {};
    Sample c{*lowest, indicator_inside(indicator, *lowest), 0.0};
    if (c.z <= deep) return c;
    if (c.z <= 0.0) return {};
    dip_x_ = scratch_x_;
    measure(c.t, dip_x_, dip_z_, dip_slope_);
    c.slope = dip_slope_[indicator];
    (c.slope < 0.0 ? a : b) = c;
  }
  return {};
}

// --- events -------------------------------------------------------------------------------------

// Cuts the step off at the first event in it, if there is one.
void Simulation::locate_event(double stop) {
  const double t0 = now_.step.t0;
  const double t1 = now_.step.t1;
  double first = never;
  now_.fired.clear();

  for (int i = 0; i < system_.n_indicators(); ++i) {
    const double z1 = now_.z[i];
    const Cubic cubic({t0, z0_[i], slope0_[i]}, {t1, z1, now_.slope[i]});
    double outside = t1;
    double z_outside = z1;
    // Semantics 1: out of the domain and back within the step?
    const std::optional<Sample> low = dip(i, {t0, z0_[i], slope0_[i]}, {t1, z1, now_.slope[i]});
    if (low) {
      outside = low->t;
      z_outside = low->z;
    } else if (z1 > 0.0) {
      continue;
    }
    if (first < outside) {
      // Another indicator fires before; this one matters only if it does so earlier.
      outside = first;
      z_outside = indicator_inside(i, first);
      if (z_outside > 0.0) continue;
    }

    double inside = t0;
    double z_inside = z0_[i];
    if (z_inside <= 0.0) {
      // Semantics 2: it counts as inside at t0; find out where it really is.
      const std::optional<double> highest = cubic.maximum();
      inside = highest && *highest < outside ? *highest : 0.5 * (t0 + outside);
      const bool enters = highest && cubic(*highest) > 0.0;
      for (int halving = 0; enters && halving < most_halvings; ++halving) {
        z_inside = indicator_inside(i, inside);
        if (z_inside > 0.0) break;
        outside = inside;
        z_outside = z_inside;
        inside = 0.5 * (t0 + inside);
      }
      if (z_inside <= 0.0 && z1 >= z0_[i]) continue;  // on its way in, or where it was left
    }
    const auto z = [&](double t) { return indicator_inside(i, t); };
    const double t = z_inside > 0.0 ? leave_domain(z, inside, z_inside, outside, z_outside,
                                                   cubic.root(inside, outside))
                                    : t0;
    if (t < first - simultaneous(first)) now_.fired.clear();
    first = std::min(t, first);
    now_.fired.push_back(i);
  }

  // Semantics 4: what is as good as simultaneous with the step's beginning or with `stop` is so.
  if (first - t0 <= simultaneous(t0)) first = t0;
  now_.time_event = std::min(first, t1) >= stop - simultaneous(stop);
  now_.event = now_.time_event || first < never;
  if (!now_.event) return;
  if (first < t1 && !now_.time_event) {
    integrator_.evaluate(now_.step, first, scratch_x_.data());
    now_.x = scratch_x_;
    now_.step.t1 = first;
    measure(first, now_.x, now_.z, now_.slope);
  }
  fold_in_simultaneous();
}

// Semantics 4: whatever else fires at the end of the step, or so soon that it is the same instant.
void Simulation::fold_in_simultaneous() {
  // Half as much again: what is left out here and found in the next step shall not be within four
  // units because of roundoff.
  const double instant = 1.5 * simultaneous(now_.step.t1);
  for (int i = 0; i < system_.n_indicators(); ++i) {
    const double z_soon = now_.z[i] + std::min(0.0, now_.slope[i] * instant);
    if ((z0_[i] > 0.0 || now_.z[i] > 0.0) && z_soon <= 0.0 &&
        std::ranges::find(now_.fired, i) == now_.fired.end()) {
      now_.fired.push_back(i);
    }
  }
  std::ranges::sort(now_.fired);
}

void Simulation::handle_event(bool input_changed) {
  changes_.clear();
  x0_ = now_.x;
  const Mode before = system_.mode();
  const bool due = now_.event;
  const long evaluations_before = integrator_.work().evaluations;
  try {
    system_.handle_event(
        now_.time, now_.x.data(),
        {.fired = now_.fired, .time_event = now_.time_event, .input_changed = input_changed},
        changes_);
    restart(integrator_.next_size());
  } catch (...) {
    now_.x = x0_;
    now_.event = due;
    system_.set_mode(before);
    throw;
  }
  bool only_routine = !changes_.empty() && now_.fired.empty();
  for (const Change& change : changes_) {
    if (now_.time == start_) break;  // semantics 5
    const bool routine = system_.is_routine(change.element);
    routine_events_ += routine;
    only_routine = only_routine && routine;
    if (routine && routine_ == Routine::counted) continue;
    events_.push_back({now_.time, change.element, change.before, change.after});
  }
  ++restarts_;
  if (only_routine) {
    routine_evaluations_ += integrator_.work().evaluations - evaluations_before;
  }
  for (const int i : now_.fired) {
    const Element element = system_.element_of(i);
    if (now_.guard.exceeded(element, now_.time)) {
      throw SimulationFailure("chattering: " + system_.describe(element) + " switches without end");
    }
  }
}

void Simulation::restart(double size) {
  integrator_.restart(now_.time, now_.x.data(), size);
  now_.step.t0 = now_.step.t1 = now_.time;
  now_.event = false;
  measure(now_.time, now_.x, now_.z, now_.slope);
}

}  // namespace manutec_r3::hybrid
