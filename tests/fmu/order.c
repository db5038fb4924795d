// Every function in every phase.
#include <stdlib.h>
#include <string.h>

#include "importer.h"

enum { N_PHASES = 10 };

static const char* const names_of_phases[N_PHASES] = {
    "instantiated",    "set up",    "initialisation", "event mode", "event mode after update",
    "continuous time", "step mode", "terminated",     "failed",     "intermediate update"};
static const char* const names_of_kinds[N_KINDS] = {"Model Exchange", "Co-Simulation",
                                                    "Co-Simulation with event mode"};

// Brings an instance there; returns whether its kind has the phase, in this version.
static bool enter(Instance* instance, unsigned phase) {
  const Calls* call = calls();
  void* handle = instance->handle;
  const bool exchange = instance->kind == MODEL_EXCHANGE;
  const bool has_events = instance->kind != CO_SIMULATION;
  OK(call->reset(handle));
  if (phase == INSTANTIATED) return true;
  if (phase == SET_UP) {
    return fmu.version == 2 &&
           fmi.fmi2SetupExperiment(handle, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK;
  }
  if (phase == FAILED) {
    const double nonsense = -1.0;
    OK(call->set(handle, find("load.mass"), &nonsense));
    OK(call->enter_initialisation(handle, 1e-7, 0.0, 1.0));
    REFUSED(instance, call->exit_initialisation(handle));
    return true;
  }
  OK(call->enter_initialisation(handle, 1e-7, 0.0, 1.0));
  if (phase == INITIALISATION) return true;
  OK(call->exit_initialisation(handle));
  if (phase == TERMINATED) {
    OK(call->terminate(handle));
    return true;
  }
  if (phase == STEP) {
    if (exchange) return false;
    if (has_events) {
      Update update;
      OK(call->update(handle, &update));
      OK((Status)fmi.fmi3EnterStepMode(handle));
    }
    return true;
  }
  if (!has_events) return false;
  if (phase == EVENT) return true;
  Update update;
  OK(call->update(handle, &update));
  if (phase == EVENT_HANDLED) return true;
  if (phase == CONTINUOUS_TIME && exchange) {
    OK(call->enter_continuous_time(handle));
    return true;
  }
  return false;
}

void check_order(const Rule* rules, size_t n_rules, Kind kind) {
  Instance instance = {0};
  create(&instance, kind);
  for (int number = 0; number < N_PHASES - 1; ++number) {
    const unsigned phase = 1u << number;
    if (!enter(&instance, phase)) continue;
    void* state = NULL;
    OK(calls()->get_state(instance.handle, &state));
    const Bytes before = state_of(&instance);
    for (size_t k = 0; k < n_rules; ++k) {
      const Rule* rule = &rules[k];
      char what[200];
      snprintf(what, sizeof what, "%s in phase %s of %s", rule->name, names_of_phases[number],
               names_of_kinds[kind]);
      const unsigned allowed = kind == MODEL_EXCHANGE ? rule->model_exchange : rule->co_simulation;
      const int messages_before = instance.n_messages;
      const Status status = rule->call(instance.handle);
      if ((allowed & phase) != 0) {
        CHECK_THAT(status == STATUS_OK, "%s is allowed; status %d, %s", what, status,
                   instance.message);
      } else {
        check_refused(what, &instance, status, messages_before);
        CHECK_THAT(strncmp(instance.message, rule->name, strcspn(rule->name, " ")) == 0,
                   "%s has a message that tells its name: %s", what, instance.message);
        const Bytes after = state_of(&instance);
        CHECK_THAT(same_bytes(before, after), "%s leaves the instance as it is", what);
        free(after.bytes);
      }
      OK(calls()->set_state(instance.handle, state));
    }
    // Nobody's instance.
    for (size_t k = 0; k < n_rules; ++k) CHECK(rules[k].call(NULL) == STATUS_ERROR);
    OK(calls()->free_state(instance.handle, &state));
    free(before.bytes);
  }
  destroy(&instance);
}
