// An importer of FMUs in plain C: the interface as the headers of the standard declare it, loaded
// from the binary by name, and one FMU at a time, which lies in a folder.
//
// TEST(claim) { ... } is a test case; a failing CHECK tells where, and the test goes on.
#ifndef IMPORTER_H
#define IMPORTER_H

#include <fmi2FunctionTypes.h>
#include <fmi3FunctionTypes.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "functions.h"

// --- tests --------------------------------------------------------------------------------------

typedef void (*Body)(void);
void add_test(const char* name, Body body);
void fail(const char* file, int line, const char* format, ...);

#define TEST(name)                                                                     \
  static void name(void);                                                              \
  __attribute__((constructor)) static void add_##name(void) { add_test(#name, name); } \
  static void name(void)

#define CHECK(condition) CHECK_THAT(condition, "%s", #condition)

#define OK(status) CHECK((status) == STATUS_OK)

// With more to tell than the expression: a format and values.
#define CHECK_THAT(condition, ...)                           \
  do {                                                       \
    if (!(condition)) fail(__FILE__, __LINE__, __VA_ARGS__); \
  } while (false)

// --- the FMU ------------------------------------------------------------------------------------

// Every function of both versions.
typedef struct {
#define POINTER(name) name##TYPE* name;
  FMI2_FUNCTIONS(POINTER) FMI3_FUNCTIONS(POINTER)
#undef POINTER
} Functions;
extern Functions fmi;

// All elements of an array; in FMI 2 each has the next value reference.
typedef struct {
  char name[64];
  unsigned first;
  size_t size;
  bool is_integer;
} Variable;

// What the importer has read of the model description.
typedef struct {
  int version;
  char resources[500], token[100];
  double sampling_time;  // of time events, or 0
  Variable variables[200];
  size_t n_variables;
  size_t n_states, n_indicators;
} Fmu;
extern Fmu fmu;
extern Fmu another;  // of the same version, and the same binary

const Variable* find(const char* name);  // of the FMU; or NULL

// --- instances ----------------------------------------------------------------------------------

typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

typedef enum { MODEL_EXCHANGE, CO_SIMULATION, CO_SIMULATION_WITH_EVENTS, N_KINDS } Kind;

typedef struct {
  void* handle;
  Kind kind;
  int n_messages;
  Status latest;  // of them
  char message[500], category[50];
  fmi3IntermediateUpdateCallback intermediate_update;  // to be set before
  void* of_test;
} Instance;

void take_message(Instance* instance, Status status, const char* category, const char* message);

typedef struct {
  bool states_changed, next_time_defined;
  double next_time;
} Update;

// What both versions have alike. States are void pointers in both.
typedef struct {
  void (*instantiate)(Instance* instance, const char* name, const char* token,
                      const char* resources);
  void (*free)(void* handle);
  Status (*reset)(void*);
  Status (*enter_initialisation)(void*, double tolerance, double start, double stop);
  Status (*exit_initialisation)(void*);
  Status (*terminate)(void*);
  Status (*get)(void*, const Variable*, double* values);
  Status (*get_integer)(void*, const Variable*, int* values);
  Status (*set)(void*, const Variable*, const double* values);
  Status (*get_state)(void*, void** state);
  Status (*set_state)(void*, void* state);
  Status (*free_state)(void*, void** state);
  Status (*size_of_state)(void*, void* state, size_t* size);
  Status (*serialise)(void*, void* state, char* bytes, size_t size);
  Status (*deserialise)(void*, const char* bytes, size_t size, void** state);
  Status (*directional_derivative)(void*, const Variable* unknown, const Variable* known,
                                   const double* seed, double* sensitivity);
  // Model Exchange
  Status (*enter_event)(void*);
  Status (*update)(void*, Update* update);
  Status (*enter_continuous_time)(void*);
  Status (*set_time)(void*, double t);
  Status (*set_states)(void*, const double* x, size_t n);
  Status (*get_states)(void*, double* x, size_t n);
  Status (*nominals)(void*, double* nominals, size_t n);
  Status (*derivatives)(void*, double* dx, size_t n);
  Status (*indicators)(void*, double* z, size_t n);
  // Co-Simulation
  Status (*step)(void*, double t, double h);
} Calls;
extern const Calls fmi2_calls, fmi3_calls;
const Calls* calls(void);  // of the FMU's version

// The instance must not move: it takes the messages.
void create(Instance* instance, Kind kind);
void destroy(Instance* instance);
// Created, and through its initialisation: where time begins to run.
void begin(Instance* instance, Kind kind);

// A state as bytes, to be freed: all that an instance knows.
typedef struct {
  size_t size;
  char* bytes;
} Bytes;
Bytes bytes_of(Instance* instance, void* state);
Bytes state_of(Instance* instance);
bool same_bytes(Bytes a, Bytes b);

// --- an integrator ------------------------------------------------------------------------------

enum { MOST_STATES = 100, MOST_INDICATORS = 100 };

// Of Model Exchange: Heun's method, and bisection where an indicator gets to zero.
typedef struct {
  Instance* instance;
  double t, next_time;
  double x[MOST_STATES];
  int state_events, time_events;
} Run;
void start_run(Run* run, Instance* instance);  // which has begun
void go_on(Run* run, double until, double step);

// --- the order of calls -------------------------------------------------------------------------

// Phases in which a function may be called, as bits.
enum {
  INSTANTIATED = 1,
  SET_UP = 2,  // FMI 2
  INITIALISATION = 4,
  EVENT = 8,           // before the update of discrete states
  EVENT_HANDLED = 16,  // after it
  CONTINUOUS_TIME = 32,
  STEP = 64,
  TERMINATED = 128,
  FAILED = 256,
  INTERMEDIATE_UPDATE = 512,  // FMI 3, inside a step
};

// A function with good arguments, and in which phases it is allowed, for each kind of instance.
typedef struct {
  const char* name;
  Status (*call)(void* handle);
  unsigned model_exchange, co_simulation;
} Rule;

// Calls each in each phase: refused or done as the rules say, and what is refused has a message
// and leaves the instance bit by bit as it was.
void check_order(const Rule* rules, size_t n_rules, Kind kind);
// That a call is refused so, too.
void check_refused(const char* what, Instance* instance, Status status, int messages_before);
#define REFUSED(instance, expression)                                      \
  do {                                                                     \
    const int before_ = (instance)->n_messages;                            \
    check_refused(#expression, (instance), (Status)(expression), before_); \
  } while (false)

#endif
