// FMI 3.0: calls by the names of the importer, and what only this version has.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

// --- calls --------------------------------------------------------------------------------------

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
                        fmi3String message) {
  take_message(environment, (Status)status, category, message);
}

static void instantiate(Instance* instance, const char* name, const char* token,
                        const char* resources) {
  if (instance->kind == MODEL_EXCHANGE) {
    instance->handle = fmi.fmi3InstantiateModelExchange(name, token, resources, fmi3False,
                                                        fmi3False, instance, log_message);
  } else {
    const bool events = instance->kind == CO_SIMULATION_WITH_EVENTS;
    instance->handle = fmi.fmi3InstantiateCoSimulation(name, token, resources, fmi3False, fmi3False,
                                                       events, true, NULL, 0, instance, log_message,
                                                       instance->intermediate_update);
  }
}

static void free_instance(void* i) { fmi.fmi3FreeInstance(i); }
static Status reset(void* i) { return (Status)fmi.fmi3Reset(i); }
static Status enter_initialisation(void* i, double tolerance, double start, double stop) {
  return (Status)fmi.fmi3EnterInitializationMode(i, fmi3True, tolerance, start, fmi3True, stop);
}
static Status exit_initialisation(void* i) { return (Status)fmi.fmi3ExitInitializationMode(i); }
static Status terminate(void* i) { return (Status)fmi.fmi3Terminate(i); }
static Status get(void* i, const Variable* variable, double* values) {
  return (Status)fmi.fmi3GetFloat64(i, &variable->first, 1, values, variable->size);
}
static Status get_integer(void* i, const Variable* variable, int* values) {
  return (Status)fmi.fmi3GetInt32(i, &variable->first, 1, values, variable->size);
}
static Status set(void* i, const Variable* variable, const double* values) {
  return (Status)fmi.fmi3SetFloat64(i, &variable->first, 1, values, variable->size);
}
static Status get_state(void* i, void** state) { return (Status)fmi.fmi3GetFMUState(i, state); }
static Status set_state(void* i, void* state) { return (Status)fmi.fmi3SetFMUState(i, state); }
static Status free_state(void* i, void** state) { return (Status)fmi.fmi3FreeFMUState(i, state); }
static Status size_of_state(void* i, void* state, size_t* size) {
  return (Status)fmi.fmi3SerializedFMUStateSize(i, state, size);
}
static Status serialise(void* i, void* state, char* bytes, size_t size) {
  return (Status)fmi.fmi3SerializeFMUState(i, state, (fmi3Byte*)bytes, size);
}
static Status deserialise(void* i, const char* bytes, size_t size, void** state) {
  return (Status)fmi.fmi3DeserializeFMUState(i, (const fmi3Byte*)bytes, size, state);
}
static Status directional_derivative(void* i, const Variable* unknown, const Variable* known,
                                     const double* seed, double* sensitivity) {
  return (Status)fmi.fmi3GetDirectionalDerivative(i, &unknown->first, 1, &known->first, 1, seed,
                                                  known->size, sensitivity, unknown->size);
}
static Status enter_event(void* i) { return (Status)fmi.fmi3EnterEventMode(i); }
static Status update(void* i, Update* update) {
  fmi3Boolean again, terminate, nominals, states, defined;
  const Status status = (Status)fmi.fmi3UpdateDiscreteStates(i, &again, &terminate, &nominals,
                                                             &states, &defined, &update->next_time);
  if (status != STATUS_OK) return status;
  CHECK(!again && !terminate && !nominals);
  update->states_changed = states;
  update->next_time_defined = defined;
  return status;
}
static Status enter_continuous_time(void* i) { return (Status)fmi.fmi3EnterContinuousTimeMode(i); }
static Status set_time(void* i, double t) { return (Status)fmi.fmi3SetTime(i, t); }
static Status set_states(void* i, const double* x, size_t n) {
  return (Status)fmi.fmi3SetContinuousStates(i, x, n);
}
static Status get_states(void* i, double* x, size_t n) {
  return (Status)fmi.fmi3GetContinuousStates(i, x, n);
}
static Status nominals(void* i, double* nominals, size_t n) {
  return (Status)fmi.fmi3GetNominalsOfContinuousStates(i, nominals, n);
}
static Status derivatives(void* i, double* dx, size_t n) {
  return (Status)fmi.fmi3GetContinuousStateDerivatives(i, dx, n);
}
static Status indicators(void* i, double* z, size_t n) {
  return (Status)fmi.fmi3GetEventIndicators(i, z, n);
}

static bool event_needed, early_return, flag;
static double last_time;

static Status do_step(void* i, double t, double h) {
  return (Status)fmi.fmi3DoStep(i, t, h, fmi3True, &event_needed, &flag, &early_return, &last_time);
}

const Calls fmi3_calls = {
    .instantiate = instantiate,
    .free = free_instance,
    .reset = reset,
    .enter_initialisation = enter_initialisation,
    .exit_initialisation = exit_initialisation,
    .terminate = terminate,
    .get = get,
    .get_integer = get_integer,
    .set = set,
    .get_state = get_state,
    .set_state = set_state,
    .free_state = free_state,
    .size_of_state = size_of_state,
    .serialise = serialise,
    .deserialise = deserialise,
    .directional_derivative = directional_derivative,
    .enter_event = enter_event,
    .update = update,
    .enter_continuous_time = enter_continuous_time,
    .set_time = set_time,
    .set_states = set_states,
    .get_states = get_states,
    .nominals = nominals,
    .derivatives = derivatives,
    .indicators = indicators,
    .step = do_step,
};

// --- the order of calls: sections 2.3, 3.2 and 4.2 of FMI 3.0
// -------------------------------------

enum {
  EVENT_MODE = EVENT | EVENT_HANDLED,
  INITIALISED = EVENT_MODE | CONTINUOUS_TIME | STEP,
  READABLE = INITIALISATION | INITIALISED | TERMINATED,
  ANYWHERE = INSTANTIATED | READABLE | FAILED,
};

static double numbers[MOST_STATES];
static int integers[10];
static size_t size;

static const fmi3ValueReference* reference_of(const char* name) { return &find(name)->first; }

#define CALL(function, ...)                             \
  static Status call_##function(void* instance) {       \
    return (Status)fmi.function(instance, __VA_ARGS__); \
  }
#define CALL_ALONE(function) \
  static Status call_##function(void* instance) { return (Status)fmi.function(instance); }
// Of a type that no variable has.
#define CALL_TYPE(type)                                               \
  CALL(fmi3Get##type, reference_of("time"), 1, (fmi3##type[1]){0}, 1) \
  CALL(fmi3Set##type, reference_of("time"), 1, (const fmi3##type[1]){0}, 1)

CALL(fmi3SetDebugLogging, fmi3True, 0, NULL)
CALL(fmi3EnterInitializationMode, fmi3False, 0.0, 0.0, fmi3False, 0.0)
CALL_ALONE(fmi3ExitInitializationMode)
CALL_ALONE(fmi3EnterEventMode)
CALL_ALONE(fmi3Terminate)
CALL_ALONE(fmi3Reset)
CALL(fmi3GetFloat64, reference_of("table_3.gravity"), 1, numbers, 1)
CALL(fmi3SetFloat64, reference_of("input.tip_force"), 1, (double[3]){1.0, 2.0, 3.0}, 3)
CALL(fmi3GetInt32, reference_of("n_events"), 1, integers, 1)
CALL(fmi3SetInt32, reference_of("n_events"), 1, integers, 1)
CALL_TYPE(Float32)
CALL_TYPE(Int8)
CALL_TYPE(UInt8)
CALL_TYPE(Int16)
CALL_TYPE(UInt16)
CALL_TYPE(UInt32)
CALL_TYPE(Int64)
CALL_TYPE(UInt64)
CALL_TYPE(Boolean)
CALL_TYPE(String)
CALL(fmi3GetBinary, reference_of("time"), 1, &size, (fmi3Binary[1]){NULL}, 1)
CALL(fmi3SetBinary, reference_of("time"), 1, &size, (fmi3Binary[1]){NULL}, 1)
CALL(fmi3GetClock, reference_of("time"), 1, &flag)
CALL(fmi3SetClock, reference_of("time"), 1, &flag)
CALL(fmi3GetNumberOfVariableDependencies, 0, &size)
CALL(fmi3GetVariableDependencies, 0, &size, (fmi3ValueReference[1]){0}, &size,
     (fmi3DependencyKind[1]){fmi3Dependent}, 1)
CALL(fmi3GetDirectionalDerivative, reference_of("der(state.joint_rate)"), 1,
     reference_of("input.tip_force"), 1, (double[3]){1.0, 0.0, 0.0}, 3, numbers,
     find("der(state.joint_rate)")->size)
CALL(fmi3GetAdjointDerivative, reference_of("der(state.joint_rate)"), 1,
     reference_of("input.tip_force"), 1, numbers, 6, numbers, 3)
CALL_ALONE(fmi3EnterConfigurationMode)
CALL_ALONE(fmi3ExitConfigurationMode)
CALL(fmi3GetIntervalDecimal, reference_of("time"), 1, numbers, (fmi3IntervalQualifier[1]){0})
CALL(fmi3GetIntervalFraction, reference_of("time"), 1, (fmi3UInt64[1]){0}, (fmi3UInt64[1]){0},
     (fmi3IntervalQualifier[1]){0})
CALL(fmi3GetShiftDecimal, reference_of("time"), 1, numbers)
CALL(fmi3GetShiftFraction, reference_of("time"), 1, (fmi3UInt64[1]){0}, (fmi3UInt64[1]){0})
CALL(fmi3SetIntervalDecimal, reference_of("time"), 1, numbers)
CALL(fmi3SetIntervalFraction, reference_of("time"), 1, (fmi3UInt64[1]){0}, (fmi3UInt64[1]){0})
CALL(fmi3SetShiftDecimal, reference_of("time"), 1, numbers)
CALL(fmi3SetShiftFraction, reference_of("time"), 1, (fmi3UInt64[1]){0}, (fmi3UInt64[1]){0})
CALL_ALONE(fmi3EvaluateDiscreteStates)
CALL(fmi3UpdateDiscreteStates, &flag, &flag, &flag, &flag, &flag, numbers)
CALL_ALONE(fmi3EnterContinuousTimeMode)
CALL(fmi3CompletedIntegratorStep, fmi3True, &flag, &flag)
CALL(fmi3SetTime, 0.001)
CALL(fmi3GetContinuousStateDerivatives, numbers, fmu.n_states)
CALL(fmi3GetEventIndicators, numbers, fmu.n_indicators)
CALL(fmi3GetContinuousStates, numbers, fmu.n_states)
CALL(fmi3GetNominalsOfContinuousStates, numbers, fmu.n_states)
CALL(fmi3GetNumberOfEventIndicators, &size)
CALL(fmi3GetNumberOfContinuousStates, &size)
CALL_ALONE(fmi3EnterStepMode)
CALL(fmi3GetOutputDerivatives, reference_of("joint_angle"), 1, integers, numbers, 6)
CALL(fmi3DoStep, 0.0, 0.001, fmi3True, &event_needed, &flag, &early_return, &last_time)
CALL(fmi3ActivateModelPartition, 0, 0.0)

static Status call_fmi3SetContinuousStates(void* instance) {
  double x[MOST_STATES] = {0.0};
  return (Status)fmi.fmi3SetContinuousStates(instance, x, fmu.n_states);
}
static Status set_parameter(void* instance) {
  return (Status)fmi.fmi3SetFloat64(instance, reference_of("load.mass"), 1, (double[1]){1.0}, 1);
}
static Status get_fmu_state(void* instance) {
  void* state = NULL;
  const fmi3Status status = fmi.fmi3GetFMUState(instance, &state);
  if (status == fmi3OK) fmi.fmi3FreeFMUState(instance, &state);
  return (Status)status;
}
static Status free_fmu_state(void* instance) {
  return (Status)fmi.fmi3FreeFMUState(instance, &(fmi3FMUState){NULL});
}
// Taken, written, read, given back.
static Status set_fmu_state(void* instance) {
  void *state = NULL, *again = NULL;
  fmi3Byte* bytes = NULL;
  fmi3Status status = fmi.fmi3GetFMUState(instance, &state);
  if (status != fmi3OK) return (Status)status;
  status = fmi.fmi3SerializedFMUStateSize(instance, state, &size);
  if (status == fmi3OK) {
    bytes = malloc(size);
    status = fmi.fmi3SerializeFMUState(instance, state, bytes, size);
  }
  if (status == fmi3OK) status = fmi.fmi3DeserializeFMUState(instance, bytes, size, &again);
  if (status == fmi3OK) status = fmi.fmi3SetFMUState(instance, again);
  free(bytes);
  fmi.fmi3FreeFMUState(instance, &state);
  fmi.fmi3FreeFMUState(instance, &again);
  return (Status)status;
}

#define RULE(function, exchange, simulation) {#function, call_##function, exchange, simulation}
#define NEVER(function) RULE(function, 0, 0)
#define NEVER_OF(type) NEVER(fmi3Get##type), NEVER(fmi3Set##type)

static const Rule rules[] = {
    RULE(fmi3SetDebugLogging, ANYWHERE, ANYWHERE),
    RULE(fmi3EnterInitializationMode, INSTANTIATED, INSTANTIATED),
    RULE(fmi3ExitInitializationMode, INITIALISATION, INITIALISATION),
    RULE(fmi3EnterEventMode, CONTINUOUS_TIME, STEP),
    RULE(fmi3Terminate, INITIALISED, INITIALISED),
    RULE(fmi3Reset, ANYWHERE, ANYWHERE),
    // Of what has been set.
    RULE(fmi3GetFloat64, ANYWHERE, ANYWHERE | INTERMEDIATE_UPDATE),
    RULE(fmi3SetFloat64, INSTANTIATED | INITIALISATION | INITIALISED,
         INSTANTIATED | INITIALISATION | INITIALISED),
    {"fmi3SetFloat64 of a parameter", set_parameter, INSTANTIATED | INITIALISATION,
     INSTANTIATED | INITIALISATION},
    RULE(fmi3GetInt32, INSTANTIATED | READABLE, INSTANTIATED | READABLE | INTERMEDIATE_UPDATE),
    NEVER(fmi3SetInt32),
    NEVER_OF(Float32),
    NEVER_OF(Int8),
    NEVER_OF(UInt8),
    NEVER_OF(Int16),
    NEVER_OF(UInt16),
    NEVER_OF(UInt32),
    NEVER_OF(Int64),
    NEVER_OF(UInt64),
    NEVER_OF(Boolean),
    NEVER_OF(String),
    NEVER_OF(Binary),
    NEVER_OF(Clock),
    NEVER(fmi3GetNumberOfVariableDependencies),
    NEVER(fmi3GetVariableDependencies),
    {"fmi3GetFMUState", get_fmu_state, ANYWHERE, ANYWHERE},
    {"fmi3SetFMUState", set_fmu_state, ANYWHERE, ANYWHERE},
    {"fmi3FreeFMUState", free_fmu_state, ANYWHERE, ANYWHERE},
    RULE(fmi3GetDirectionalDerivative, READABLE, 0),
    NEVER(fmi3GetAdjointDerivative),
    NEVER(fmi3EnterConfigurationMode),
    NEVER(fmi3ExitConfigurationMode),
    NEVER(fmi3GetIntervalDecimal),
    NEVER(fmi3GetIntervalFraction),
    NEVER(fmi3GetShiftDecimal),
    NEVER(fmi3GetShiftFraction),
    NEVER(fmi3SetIntervalDecimal),
    NEVER(fmi3SetIntervalFraction),
    NEVER(fmi3SetShiftDecimal),
    NEVER(fmi3SetShiftFraction),
    NEVER(fmi3EvaluateDiscreteStates),
    RULE(fmi3UpdateDiscreteStates, EVENT_MODE, EVENT_MODE),
    RULE(fmi3EnterContinuousTimeMode, EVENT_HANDLED, 0),
    RULE(fmi3CompletedIntegratorStep, CONTINUOUS_TIME, 0),
    RULE(fmi3SetTime, CONTINUOUS_TIME, 0),
    RULE(fmi3SetContinuousStates, CONTINUOUS_TIME, 0),
    RULE(fmi3GetContinuousStateDerivatives, READABLE, 0),
    RULE(fmi3GetEventIndicators, READABLE, 0),
    RULE(fmi3GetContinuousStates, READABLE, 0),
    RULE(fmi3GetNominalsOfContinuousStates, READABLE | FAILED, 0),
    RULE(fmi3GetNumberOfEventIndicators, ANYWHERE, 0),
    RULE(fmi3GetNumberOfContinuousStates, ANYWHERE, 0),
    RULE(fmi3EnterStepMode, 0, EVENT_HANDLED),
    NEVER(fmi3GetOutputDerivatives),
    RULE(fmi3DoStep, 0, STEP),
    NEVER(fmi3ActivateModelPartition),
};
enum { N_RULES = sizeof rules / sizeof *rules };

TEST(Fmi3IsCalledInOrder) {
  check_order(rules, N_RULES, MODEL_EXCHANGE);
  check_order(rules, N_RULES, CO_SIMULATION_WITH_EVENTS);
  CHECK(strncmp(fmi.fmi3GetVersion(), "3.0", 3) == 0);
}

TEST(Fmi3HasNoEventModeUnlessItIsUsed) {
  Rule without[N_RULES];
  memcpy(without, rules, sizeof rules);
  for (int k = 0; k < N_RULES; ++k) {
    if (strcmp(rules[k].name, "fmi3EnterEventMode") == 0) without[k].co_simulation = 0;
  }
  check_order(without, N_RULES, CO_SIMULATION);
  // Nor can it be entered by a state.
  Instance with = {0}, alone = {0};
  begin(&with, CO_SIMULATION_WITH_EVENTS);
  begin(&alone, CO_SIMULATION);
  void* state = NULL;
  OK(calls()->get_state(with.handle, &state));
  REFUSED(&alone, fmi.fmi3SetFMUState(alone.handle, state));
  OK(calls()->free_state(alone.handle, &state));
  destroy(&with);
  destroy(&alone);
}

// --- Co-Simulation ------------------------------------------------------------------------------

static void enter_step_mode(Instance* instance) {
  Update update;
  OK(calls()->update(instance->handle, &update));
  OK((Status)fmi.fmi3EnterStepMode(instance->handle));
}

TEST(StepsReturnAtEvents) {
  Instance instance = {0}, straight = {0};
  begin(&instance, CO_SIMULATION_WITH_EVENTS);
  enter_step_mode(&instance);
  begin(&straight, CO_SIMULATION);
  int n_events = 0;
  for (int k = 0; k < 10; ++k) {
    const double target = 0.01 * (k + 1);
    double t = 0.01 * k;
    OK(do_step(straight.handle, t, target - t));
    CHECK(!event_needed && !early_return);
    while (t < target) {
      OK(do_step(instance.handle, t, target - t));
      CHECK(last_time >= t && last_time <= target && early_return == (last_time < target));
      CHECK(event_needed || last_time == target);
      t = last_time;
      if (!event_needed) continue;
      ++n_events;
      CHECK(n_events < 1000);
      OK((Status)fmi.fmi3EnterEventMode(instance.handle));
      enter_step_mode(&instance);
    }
  }
  if (find("state.rotor_rate") != NULL) CHECK(n_events > 0);
  // Where it stops to look does not change what happens.
  double of_one[6], of_other[6];
  OK(get(instance.handle, find("joint_angle"), of_one));
  OK(get(straight.handle, find("joint_angle"), of_other));
  CHECK(memcmp(of_one, of_other, sizeof of_one) == 0);
  destroy(&instance);
  destroy(&straight);
}

// What a test wants to know of intermediate updates.
typedef struct {
  int n;
  double first, latest, return_at;
  fmi3FMUState state;  // of the beginning
} Updates;

static void count_updates(fmi3InstanceEnvironment environment, double t, bool can_set, bool can_get,
                          bool finished, bool can_return, bool* wanted, double* until) {
  Instance* instance = environment;
  Updates* updates = instance->of_test;
  CHECK(!can_set && can_get && finished && can_return);
  CHECK(t >= updates->latest);
  if (updates->n++ == 0) updates->first = t;
  updates->latest = t;
  double now = -1.0;
  OK(get(instance->handle, find("time"), &now));
  CHECK(now == t);
  *wanted = updates->return_at > 0.0;
  *until = updates->return_at;
}

TEST(StepsReturnEarlyWhenTheImporterWantsIt) {
  Updates updates = {0};
  Instance instance = {.intermediate_update = count_updates, .of_test = &updates};
  begin(&instance, CO_SIMULATION);
  OK(do_step(instance.handle, 0.0, 0.1));
  CHECK(updates.n > 1 && updates.latest == 0.1 && !early_return && last_time == 0.1);
  // At the instant that it names, in the middle of a step of the integration if need be,
  const double instants[2] = {0.1 + 1e-3 / 3.0, 0.1501};
  for (int k = 0; k < 2; ++k) {
    const double t = last_time;
    updates.n = 0;
    updates.return_at = instants[k];
    OK(do_step(instance.handle, t, 0.1));
    CHECK(last_time == fmax(updates.first, instants[k]) && !event_needed);
    CHECK(early_return == (last_time < t + 0.1));
  }
  // or at once, if that is past.
  const double t = last_time;
  updates.n = 0;
  updates.return_at = 1e-9;
  OK(do_step(instance.handle, t, 0.1));
  CHECK(updates.n == 1 && last_time == updates.first);
  if (find("state.rotor_rate") != NULL) CHECK(early_return);
  destroy(&instance);
}

static void call_everything(fmi3InstanceEnvironment environment, double t, bool can_set,
                            bool can_get, bool finished, bool can_return, bool* wanted,
                            double* until) {
  Instance* instance = environment;
  Updates* updates = instance->of_test;
  (void)t, (void)can_set, (void)can_get, (void)finished, (void)can_return;
  for (size_t k = 0; updates->n == 0 && k < N_RULES; ++k) {
    const int before = instance->n_messages;
    const Status status = rules[k].call(instance->handle);
    if ((rules[k].co_simulation & INTERMEDIATE_UPDATE) != 0) {
      CHECK_THAT(status == STATUS_OK, "%s is allowed in intermediate updates", rules[k].name);
    } else {
      check_refused(rules[k].name, instance, status, before);
    }
  }
  if (updates->n == 0) {
    REFUSED(instance, fmi.fmi3SetFMUState(instance->handle, updates->state));
    fmi.fmi3FreeInstance(instance->handle);  // It does not even go away.
  }
  ++updates->n;
  *wanted = false;
  *until = 0.0;
}

TEST(InIntermediateUpdatesInstancesAreOnlyRead) {
  Updates updates = {0}, counted = {0};
  Instance instance = {.intermediate_update = call_everything, .of_test = &updates};
  Instance undisturbed = {.intermediate_update = count_updates, .of_test = &counted};
  begin(&instance, CO_SIMULATION);
  begin(&undisturbed, CO_SIMULATION);
  OK(get_state(instance.handle, &updates.state));
  OK(do_step(instance.handle, 0.0, 0.05));
  OK(free_state(instance.handle, &updates.state));
  OK(do_step(undisturbed.handle, 0.0, 0.05));
  CHECK(updates.n > 0 && updates.n == counted.n);
  double of_one[6], of_other[6];
  OK(get(instance.handle, find("joint_angle"), of_one));
  OK(get(undisturbed.handle, find("joint_angle"), of_other));
  CHECK(memcmp(of_one, of_other, sizeof of_one) == 0);
  destroy(&instance);
  destroy(&undisturbed);
}

// --- arguments ----------------------------------------------------------------------------------

TEST(Fmi3RefusesWrongArguments) {
  Instance exchange = {0}, simulation = {0};
  begin(&exchange, MODEL_EXCHANGE);
  begin(&simulation, CO_SIMULATION);
  void* i = exchange.handle;
  const fmi3ValueReference beyond = 100000, angles = *reference_of("joint_angle"),
                           inside = angles + 1, whole = *reference_of("n_events"),
                           force = *reference_of("input.tip_force");
  const size_t n = find("joint_angle")->size;
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &beyond, 1, numbers, 1));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &inside, 1, numbers, n));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &angles, 1, numbers, n - 1));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &angles, 1, numbers, n + 1));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &angles, 1, numbers, 0));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &whole, 1, numbers, 1));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, NULL, 1, numbers, n));
  REFUSED(&exchange, fmi.fmi3GetFloat64(i, &angles, 1, NULL, n));
  OK((Status)fmi.fmi3GetFloat64(i, NULL, 0, NULL, 0));
  REFUSED(&exchange, fmi.fmi3GetInt32(i, &angles, 1, integers, n));
  REFUSED(&exchange, fmi.fmi3GetInt32(i, &whole, 1, NULL, 1));
  REFUSED(&exchange, fmi.fmi3GetInt32(i, &whole, 1, integers, 2));
  OK((Status)fmi.fmi3GetInt32(i, NULL, 0, NULL, 0));
  REFUSED(&exchange, fmi.fmi3SetFloat64(i, &angles, 1, numbers, n));
  REFUSED(&exchange, fmi.fmi3SetFloat64(i, &force, 1, (double[3]){0.0, NAN, 0.0}, 3));
  REFUSED(&exchange, fmi.fmi3SetFloat64(i, &force, 1, (double[3]){0.0, 0.0, -INFINITY}, 3));
  REFUSED(&exchange, fmi.fmi3SetFloat64(i, &force, 1, numbers, 2));
  REFUSED(&exchange, fmi.fmi3SetFloat64(i, &force, 1, NULL, 3));
  OK((Status)fmi.fmi3SetFloat64(i, NULL, 0, NULL, 0));
  REFUSED(&exchange, fmi.fmi3UpdateDiscreteStates(i, NULL, &flag, &flag, &flag, &flag, numbers));
  REFUSED(&exchange, fmi.fmi3UpdateDiscreteStates(i, &flag, &flag, &flag, &flag, &flag, NULL));
  REFUSED(&exchange, fmi.fmi3GetContinuousStateDerivatives(i, numbers, fmu.n_states + 1));
  REFUSED(&exchange, fmi.fmi3GetContinuousStateDerivatives(i, NULL, fmu.n_states));
  REFUSED(&exchange, fmi.fmi3GetEventIndicators(i, numbers, 1));
  REFUSED(&exchange, fmi.fmi3GetNumberOfContinuousStates(i, NULL));
  REFUSED(&exchange, fmi.fmi3GetNumberOfEventIndicators(i, NULL));
  OK((Status)fmi.fmi3GetNumberOfContinuousStates(i, &size));
  CHECK(size == fmu.n_states);
  OK((Status)fmi.fmi3GetNumberOfEventIndicators(i, &size));
  CHECK(size == fmu.n_indicators);
  const fmi3ValueReference rates = *reference_of("der(state.joint_rate)");
  const size_t n_rates = find("der(state.joint_rate)")->size;
  REFUSED(&exchange,
          fmi.fmi3GetDirectionalDerivative(i, &rates, 1, &force, 1, numbers, 2, numbers, n_rates));
  REFUSED(&exchange,
          fmi.fmi3GetDirectionalDerivative(i, &rates, 1, &force, 1, (double[3]){INFINITY, 0.0, 0.0},
                                           3, numbers, n_rates));
  REFUSED(&exchange,
          fmi.fmi3GetDirectionalDerivative(i, &rates, 1, &angles, 1, numbers, n, numbers, n_rates));
  REFUSED(&exchange, fmi.fmi3SetDebugLogging(i, true, 1, (fmi3String[1]){"logNothing"}));

  i = simulation.handle;
  REFUSED(&simulation, do_step(i, 0.1, 0.01));
  REFUSED(&simulation, do_step(i, INFINITY, 0.01));
  REFUSED(&simulation, do_step(i, 0.0, 0.0));
  REFUSED(&simulation, do_step(i, 0.0, INFINITY));
  REFUSED(&simulation, do_step(i, 0.0, 10.1));  // beyond the stop time
  REFUSED(&simulation,
          fmi.fmi3DoStep(i, 0.0, 0.01, fmi3True, NULL, &flag, &early_return, &last_time));
  REFUSED(&simulation,
          fmi.fmi3DoStep(i, 0.0, 0.01, fmi3True, &event_needed, &flag, &early_return, NULL));
  OK(do_step(i, 0.0, 0.01));
  CHECK(fmi.fmi3InstantiateScheduledExecution("arm", fmu.token, fmu.resources, false, false,
                                              &simulation, log_message, NULL, NULL, NULL) == NULL);
  CHECK(simulation.latest == STATUS_ERROR);
  destroy(&exchange);
  destroy(&simulation);
}
