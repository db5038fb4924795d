// The C interface of FMI 2.0: each function says who may call it when, and hands over.
#include <fmi2Functions.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fmi/component.hpp"

namespace {

using namespace manutec_r3;
using fmi::Component;
using fmu::Kind;
using Elements = Component::Elements;
using Type = Component::Type;

struct Instance2 final : Component {
  using Component::Component;

  bool is_set_up = false;
  std::optional<double> tolerance, stop_time;
  double start_time = 0.0;
};

fmi2Status as_fmi2(fmi::Status status) { return static_cast<fmi2Status>(status); }

template <class... Arguments>
fmi2Status call(fmi2Component component, Arguments&&... arguments) {
  if (component == nullptr) return fmi2Error;
  return as_fmi2(static_cast<Instance2*>(component)->call(std::forward<Arguments>(arguments)...));
}

Instance2& of(fmi2Component component) { return *static_cast<Instance2*>(component); }

fmi2Status refuse(fmi2Component component, const char* function, const char* reason) {
  if (component == nullptr) return fmi2Error;
  return as_fmi2(of(component).refuse(function, reason));
}

// file:///folder/with%20spaces or file:/folder as a path.
std::string path_of(std::string_view location) {
  constexpr std::string_view scheme = "file:";
  if (!location.starts_with(scheme)) {
    throw std::invalid_argument("resource location: expected file:..., got " +
                                std::string(location));
  }
  location.remove_prefix(scheme.size());
  constexpr std::string_view host = "localhost";
  if (location.starts_with("//")) {
    location.remove_prefix(2);
    if (location.starts_with(host)) location.remove_prefix(host.size());
  }
#ifdef _WIN32
  if (location.starts_with("/")) location.remove_prefix(1);  // before the letter of the drive
#endif
  std::string path;
  for (std::size_t k = 0; k < location.size(); ++k) {
    if (location[k] == '%' && k + 2 < location.size()) {
      const std::string digits(location.substr(k + 1, 2));
      path += static_cast<char>(std::strtol(digits.c_str(), nullptr, 16));
      k += 2;
    } else {
      path += location[k];
    }
  }
  return path;
}

fmi2Status with_range(fmi2Component component, const char* function, unsigned phases, Type type,
                      const fmi2ValueReference references[], size_t n,
                      const std::function<void(std::span<const Component::Range>)>& action) {
  return call(component, function, phases,
              [&] { action(of(component).ranges({references, n}, Elements::single, type, n)); });
}

}  // namespace

extern "C" {

// --- common functions ---------------------------------------------------------------------------

const char* fmi2GetTypesPlatform() { return fmi2TypesPlatform; }
const char* fmi2GetVersion() { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                               const fmi2String categories[]) {
  return call(component, "fmi2SetDebugLogging", fmi::any_phase,
              [&] { of(component).set_logging(on, {categories, categories + n}); });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean,
                              fmi2Boolean logging) {
  const std::string instance_name = name != nullptr ? name : "";
  const auto log = [callbacks, instance_name](fmi::Status status, const char* category,
                                              const std::string& message) {
    if (callbacks == nullptr || callbacks->logger == nullptr) return;
    callbacks->logger(callbacks->componentEnvironment, instance_name.c_str(), as_fmi2(status),
                      category, "%s", message.c_str());
  };
  const Kind kind = type == fmi2ModelExchange ? Kind::model_exchange : Kind::co_simulation;
  try {
    auto instance = std::make_unique<Instance2>(path_of(resources != nullptr ? resources : ""),
                                                guid != nullptr ? guid : "", kind, log);
    instance->set_logging(logging, {});
    return instance.release();
  } catch (const std::exception& error) {
    log(fmi::Status::error, fmi::log_error, error.what());
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component component) { delete static_cast<Instance2*>(component); }

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined,
                               fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return call(component, "fmi2SetupExperiment", fmi::instantiated, [&] {
    Instance2& now = of(component);
    now.tolerance = tolerance_defined ? std::optional(tolerance) : std::nullopt;
    now.start_time = start_time;
    now.stop_time = stop_time_defined ? std::optional(stop_time) : std::nullopt;
    now.is_set_up = true;
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return call(component, "fmi2EnterInitializationMode", fmi::instantiated, [&] {
    Instance2& now = of(component);
    if (!now.is_set_up) throw std::invalid_argument("expected fmi2SetupExperiment before");
    now.begin_initialisation(now.tolerance, now.start_time, now.stop_time);
  });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return call(component, "fmi2ExitInitializationMode", fmi::initialisation, [&] {
    const bool steps = of(component).kind == Kind::co_simulation;
    of(component).end_initialisation(steps ? fmi::step_mode : fmi::event_mode);
  });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return call(component, "fmi2Terminate", fmi::initialised,
              [&] { of(component).phase = fmi::terminated; });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return call(component, "fmi2Reset", fmi::any_phase, [&] {
    of(component).reset();
    of(component).is_set_up = false;
  });
}

// --- values -------------------------------------------------------------------------------------

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t n,
                       fmi2Real values[]) {
  return with_range(component, "fmi2GetReal", fmi::any_phase, Type::real, references, n,
                    [&](auto ranges) { of(component).get(ranges, values); });
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t n,
                       const fmi2Real values[]) {
  return with_range(component, "fmi2SetReal",
                    fmi::instantiated | fmi::initialisation | fmi::initialised, Type::real,
                    references, n, [&](auto ranges) { of(component).set(ranges, values); });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t n,
                          fmi2Integer values[]) {
  return with_range(
      component, "fmi2GetInteger", fmi::any_phase, Type::integer, references, n, [&](auto ranges) {
        std::vector<double> numbers(n);
        of(component).get(ranges, numbers.data());
        std::ranges::transform(numbers, values,
                               [](double number) { return static_cast<fmi2Integer>(number); });
      });
}

// Types that no variable has.
fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference*, size_t,
                          const fmi2Integer*) {
  return refuse(component, "fmi2SetInteger", "expected Real, no Integer can be set");
}
fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference*, size_t,
                          fmi2Boolean*) {
  return refuse(component, "fmi2GetBoolean", "expected Real or Integer, no variable is Boolean");
}
fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference*, size_t,
                          const fmi2Boolean*) {
  return refuse(component, "fmi2SetBoolean", "expected Real, no variable is Boolean");
}
fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference*, size_t, fmi2String*) {
  return refuse(component, "fmi2GetString", "expected Real or Integer, no variable is a String");
}
fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference*, size_t,
                         const fmi2String*) {
  return refuse(component, "fmi2SetString", "expected Real, no variable is a String");
}

// --- the state of the FMU -----------------------------------------------------------------------

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return call(component, "fmi2GetFMUstate", fmi::any_phase & ~fmi::failed, [&] {
    auto saved = of(component).save();
    if (*state == nullptr) {
      *state = new fmu::SavedState(std::move(saved));
    } else {
      *static_cast<fmu::SavedState*>(*state) = std::move(saved);
    }
  });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return call(component, "fmi2SetFMUstate", fmi::any_phase, [&] {
    if (state == nullptr) throw std::invalid_argument("state: expected one, got none");
    of(component).restore(*static_cast<fmu::SavedState*>(state));
  });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return call(component, "fmi2FreeFMUstate", fmi::any_phase, [&] {
    if (state == nullptr) return;
    delete static_cast<fmu::SavedState*>(*state);
    *state = nullptr;
  });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return call(component, "fmi2SerializedFMUstateSize", fmi::any_phase,
              [&] { *size = bytes_of(*static_cast<fmu::SavedState*>(state)).size(); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
  return call(component, "fmi2SerializeFMUstate", fmi::any_phase, [&] {
    const auto written = bytes_of(*static_cast<fmu::SavedState*>(state));
    Component::expect("bytes", written.size(), size);
    std::ranges::copy(written, bytes);
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate* state) {
  return call(component, "fmi2DeSerializeFMUstate", fmi::any_phase, [&] {
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes);
    auto saved = fmu::saved_state_from({begin, size});
    if (*state == nullptr) {
      *state = new fmu::SavedState(std::move(saved));
    } else {
      *static_cast<fmu::SavedState*>(*state) = std::move(saved);
    }
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component,
                                        const fmi2ValueReference unknowns[], size_t n_unknowns,
                                        const fmi2ValueReference knowns[], size_t n_knowns,
                                        const fmi2Real seed[], fmi2Real sensitivity[]) {
  return call(component, "fmi2GetDirectionalDerivative", Kind::model_exchange, fmi::initialised,
              [&] {
                Instance2& now = of(component);
                now.directional_derivative(
                    now.ranges({unknowns, n_unknowns}, Elements::single, {}, n_unknowns),
                    now.ranges({knowns, n_knowns}, Elements::single, {}, n_knowns),
                    {seed, n_knowns}, {sensitivity, n_unknowns});
              });
}

// --- Model Exchange -----------------------------------------------------------------------------

fmi2Status fmi2EnterEventMode(fmi2Component component) {
  return call(component, "fmi2EnterEventMode", Kind::model_exchange, fmi::continuous_time, [&] {
    of(component).instance->enter_event();
    of(component).phase = fmi::event_mode;
  });
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo* info) {
  return call(component, "fmi2NewDiscreteStates", Kind::model_exchange, fmi::event_mode, [&] {
    const auto update = of(component).instance->update_discrete_states();
    info->newDiscreteStatesNeeded = fmi2False;
    info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = update.states_changed;
    info->nextEventTimeDefined = update.next_time_event < hybrid::never;
    info->nextEventTime = info->nextEventTimeDefined ? update.next_time_event : 0.0;
  });
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  return call(component, "fmi2EnterContinuousTimeMode", Kind::model_exchange, fmi::event_mode,
              [&] { of(component).phase = fmi::continuous_time; });
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean,
                                       fmi2Boolean* enter_event_mode, fmi2Boolean* terminate) {
  return call(component, "fmi2CompletedIntegratorStep", Kind::model_exchange, fmi::continuous_time,
              [&] { *enter_event_mode = *terminate = fmi2False; });
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  return call(component, "fmi2SetTime", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time, [&] { of(component).set_time(time); });
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t n) {
  return call(component, "fmi2SetContinuousStates", Kind::model_exchange, fmi::continuous_time,
              [&] { of(component).set_states({states, n}); });
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t n) {
  return call(component, "fmi2GetDerivatives", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time | fmi::terminated,
              [&] { of(component).derivatives({derivatives, n}); });
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real indicators[], size_t n) {
  return call(component, "fmi2GetEventIndicators", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time | fmi::terminated, [&] {
                Component::expect("indicators", of(component).instance->n_indicators(), n);
                of(component).instance->indicators({indicators, n});
              });
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t n) {
  return call(component, "fmi2GetContinuousStates", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time | fmi::terminated, [&] {
                Component::expect("states", of(component).instance->n_states(), n);
                std::ranges::copy(of(component).instance->states(), states);
              });
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[],
                                             size_t n) {
  return call(component, "fmi2GetNominalsOfContinuousStates", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time | fmi::terminated, [&] {
                Component::expect("states", of(component).instance->n_states(), n);
                std::ranges::copy(of(component).instance->nominals(), nominals);
              });
}

// --- Co-Simulation ------------------------------------------------------------------------------

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real point, fmi2Real step, fmi2Boolean) {
  return call(component, "fmi2DoStep", Kind::co_simulation, fmi::step_mode, [&] {
    of(component).check_communication_point(point, step);
    of(component).instance->advance(point + step, fmu::Instance::Stop::at_target, {});
  });
}

fmi2Status fmi2CancelStep(fmi2Component component) {
  return refuse(component, "fmi2CancelStep", "steps do not go on in the background");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference*, size_t,
                                       const fmi2Integer*, const fmi2Real*) {
  return refuse(component, "fmi2SetRealInputDerivatives",
                "inputs are held; the rate of a reference is an input of its own");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference*, size_t,
                                        const fmi2Integer*, fmi2Real*) {
  return refuse(component, "fmi2GetRealOutputDerivatives",
                "rates and accelerations are outputs of their own");
}

fmi2Status fmi2GetRealStatus(fmi2Component component, fmi2StatusKind what, fmi2Real* value) {
  return call(component, "fmi2GetRealStatus", Kind::co_simulation, fmi::any_phase, [&] {
    if (what != fmi2LastSuccessfulTime) {
      throw std::invalid_argument("expected fmi2LastSuccessfulTime");
    }
    *value = of(component).instance->time();
  });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind what, fmi2Boolean* value) {
  return call(component, "fmi2GetBooleanStatus", Kind::co_simulation, fmi::any_phase, [&] {
    if (what != fmi2Terminated) throw std::invalid_argument("expected fmi2Terminated");
    *value = fmi2False;
  });
}

fmi2Status fmi2GetStatus(fmi2Component component, fmi2StatusKind, fmi2Status*) {
  return refuse(component, "fmi2GetStatus", "steps do not go on in the background");
}
fmi2Status fmi2GetIntegerStatus(fmi2Component component, fmi2StatusKind, fmi2Integer*) {
  return refuse(component, "fmi2GetIntegerStatus", "steps do not go on in the background");
}
fmi2Status fmi2GetStringStatus(fmi2Component component, fmi2StatusKind, fmi2String*) {
  return refuse(component, "fmi2GetStringStatus", "steps do not go on in the background");
}

}  // extern "C"
