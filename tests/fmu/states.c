// The state of the FMU: taken, given back, written as bytes and read, in both versions.
#include <stdlib.h>
#include <string.h>

#include "importer.h"

static const double integration_step = 1e-4;  // [s]

// Goes on from 0.02 s; what comes out is all that the instance knows then.
static Bytes go_on_from(Instance* instance, Run run) {
  if (instance->kind == MODEL_EXCHANGE) {
    run.instance = instance;
    go_on(&run, 0.04, integration_step);
  } else {
    OK(calls()->step(instance->handle, 0.02, 0.01));
    OK(calls()->step(instance->handle, 0.03, 0.01));
  }
  return state_of(instance);
}

TEST(ARestoredStateGoesOnWithTheSameBits) {
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    Instance instance = {0};
    begin(&instance, kind);
    Run run = {0};
    if (kind == MODEL_EXCHANGE) {
      start_run(&run, &instance);
      go_on(&run, 0.02, integration_step);
    } else {
      OK(calls()->step(instance.handle, 0.0, 0.013));
      OK(calls()->step(instance.handle, 0.013, 0.007));
    }
    void* state = NULL;
    OK(calls()->get_state(instance.handle, &state));
    const Bytes saved = bytes_of(&instance, state);
    const Bytes expected = go_on_from(&instance, run);

    // In the same instance,
    OK(calls()->set_state(instance.handle, state));
    Bytes got = go_on_from(&instance, run);
    CHECK(same_bytes(got, expected));
    free(got.bytes);
    // in another one that has run, with other parameters and another tolerance,
    Instance other = {0};
    create(&other, kind);
    const double load = 3.0;
    OK(calls()->set(other.handle, find("load.mass"), &load));
    OK(calls()->enter_initialisation(other.handle, 1e-5, 0.0, 1.0));
    OK(calls()->exit_initialisation(other.handle));
    OK(calls()->set_state(other.handle, state));
    got = go_on_from(&other, run);
    CHECK(same_bytes(got, expected));
    free(got.bytes);
    destroy(&other);
    // and, from the bytes, in one that has never been initialised.
    create(&other, kind);
    void* read = NULL;
    OK(calls()->deserialise(other.handle, saved.bytes, saved.size, &read));
    OK(calls()->set_state(other.handle, read));
    got = go_on_from(&other, run);
    CHECK(same_bytes(got, expected));
    free(got.bytes);
    OK(calls()->free_state(other.handle, &read));
    destroy(&other);

    OK(calls()->free_state(instance.handle, &state));
    destroy(&instance);
    free(saved.bytes);
    free(expected.bytes);
  }
}

TEST(AFailedInstanceCanBeRestored) {
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    Instance instance = {0};
    create(&instance, kind);
    void* state = NULL;
    OK(calls()->get_state(instance.handle, &state));
    const double nonsense = -1.0;
    OK(calls()->set(instance.handle, find("load.mass"), &nonsense));
    OK(calls()->enter_initialisation(instance.handle, 1e-7, 0.0, 1.0));
    REFUSED(&instance, calls()->exit_initialisation(instance.handle));
    REFUSED(&instance, calls()->exit_initialisation(instance.handle));
    OK(calls()->set_state(instance.handle, state));
    OK(calls()->enter_initialisation(instance.handle, 1e-7, 0.0, 1.0));
    OK(calls()->exit_initialisation(instance.handle));
    OK(calls()->free_state(instance.handle, &state));
    destroy(&instance);
  }
}

TEST(AFailedStepIsTheEndUntilAStateIsRestored) {
  const double beyond_all_bounds[3] = {1e300, 1e300, 1e300};
  Instance instance = {0};
  begin(&instance, CO_SIMULATION);
  OK(calls()->step(instance.handle, 0.0, 0.01));
  void* state = NULL;
  OK(calls()->get_state(instance.handle, &state));
  OK(calls()->step(instance.handle, 0.01, 0.01));
  const Bytes expected = state_of(&instance);
  OK(calls()->set_state(instance.handle, state));
  OK(calls()->set(instance.handle, find("input.tip_force"), beyond_all_bounds));
  REFUSED(&instance, calls()->step(instance.handle, 0.01, 0.01));
  REFUSED(&instance, calls()->step(instance.handle, 0.01, 0.01));
  REFUSED(&instance, calls()->terminate(instance.handle));
  OK(calls()->set_state(instance.handle, state));
  OK(calls()->step(instance.handle, 0.01, 0.01));
  const Bytes got = state_of(&instance);
  CHECK(same_bytes(got, expected));
  OK(calls()->free_state(instance.handle, &state));
  free(expected.bytes);
  free(got.bytes);
  destroy(&instance);

  // Of Model Exchange it is the importer that may try something else.
  begin(&instance, MODEL_EXCHANGE);
  Run run;
  start_run(&run, &instance);
  double x[MOST_STATES], dx[MOST_STATES];
  for (size_t k = 0; k < fmu.n_states; ++k) x[k] = 1e300;
  OK(calls()->set_states(instance.handle, x, fmu.n_states));
  CHECK(calls()->derivatives(instance.handle, dx, fmu.n_states) == STATUS_DISCARD);
  OK(calls()->set_states(instance.handle, run.x, fmu.n_states));
  OK(calls()->derivatives(instance.handle, dx, fmu.n_states));
  destroy(&instance);
}

TEST(StatesOfOthersAreRefused) {
  Instance exchange = {0}, simulation = {0}, other = {0};
  begin(&exchange, MODEL_EXCHANGE);
  begin(&simulation, CO_SIMULATION);
  calls()->instantiate(&other, "other", another.token, another.resources);
  void *of_exchange = NULL, *of_simulation = NULL, *of_another = NULL;
  OK(calls()->get_state(exchange.handle, &of_exchange));
  OK(calls()->get_state(simulation.handle, &of_simulation));
  OK(calls()->get_state(other.handle, &of_another));
  const Bytes before = state_of(&exchange);
  REFUSED(&exchange, calls()->set_state(exchange.handle, of_simulation));
  REFUSED(&exchange, calls()->set_state(exchange.handle, of_another));
  REFUSED(&exchange, calls()->set_state(exchange.handle, NULL));
  const Bytes after = state_of(&exchange);
  CHECK(same_bytes(before, after));
  REFUSED(&simulation, calls()->set_state(simulation.handle, of_exchange));
  OK(calls()->step(simulation.handle, 0.0, 0.001));
  // One that exists is overwritten.
  void* const place = of_simulation;
  OK(calls()->get_state(simulation.handle, &of_simulation));
  CHECK(of_simulation == place);
  OK(calls()->set_state(simulation.handle, of_simulation));
  OK(calls()->free_state(exchange.handle, &of_exchange));
  OK(calls()->free_state(simulation.handle, &of_simulation));
  OK(calls()->free_state(other.handle, &of_another));
  free(before.bytes);
  free(after.bytes);
  destroy(&exchange);
  destroy(&simulation);
  destroy(&other);
}

TEST(BytesThatHaveSufferedAreNoState) {
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    Instance instance = {0};
    begin(&instance, kind);
    if (kind == CO_SIMULATION) OK(calls()->step(instance.handle, 0.0, 0.02));
    const Bytes good = state_of(&instance);
    void* state = NULL;
    // One bit, everywhere in the beginning and at places as far from each other as a prime.
    for (size_t k = 0; k < good.size; k += k < 300 ? 1 : 97) {
      good.bytes[k] ^= (char)(1 << k % 8);
      REFUSED(&instance, calls()->deserialise(instance.handle, good.bytes, good.size, &state));
      good.bytes[k] ^= (char)(1 << k % 8);
    }
    // The end is missing, in memory of its own: what is read beyond it is found out.
    for (size_t size = 0; size < good.size; size += size < 300 ? 1 : 97) {
      char* part = malloc(size);
      memcpy(part, good.bytes, size);
      REFUSED(&instance, calls()->deserialise(instance.handle, part, size, &state));
      free(part);
    }
    // There is too much, or noise.
    char* noise = calloc(good.size + 1, 1);
    memcpy(noise, good.bytes, good.size);
    REFUSED(&instance, calls()->deserialise(instance.handle, noise, good.size + 1, &state));
    unsigned random = 1;
    for (size_t k = 0; k < good.size; ++k) {
      random = random * 1664525u + 1013904223u;
      noise[k] = (char)(random >> 24);
    }
    REFUSED(&instance, calls()->deserialise(instance.handle, noise, good.size, &state));
    REFUSED(&instance, calls()->deserialise(instance.handle, NULL, 10, &state));
    REFUSED(&instance, calls()->deserialise(instance.handle, good.bytes, good.size, NULL));
    CHECK(state == NULL);
    // Nothing of that has left a trace.
    OK(calls()->deserialise(instance.handle, good.bytes, good.size, &state));
    OK(calls()->set_state(instance.handle, state));
    const Bytes again = state_of(&instance);
    CHECK(same_bytes(good, again));

    size_t size = 0;
    REFUSED(&instance, calls()->size_of_state(instance.handle, NULL, &size));
    REFUSED(&instance, calls()->size_of_state(instance.handle, state, NULL));
    REFUSED(&instance, calls()->serialise(instance.handle, NULL, noise, good.size));
    REFUSED(&instance, calls()->serialise(instance.handle, state, noise, good.size - 1));
    REFUSED(&instance, calls()->serialise(instance.handle, state, noise, good.size + 1));
    REFUSED(&instance, calls()->serialise(instance.handle, state, NULL, good.size));
    REFUSED(&instance, calls()->get_state(instance.handle, NULL));
    OK(calls()->free_state(instance.handle, &state));
    OK(calls()->free_state(instance.handle, &state));  // nothing
    OK(calls()->free_state(instance.handle, NULL));
    free(noise);
    free(good.bytes);
    free(again.bytes);
    destroy(&instance);
  }
}
