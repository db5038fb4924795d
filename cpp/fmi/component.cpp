#include "fmi/component.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
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
  constexpr std::pair<Phase, std::string_view> names[] = {
      {instantiated, "instantiated"},
      {initialisation, "initialization mode"},
      {event_mode, "event mode"},
      {continuous_time, "continuous-time mode"},
      {step_mode, "step mode"},
      {terminated, "terminated"},
      {failed, "failed"},
  };
  std::string list;
  for (const auto& [phase, name] : names) {
    if ((phases & phase) == 0) continue;
    if (!list.empty()) list += " or ";
    list += name;
  }
  return list;
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

}  // namespace

Component::Component(const std::string& resources, const std::string& token, fmu::Kind kind,
                     Log log)
    : kind(kind), recipe_(read(resources, token)), log_(std::move(log)) {
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

void Component::reset() {
  instance = new_instance();
  phase = instantiated;
}

void Component::set_logging(bool on, std::vector<std::string> categories) {
  logging_ = on;
  categories_ = std::move(categories);
}

void Component::log(Status status, const char* category, const std::string& message) const {
  // Errors are told in any case.
  const bool wanted = status >= Status::discard ||
                      (logging_ && (categories_.empty() ||
                                    std::ranges::find(categories_, category) != categories_.end()));
  if (wanted && log_) log_(status, category, message);
}

void Component::begin_initialisation(std::optional<double> tolerance, double start_time,
                                     std::optional<double> stop_time) {
  const auto refuse_time = [](const char* what, const char* expected, double got) {
    std::ostringstream message;
    message << what << ": expected " << expected << ", got " << got;
    throw std::invalid_argument(message.str());
  };
  // The robot rests at the beginning of its motion.
  if (start_time != 0.0) refuse_time("start time", "0 s, where motions begin", start_time);
  if (stop_time && !(*stop_time > start_time)) {
    refuse_time("stop time", "a time after the start [s]", *stop_time);
  }
  if (tolerance) {
    if (!(*tolerance > 0.0 && std::isfinite(*tolerance))) {
      refuse_time("tolerance", "a positive number", *tolerance);
    }
    instance->set_tolerance(*tolerance);
  }
  phase = initialisation;
}

void Component::end_initialisation(unsigned next) {
  try {
    instance->end_initialisation();
  } catch (const std::exception& error) {
    throw Ended(error.what());
  }
  phase = static_cast<Phase>(next);
}

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
    const bool is_integer =
        variable.group == fmu::Group::branch || variable.group == fmu::Group::n_events;
    if (type && is_integer != (*type == Type::integer)) {
      throw std::invalid_argument(variable.name + ": it has another type, " +
                                  (is_integer ? "integer" : "real"));
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

void Component::get(std::span<const Range> ranges, double* values) {
  for (const Range& range : ranges) {
    const auto n = static_cast<std::size_t>(range.size);
    instance->get(range.first, {values, n});
    values += n;
  }
}

void Component::set(std::span<const Range> ranges, const double* values) {
  for (const Range& range : ranges) {
    const auto n = static_cast<std::size_t>(range.size);
    instance->set(range.first, {values, n});
    values += n;
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

void Component::set_time(double t) {
  if (!std::isfinite(t)) {
    throw std::invalid_argument("time: expected a finite number [s], got " + std::to_string(t));
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

void Component::derivatives(std::span<double> values) {
  expect("derivatives", instance->n_states(), values.size());
  instance->derivatives(values);
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (!std::ranges::all_of(values, is_finite)) {
    throw hybrid::SimulationFailure("the derivatives have grown beyond all bounds");
  }
}

void Component::check_communication_point(double t, double step) const {
  std::ostringstream message;
  message.precision(std::numeric_limits<double>::digits10);
  if (!(std::abs(t - instance->time()) <= meeting_tolerance * (1.0 + std::abs(t)))) {
    message << "communication point: expected " << instance->time() << " s, got " << t << " s";
    throw std::invalid_argument(message.str());
  }
  if (!(step > 0.0 && std::isfinite(step))) {
    message << "communication step: expected a positive time [s], got " << step;
    throw std::invalid_argument(message.str());
  }
}

fmu::SavedState Component::save() const {
  fmu::SavedState saved = instance->save();
  saved.phase = static_cast<int>(phase);
  return saved;
}

void Component::restore(const fmu::SavedState& saved) {
  instance->restore(saved);
  phase = static_cast<Phase>(saved.phase);
}

}  // namespace manutec_r3::fmi
