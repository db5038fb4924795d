// What both versions of the standard have in common: an instance with its place in the order of
// calls, and errors that become messages instead of exceptions.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "fmu/instance.hpp"

namespace manutec_r3::fmi {

// Where an instance is in the order of calls, as bits. FMI 2.0.4 has tables of who may be called
// when in its sections 3.2.3 and 4.2.4, FMI 3.0 has lists in 2.3, 3.2 and 4.2.
enum Phase : unsigned {
  instantiated = 1,
  set_up = 2,  // by fmi2SetupExperiment
  initialisation = 4,
  event_begun = 8,            // the discrete states have to be updated
  event_handled = 16,         // they have been
  continuous_time = 32,       // Model Exchange
  step_mode = 64,             // Co-Simulation
  intermediate_update = 128,  // the importer looks into a step
  terminated = 256,
  failed = 512,  // only to be read, restored, reset or freed
};
inline constexpr unsigned created = instantiated | set_up;
inline constexpr unsigned event_mode = event_begun | event_handled;
inline constexpr unsigned initialised = event_mode | continuous_time | step_mode;
inline constexpr unsigned ended = terminated | failed;
// Where equations hold.
inline constexpr unsigned evaluable = initialisation | initialised | ended;
inline constexpr unsigned between_steps = created | evaluable;

// In the order of both versions.
enum class Status { ok, warning, discard, error, fatal };

enum Category { log_events, log_error, log_discard, n_categories };
inline constexpr std::array<const char*, n_categories> category_names = {
    "logEvents", "logStatusError", "logStatusDiscard"};

using Log = std::function<void(Status, const char* category, const std::string& message)>;

// What an importer hands over. Nothing at all is as good as an empty list; otherwise these throw
// std::invalid_argument.
[[noreturn]] void refuse_null(const char* argument);

template <class Value>
std::span<Value> list(const char* argument, Value* first, std::size_t n) {
  if (first == nullptr && n > 0) refuse_null(argument);
  return {first, n};
}
template <class Value>
Value& place(const char* argument, Value* pointer) {
  if (pointer == nullptr) refuse_null(argument);
  return *pointer;
}

struct Component {
  // Throws std::invalid_argument if the instance has no name, if the resources, a folder, cannot be
  // read or the token is of another FMU.
  Component(const char* name, const std::string& resources, const char* token, fmu::Kind kind,
            Log log);

  // Says no unless the instance is in one of these phases, or of this kind; otherwise does it.
  // What is wrong with an argument is an error, which leaves the instance as it is; a failed
  // step, event or initialisation is the end of it.
  Status call(const char* function, unsigned phases, const std::function<void()>& action);
  Status call(const char* function, fmu::Kind expected, unsigned phases,
              const std::function<void()>& action);
  Status refuse(const char* function, const std::string& reason);

  void reset();
  // Of these categories, or of all if there are none here.
  void set_logging(bool on, std::span<const char* const> categories);
  void log(Status status, Category category, const std::string& message) const;

  // --- what calls of both versions do ------------------------------------------------------------

  void set_up_experiment(std::optional<double> tolerance, double start_time,
                         std::optional<double> stop_time);
  void end_initialisation();

  // Reads or sets all elements of variables, one variable after another.
  // `whole`: a value reference means all elements of its variable (FMI 3), or one element (FMI 2).
  enum class Elements { whole, single };
  enum class Type { real, integer, clock };
  struct Range {
    int first, size;
  };
  std::vector<Range> ranges(std::span<const unsigned> references, Elements elements,
                            std::optional<Type> type, std::size_t n_values) const;
  void get(std::span<const Range> ranges, std::span<double> values);
  // All of them or, if one is refused, none.
  void set(std::span<const Range> ranges, std::span<const double> values);
  void directional_derivative(std::span<const Range> unknowns, std::span<const Range> knowns,
                              std::span<const double> seed, std::span<double> sensitivity);

  // Model Exchange
  void enter_event_mode();
  fmu::Instance::Update update_discrete_states();
  void set_time(double t);
  void set_states(std::span<const double> x);
  void get_states(std::span<double> x);
  void get_nominals(std::span<double> nominals) const;
  void derivatives(std::span<double> values);
  void indicators(std::span<double> values);

  // Co-Simulation: advances by a step, as fmu::Instance::advance() does.
  bool do_step(double t, double step, fmu::Instance::Stop stop,
               const fmu::Instance::LookUp& look_up);

  // States as importers hold them: *state is null, or one that is overwritten.
  void get_state(void** state) const;
  void set_state(void* state);
  static void free_state(void** state);
  static std::vector<unsigned char> serialise(void* state);
  static void deserialise(std::span<const unsigned char> bytes, void** state);

  // Throws unless there are so many.
  static void expect(const char* what, std::size_t expected, std::size_t got);

  const fmu::Kind kind;
  unsigned possible;  // phases: those of its kind
  Phase phase = instantiated;
  std::unique_ptr<fmu::Instance> instance;

 private:
  std::unique_ptr<fmu::Instance> new_instance() const;
  void without_return(const std::function<void()>& action);

  const std::string token_;
  fmu::Recipe recipe_;
  Log log_;
  std::array<bool, n_categories> wanted_{};
  double stop_time_ = hybrid::never;
};

}  // namespace manutec_r3::fmi
