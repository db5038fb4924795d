// FMI 2.0: calls by the names of the importer, and what only this version has.
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

// --- calls --------------------------------------------------------------------------------------

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status,
                        fmi2String category, fmi2String format, ...) {
  char message[500];
  va_list values;
  va_start(values, format);
  vsnprintf(message, sizeof message, format, values);
  va_end(values);
  (void)name;
  take_message(environment, (Status)status, category, message);
}

static void instantiate(Instance* instance, const char* name, const char* token,
                        const char* resources) {
  char location[600];
  snprintf(location, sizeof location, "file://%s", resources != NULL ? resources : "");
  // The FMU need not remember where this stands.
  fmi2CallbackFunctions functions = {log_message, calloc, free, NULL, instance};
  instance->handle = fmi.fmi2Instantiate(
      name, instance->kind == MODEL_EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation, token,
      resources != NULL ? location : NULL, &functions, fmi2False, fmi2False);
  memset(&functions, 0, sizeof functions);
}

static void free_instance(void* c) { fmi.fmi2FreeInstance(c); }
static Status reset(void* c) { return (Status)fmi.fmi2Reset(c); }
static Status enter_initialisation(void* c, double tolerance, double start, double stop) {
  const Status status =
      (Status)fmi.fmi2SetupExperiment(c, fmi2True, tolerance, start, fmi2True, stop);
  return status != STATUS_OK ? status : (Status)fmi.fmi2EnterInitializationMode(c);
}
static Status exit_initialisation(void* c) { return (Status)fmi.fmi2ExitInitializationMode(c); }
static Status terminate(void* c) { return (Status)fmi.fmi2Terminate(c); }

// The value references of a variable's elements.
static const fmi2ValueReference* elements_of(const Variable* variable,
                                             fmi2ValueReference* references) {
  for (size_t k = 0; k < variable->size; ++k) references[k] = variable->first + (unsigned)k;
  return references;
}
enum { MOST_ELEMENTS = 20 };

static Status get(void* c, const Variable* variable, double* values) {
  fmi2ValueReference references[MOST_ELEMENTS];
  return (Status)fmi.fmi2GetReal(c, elements_of(variable, references), variable->size, values);
}
static Status get_integer(void* c, const Variable* variable, int* values) {
  fmi2ValueReference references[MOST_ELEMENTS];
  return (Status)fmi.fmi2GetInteger(c, elements_of(variable, references), variable->size, values);
}
static Status set(void* c, const Variable* variable, const double* values) {
  fmi2ValueReference references[MOST_ELEMENTS];
  return (Status)fmi.fmi2SetReal(c, elements_of(variable, references), variable->size, values);
}
static Status get_state(void* c, void** state) { return (Status)fmi.fmi2GetFMUstate(c, state); }
static Status set_state(void* c, void* state) { return (Status)fmi.fmi2SetFMUstate(c, state); }
static Status free_state(void* c, void** state) { return (Status)fmi.fmi2FreeFMUstate(c, state); }
static Status size_of_state(void* c, void* state, size_t* size) {
  return (Status)fmi.fmi2SerializedFMUstateSize(c, state, size);
}
static Status serialise(void* c, void* state, char* bytes, size_t size) {
  return (Status)fmi.fmi2SerializeFMUstate(c, state, bytes, size);
}
static Status deserialise(void* c, const char* bytes, size_t size, void** state) {
  return (Status)fmi.fmi2DeSerializeFMUstate(c, bytes, size, state);
}
static Status directional_derivative(void* c, const Variable* unknown, const Variable* known,
                                     const double* seed, double* sensitivity) {
  fmi2ValueReference unknowns[MOST_ELEMENTS], knowns[MOST_ELEMENTS];
  return (Status)fmi.fmi2GetDirectionalDerivative(c, elements_of(unknown, unknowns), unknown->size,
                                                  elements_of(known, knowns), known->size, seed,
                                                  sensitivity);
}
static Status enter_event(void* c) { return (Status)fmi.fmi2EnterEventMode(c); }
static Status update(void* c, Update* update) {
  fmi2EventInfo info;
  const Status status = (Status)fmi.fmi2NewDiscreteStates(c, &info);
  if (status != STATUS_OK) return status;
  CHECK(!info.newDiscreteStatesNeeded && !info.terminateSimulation &&
        !info.nominalsOfContinuousStatesChanged);
  *update =
      (Update){info.valuesOfContinuousStatesChanged, info.nextEventTimeDefined, info.nextEventTime};
  return status;
}
static Status enter_continuous_time(void* c) { return (Status)fmi.fmi2EnterContinuousTimeMode(c); }
static Status set_time(void* c, double t) { return (Status)fmi.fmi2SetTime(c, t); }
static Status set_states(void* c, const double* x, size_t n) {
  return (Status)fmi.fmi2SetContinuousStates(c, x, n);
}
static Status get_states(void* c, double* x, size_t n) {
  return (Status)fmi.fmi2GetContinuousStates(c, x, n);
}
static Status nominals(void* c, double* nominals, size_t n) {
  return (Status)fmi.fmi2GetNominalsOfContinuousStates(c, nominals, n);
}
static Status derivatives(void* c, double* dx, size_t n) {
  return (Status)fmi.fmi2GetDerivatives(c, dx, n);
}
static Status indicators(void* c, double* z, size_t n) {
  return (Status)fmi.fmi2GetEventIndicators(c, z, n);
}
static Status do_step(void* c, double t, double h) {
  return (Status)fmi.fmi2DoStep(c, t, h, fmi2True);
}

const Calls fmi2_calls = {
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

// --- the order of calls: the tables of sections 3.2.3 and 4.2.4 of FMI 2.0.4 ---------------------

enum {
  CREATED = INSTANTIATED | SET_UP,
  EVENT_MODE = EVENT | EVENT_HANDLED,
  INITIALISED = EVENT_MODE | CONTINUOUS_TIME | STEP,
  READABLE = INITIALISATION | INITIALISED | TERMINATED,
  ANYWHERE = CREATED | READABLE | FAILED,
};

static double numbers[MOST_STATES];
static fmi2Integer integer;
static fmi2Boolean flag;
static size_t size;

static const fmi2ValueReference* reference_of(const char* name) { return &find(name)->first; }

// A function with these arguments.
#define CALL(function, ...)                              \
  static Status call_##function(void* component) {       \
    return (Status)fmi.function(component, __VA_ARGS__); \
  }
#define CALL_ALONE(function) \
  static Status call_##function(void* component) { return (Status)fmi.function(component); }

CALL(fmi2SetDebugLogging, fmi2True, 0, NULL)
CALL(fmi2SetupExperiment, fmi2False, 0.0, 0.0, fmi2False, 0.0)
CALL_ALONE(fmi2EnterInitializationMode)
CALL_ALONE(fmi2ExitInitializationMode)
CALL_ALONE(fmi2Terminate)
CALL_ALONE(fmi2Reset)
CALL(fmi2GetReal, reference_of("table_3.gravity"), 1, numbers)
CALL(fmi2GetInteger, reference_of("n_events"), 1, &integer)
CALL(fmi2GetBoolean, reference_of("time"), 1, &flag)
CALL(fmi2GetString, reference_of("time"), 1, (fmi2String[1]){""})
CALL(fmi2SetReal, reference_of("input.tip_force"), 1, (fmi2Real[1]){1.0})
CALL(fmi2SetInteger, reference_of("n_events"), 1, (fmi2Integer[1]){1})
CALL(fmi2SetBoolean, reference_of("time"), 1, (fmi2Boolean[1]){fmi2True})
CALL(fmi2SetString, reference_of("time"), 1, (fmi2String[1]){""})
CALL(fmi2GetDirectionalDerivative, reference_of("der(state.joint_rate)"), 1,
     reference_of("state.joint_angle"), 1, (fmi2Real[1]){1.0}, numbers)
CALL_ALONE(fmi2EnterEventMode)
CALL(fmi2NewDiscreteStates, &(fmi2EventInfo){0})
CALL_ALONE(fmi2EnterContinuousTimeMode)
CALL(fmi2CompletedIntegratorStep, fmi2True, &flag, &flag)
CALL(fmi2SetTime, 0.001)
CALL(fmi2GetDerivatives, numbers, fmu.n_states)
CALL(fmi2GetEventIndicators, numbers, fmu.n_indicators)
CALL(fmi2GetContinuousStates, numbers, fmu.n_states)
CALL(fmi2GetNominalsOfContinuousStates, numbers, fmu.n_states)
CALL(fmi2SetRealInputDerivatives, reference_of("input.tip_force"), 1, (fmi2Integer[1]){1}, numbers)
CALL(fmi2GetRealOutputDerivatives, reference_of("joint_angle"), 1, (fmi2Integer[1]){1}, numbers)
CALL(fmi2DoStep, 0.0, 0.001, fmi2True)
CALL_ALONE(fmi2CancelStep)
CALL(fmi2GetStatus, fmi2DoStepStatus, &(fmi2Status){fmi2OK})
CALL(fmi2GetRealStatus, fmi2LastSuccessfulTime, numbers)
CALL(fmi2GetIntegerStatus, fmi2LastSuccessfulTime, &integer)
CALL(fmi2GetBooleanStatus, fmi2Terminated, &flag)
CALL(fmi2GetStringStatus, fmi2PendingStatus, &(fmi2String){""})

static Status call_fmi2SetContinuousStates(void* component) {
  double x[MOST_STATES] = {0.0};
  return (Status)fmi.fmi2SetContinuousStates(component, x, fmu.n_states);
}
static Status set_parameter(void* component) {
  return (Status)fmi.fmi2SetReal(component, reference_of("load.mass"), 1, (fmi2Real[1]){1.0});
}
static Status set_one_state(void* component) {
  return (Status)fmi.fmi2SetReal(component, reference_of("state.joint_angle"), 1,
                                 (fmi2Real[1]){0.1});
}
static Status get_fmu_state(void* component) {
  void* state = NULL;
  const fmi2Status status = fmi.fmi2GetFMUstate(component, &state);
  if (status == fmi2OK) fmi.fmi2FreeFMUstate(component, &state);
  return (Status)status;
}
static Status free_fmu_state(void* component) {
  return (Status)fmi.fmi2FreeFMUstate(component, &(fmi2FMUstate){NULL});
}
// Taken, written, read, given back.
static Status set_fmu_state(void* component) {
  void *state = NULL, *again = NULL;
  char* bytes = NULL;
  fmi2Status status = fmi.fmi2GetFMUstate(component, &state);
  if (status == fmi2OK) status = fmi.fmi2SerializedFMUstateSize(component, state, &size);
  if (status == fmi2OK) {
    bytes = malloc(size);
    status = fmi.fmi2SerializeFMUstate(component, state, bytes, size);
  }
  if (status == fmi2OK) status = fmi.fmi2DeSerializeFMUstate(component, bytes, size, &again);
  if (status == fmi2OK) status = fmi.fmi2SetFMUstate(component, again);
  free(bytes);
  if (state != NULL) fmi.fmi2FreeFMUstate(component, &state);
  if (again != NULL) fmi.fmi2FreeFMUstate(component, &again);
  return (Status)status;
}

#define RULE(function, exchange, simulation) {#function, call_##function, exchange, simulation}

static const Rule rules[] = {
    RULE(fmi2SetDebugLogging, ANYWHERE, ANYWHERE),
    RULE(fmi2SetupExperiment, CREATED, CREATED),
    RULE(fmi2EnterInitializationMode, SET_UP, SET_UP),
    RULE(fmi2ExitInitializationMode, INITIALISATION, INITIALISATION),
    RULE(fmi2Terminate, INITIALISED, INITIALISED),
    RULE(fmi2Reset, ANYWHERE, ANYWHERE),
    RULE(fmi2GetReal, READABLE | FAILED, READABLE | FAILED),  // of what has been set
    RULE(fmi2GetInteger, READABLE, READABLE),
    RULE(fmi2GetBoolean, 0, 0),
    RULE(fmi2GetString, 0, 0),
    RULE(fmi2SetReal, CREATED | INITIALISATION | INITIALISED,
         CREATED | INITIALISATION | INITIALISED),
    {"fmi2SetReal of a parameter", set_parameter, CREATED | INITIALISATION,
     CREATED | INITIALISATION},
    {"fmi2SetReal of a state", set_one_state, CONTINUOUS_TIME, 0},
    RULE(fmi2SetInteger, 0, 0),
    RULE(fmi2SetBoolean, 0, 0),
    RULE(fmi2SetString, 0, 0),
    {"fmi2GetFMUstate", get_fmu_state, ANYWHERE, ANYWHERE},
    {"fmi2SetFMUstate", set_fmu_state, ANYWHERE, ANYWHERE},
    {"fmi2FreeFMUstate", free_fmu_state, ANYWHERE, ANYWHERE},
    RULE(fmi2GetDirectionalDerivative, READABLE, 0),
    RULE(fmi2EnterEventMode, EVENT_MODE | CONTINUOUS_TIME, 0),
    RULE(fmi2NewDiscreteStates, EVENT_MODE, 0),
    RULE(fmi2EnterContinuousTimeMode, EVENT_HANDLED, 0),
    RULE(fmi2CompletedIntegratorStep, CONTINUOUS_TIME, 0),
    RULE(fmi2SetTime, CONTINUOUS_TIME, 0),
    RULE(fmi2SetContinuousStates, CONTINUOUS_TIME, 0),
    RULE(fmi2GetDerivatives, READABLE, 0),
    RULE(fmi2GetEventIndicators, READABLE, 0),
    RULE(fmi2GetContinuousStates, READABLE, 0),
    RULE(fmi2GetNominalsOfContinuousStates, ANYWHERE, 0),
    RULE(fmi2SetRealInputDerivatives, 0, 0),
    RULE(fmi2GetRealOutputDerivatives, 0, 0),
    RULE(fmi2DoStep, 0, STEP),
    RULE(fmi2CancelStep, 0, 0),
    RULE(fmi2GetStatus, 0, 0),
    RULE(fmi2GetRealStatus, 0, STEP | TERMINATED | FAILED),
    RULE(fmi2GetIntegerStatus, 0, 0),
    RULE(fmi2GetBooleanStatus, 0, STEP | TERMINATED | FAILED),
    RULE(fmi2GetStringStatus, 0, 0),
};

TEST(Fmi2IsCalledInOrder) {
  check_order(rules, sizeof rules / sizeof *rules, MODEL_EXCHANGE);
  check_order(rules, sizeof rules / sizeof *rules, CO_SIMULATION);
  CHECK(strcmp(fmi.fmi2GetVersion(), "2.0") == 0);
  CHECK(strcmp(fmi.fmi2GetTypesPlatform(), "default") == 0);
}

// --- arguments ----------------------------------------------------------------------------------

TEST(Fmi2RefusesWrongArguments) {
  Instance exchange = {0}, simulation = {0};
  begin(&exchange, MODEL_EXCHANGE);
  begin(&simulation, CO_SIMULATION);
  void* c = exchange.handle;
  const fmi2ValueReference beyond = 100000, real = *reference_of("joint_angle"),
                           whole = *reference_of("n_events"),
                           input = *reference_of("input.tip_force");
  REFUSED(&exchange, fmi.fmi2GetReal(c, &beyond, 1, numbers));
  REFUSED(&exchange, fmi.fmi2GetReal(c, &whole, 1, numbers));
  REFUSED(&exchange, fmi.fmi2GetReal(c, NULL, 1, numbers));
  REFUSED(&exchange, fmi.fmi2GetReal(c, &real, 1, NULL));
  OK((Status)fmi.fmi2GetReal(c, NULL, 0, NULL));
  REFUSED(&exchange, fmi.fmi2GetInteger(c, &real, 1, &integer));
  REFUSED(&exchange, fmi.fmi2GetInteger(c, &whole, 1, NULL));
  REFUSED(&exchange, fmi.fmi2SetReal(c, &real, 1, numbers));
  REFUSED(&exchange, fmi.fmi2SetReal(c, &input, 1, &(double){NAN}));
  REFUSED(&exchange, fmi.fmi2SetReal(c, &input, 1, &(double){INFINITY}));
  REFUSED(&exchange, fmi.fmi2SetReal(c, &input, 1, NULL));
  OK((Status)fmi.fmi2SetReal(c, NULL, 0, NULL));
  // All or nothing.
  const fmi2ValueReference two[2] = {input, real};
  double force = 0.0;
  REFUSED(&exchange, fmi.fmi2SetReal(c, two, 2, (double[2]){5.0, 0.0}));
  OK((Status)fmi.fmi2GetReal(c, &input, 1, &force));
  CHECK(force == 0.0);
  REFUSED(&exchange, fmi.fmi2NewDiscreteStates(c, NULL));
  REFUSED(&exchange, fmi.fmi2GetDerivatives(c, numbers, fmu.n_states - 1));
  REFUSED(&exchange, fmi.fmi2GetDerivatives(c, NULL, fmu.n_states));
  REFUSED(&exchange, fmi.fmi2GetEventIndicators(c, numbers, 1));
  REFUSED(&exchange, fmi.fmi2GetContinuousStates(c, numbers, 1));
  REFUSED(&exchange, fmi.fmi2GetNominalsOfContinuousStates(c, numbers, 1));
  const fmi2ValueReference rate = *reference_of("der(state.joint_rate)");
  const fmi2ValueReference angle = *reference_of("state.joint_angle");
  REFUSED(&exchange, fmi.fmi2GetDirectionalDerivative(c, &rate, 1, &real, 1, numbers, numbers));
  REFUSED(&exchange, fmi.fmi2GetDirectionalDerivative(c, &whole, 1, &angle, 1, numbers, numbers));
  REFUSED(&exchange,
          fmi.fmi2GetDirectionalDerivative(c, &rate, 1, &angle, 1, &(double){NAN}, numbers));
  REFUSED(&exchange, fmi.fmi2GetDirectionalDerivative(c, &rate, 1, &angle, 1, NULL, numbers));
  REFUSED(&exchange, fmi.fmi2SetDebugLogging(c, fmi2True, 1, (fmi2String[1]){"logNothing"}));
  REFUSED(&exchange, fmi.fmi2SetDebugLogging(c, fmi2True, 1, (fmi2String[1]){NULL}));
  REFUSED(&exchange, fmi.fmi2SetDebugLogging(c, fmi2True, 1, NULL));

  c = simulation.handle;
  REFUSED(&simulation, fmi.fmi2DoStep(c, 0.1, 0.01, fmi2True));
  REFUSED(&simulation, fmi.fmi2DoStep(c, NAN, 0.01, fmi2True));
  REFUSED(&simulation, fmi.fmi2DoStep(c, 0.0, 0.0, fmi2True));
  REFUSED(&simulation, fmi.fmi2DoStep(c, 0.0, -1.0, fmi2True));
  REFUSED(&simulation, fmi.fmi2DoStep(c, 0.0, NAN, fmi2True));
  REFUSED(&simulation, fmi.fmi2DoStep(c, 0.0, 10.1, fmi2True));  // beyond the stop time
  REFUSED(&simulation, fmi.fmi2GetRealStatus(c, fmi2Terminated, numbers));
  REFUSED(&simulation, fmi.fmi2GetRealStatus(c, fmi2LastSuccessfulTime, NULL));
  REFUSED(&simulation, fmi.fmi2GetBooleanStatus(c, fmi2LastSuccessfulTime, &flag));
  OK((Status)fmi.fmi2DoStep(c, 0.0, 0.01, fmi2True));
  OK((Status)fmi.fmi2GetRealStatus(c, fmi2LastSuccessfulTime, numbers));
  CHECK(numbers[0] == 0.01);
  destroy(&exchange);
  destroy(&simulation);
}

TEST(Fmi2ReadsLocationsOfResources) {
  Instance instance = {.kind = CO_SIMULATION};
  const fmi2CallbackFunctions functions = {log_message, calloc, free, NULL, &instance};
  const char* const wrong[] = {"",          "resources",       "http://example.org/",
                               "file:",     "file:///nowhere", "file://%",
                               "file://%0", "file://%zz",      NULL};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; ++k) {
    const int before = instance.n_messages;
    CHECK(fmi.fmi2Instantiate("arm", fmi2CoSimulation, fmu.token, wrong[k], &functions, fmi2False,
                              fmi2True) == NULL);
    CHECK(instance.n_messages == before + 1 && instance.latest == STATUS_ERROR);
  }
  // Without anybody to tell.
  CHECK(fmi.fmi2Instantiate("arm", fmi2CoSimulation, "", "", NULL, fmi2False, fmi2True) == NULL);
  // A letter may be written as its number.
  char location[700] = "file://localhost";
  for (const char* letter = fmu.resources; *letter != '\0'; ++letter) {
    char written[4];
    snprintf(written, sizeof written, *letter == 'r' ? "%%%02x" : "%c", *letter);
    strcat(location, written);
  }
  fmi2Component c = fmi.fmi2Instantiate("arm", fmi2CoSimulation, fmu.token, location, &functions,
                                        fmi2False, fmi2False);
  CHECK(c != NULL);
  fmi.fmi2FreeInstance(c);
}
