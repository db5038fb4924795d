// What both versions of the standard have in common: an instance with its place in the order of
// calls, and errors that become messages instead of exceptions.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fmu/instance.hpp"

namespace manutec_r3::fmi {

// Where an instance is in the order of calls, as bits.
enum Phase : unsigned {
  instantiated = 1,
  initialisation = 2,
  event_mode = 4,
  continuous_time = 8,  // Model Exchange
  step_mode = 16,       // Co-Simulation
  terminated = 32,
  failed = 64,  // only to be read, reset or freed
};
inline constexpr unsigned initialised = event_mode | continuous_time | step_mode;
inline constexpr unsigned any_phase = 127;

// In the order of both versions.
enum class Status { ok, warning, discard, error, fatal };

// The standard's names of categories.
inline constexpr const char* log_events = "logEvents";
inline constexpr const char* log_error = "logStatusError";
inline constexpr const char* log_discard = "logStatusDiscard";

using Log = std::function<void(Status, const char* category, const std::string& message)>;

struct Component {
  // Throws std::invalid_argument if the resources, a folder, cannot be read or the token is of
  // another FMU.
  Component(const std::string& resources, const std::string& token, fmu::Kind kind, Log log);

  // Says no unless the instance is in one of these phases, or of this kind; otherwise does it.
  // What is wrong with an argument is an error, which leaves the instance as it is; a failed
  // simulation or initialisation is the end of it.
  Status call(const char* function, unsigned phases, const std::function<void()>& action);
  Status call(const char* function, fmu::Kind expected, unsigned phases,
              const std::function<void()>& action);
  Status refuse(const char* function, const std::string& reason);

  void reset();
  // Messages of a category that the importer does not want are left out; of none, all.
  void set_logging(bool on, std::vector<std::string> categories);
  void log(Status status, const char* category, const std::string& message) const;

  // --- what calls of both versions do ------------------------------------------------------------

  void begin_initialisation(std::optional<double> tolerance, double start_time,
                            std::optional<double> stop_time);
  void end_initialisation(unsigned next);

  // Reads or sets all elements of variables, one variable after another.
  // `whole`: a value reference means all elements of its variable (FMI 3), or one element (FMI 2).
  enum class Elements { whole, single };
  enum class Type { real, integer };
  struct Range {
    int first, size;
  };
  std::vector<Range> ranges(std::span<const unsigned> references, Elements elements,
                            std::optional<Type> type, std::size_t n_values) const;
  void get(std::span<const Range> ranges, double* values);
  void set(std::span<const Range> ranges, const double* values);
  void directional_derivative(std::span<const Range> unknowns, std::span<const Range> knowns,
                              std::span<const double> seed, std::span<double> sensitivity);

  void set_time(double t);
  void set_states(std::span<const double> x);
  void derivatives(std::span<double> values);
  // Throws unless there are so many.
  static void expect(const char* what, std::size_t expected, std::size_t got);
  void check_communication_point(double t, double step) const;

  fmu::SavedState save() const;
  void restore(const fmu::SavedState& saved);

  fmu::Kind kind;
  Phase phase = instantiated;
  std::unique_ptr<fmu::Instance> instance;

 private:
  std::unique_ptr<fmu::Instance> new_instance() const;

  fmu::Recipe recipe_;
  Log log_;
  bool logging_ = false;
  std::vector<std::string> categories_;
};

}  // namespace manutec_r3::fmi
