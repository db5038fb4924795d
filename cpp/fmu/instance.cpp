#include "fmu/instance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "fmu/parameters.hpp"
#include "hybrid/crossing.hpp"
#include "hybrid/failure.hpp"
#include "robot/start.hpp"

namespace manutec_r3::fmu {
namespace {

// What is left of an indicator right after an event, at least, of its magnitude: far above the
// roundoff of an importer's arithmetic, and crossed within 1e-9 s by whatever moves.
constexpr double smallest_indicator = 1e-11;

// The step of the differences that make directional derivatives, relative to nominal values. With
// four points the error of the formula is of the order of its fourth power, 1e-12, and roundoff
// costs three digits of fifteen.
constexpr double difference_step = 1e-3;

// An importer's clock may be off by its roundoff [s].
constexpr double simultaneous_ticks = 1e-9;

// An input that is a reference goes on for ever [s].
constexpr double for_ever = 1e300;

}  // namespace

// Between the instants at which an importer of Co-Simulation sets it, it goes on with its rate.
struct Instance::Reference {
  std::array<double, motion::most_axes> angle{}, rate{};
  double since = 0.0;
  bool goes_on = false;

  static std::shared_ptr<const motion::Motion> as_motion(std::shared_ptr<const Reference> now,
                                                         std::size_t n_axes) {
    const auto angle = [now](double t, std::span<double> values) {
      const double later = now->goes_on ? t - now->since : 0.0;
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = now->angle[i] + later * now->rate[i];
      }
    };
    const auto rate = [now](double, std::span<double> values) {
      std::copy_n(now->rate.begin(), values.size(), values.begin());
    };
    return std::make_shared<motion::Motion>(motion::functions(
        n_axes, {.angle = angle, .rate = rate, .acceleration = {}}, for_ever, {}));
  }
};

Instance::Instance(Recipe recipe, Kind kind, Report report)
    : recipe_(std::move(recipe)),
      kind_(kind),
      report_(std::move(report)),
      variables_(variables_of(recipe_)),
      tolerance_(recipe_.relative_tolerance),
      reference_(std::make_shared<Reference>()) {
  const Variable& last = variables_.back();
  const int end = last.first + last.size;
  first_.assign(n_groups + 1, end);
  for (auto variable = variables_.rbegin(); variable != variables_.rend(); ++variable) {
    first_[static_cast<int>(variable->group)] = variable->first;
  }
  for (int group = n_groups - 1; group >= 0; --group) {
    first_[group] = std::min(first_[group], first_[group + 1]);  // a group may be empty
  }
  row_.assign(end, 0.0);
  for (const Variable& variable : variables_) {
    std::ranges::copy(variable.start, row_.begin() + variable.first);
  }
  reference_->goes_on = kind_ == Kind::co_simulation;
}

std::span<double> Instance::group(Group which) {
  const auto number = static_cast<std::size_t>(which);
  return std::span(row_).subspan(first_[number], first_[number + 1] - first_[number]);
}

std::span<const double> Instance::group(Group which) const {
  return const_cast<Instance*>(this)->group(which);
}

// --- variables ----------------------------------------------------------------------------------

const Variable& Instance::variable(unsigned reference) const {
  const auto after =
      std::ranges::upper_bound(variables_, static_cast<double>(reference), {}, &Variable::first);
  const Variable& found = *std::prev(after);
  if (reference >= static_cast<unsigned>(found.first + found.size)) {
    throw std::invalid_argument("value reference " + std::to_string(reference) +
                                ": expected one below " + std::to_string(row_.size()));
  }
  return found;
}

void Instance::get(int first, std::span<double> values) {
  const bool is_given = first < first_[static_cast<int>(Group::signal)];
  if (!is_given) refresh();
  std::copy_n(row_.begin() + first, values.size(), values.begin());
}

void Instance::check(int first, std::span<const double> values, States states) const {
  const Variable& variable = this->variable(first);
  const bool is_input = variable.group == Group::input;
  const bool is_start = initialising_ && !variable.start.empty();
  const bool is_state = variable.group == Group::state && states == States::can_be_set;
  if (!is_input && !is_start && !is_state) {
    throw std::invalid_argument(
        variable.name + (variable.start.empty() ? ": it cannot be set"
                                                : ": it can be set until initialisation ends"));
  }
  for (const double value : values) {
    if (std::isfinite(value)) continue;
    std::ostringstream message;
    message << variable.name << ": expected finite numbers [" << variable.unit << "], got "
            << value;
    throw std::invalid_argument(message.str());
  }
}

void Instance::set(int first, std::span<const double> values) {
  const Variable& variable = this->variable(first);
  if (variable.group == Group::state && !initialising_) {
    std::vector<double> x(group(Group::state).begin(), group(Group::state).end());
    std::ranges::copy(values, x.begin() + (first - first_[static_cast<int>(Group::state)]));
    return set_states(x);
  }
  const auto place = row_.begin() + first;
  // The same as before is no event, unless it is a reference that has gone on meanwhile.
  const bool goes_on = kind_ == Kind::co_simulation && variable.name == reference_angle_input;
  if (!goes_on && std::equal(values.begin(), values.end(), place)) return;
  std::ranges::copy(values, place);
  stale_ = true;
  if (initialising_) {
    started_ = false;
    return;
  }
  input_changed_ = true;
  if (kind_ == Kind::model_exchange) put_inputs();
}

// What the position controllers follow, from now on.
void Instance::read_reference() {
  if (!recipe_.reference_is_input) return;
  const auto inputs = group(Group::input);
  const int n = recipe_.robot->n_axes();
  std::copy_n(inputs.begin(), n, reference_->angle.begin());
  std::copy_n(inputs.begin() + n, n, reference_->rate.begin());
  reference_->since = time();
}

// Gives the system what the importer has set.
void Instance::put_inputs() {
  read_reference();
  const auto inputs = group(Group::input);
  const int n = recipe_.robot->n_axes();
  if (!axes_input(*recipe_.robot).empty()) {
    system_->set_input(inputs.subspan(recipe_.reference_is_input ? 2 * n : 0, n));
  }
  std::array<double, 3> force;
  std::ranges::copy(inputs.last(3), force.begin());
  system_->set_tip_force(force);
}

// --- initialisation -----------------------------------------------------------------------------

// The robot of the present parameters.
void Instance::build() {
  const robot::Robot& exported = *recipe_.robot;
  arm::Load load = exported.load();
  robot::Tables tables = exported.tables();
  const auto parameters = group(Group::parameter);
  auto value = parameters.begin();
  for (const Parameter& parameter : parameters_of(exported.model(), load, tables)) {
    for (double* place : parameter.places) *place = *value++;
  }
  auto robot = std::make_shared<robot::Robot>(exported.model(), load, exported.options(), tables);
  read_reference();
  robot::Inputs inputs{.motion = recipe_.motion};
  if (recipe_.reference_is_input) {
    inputs.motion = Reference::as_motion(reference_, robot->n_axes());
  }
  // The simulation knows the system: it goes first.
  simulation_.reset();
  integrator_.reset();
  system_ = robot::make_system(robot, inputs);
  if (!recipe_.input.empty()) put_inputs();
  system_->set_brakes(recipe_.brakes);
  parameters_.assign(parameters.begin(), parameters.end());

  magnitude_.clear();
  for (const auto& [_, magnitude] : system_->indicator_rows()) {
    magnitude_.insert(magnitude_.end(), 2 * robot->n_axes(), magnitude);
  }
  lift_.assign(magnitude_.size(), 0.0);

  if (const auto* start = std::get_if<robot::Start>(&recipe_.start)) {
    std::ranges::copy(robot::rest_state(*robot, inputs.motion.get(), *start),
                      group(Group::state).begin());
  }
}

void Instance::start() {
  started_ = false;
  build();
  std::vector<double> x(group(Group::state).begin(), group(Group::state).end());
  if (kind_ == Kind::co_simulation) {
    begin_simulation(x);
    synchronise();
  } else {
    system_->initialise(time(), x.data());
    std::ranges::copy(x, group(Group::state).begin());
    lift_indicators();
  }
  group(Group::n_events)[0] = 0.0;
  given_ = x;
  started_ = true;
  stale_ = true;
}

void Instance::begin_simulation(const std::vector<double>& x) {
  simulation_.reset();
  integrator_ = solver::make_integrator(recipe_.method, *system_, tolerance_);
  simulation_ = std::make_unique<hybrid::Simulation>(*system_, *integrator_, time(), x);
  n_reported_ = 0;
}

void Instance::set_tolerance(double tolerance) {
  if (!(tolerance > 0.0 && std::isfinite(tolerance))) {
    std::ostringstream message;
    message << "tolerance: expected a positive number, got " << tolerance;
    throw std::invalid_argument(message.str());
  }
  tolerance_ = tolerance;
}

void Instance::end_initialisation() {
  if (!started_) start();
  initialising_ = false;
  input_changed_ = false;
}

// --- what follows from the state ----------------------------------------------------------------

void Instance::refresh() {
  if (!started_) start();
  if (kind_ == Kind::co_simulation) change_inputs();
  if (!stale_) return;
  const double* x = group(Group::state).data();
  const auto signals = group(Group::signal);
  system_->signals(time(), x, signals.data());
  system_->energies(x, signals.data(), group(Group::energy).data());
  auto branch = group(Group::branch).begin();
  for (int kind = 0; kind < robot::n_axis_elements; ++kind) {
    for (int i = 0; i < system_->n_axes(); ++i) {
      *branch++ = system_->branch(static_cast<robot::ElementKind>(kind), i);
    }
  }
  system_->derivatives(time(), x, group(Group::derivative).data());
  evaluate_indicators(group(Group::indicator).data());
  stale_ = false;
}

void Instance::evaluate_indicators(double* values) {
  system_->indicators(time(), group(Group::state).data(), values);
  for (std::size_t i = 0; i < lift_.size(); ++i) {
    values[i] = values[i] / magnitude_[i] + lift_[i];
  }
}

void Instance::lift_indicators() {
  std::ranges::fill(lift_, 0.0);
  const auto indicators = group(Group::indicator);
  evaluate_indicators(indicators.data());
  for (std::size_t i = 0; i < lift_.size(); ++i) {
    lift_[i] = std::max(0.0, smallest_indicator - indicators[i]);
  }
}

// --- Model Exchange -----------------------------------------------------------------------------

void Instance::set_time(double t) {
  row_[0] = t;
  stale_ = true;
}

void Instance::set_states(std::span<const double> x) {
  const auto states = group(Group::state);
  std::ranges::copy(x, states.begin());
  given_.assign(x.begin(), x.end());
  system_->hold(states.data());  // an axis that sticks does, however the importer rounds
  stale_ = true;
}

std::span<const double> Instance::states() {
  if (!started_) start();
  given_.assign(group(Group::state).begin(), group(Group::state).end());
  return given_;
}

std::vector<double> Instance::nominals() const {
  std::vector<double> nominals;
  for (const Variable& variable : variables_) {
    nominals.insert(nominals.end(), variable.nominal.begin(), variable.nominal.end());
  }
  return nominals;
}

void Instance::derivatives(std::span<double> values) {
  if (!started_) start();
  system_->derivatives(time(), group(Group::state).data(), values.data());
}

void Instance::indicators(std::span<double> values) {
  if (!started_) start();
  evaluate_indicators(values.data());
}

void Instance::enter_event() {
  latest_event_ = time();
  input_changed_ = false;
  fired_.clear();
  const auto indicators = group(Group::indicator);
  evaluate_indicators(indicators.data());
  for (std::size_t i = 0; i < indicators.size(); ++i) {
    if (indicators[i] <= 0.0) fired_.push_back(static_cast<int>(i));
  }
}

double Instance::sampling_time() const {
  const auto found =
      std::ranges::find(variables_, std::string_view(sampling_time_parameter), &Variable::name);
  return row_[found->first];
}

void Instance::tick() {
  const double T = sampling_time();
  const double instant = std::round(time() / T) * T;
  if (std::abs(time() - instant) > simultaneous_ticks) {
    std::ostringstream message;
    message.precision(std::numeric_limits<double>::digits10);
    message << "sampling: expected ticks at multiples of " << T << " s, got one at " << time()
            << " s";
    throw std::invalid_argument(message.str());
  }
  group(Group::clock)[0] = 1.0;
}

Instance::Update Instance::update_discrete_states() {
  Update update;
  double now = time();
  for (double& ticks : group(Group::clock)) {
    if (ticks != 0.0) now = std::max(now, std::round(now / sampling_time()) * sampling_time());
    ticks = 0.0;
  }
  if (kind_ == Kind::co_simulation) {
    change_inputs();
    simulation_->advance(time(), hybrid::Simulation::Stop::at_target,
                         hybrid::Simulation::Target::included);
    synchronise();
    report_new_events();
  } else {
    const double next = system_->next_time_event(time());
    const bool time_event = now >= next - hybrid::simultaneous(next);
    const auto states = group(Group::state);
    if (time_event || input_changed_ || !fired_.empty()) {
      std::vector<hybrid::Change> changes;
      system_->handle_event(
          now, states.data(),
          {.fired = fired_, .time_event = time_event, .input_changed = input_changed_}, changes);
      report_changes(time(), changes);
      lift_indicators();
      fired_.clear();
      input_changed_ = false;
      stale_ = true;
    }
    update.states_changed = !std::ranges::equal(states, given_);
  }
  update.next_time_event = system_->next_time_event(time());
  if (update.next_time_event == for_ever) update.next_time_event = hybrid::never;
  return update;
}

void Instance::directional_derivative(std::span<const int> unknowns, std::span<const int> knowns,
                                      std::span<const double> seed, std::span<double> sensitivity) {
  if (kind_ == Kind::co_simulation) {
    throw std::invalid_argument("directional derivatives: expected Model Exchange");
  }
  double largest = 0.0;
  for (std::size_t k = 0; k < knowns.size(); ++k) {
    const Variable& known = variable(knowns[k]);
    if (!std::isfinite(seed[k])) {
      throw std::invalid_argument("seed: expected finite numbers, got " + std::to_string(seed[k]));
    }
    if (known.group != Group::state && known.group != Group::input) {
      throw std::invalid_argument("directional derivatives by " + known.name +
                                  ": expected states or inputs");
    }
    const bool is_state = !known.nominal.empty();
    const double nominal = is_state ? known.nominal[knowns[k] - known.first] : 1.0;
    largest = std::max(largest, std::abs(seed[k]) / nominal);
  }
  for (const int unknown : unknowns) {
    const Group group = variable(unknown).group;
    if (group == Group::signal || group == Group::energy || group == Group::derivative ||
        group == Group::indicator) {
      continue;
    }
    throw std::invalid_argument("directional derivatives of " + variable(unknown).name +
                                ": expected derivatives of states, continuous outputs or "
                                "indicators");
  }
  std::ranges::fill(sensitivity, 0.0);
  if (largest == 0.0) return;

  refresh();
  const std::vector<double> before = row_;
  const auto move = [&](double distance) {
    row_ = before;
    for (std::size_t k = 0; k < knowns.size(); ++k) row_[knowns[k]] += distance * seed[k];
    put_inputs();
    stale_ = true;
  };
  const double h = difference_step / largest;
  for (const auto& [steps, weight] :
       {std::pair{-2, 1.0}, std::pair{-1, -8.0}, std::pair{1, 8.0}, std::pair{2, -1.0}}) {
    move(steps * h);
    refresh();
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      sensitivity[k] += weight / (12.0 * h) * row_[unknowns[k]];
    }
  }
  row_ = before;
  put_inputs();
}

// --- Co-Simulation ------------------------------------------------------------------------------

// Takes over where the simulation stands.
void Instance::synchronise() {
  row_[0] = simulation_->time();
  std::ranges::copy(simulation_->state(), group(Group::state).begin());
  stale_ = true;
}

// Inputs that the importer has set since: an event.
void Instance::change_inputs() {
  if (!input_changed_) return;
  simulation_->change_input([this] { put_inputs(); });
  input_changed_ = false;
  synchronise();
  report_new_events();
}

bool Instance::advance(double t, Stop stop, const LookUp& look_up) {
  struct Sooner {};
  change_inputs();
  const auto stop_of_simulation = stop == Stop::at_event ? hybrid::Simulation::Stop::before_event
                                                         : hybrid::Simulation::Stop::at_target;
  double until = t;
  std::function<void(double)> look;
  if (look_up) {
    look = [&](double now) {
      synchronise();
      const double before = until;
      until = std::max(now, std::min(until, look_up(now)));
      if (until < before) throw Sooner{};
    };
  }
  const auto tell = [&] {
    synchronise();
    report_new_events();
  };
  const auto waits = [&] { return stop == Stop::at_event && simulation_->is_event_due(); };
  try {
    for (bool again = true; again;) {
      try {
        simulation_->advance(until, stop_of_simulation, hybrid::Simulation::Target::included, look);
        again = false;
      } catch (const Sooner&) {
        again = !waits();
      }
    }
  } catch (...) {
    tell();
    throw;
  }
  tell();
  return waits();
}

// --- events -------------------------------------------------------------------------------------

void Instance::report_changes(double t, std::span<const hybrid::Change> changes) {
  for (const auto& [element, before, after] : changes) {
    if (system_->is_routine(element)) continue;
    group(Group::n_events)[0] += 1.0;
    if (!report_) continue;
    std::ostringstream message;
    message.precision(std::numeric_limits<double>::digits10);
    message << "t = " << t << " s: " << system_->describe(element);
    if (element.axis > 0) message << ", " << before << " -> " << after;
    report_(message.str());
  }
}

void Instance::report_new_events() {
  const auto& events = simulation_->events();
  for (; n_reported_ < events.size(); ++n_reported_) {
    const hybrid::Event& event = events[n_reported_];
    const hybrid::Change change{event.element, event.before, event.after};
    report_changes(event.time, {&change, 1});
  }
}

// --- saving -------------------------------------------------------------------------------------

SavedState Instance::save() const {
  SavedState saved{.kind = kind_,
                   .row = row_,
                   .tolerance = tolerance_,
                   .initialising = initialising_,
                   .started = started_,
                   .reference_since = reference_->since,
                   .input_changed = input_changed_,
                   .mode = {},
                   .given = given_,
                   .lift = lift_,
                   .fired = fired_,
                   .latest_event = latest_event_,
                   .simulation = {}};
  if (!started_) return saved;
  saved.mode = system_->mode();
  if (simulation_) saved.simulation = simulation_->save();
  return saved;
}

void Instance::restore(const SavedState& saved) {
  const bool other_tolerance = saved.tolerance != tolerance_;
  row_ = saved.row;
  tolerance_ = saved.tolerance;
  initialising_ = saved.initialising;
  started_ = saved.started;
  const auto parameters = group(Group::parameter);
  const bool other_robot = !system_ || !std::ranges::equal(parameters, parameters_);
  if (started_ && other_robot) {
    build();
    row_ = saved.row;
  }
  read_reference();
  reference_->since = saved.reference_since;
  if (started_ && kind_ == Kind::co_simulation) {
    if (other_robot || other_tolerance || !simulation_) begin_simulation(saved.simulation->front.x);
    simulation_->restore(*saved.simulation);
    n_reported_ = simulation_->events().size();
  } else if (started_) {
    system_->set_mode(saved.mode);
  }
  given_ = saved.given;
  lift_ = saved.lift;
  fired_ = saved.fired;
  latest_event_ = saved.latest_event;
  input_changed_ = saved.input_changed;
  stale_ = true;
}

}  // namespace manutec_r3::fmu
