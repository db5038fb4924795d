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
// Over half the distance a cubic errs by 2^4 times less, if the indicator is smooth; it is believed
// to err by no more than four times that.
constexpr double doubt_at_half = 4.0 / 16.0;
// A cubic that errs by `doubt` in its middle does so as s^2 (1 - s)^2. Of a polynomial of degree 4
// that lowers the control point in the middle, which for a cubic is the mean of its two inner ones.
constexpr double weight_of_doubt = 16.0 / 6.0;

// Nothing times zero is zero, unless it is not finite.
template <class Values>
bool all_finite(const Values& values) {
  return (0.0 * Eigen::ArrayXd::Map(values.data(), values.size())).sum() == 0.0;
}

}  // namespace

Simulation::Simulation(System& system, Integrator& integrator, double t, std::vector<double> x,
                       Trajectory* trajectory, Routine routine)
    : system_(system),
      integrator_(integrator),
      trajectory_(trajectory),
      routine_(routine),
      start_(t),
      looks_(2),
      doubt_(system.n_indicators()),
      bound_(system.n_indicators()),
      scratch_x_(system.n_states()),
      scratch_z_(system.n_indicators()),
      scratch_derivatives_(system.n_states()) {
  now_.time = t;
  now_.x = std::move(x);
  system_.initialise(t, now_.x.data());
  restart(0.0);
}

void Simulation::advance(double target, Stop stop, Target at_target,
                         const std::function<void(double)>& look_up) {
  bool moved = false;
  for (;;) {
    if (is_event_due()) {
      if (now_.time >= target && at_target == Target::excluded) return;
      if (moved && stop == Stop::before_event) return;
      const std::size_t events_before = events_.size();
      handle_event(false);
      if (stop == Stop::at_first_event && events_.size() > events_before) return;
    } else if (now_.time >= target) {
      return;
    } else {
      if (now_.time == now_.step.t1) advance_front();
      now_.time = std::min(now_.step.t1, target);
      moved = true;
      if (look_up) look_up(now_.time);
    }
  }
}

void Simulation::change_input(const std::function<void()>& set) {
  const Snapshot before = save();
  try {
    now_.x = state();  // with the old input
    // An event that is due at this very instant is part of the same decision.
    const bool due = is_event_due();
    if (!due) {
      now_.fired.clear();
      now_.time_event = false;
    }
    now_.begin_step(now_.time);
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
  integrator_.interpolate(now_.stretch(), now_.time, x.data());
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
  if (snapshot.front.x.size() != now_.x.size() ||
      snapshot.front.look.z.size() != now_.look.z.size() ||
      snapshot.mode.branches.size() != mode.branches.size() ||
      snapshot.mode.held.size() != mode.held.size()) {
    throw std::invalid_argument("snapshot: expected one of the same system");
  }
  now_ = snapshot.front;
  system_.set_mode(snapshot.mode);
  if (trajectory_) trajectory_->cut(now_.step.t0);
  record_step();
  integrator_.restart(now_.step.t1, now_.x.data(), snapshot.next_size);
  integrator_.remember(now_.step);
}

Stretch Simulation::Front::stretch() const {
  Stretch stretch;
  stretch.append(step);
  for (std::size_t k = 0; k < n_before; ++k) stretch.append(before[k]);
  return stretch;
}

void Simulation::Front::continue_step() {
  if (step.t1 == step.t0) return;
  std::ranges::rotate(before, before.end() - 1);
  std::swap(before.front(), step);
  n_before = std::min(n_before + 1, before.size());
}

void Simulation::Front::begin_step(double t) {
  step.t0 = step.t1 = t;
  n_before = 0;
}

// --- one step -----------------------------------------------------------------------------------

void Simulation::advance_front() {
  const double stop = system_.next_time_event(now_.step.t1);
  x0_ = now_.x;
  looks_[0] = now_.look;
  now_.continue_step();
  try {
    integrator_.advance(stop, now_.step, now_.x.data());
    if (!all_finite(now_.x)) {
      throw SimulationFailure("the state has grown beyond all bounds");
    }
    look_at_step();
    search_step(stop);
  } catch (...) {
    // Back to the beginning of the step, where all was well: the run can be continued.
    now_.x = x0_;
    now_.look = looks_[0];
    now_.begin_step(now_.time);
    now_.event = false;
    integrator_.restart(now_.time, now_.x.data(), integrator_.next_size());
    // A run that cannot even begin leaves its beginning behind.
    if (trajectory_ && trajectory_->n_steps() == 0) {
      trajectory_->append(now_.step, system_.mode(), false);
    }
    throw;
  }
  record_step();
}

void Simulation::record_step() {
  if (!trajectory_ || now_.step.t1 == now_.step.t0) return;
  trajectory_->append(now_.step, system_.mode(), now_.n_before > 0);
}

void Simulation::prepare(Look& look) const {
  look.is_glance = false;
  look.z.resize(doubt_.size());
  look.slope.resize(doubt_.size());
}

void Simulation::measure(double t, const std::vector<double>& x, Look& look) {
  look.t = t;
  prepare(look);
  integrator_.derivatives(t, x.data(), scratch_derivatives_.data());
  system_.indicators(t, x.data(), look.z.data());
  system_.indicator_rates(t, x.data(), scratch_derivatives_.data(), look.slope.data());
  check_indicators(look.z);
}

double Simulation::indicator_inside(int indicator, double t) {
  ++locations_;
  integrator_.evaluate(now_.step, t, scratch_x_.data());
  system_.indicators(t, scratch_x_.data(), scratch_z_.data());
  check_indicator(indicator, scratch_z_[indicator]);
  return scratch_z_[indicator];
}

void Simulation::check_indicators(const Eigen::ArrayXd& z) const {
  if (all_finite(z)) return;
  for (int i = 0; i < z.size(); ++i) check_indicator(i, z[i]);
}

void Simulation::check_indicator(int indicator, double z) const {
  if (std::isfinite(z)) return;
  throw SimulationFailure("an indicator of " + system_.describe(system_.element_of(indicator)) +
                          " is not a finite number");
}

// --- looking for events in a step
// -----------------------------------------------------------------

// Looks at all instants at which the integrator knows the solution, unless a glance at them says
// that there is nothing to see.
void Simulation::look_at_step() {
  const double t1 = now_.step.t1;
  Look& begin = looks_[0];
  last_look_ = 0;
  prepare(now_.look);
  near_.clear();
  const bool glanced = integrator_.glance(
      begin.z.data(), begin.is_glance ? nullptr : begin.slope.data(), now_.look.z.data(), near_);
  if (glanced && near_.empty()) {
    now_.look.t = t1;
    now_.look.is_glance = true;
    return;
  }
  if (begin.is_glance) measure(begin.t, x0_, begin);
  const int n_looks = integrator_.n_looks();
  if (static_cast<int>(looks_.size()) < n_looks + 2) looks_.resize(n_looks + 2);
  for (int k = 0; k < n_looks; ++k) {
    Look& look = looks_[++last_look_];
    prepare(look);
    look.t = integrator_.look(k, look.z.data(), look.slope.data());
    check_indicators(look.z);
  }
  if (looks_[last_look_].t < t1) measure(t1, now_.x, looks_[++last_look_]);
  now_.look = looks_[last_look_];
  if (!glanced) find_near(begin, now_.look);
  for (const int i : near_) doubt_[i] = doubt_about(i);
}

// A cubic is nowhere lower than its control points: most indicators need no more.
void Simulation::find_near(const Look& a, const Look& b) {
  const double third = (b.t - a.t) / 3.0;
  const auto ends = a.z.min(b.z);
  bound_ = (a.z + third * a.slope).min(b.z - third * b.slope).min(ends) - doubtful * ends;
  if (bound_.minCoeff() > 0.0) return;
  for (int i = 0; i < bound_.size(); ++i) {
    if (bound_[i] <= 0.0) near_.push_back(i);
  }
}

// How well a cubic from one look to the next but one meets the look between them tells how well
// cubics from look to look do.
double Simulation::doubt_about(int indicator) const {
  double doubt = 0.0;
  for (std::size_t k = 1; k < last_look_; ++k) {
    const Look &a = looks_[k - 1], &b = looks_[k], &c = looks_[k + 1];
    const double at_b = CubicWeights(a.t, c.t, b.t)(a.z[indicator], a.slope[indicator],
                                                    c.z[indicator], c.slope[indicator]);
    doubt = std::max(doubt, doubt_at_half * std::abs(at_b - b.z[indicator]));
  }
  return doubt;
}

// Cuts the step off at the first event in it, if there is one.
void Simulation::search_step(double stop) {
  const double t0 = now_.step.t0;
  const double t1 = now_.step.t1;
  double first = never;
  std::size_t k = 0;
  now_.fired.clear();
  while (first == never && k < last_look_) {
    ++k;
    first = first_event(looks_[k - 1], looks_[k]);
  }

  // Semantics 4: what is as good as simultaneous with the step's beginning or with `stop` is so.
  if (first - t0 <= simultaneous(t0)) first = t0;
  now_.time_event = std::min(first, t1) >= stop - simultaneous(stop);
  now_.event = now_.time_event || first < never;
  if (!now_.event) return;
  if (first < t1 && !now_.time_event) {
    integrator_.evaluate(now_.step, first, now_.x.data());
    // Rates that are good enough for the same instant.
    const Look &a = looks_[k - 1], &b = looks_[k];
    now_.look.t = first;
    system_.indicators(first, now_.x.data(), now_.look.z.data());
    for (int i = 0; i < system_.n_indicators(); ++i) {
      const Cubic cubic({a.t, a.z[i], a.slope[i]}, {b.t, b.z[i], b.slope[i]});
      now_.look.slope[i] = cubic.slope(first);
    }
    integrator_.cut(now_.step, first, now_.x.data());
  }
  fold_in_simultaneous(looks_[k > 0 ? k - 1 : 0]);
}

// The first instant between two looks at which indicators leave their domain, which become those
// that have fired.
double Simulation::first_event(const Look& a, const Look& b) {
  const double third = (b.t - a.t) / 3.0;
  double first = never;
  for (const int i : near_) {
    const double c0 = a.z[i] + third * a.slope[i], c1 = b.z[i] - third * b.slope[i];
    const double ends = std::min(a.z[i], b.z[i]);
    const double middle = 0.5 * (c0 + c1) - weight_of_doubt * doubt_[i];
    if (std::min({c0, c1, ends}) - doubtful * ends > 0.0 && middle > 0.0) continue;
    const Sample at_a{a.t, a.z[i], a.slope[i]}, at_b{b.t, b.z[i], b.slope[i]};
    const Cubic cubic(at_a, at_b);
    double outside = b.t;
    double z_outside = b.z[i];
    // Semantics 1: out of the domain and back between the looks?
    const std::optional<Sample> low = dip(i, at_a, at_b, doubt_[i], most_searches);
    if (low) {
      outside = low->t;
      z_outside = low->z;
    } else if (b.z[i] > 0.0) {
      continue;
    }
    if (first < outside) {
      // Another indicator fires before; this one matters only if it does so earlier.
      outside = first;
      z_outside = indicator_inside(i, first);
      if (z_outside > 0.0) continue;
    }

    double inside = a.t;
    double z_inside = a.z[i];
    if (z_inside <= 0.0) {
      // Semantics 2: it counts as inside at a; find out where it really is.
      const std::optional<double> highest = cubic.maximum();
      inside = highest && *highest < outside ? *highest : 0.5 * (a.t + outside);
      const bool enters = highest && cubic(*highest) > 0.0;
      for (int halving = 0; enters && halving < most_halvings; ++halving) {
        z_inside = indicator_inside(i, inside);
        if (z_inside > 0.0) break;
        outside = inside;
        z_outside = z_inside;
        inside = 0.5 * (a.t + inside);
      }
      if (z_inside <= 0.0 && b.z[i] >= a.z[i]) continue;  // on its way in, or where it was left
    }
    const auto z = [&](double t) { return indicator_inside(i, t); };
    const double t = z_inside > 0.0 ? leave_domain(z, inside, z_inside, outside, z_outside,
                                                   cubic.root(inside, outside))
                                    : a.t;
    if (t < first - simultaneous(first)) now_.fired.clear();
    first = std::min(t, first);
    now_.fired.push_back(i);
  }
  return first;
}

// An instant between a and b at which the indicator is out of its domain though the cubic begins
// inside, if there is one: where its minimum is, better known with each evaluation. `doubt` is by
// how much the cubic may err.
std::optional<Sample> Simulation::dip(int indicator, const Sample& a, const Sample& b, double doubt,
                                      int searches) {
  if (!(a.z > 0.0) || searches == 0) return {};
  const Cubic cubic(a, b);
  const std::optional<double> lowest = a.slope < 0.0 ? cubic.minimum() : std::nullopt;
  const bool near = lowest && cubic(*lowest) <= doubtful * std::min(a.z, std::abs(b.z));
  const double third = (b.t - a.t) / 3.0;
  const double middle = 0.5 * (a.z + third * a.slope + b.z - third * b.slope);
  const bool unsure = doubt > 0.0 && b.z > 0.0 && middle <= weight_of_doubt * doubt;
  if (!near && !unsure) return {};
  const double t = lowest ? *lowest : 0.5 * (a.t + b.t);
  Sample c{t, indicator_inside(indicator, t), 0.0};
  if (c.z <= -shallowest_dip * std::max(a.z, b.z)) return c;
  if (c.z <= 0.0) return {};
  dip_x_ = scratch_x_;
  measure(c.t, dip_x_, dip_look_);
  c.slope = dip_look_.slope[indicator];
  const double doubt_after = std::min(doubt, doubt_at_half * std::abs(c.z - cubic(c.t)));
  const std::optional<Sample> before_c = dip(indicator, a, c, doubt_after, searches - 1);
  return before_c ? before_c : dip(indicator, c, b, doubt_after, searches - 1);
}

// --- events -------------------------------------------------------------------------------------

// Semantics 4: whatever else fires at the end of the step, or so soon that it is the same instant.
void Simulation::fold_in_simultaneous(const Look& before) {
  if (now_.look.is_glance) return;
  // Half as much again: what is left out here and found in the next step shall not be within four
  // units because of roundoff.
  const double instant = 1.5 * simultaneous(now_.step.t1);
  for (int i = 0; i < system_.n_indicators(); ++i) {
    const double z = now_.look.z[i];
    const double z_soon = z + std::min(0.0, now_.look.slope[i] * instant);
    if ((before.z[i] > 0.0 || z > 0.0) && z_soon <= 0.0 &&
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
  now_.begin_step(now_.time);
  now_.event = false;
  measure(now_.time, now_.x, now_.look);
}

}  // namespace manutec_r3::hybrid
