// The C interface of FMI 3.0: each function says who may call it when, and hands over.
#include <fmi3Functions.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>
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

struct Instance3 final : Component {
  using Component::Component;

  bool early_return_allowed = false;
  fmi3InstanceEnvironment environment = nullptr;
  fmi3IntermediateUpdateCallback intermediate_update = nullptr;

  double look_up(double t);
};

fmi3Status as_fmi3(fmi::Status status) { return static_cast<fmi3Status>(status); }

template <class... Arguments>
fmi3Status call(fmi3Instance instance, Arguments&&... arguments) {
  if (instance == nullptr) return fmi3Error;
  return as_fmi3(static_cast<Instance3*>(instance)->call(std::forward<Arguments>(arguments)...));
}

Instance3& of(fmi3Instance instance) { return *static_cast<Instance3*>(instance); }

// What the importer wants during a step: until when it is to go on.
double Instance3::look_up(double t) {
  fmi3Boolean wanted = fmi3False;
  fmi3Float64 until = t;
  phase = fmi::intermediate_update;
  intermediate_update(environment, t, fmi3False, fmi3True, fmi3True, early_return_allowed, &wanted,
                      &until);
  phase = fmi::step_mode;
  return wanted && early_return_allowed ? until : hybrid::never;
}

Instance3* instantiate(fmi3String name, Kind kind, fmi3String token, fmi3String resources,
                       bool logging, fmi3InstanceEnvironment environment,
                       fmi3LogMessageCallback tell) {
  const auto log = [environment, tell](fmi::Status status, const char* category,
                                       const std::string& message) {
    if (tell != nullptr) tell(environment, as_fmi3(status), category, message.c_str());
  };
  try {
    auto instance =
        std::make_unique<Instance3>(name, resources != nullptr ? resources : "", token, kind, log);
    instance->set_logging(logging, {});
    instance->environment = environment;
    return instance.release();
  } catch (const std::exception& error) {
    log(fmi::Status::error, fmi::category_names[fmi::log_error], error.what());
    return nullptr;
  }
}

// A function that some FMUs have and this one has nothing to do for.
fmi3Status refuse(fmi3Instance instance, const char* function, const char* reason) {
  if (instance == nullptr) return fmi3Error;
  return as_fmi3(of(instance).refuse(function, reason));
}

auto ranges(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
            std::optional<Type> type, size_t n_values) {
  return of(instance).ranges(list("value references", references, n), Elements::whole, type,
                             n_values);
}

}  // namespace

extern "C" {

// --- common functions ---------------------------------------------------------------------------

const char* fmi3GetVersion() { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                               const fmi3String categories[]) {
  return call(instance, "fmi3SetDebugLogging", fmi::between_steps,
              [&] { of(instance).set_logging(on, list("categories", categories, n)); });
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                          fmi3Boolean, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback log) {
  return instantiate(name, Kind::model_exchange, token, resources, logging, environment, log);
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean, fmi3Boolean logging,
    fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed, const fmi3ValueReference[],
    size_t, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback intermediate_update) {
  Instance3* instance =
      instantiate(name, Kind::co_simulation, token, resources, logging, environment, log);
  if (instance == nullptr) return nullptr;
  if (event_mode_used) instance->possible |= fmi::event_mode;
  instance->early_return_allowed = early_return_allowed;
  instance->intermediate_update = intermediate_update;
  return instance;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean,
                                               fmi3Boolean, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback log, fmi3ClockUpdateCallback,
                                               fmi3LockPreemptionCallback,
                                               fmi3UnlockPreemptionCallback) {
  if (log != nullptr) {
    log(environment, fmi3Error, fmi::category_names[fmi::log_error],
        "fmi3InstantiateScheduledExecution: expected Model Exchange or Co-Simulation");
  }
  return nullptr;
}

void fmi3FreeInstance(fmi3Instance instance) {
  if (instance != nullptr && of(instance).phase == fmi::intermediate_update) {
    refuse(instance, "fmi3FreeInstance", "a step is on its way");
    return;
  }
  delete static_cast<Instance3*>(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined,
                                       fmi3Float64 tolerance, fmi3Float64 start_time,
                                       fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
  return call(instance, "fmi3EnterInitializationMode", fmi::instantiated, [&] {
    of(instance).set_up_experiment(tolerance_defined ? std::optional(tolerance) : std::nullopt,
                                   start_time,
                                   stop_time_defined ? std::optional(stop_time) : std::nullopt);
    of(instance).phase = fmi::initialisation;
  });
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  return call(instance, "fmi3ExitInitializationMode", fmi::initialisation,
              [&] { of(instance).end_initialisation(); });
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  return call(instance, "fmi3EnterEventMode", fmi::continuous_time | fmi::step_mode, [&] {
    if ((of(instance).possible & fmi::event_mode) == 0) {
      throw std::invalid_argument("the instance was created without event mode");
    }
    of(instance).enter_event_mode();
  });
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  return call(instance, "fmi3Terminate", fmi::initialised,
              [&] { of(instance).phase = fmi::terminated; });
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  return call(instance, "fmi3Reset", fmi::between_steps, [&] { of(instance).reset(); });
}

// --- values -------------------------------------------------------------------------------------

// Before initialisation these are start values, or what follows from them.
constexpr unsigned readable = fmi::between_steps | fmi::intermediate_update;

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                          fmi3Float64 values[], size_t n_values) {
  return call(instance, "fmi3GetFloat64", readable, [&] {
    of(instance).get(ranges(instance, references, n, Type::real, n_values),
                     list("values", values, n_values));
  });
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                          const fmi3Float64 values[], size_t n_values) {
  return call(instance, "fmi3SetFloat64",
              fmi::instantiated | fmi::initialisation | fmi::initialised, [&] {
                of(instance).set(ranges(instance, references, n, Type::real, n_values),
                                 list("values", values, n_values));
              });
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                        fmi3Int32 values[], size_t n_values) {
  return call(instance, "fmi3GetInt32", readable, [&] {
    std::vector<double> numbers(list("values", values, n_values).size());
    of(instance).get(ranges(instance, references, n, Type::integer, n_values), numbers);
    std::ranges::transform(numbers, values,
                           [](double number) { return static_cast<fmi3Int32>(number); });
  });
}

// Types that no variable has.
#define MANUTEC_R3_NO_VARIABLES(type)                                                             \
  fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference*, size_t, fmi3##type*, \
                           size_t) {                                                              \
    return refuse(instance, "fmi3Get" #type, "expected Float64 or Int32, no variable is " #type); \
  }                                                                                               \
  fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference*, size_t,              \
                           const fmi3##type*, size_t) {                                           \
    return refuse(instance, "fmi3Set" #type,                                                      \
                  "expected Float64, no variable that can be set is " #type);                     \
  }
MANUTEC_R3_NO_VARIABLES(Float32)
MANUTEC_R3_NO_VARIABLES(Int8)
MANUTEC_R3_NO_VARIABLES(UInt8)
MANUTEC_R3_NO_VARIABLES(Int16)
MANUTEC_R3_NO_VARIABLES(UInt16)
MANUTEC_R3_NO_VARIABLES(UInt32)
MANUTEC_R3_NO_VARIABLES(Int64)
MANUTEC_R3_NO_VARIABLES(UInt64)
MANUTEC_R3_NO_VARIABLES(Boolean)
MANUTEC_R3_NO_VARIABLES(String)
#undef MANUTEC_R3_NO_VARIABLES

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference*, size_t, const fmi3Int32*,
                        size_t) {
  return refuse(instance, "fmi3SetInt32", "expected Float64, no variable that can be set is Int32");
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference*, size_t, size_t*,
                         fmi3Binary*, size_t) {
  return refuse(instance, "fmi3GetBinary", "expected Float64 or Int32, no variable is Binary");
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference*, size_t, const size_t*,
                         const fmi3Binary*, size_t) {
  return refuse(instance, "fmi3SetBinary", "expected Float64, no variable is Binary");
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference, size_t*) {
  return refuse(instance, "fmi3GetNumberOfVariableDependencies",
                "what depends on what does not change with the parameters");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference, size_t*,
                                       fmi3ValueReference*, size_t*, fmi3DependencyKind*, size_t) {
  return refuse(instance, "fmi3GetVariableDependencies",
                "what depends on what does not change with the parameters");
}

// --- the state of the FMU -----------------------------------------------------------------------

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return call(instance, "fmi3GetFMUState", fmi::between_steps,
              [&] { of(instance).get_state(state); });
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  return call(instance, "fmi3SetFMUState", fmi::between_steps,
              [&] { of(instance).set_state(state); });
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState* state) {
  return call(instance, "fmi3FreeFMUState", fmi::between_steps,
              [&] { Component::free_state(state); });
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t* size) {
  return call(instance, "fmi3SerializedFMUStateSize", fmi::between_steps,
              [&] { place("size", size) = Component::serialise(state).size(); });
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                 size_t size) {
  return call(instance, "fmi3SerializeFMUState", fmi::between_steps, [&] {
    const auto written = Component::serialise(state);
    Component::expect("bytes", written.size(), size);
    std::ranges::copy(written, list("bytes", bytes, size).begin());
  });
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState* state) {
  return call(instance, "fmi3DeserializeFMUState", fmi::between_steps,
              [&] { Component::deserialise(list("bytes", bytes, size), state); });
}

// --- derivatives --------------------------------------------------------------------------------

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[],
                                        size_t n_unknowns, const fmi3ValueReference knowns[],
                                        size_t n_knowns, const fmi3Float64 seed[], size_t n_seed,
                                        fmi3Float64 sensitivity[], size_t n_sensitivity) {
  return call(instance, "fmi3GetDirectionalDerivative", Kind::model_exchange, fmi::evaluable, [&] {
    of(instance).directional_derivative(ranges(instance, unknowns, n_unknowns, {}, n_sensitivity),
                                        ranges(instance, knowns, n_knowns, {}, n_seed),
                                        list("seed", seed, n_seed),
                                        list("sensitivity", sensitivity, n_sensitivity));
  });
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference*, size_t,
                                    const fmi3ValueReference*, size_t, const fmi3Float64*, size_t,
                                    fmi3Float64*, size_t) {
  return refuse(instance, "fmi3GetAdjointDerivative", "expected directional derivatives");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference*, size_t,
                                    const fmi3Int32*, fmi3Float64*, size_t) {
  return refuse(instance, "fmi3GetOutputDerivatives",
                "rates and accelerations are outputs of their own");
}

// --- modes and clocks that this FMU does not have -----------------------------------------------

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
  return refuse(instance, "fmi3EnterConfigurationMode", "there are no structural parameters");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
  return refuse(instance, "fmi3ExitConfigurationMode", "there are no structural parameters");
}

// --- the clock of sampled controllers ------------------------------------------------------------

// Time events announce the samples in any case; an importer with clocks may let them tick.

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                        fmi3Clock values[]) {
  return call(instance, "fmi3GetClock", fmi::event_mode, [&] {
    const auto clocks = of(instance).ranges(list("value references", references, n),
                                            Elements::whole, Type::clock, n);
    std::vector<double> ticks(n);
    of(instance).get(clocks, ticks);
    std::ranges::transform(ticks, list("values", values, n).begin(), [](double tick) {
      return tick != 0.0 ? fmi3ClockActive : fmi3ClockInactive;
    });
  });
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n,
                        const fmi3Clock values[]) {
  return call(instance, "fmi3SetClock", fmi::event_mode, [&] {
    of(instance).ranges(list("value references", references, n), Elements::whole, Type::clock, n);
    for (const fmi3Clock active : list("values", values, n)) {
      if (!active) continue;
      of(instance).instance->tick();
      of(instance).phase = fmi::event_begun;
    }
  });
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                                  size_t n, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[]) {
  return call(instance, "fmi3GetIntervalDecimal", fmi::initialisation | fmi::initialised, [&] {
    of(instance).ranges(list("value references", references, n), Elements::whole, Type::clock, n);
    for (fmi3Float64& interval : list("intervals", intervals, n)) {
      interval = of(instance).instance->sampling_time();
    }
    // It is fixed when initialisation begins.
    std::ranges::fill(list("qualifiers", qualifiers, n), fmi3IntervalUnchanged);
  });
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[],
                               size_t n, fmi3Float64 shifts[]) {
  return call(instance, "fmi3GetShiftDecimal", fmi::initialisation | fmi::initialised, [&] {
    of(instance).ranges(list("value references", references, n), Elements::whole, Type::clock, n);
    std::ranges::fill(list("shifts", shifts, n), 0.0);
  });
}

#define MANUTEC_R3_NO_CLOCKS(name, ...)                                                       \
  fmi3Status fmi3##name(fmi3Instance instance, __VA_ARGS__) {                                 \
    return refuse(instance, "fmi3" #name, "the clock's interval is a parameter, in seconds"); \
  }
MANUTEC_R3_NO_CLOCKS(GetIntervalFraction, const fmi3ValueReference*, size_t, fmi3UInt64*,
                     fmi3UInt64*, fmi3IntervalQualifier*)
MANUTEC_R3_NO_CLOCKS(GetShiftFraction, const fmi3ValueReference*, size_t, fmi3UInt64*, fmi3UInt64*)
MANUTEC_R3_NO_CLOCKS(SetIntervalDecimal, const fmi3ValueReference*, size_t, const fmi3Float64*)
MANUTEC_R3_NO_CLOCKS(SetIntervalFraction, const fmi3ValueReference*, size_t, const fmi3UInt64*,
                     const fmi3UInt64*)
MANUTEC_R3_NO_CLOCKS(SetShiftDecimal, const fmi3ValueReference*, size_t, const fmi3Float64*)
MANUTEC_R3_NO_CLOCKS(SetShiftFraction, const fmi3ValueReference*, size_t, const fmi3UInt64*,
                     const fmi3UInt64*)
#undef MANUTEC_R3_NO_CLOCKS

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference, fmi3Float64) {
  return refuse(instance, "fmi3ActivateModelPartition",
                "expected Model Exchange or Co-Simulation, not scheduled execution");
}

// --- events -------------------------------------------------------------------------------------

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  return refuse(instance, "fmi3EvaluateDiscreteStates",
                "discrete states change with fmi3UpdateDiscreteStates only");
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean* need_update,
                                    fmi3Boolean* terminate, fmi3Boolean* nominals_changed,
                                    fmi3Boolean* states_changed, fmi3Boolean* next_defined,
                                    fmi3Float64* next) {
  return call(instance, "fmi3UpdateDiscreteStates", fmi::event_mode, [&] {
    for (fmi3Boolean* told :
         {need_update, terminate, nominals_changed, states_changed, next_defined}) {
      place("event info", told) = fmi3False;
    }
    place("next event time", next) = 0.0;
    const auto update = of(instance).update_discrete_states();
    *states_changed = update.states_changed;
    *next_defined = update.next_time_event < hybrid::never;
    if (*next_defined) *next = update.next_time_event;
  });
}

// --- Model Exchange -----------------------------------------------------------------------------

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  return call(instance, "fmi3EnterContinuousTimeMode", Kind::model_exchange, fmi::event_handled,
              [&] { of(instance).phase = fmi::continuous_time; });
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean,
                                       fmi3Boolean* enter_event_mode, fmi3Boolean* terminate) {
  return call(instance, "fmi3CompletedIntegratorStep", Kind::model_exchange, fmi::continuous_time,
              [&] {
                place("enter event mode", enter_event_mode) = fmi3False;
                place("terminate simulation", terminate) = fmi3False;
              });
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  return call(instance, "fmi3SetTime", Kind::model_exchange, fmi::continuous_time,
              [&] { of(instance).set_time(time); });
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t n) {
  return call(instance, "fmi3SetContinuousStates", Kind::model_exchange, fmi::continuous_time,
              [&] { of(instance).set_states(list("states", states, n)); });
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[],
                                             size_t n) {
  return call(instance, "fmi3GetContinuousStateDerivatives", Kind::model_exchange, fmi::evaluable,
              [&] { of(instance).derivatives(list("derivatives", derivatives, n)); });
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], size_t n) {
  return call(instance, "fmi3GetEventIndicators", Kind::model_exchange, fmi::evaluable,
              [&] { of(instance).indicators(list("indicators", indicators, n)); });
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], size_t n) {
  return call(instance, "fmi3GetContinuousStates", Kind::model_exchange, fmi::evaluable,
              [&] { of(instance).get_states(list("states", states, n)); });
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[],
                                             size_t n) {
  return call(instance, "fmi3GetNominalsOfContinuousStates", Kind::model_exchange, fmi::evaluable,
              [&] { of(instance).get_nominals(list("nominals", nominals, n)); });
}

// Numbers that never change can be asked for at any time.
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t* n) {
  return call(instance, "fmi3GetNumberOfEventIndicators", Kind::model_exchange, fmi::between_steps,
              [&] { place("number", n) = of(instance).instance->n_indicators(); });
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t* n) {
  return call(instance, "fmi3GetNumberOfContinuousStates", Kind::model_exchange, fmi::between_steps,
              [&] { place("number", n) = of(instance).instance->n_states(); });
}

// --- Co-Simulation ------------------------------------------------------------------------------

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
  return call(instance, "fmi3EnterStepMode", Kind::co_simulation, fmi::event_handled,
              [&] { of(instance).phase = fmi::step_mode; });
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 point, fmi3Float64 step, fmi3Boolean,
                      fmi3Boolean* event_handling_needed, fmi3Boolean* terminate,
                      fmi3Boolean* early_return, fmi3Float64* last_successful_time) {
  return call(instance, "fmi3DoStep", Kind::co_simulation, fmi::step_mode, [&] {
    Instance3& now = of(instance);
    for (fmi3Boolean* told : {event_handling_needed, terminate, early_return}) {
      place("result", told) = fmi3False;
    }
    place("last successful time", last_successful_time) = now.instance->time();
    fmu::Instance::LookUp look_up;
    if (now.intermediate_update != nullptr) look_up = [&](double t) { return now.look_up(t); };
    const bool may_stop = (now.possible & fmi::event_mode) != 0 && now.early_return_allowed;
    *event_handling_needed = now.do_step(
        point, step, may_stop ? fmu::Instance::Stop::at_event : fmu::Instance::Stop::at_target,
        look_up);
    *last_successful_time = now.instance->time();
    *early_return = now.instance->time() < point + step;
  });
}

}  // extern "C"
