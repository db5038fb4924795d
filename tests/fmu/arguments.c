// Wrong arguments of calls that both versions have.
#include <math.h>
#include <string.h>

#include "importer.h"

TEST(InstancesNeedNameTokenAndResources) {
  const struct {
    const char *name, *token, *resources;
  } wrong[] = {
      {NULL, fmu.token, fmu.resources},  {"", fmu.token, fmu.resources},
      {" \t", fmu.token, fmu.resources}, {"arm", NULL, fmu.resources},
      {"arm", "", fmu.resources},        {"arm", another.token, fmu.resources},
      {"arm", fmu.token, NULL},          {"arm", fmu.token, ""},
      {"arm", fmu.token, "/nowhere"},    {"arm", fmu.token, another.resources},
  };
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; ++k) {
      Instance instance = {.kind = kind};
      calls()->instantiate(&instance, wrong[k].name, wrong[k].token, wrong[k].resources);
      CHECK_THAT(instance.handle == NULL, "attempt %zu gives no instance", k);
      CHECK(instance.n_messages == 1 && instance.latest == STATUS_ERROR);
    }
  }
  calls()->free(NULL);
}

TEST(InitialisationRefusesWrongTimesAndTolerances) {
  const double wrong[][3] = {
      {0.0, 0.0, 1.0},       {-1e-6, 0.0, 1.0}, {NAN, 0.0, 1.0},  {INFINITY, 0.0, 1.0},
      {1e-6, 1.0, 2.0},      {1e-6, NAN, 1.0},  {1e-6, 0.0, 0.0}, {1e-6, 0.0, -1.0},
      {1e-6, 0.0, INFINITY}, {1e-6, 0.0, NAN},
  };
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    Instance instance = {0};
    create(&instance, kind);
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; ++k) {
      REFUSED(&instance, calls()->enter_initialisation(instance.handle, wrong[k][0], wrong[k][1],
                                                       wrong[k][2]));
    }
    OK(calls()->enter_initialisation(instance.handle, 1e-6, 0.0, 1.0));
    destroy(&instance);
  }
}

TEST(TimeAndStatesOfModelExchangeAreFinite) {
  Instance instance = {0};
  begin(&instance, MODEL_EXCHANGE);
  Run run;
  start_run(&run, &instance);
  go_on(&run, 0.01, 1e-4);
  const Calls* call = calls();
  REFUSED(&instance, call->set_time(instance.handle, NAN));
  REFUSED(&instance, call->set_time(instance.handle, INFINITY));
  // Before the latest event, no more.
  OK(call->enter_event(instance.handle));
  Update update;
  OK(call->update(instance.handle, &update));
  OK(call->enter_continuous_time(instance.handle));
  REFUSED(&instance, call->set_time(instance.handle, 0.009));
  REFUSED(&instance, call->set_states(instance.handle, run.x, fmu.n_states - 1));
  REFUSED(&instance, call->set_states(instance.handle, NULL, fmu.n_states));
  // An importer may try again with a smaller step, where these come from: no error.
  double x[MOST_STATES];
  memcpy(x, run.x, sizeof x);
  const int before = instance.n_messages;
  x[0] = NAN;
  CHECK(call->set_states(instance.handle, x, fmu.n_states) == STATUS_DISCARD);
  x[0] = INFINITY;
  CHECK(call->set_states(instance.handle, x, fmu.n_states) == STATUS_DISCARD);
  CHECK(instance.n_messages == before);  // nobody has asked for messages
  double dx[MOST_STATES], nominals[MOST_STATES];
  OK(call->derivatives(instance.handle, dx, fmu.n_states));
  OK(call->nominals(instance.handle, nominals, fmu.n_states));
  for (size_t k = 0; k < fmu.n_states; ++k) CHECK(nominals[k] > 0.0 && isfinite(dx[k]));
  destroy(&instance);
}

// What categories say.
static int events_told(Instance* instance) {
  const int before = instance->n_messages;
  OK(calls()->reset(instance->handle));
  OK(calls()->enter_initialisation(instance->handle, 1e-7, 0.0, 1.0));
  OK(calls()->exit_initialisation(instance->handle));
  OK(calls()->step(instance->handle, 0.0, 0.2));
  return instance->n_messages - before;
}

static void set_logging(Instance* instance, bool on, size_t n, const char* const* categories) {
  if (fmu.version == 2) {
    OK((Status)fmi.fmi2SetDebugLogging(instance->handle, on, n, categories));
  } else {
    OK((Status)fmi.fmi3SetDebugLogging(instance->handle, on, n, categories));
  }
}

TEST(MessagesOfACategoryComeIfTheyAreWanted) {
  const char* const events[] = {"logEvents"};
  const char* const others[] = {"logStatusError", "logStatusDiscard"};
  Instance instance = {0};
  create(&instance, CO_SIMULATION);
  CHECK(events_told(&instance) == 0);
  set_logging(&instance, true, 0, NULL);
  const int all = events_told(&instance);
  if (find("state.rotor_rate") != NULL) CHECK(all > 0);
  CHECK(all == 0 || (strcmp(instance.category, "logEvents") == 0 && instance.latest == STATUS_OK &&
                     strstr(instance.message, "t = ") != NULL));
  set_logging(&instance, false, 1, events);
  CHECK(events_told(&instance) == 0);
  set_logging(&instance, true, 1, events);
  set_logging(&instance, false, 2, others);
  CHECK(events_told(&instance) == all);
  set_logging(&instance, false, 0, NULL);
  CHECK(events_told(&instance) == 0);
  // Errors come in any case.
  REFUSED(&instance, calls()->step(instance.handle, 5.0, 1.0));
  destroy(&instance);
}
