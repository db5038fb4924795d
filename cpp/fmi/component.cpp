#include "fmi/component.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "hybrid/failure.hpp"

namespace manutec_r3::fmi {
namespace {

// Communication points that an importer has summed up may be off by roundoff [s].
constexpr double meeting_tolerance = 1e-9;

// The state of an instance that has come to an end.
struct Ended : std::runtime_error {
  using std::runtime_error::runtime_error;
};

std::string names_of(unsigned phases) {
  constexpr std::pair<unsigned, std::string_view> names[] = {
      {created, "instantiated"},
      {instantiated, "instantiated"},
      {set_up, "set up"},
      {initialisation, "initialization mode"},
      {event_mode, "event mode"},
      {event_begun, "event mode before its update"},
      {event_handled, "event mode after its update"},
      {continuous_time, "continuous-time mode"},
      {step_mode, "step mode"},
      {intermediate_update, "intermediate update mode"},
      {terminated, "terminated"},
      {failed, "failed"},
  };
  std::string list;
  for (const auto& [some, name] : names) {
    if ((phases & some) != some) continue;
    phases &= ~some;
    if (!list.empty()) list += " or ";
    list += name;
  }
  return list;
}

[[noreturn]] void refuse_number(const char* what, const char* expected, double got) {
  std::ostringstream message;
  message.precision(std::numeric_limits<double>::digits10);
  message << what << ": expected " << expected << ", got " << got;
  throw std::invalid_argument(message.str());
}

fmu::Recipe read(const std::string& resources, const std::string& token) {
  const std::string path = resources + "/robot.txt";
  std::ifstream file(path);
  std::string expected;
  if (!std::getline(file, expected)) throw std::invalid_argument(path + ": it cannot be read");
  if (token != expected) {
    throw std::invalid_argument("instantiation token: expected " + expected + ", got " + token);
  }
  return fmu::recipe_from(file);
}

// Puts a state where an importer keeps it.
void put(fmu::SavedState saved, void** state) {
  void*& kept = place("state", state);
  if (kept == nullptr) {
    kept = new fmu::SavedState(std::move(saved));
  } else {
    *static_cast<fmu::SavedState*>(kept) = std::move(saved);
  }
}

const fmu::SavedState& as_saved(void* state) {
  return place("state", static_cast<fmu::SavedState*>(state));
}

}  // namespace

void refuse_null(const char* argument) {
  throw std::invalid_argument(std::string(argument) + ": expected a pointer, got NULL");
}

Component::Component(const char* name, const std::string& resources, const char* token,
                     fmu::Kind kind, Log log)
    : kind(kind),
      possible(between_steps),
      token_(token != nullptr ? token : ""),
      recipe_(read(resources, token_)),
      log_(std::move(log)) {
  if (name == nullptr || std::string_view(name).find_first_not_of(" \t\r\n") == std::string::npos) {
    throw std::invalid_argument("instance name: expected one that is not empty");
  }
  possible &=
      ~(kind == fmu::Kind::model_exchange ? unsigned(step_mode) : continuous_time | event_mode);
  instance = new_instance();
}

std::unique_ptr<fmu::Instance> Component::new_instance() const {
  return std::make_unique<fmu::Instance>(
      recipe_, kind, [this](const std::string& event) { log(Status::ok, log_events, event); });
}

Status Component::call(const char* function, unsigned phases, const std::function<void()>& action) {
  if ((phase & phases) == 0) {
    return refuse(function, "expected the instance to be in " + names_of(phases) +
                                ", but it is in " + names_of(phase));
  }
  try {
    action();
    return Status::ok;
  } catch (const Ended& end) {
    phase = failed;
    return refuse(function, end.what());
  } catch (const hybrid::SimulationFailure& failure) {
    // An importer may try again, with a smaller step or other values.
    log(Status::discard, log_discard, std::string(function) + ": " + failure.what());
    return Status::discard;
  } catch (const std::exception& error) {
    return refuse(function, error.what());
  }
}

Status Component::call(const char* function, fmu::Kind expected, unsigned phases,
                       const std::function<void()>& action) {
  if (kind != expected) {
    const bool exchange = expected == fmu::Kind::model_exchange;
    return refuse(function, exchange ? "the instance is one of Co-Simulation"
                                     : "the instance is one of Model Exchange");
  }
  return call(function, phases, action);
}

Status Component::refuse(const char* function, const std::string& reason) {
  log(Status::error, log_error, std::string(function) + ": " + reason);
  return Status::error;
}

// What must not fail in the middle.
void Component::without_return(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    throw Ended(error.what());
  }
}

void Component::reset() {
  instance = new_instance();
  stop_time_ = hybrid::never;
  phase = instantiated;
}

void Component::set_logging(bool on, std::span<const char* const> categories) {
  std::array<bool, n_categories> wanted = wanted_;
  if (categories.empty()) wanted.fill(on);
  for (const char* category : categories) {
    if (category == nullptr) refuse_null("category");
    const auto found = std::ranges::find(category_names, std::string_view(category));
    if (found == category_names.end()) {
      throw std::invalid_argument(
          std::string("log category: expected one that the model has, got ") + category);
    }
    wanted[found - category_names.begin()] = on;
  }
  wanted_ = wanted;
}

void Component::log(Status status, Category category, const std::string& message) const {
  // Errors are told in any case.
  if (status >= Status::error || wanted_[category]) {
    log_(status, category_names[category], message);
  }
}

void Component::set_up_experiment(std::optional<double> tolerance, double start_time,
                                  std::optional<double> stop_time) {
  // The robot rests at the beginning of its motion.
  if (start_time != 0.0) refuse_number("start time", "0 s, where motions begin", start_time);
  if (stop_time && !(*stop_time > start_time && std::isfinite(*stop_time))) {
    refuse_number("stop time", "a time after the start [s]", *stop_time);
  }
  if (tolerance) instance->set_tolerance(*tolerance);
  stop_time_ = stop_time.value_or(hybrid::never);
}

void Component::end_initialisation() {
  without_return([this] { instance->end_initialisation(); });
  phase = (possible & event_mode) != 0 ? event_begun : step_mode;
}

namespace {

std::pair<Component::Type, const char*> type_of(fmu::Group group) {
  switch (group) {
    case fmu::Group::branch:
    case fmu::Group::n_events:
      return {Component::Type::integer, "integer"};
    case fmu::Group::clock:
      return {Component::Type::clock, "clock"};
    default:
      return {Component::Type::real, "real"};
  }
}

}  // namespace

std::vector<Component::Range> Component::ranges(std::span<const unsigned> references,
                                                Elements elements, std::optional<Type> type,
                                                std::size_t n_values) const {
  std::vector<Range> ranges;
  std::size_t size = 0;
  for (const unsigned reference : references) {
    const fmu::Variable& variable = instance->variable(reference);
    const bool is_first = static_cast<int>(reference) == variable.first;
    if (elements == Elements::whole && !is_first) {
      throw std::invalid_argument("value reference " + std::to_string(reference) +
                                  ": expected the first element of " + variable.name);
    }
    const auto& [its_type, its_name] = type_of(variable.group);
    if (type && its_type != *type) {
      throw std::invalid_argument(variable.name + ": it has another type, " + its_name);
    }
    const int n = elements == Elements::whole ? variable.size : 1;
    ranges.push_back({static_cast<int>(reference), n});
    size += n;
  }
  expect("values", size, n_values);
  return ranges;
}

void Component::expect(const char* what, std::size_t expected, std::size_t got) {
  if (got == expected) return;
  throw std::invalid_argument(std::string(what) + ": expected " + std::to_string(expected) +
                              ", got " + std::to_string(got));
}

void Component::get(std::span<const Range> ranges, std::span<double> values) {
  for (const Range& range : ranges) {
    instance->get(range.first, values.first(range.size));
    values = values.subspan(range.size);
  }
}

void Component::set(std::span<const Range> ranges, std::span<const double> values) {
  // In continuous-time mode states can be set one by one.
  const auto states =
      phase == continuous_time ? fmu::Instance::States::can_be_set : fmu::Instance::States::follow;
  std::span<const double> rest = values;
  for (const Range& range : ranges) {
    instance->check(range.first, rest.first(range.size), states);
    rest = rest.subspan(range.size);
  }
  for (const Range& range : ranges) {
    instance->set(range.first, values.first(range.size));
    values = values.subspan(range.size);
  }
}

void Component::directional_derivative(std::span<const Range> unknowns,
                                       std::span<const Range> knowns, std::span<const double> seed,
                                       std::span<double> sensitivity) {
  const auto places = [](std::span<const Range> ranges) {
    std::vector<int> places;
    for (const Range& range : ranges) {
      for (int k = 0; k < range.size; ++k) places.push_back(range.first + k);
    }
    return places;
  };
  instance->directional_derivative(places(unknowns), places(knowns), seed, sensitivity);
}

// --- Model Exchange -----------------------------------------------------------------------------

void Component::enter_event_mode() {
  // FMI 2 allows it once more.
  if (phase == continuous_time) instance->enter_event();
  phase = event_begun;
}

fmu::Instance::Update Component::update_discrete_states() {
  fmu::Instance::Update update;
  without_return([&] { update = instance->update_discrete_states(); });
  phase = event_handled;
  return update;
}

void Component::set_time(double t) {
  // Beyond the stop time importers look with steps that they cut off later.
  const double earliest = instance->latest_event();
  if (!(t >= earliest && std::isfinite(t))) {
    std::ostringstream expected;
    expected << "a finite time not before the latest event, " << earliest << " s";
    refuse_number("time", expected.str().c_str(), t);
  }
  instance->set_time(t);
}

void Component::set_states(std::span<const double> x) {
  expect("states", instance->n_states(), x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (std::isfinite(x[k])) continue;
    throw hybrid::SimulationFailure("state " + std::to_string(k + 1) +
                                    ": expected a finite number, got " + std::to_string(x[k]));
  }
  instance->set_states(x);
}

void Component::get_states(std::span<double> x) {
  expect("states", instance->n_states(), x.size());
  std::ranges::copy(instance->states(), x.begin());
}

void Component::get_nominals(std::span<double> nominals) const {
  expect("states", instance->n_states(), nominals.size());
  std::ranges::copy(instance->nominals(), nominals.begin());
}

void Component::derivatives(std::span<double> values) {
  expect("derivatives", instance->n_states(), values.size());
  instance->derivatives(values);
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, is_finite)) {
    throw hybrid::SimulationFailure("the derivatives have grown beyond all bounds");
  }
}

void Component::indicators(std::span<double> values) {
  expect("indicators", instance->n_indicators(), values.size());
  instance->indicators(values);
}

// --- Co-Simulation ------------------------------------------------------------------------------

bool Component::do_step(double t, double step, fmu::Instance::Stop stop,
                        const fmu::Instance::LookUp& look_up) {
  const double now = instance->time();
  const double tolerance = meeting_tolerance * (1.0 + std::abs(now));
  if (!(std::abs(t - now) <= tolerance)) {
    std::ostringstream expected;
    expected << now << " s";
    refuse_number("communication point", expected.str().c_str(), t);
  }
  if (!(step > 0.0 && std::isfinite(step))) {
    refuse_number("communication step", "a positive time [s]", step);
  }
  if (t + step > stop_time_ + meeting_tolerance * (1.0 + stop_time_)) {
    refuse_number("communication step", "one that ends at the stop time at the latest [s]", step);
  }
  bool event = false;
  without_return([&] { event = instance->advance(t + step, stop, look_up); });
  return event;
}

// --- the state of the FMU -----------------------------------------------------------------------

void Component::get_state(void** state) const {
  fmu::SavedState saved = instance->save();
  saved.token = token_;
  saved.kind = kind;
  saved.phase = phase;
  saved.stop_time = stop_time_;
  put(std::move(saved), state);
}

void Component::set_state(void* state) {
  const fmu::SavedState& saved = as_saved(state);
  if (saved.token != token_) {
    throw std::invalid_argument("state: expected one of this FMU");
  }
  if (saved.kind != kind || (saved.phase & possible) == 0) {
    throw std::invalid_argument("state: expected one of an instance of the same kind");
  }
  instance->restore(saved);
  phase = static_cast<Phase>(saved.phase);
  stop_time_ = saved.stop_time;
}

void Component::free_state(void** state) {
  if (state == nullptr) return;
  delete static_cast<fmu::SavedState*>(*state);
  *state = nullptr;
}

std::vector<unsigned char> Component::serialise(void* state) {
  return fmu::bytes_of(as_saved(state));
}

void Component::deserialise(std::span<const unsigned char> bytes, void** state) {
  put(fmu::saved_state_from(bytes), state);
}

}  // namespace manutec_r3::fmi
