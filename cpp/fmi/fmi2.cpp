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
using fmi::list;
using fmi::place;
using fmu::Kind;
using Elements = Component::Elements;
using Type = Component::Type;

fmi2Status as_fmi2(fmi::Status status) { return static_cast<fmi2Status>(status); }

template <class... Arguments>
fmi2Status call(fmi2Component component, Arguments&&... arguments) {
  if (component == nullptr) return fmi2Error;
  return as_fmi2(static_cast<Component*>(component)->call(std::forward<Arguments>(arguments)...));
}

Component& of(fmi2Component component) { return *static_cast<Component*>(component); }

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

auto ranges(fmi2Component component, const fmi2ValueReference references[], size_t n,
            std::optional<Type> type) {
  return of(component).ranges(list("value references", references, n), Elements::single, type, n);
}

}  // namespace

extern "C" {

// --- common functions ---------------------------------------------------------------------------

const char* fmi2GetTypesPlatform() { return fmi2TypesPlatform; }
const char* fmi2GetVersion() { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                               const fmi2String categories[]) {
  return call(component, "fmi2SetDebugLogging", fmi::between_steps,
              [&] { of(component).set_logging(on, list("categories", categories, n)); });
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean,
                              fmi2Boolean logging) {
  const auto logger = callbacks != nullptr ? callbacks->logger : nullptr;
  const auto environment = callbacks != nullptr ? callbacks->componentEnvironment : nullptr;
  const std::string instance_name = name != nullptr ? name : "";
  const auto log = [logger, environment, instance_name](fmi::Status status, const char* category,
                                                        const std::string& message) {
    if (logger == nullptr) return;
    logger(environment, instance_name.c_str(), as_fmi2(status), category, "%s", message.c_str());
  };
  const Kind kind = type == fmi2ModelExchange ? Kind::model_exchange : Kind::co_simulation;
  try {
    auto instance = std::make_unique<Component>(
        name, path_of(resources != nullptr ? resources : ""), guid, kind, log);
    instance->set_logging(logging, {});
    return instance.release();
  } catch (const std::exception& error) {
    log(fmi::Status::error, fmi::category_names[fmi::log_error], error.what());
    return nullptr;
  }
}

void fmi2FreeInstance(fmi2Component component) { delete static_cast<Component*>(component); }

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined,
                               fmi2Real tolerance, fmi2Real start_time,
                               fmi2Boolean stop_time_defined, fmi2Real stop_time) {
  return call(component, "fmi2SetupExperiment", fmi::created, [&] {
    of(component).set_up_experiment(tolerance_defined ? std::optional(tolerance) : std::nullopt,
                                    start_time,
                                    stop_time_defined ? std::optional(stop_time) : std::nullopt);
    of(component).phase = fmi::set_up;
  });
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
  return call(component, "fmi2EnterInitializationMode", fmi::set_up,
              [&] { of(component).phase = fmi::initialisation; });
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
  return call(component, "fmi2ExitInitializationMode", fmi::initialisation,
              [&] { of(component).end_initialisation(); });
}

fmi2Status fmi2Terminate(fmi2Component component) {
  return call(component, "fmi2Terminate", fmi::initialised,
              [&] { of(component).phase = fmi::terminated; });
}

fmi2Status fmi2Reset(fmi2Component component) {
  return call(component, "fmi2Reset", fmi::between_steps, [&] { of(component).reset(); });
}

// --- values -------------------------------------------------------------------------------------

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t n,
                       fmi2Real values[]) {
  return call(component, "fmi2GetReal", fmi::evaluable, [&] {
    of(component).get(ranges(component, references, n, Type::real), list("values", values, n));
  });
}

// Inputs, too, from the beginning: importers set their start values with those of parameters.
fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t n,
                       const fmi2Real values[]) {
  return call(component, "fmi2SetReal", fmi::created | fmi::initialisation | fmi::initialised, [&] {
    of(component).set(ranges(component, references, n, Type::real), list("values", values, n));
  });
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t n,
                          fmi2Integer values[]) {
  return call(component, "fmi2GetInteger", fmi::evaluable, [&] {
    std::vector<double> numbers(n);
    of(component).get(ranges(component, references, n, Type::integer), numbers);
    std::ranges::transform(numbers, list("values", values, n).begin(),
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
  return call(component, "fmi2GetFMUstate", fmi::between_steps,
              [&] { of(component).get_state(state); });
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
  return call(component, "fmi2SetFMUstate", fmi::between_steps,
              [&] { of(component).set_state(state); });
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate* state) {
  return call(component, "fmi2FreeFMUstate", fmi::between_steps,
              [&] { Component::free_state(state); });
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t* size) {
  return call(component, "fmi2SerializedFMUstateSize", fmi::between_steps,
              [&] { place("size", size) = Component::serialise(state).size(); });
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
  return call(component, "fmi2SerializeFMUstate", fmi::between_steps, [&] {
    const auto written = Component::serialise(state);
    Component::expect("bytes", written.size(), size);
    std::ranges::copy(written, list("bytes", bytes, size).begin());
  });
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate* state) {
  return call(component, "fmi2DeSerializeFMUstate", fmi::between_steps, [&] {
    const auto* begin = reinterpret_cast<const unsigned char*>(bytes);
    Component::deserialise(list("bytes", begin, size), state);
  });
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component,
                                        const fmi2ValueReference unknowns[], size_t n_unknowns,
                                        const fmi2ValueReference knowns[], size_t n_knowns,
                                        const fmi2Real seed[], fmi2Real sensitivity[]) {
  return call(component, "fmi2GetDirectionalDerivative", Kind::model_exchange, fmi::evaluable, [&] {
    of(component).directional_derivative(
        ranges(component, unknowns, n_unknowns, {}), ranges(component, knowns, n_knowns, {}),
        list("seed", seed, n_knowns), list("sensitivity", sensitivity, n_unknowns));
  });
}

// --- Model Exchange -----------------------------------------------------------------------------

fmi2Status fmi2EnterEventMode(fmi2Component component) {
  return call(component, "fmi2EnterEventMode", Kind::model_exchange,
              fmi::event_mode | fmi::continuous_time, [&] { of(component).enter_event_mode(); });
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo* info) {
  return call(component, "fmi2NewDiscreteStates", Kind::model_exchange, fmi::event_mode, [&] {
    fmi2EventInfo& told = place("event info", info);
    const auto update = of(component).update_discrete_states();
    told.newDiscreteStatesNeeded = fmi2False;
    told.terminateSimulation = fmi2False;
    told.nominalsOfContinuousStatesChanged = fmi2False;
    told.valuesOfContinuousStatesChanged = update.states_changed;
    told.nextEventTimeDefined = update.next_time_event < hybrid::never;
    told.nextEventTime = told.nextEventTimeDefined ? update.next_time_event : 0.0;
  });
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
  return call(component, "fmi2EnterContinuousTimeMode", Kind::model_exchange, fmi::event_handled,
              [&] { of(component).phase = fmi::continuous_time; });
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean,
                                       fmi2Boolean* enter_event_mode, fmi2Boolean* terminate) {
  return call(component, "fmi2CompletedIntegratorStep", Kind::model_exchange, fmi::continuous_time,
              [&] {
                place("enter event mode", enter_event_mode) = fmi2False;
                place("terminate simulation", terminate) = fmi2False;
              });
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
  return call(component, "fmi2SetTime", Kind::model_exchange, fmi::continuous_time,
              [&] { of(component).set_time(time); });
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t n) {
  return call(component, "fmi2SetContinuousStates", Kind::model_exchange, fmi::continuous_time,
              [&] { of(component).set_states(list("states", states, n)); });
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t n) {
  return call(component, "fmi2GetDerivatives", Kind::model_exchange, fmi::evaluable,
              [&] { of(component).derivatives(list("derivatives", derivatives, n)); });
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real indicators[], size_t n) {
  return call(component, "fmi2GetEventIndicators", Kind::model_exchange, fmi::evaluable,
              [&] { of(component).indicators(list("indicators", indicators, n)); });
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t n) {
  return call(component, "fmi2GetContinuousStates", Kind::model_exchange, fmi::evaluable,
              [&] { of(component).get_states(list("states", states, n)); });
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[],
                                             size_t n) {
  return call(component, "fmi2GetNominalsOfContinuousStates", Kind::model_exchange,
              fmi::between_steps,
              [&] { of(component).get_nominals(list("nominals", nominals, n)); });
}

// --- Co-Simulation ------------------------------------------------------------------------------

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real point, fmi2Real step, fmi2Boolean) {
  return call(component, "fmi2DoStep", Kind::co_simulation, fmi::step_mode,
              [&] { of(component).do_step(point, step, fmu::Instance::Stop::at_target, {}); });
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
  return call(component, "fmi2GetRealStatus", Kind::co_simulation, fmi::step_mode | fmi::ended,
              [&] {
                if (what != fmi2LastSuccessfulTime) {
                  throw std::invalid_argument("expected fmi2LastSuccessfulTime");
                }
                place("value", value) = of(component).instance->time();
              });
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, fmi2StatusKind what, fmi2Boolean* value) {
  return call(component, "fmi2GetBooleanStatus", Kind::co_simulation, fmi::step_mode | fmi::ended,
              [&] {
                if (what != fmi2Terminated) throw std::invalid_argument("expected fmi2Terminated");
                place("value", value) = fmi2False;
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
