// Runs in the order of calls that the standard asks for, in both versions.
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "importer.h"

static const double integration_step = 1e-4;  // [s]: a sixtieth of the fastest time constant
static const double t_end = 0.05;             // [s]: axes break away, five samples are taken

enum { N_ANGLES = 6 };

static void simulate(Instance* instance, double until, double communication_step) {
  const int n = (int)lround(until / communication_step);
  for (int k = 0; k < n; ++k) {
    OK(calls()->step(instance->handle, k * communication_step, communication_step));
  }
}

static void angles_of(const Instance* instance, double* angles) {
  OK(calls()->get(instance->handle, find("joint_angle"), angles));
}

static bool same(const double* a, const double* b, size_t n) {
  return memcmp(a, b, n * sizeof *a) == 0;
}

// How a run of either kind ends: all states.
static void end_of_run(Kind kind, double* x) {
  Instance instance = {0};
  begin(&instance, kind);
  if (kind == MODEL_EXCHANGE) {
    Run run;
    start_run(&run, &instance);
    go_on(&run, t_end, integration_step);
    memcpy(x, run.x, sizeof run.x);
  } else {
    simulate(&instance, t_end, 0.01);
    angles_of(&instance, x);
  }
  OK(calls()->terminate(instance.handle));
  destroy(&instance);
}

TEST(EventsOfModelExchangeAreHandled) {
  Instance instance = {0};
  begin(&instance, MODEL_EXCHANGE);
  Run run;
  start_run(&run, &instance);
  go_on(&run, t_end, integration_step);
  // Axes break away; without friction there is nothing to happen so soon.
  if (find("state.rotor_rate") != NULL && fmu.sampling_time == 0.0) CHECK(run.state_events > 0);
  // One begins at the start.
  const int n_samples = fmu.sampling_time > 0.0 ? (int)(t_end / fmu.sampling_time) : 0;
  CHECK_THAT(run.time_events == n_samples, "%d time events are %d", run.time_events, n_samples);
  OK(calls()->terminate(instance.handle));
  double angles[N_ANGLES];
  angles_of(&instance, angles);
  destroy(&instance);
}

TEST(BothKindsAgree) {
  Instance a = {0}, b = {0};
  begin(&a, MODEL_EXCHANGE);
  begin(&b, CO_SIMULATION);
  Run run;
  start_run(&run, &a);
  go_on(&run, t_end, integration_step);
  simulate(&b, t_end, 0.01);
  double of_a[N_ANGLES], of_b[N_ANGLES];
  angles_of(&a, of_a);
  angles_of(&b, of_b);
  for (int i = 0; i < N_ANGLES; ++i) {
    CHECK_THAT(fabs(of_a[i] - of_b[i]) <= 1e-6, "axis %d: %.17g and %.17g rad", i + 1, of_a[i],
               of_b[i]);
  }
  destroy(&a);
  destroy(&b);
}

TEST(AResetInstanceRunsAgainWithTheSameBits) {
  for (Kind kind = MODEL_EXCHANGE; kind <= CO_SIMULATION; ++kind) {
    Instance instance = {0};
    begin(&instance, kind);
    double ends[2][MOST_STATES] = {{0}};
    for (int k = 0; k < 2; ++k) {
      if (kind == MODEL_EXCHANGE) {
        Run run;
        start_run(&run, &instance);
        go_on(&run, t_end, integration_step);
        memcpy(ends[k], run.x, sizeof run.x);
      } else {
        simulate(&instance, t_end, 0.01);
        angles_of(&instance, ends[k]);
      }
      if (k == 1) break;
      // Whatever has been set is forgotten.
      const double force[3] = {1.0, 2.0, 3.0};
      OK(calls()->set(instance.handle, find("input.tip_force"), force));
      OK(calls()->reset(instance.handle));
      OK(calls()->enter_initialisation(instance.handle, 1e-7, 0.0, 10.0));
      OK(calls()->exit_initialisation(instance.handle));
    }
    CHECK(same(ends[0], ends[1], MOST_STATES));
    destroy(&instance);
  }
}

TEST(TwoInstancesAtOnceKnowNothingOfEachOther) {
  enum { N_PIECES = 10 };
  Instance a = {0}, b = {0}, alone = {0};
  Run of_a, of_b, of_alone;
  begin(&alone, MODEL_EXCHANGE);
  start_run(&of_alone, &alone);
  for (int k = 1; k <= N_PIECES; ++k) go_on(&of_alone, k * t_end / N_PIECES, integration_step);
  begin(&a, MODEL_EXCHANGE);
  begin(&b, MODEL_EXCHANGE);
  start_run(&of_a, &a);
  start_run(&of_b, &b);
  const double force[3] = {500.0, 500.0, 0.0};
  OK(calls()->set(b.handle, find("input.tip_force"), force));
  for (int k = 1; k <= N_PIECES; ++k) {
    go_on(&of_a, k * t_end / N_PIECES, integration_step);
    go_on(&of_b, k * t_end / N_PIECES, integration_step);
  }
  CHECK(same(of_a.x, of_alone.x, fmu.n_states));
  CHECK(!same(of_a.x, of_b.x, fmu.n_states));
  destroy(&b);
  go_on(&of_a, t_end + integration_step, integration_step);
  destroy(&a);
  destroy(&alone);
}

typedef struct {
  Kind kind;
  double end[MOST_STATES];
} Job;

static void* do_job(void* job) {
  end_of_run(((Job*)job)->kind, ((Job*)job)->end);
  return NULL;
}

TEST(InstancesRunInThreads) {
  double expected[N_KINDS][MOST_STATES] = {{0}};
  end_of_run(MODEL_EXCHANGE, expected[MODEL_EXCHANGE]);
  end_of_run(CO_SIMULATION, expected[CO_SIMULATION]);
  enum { N_THREADS = 4 };
  Job jobs[N_THREADS] = {{0}};
  pthread_t threads[N_THREADS];
  for (int k = 0; k < N_THREADS; ++k) {
    jobs[k].kind = k % 2 == 0 ? MODEL_EXCHANGE : CO_SIMULATION;
    CHECK(pthread_create(&threads[k], NULL, do_job, &jobs[k]) == 0);
  }
  for (int k = 0; k < N_THREADS; ++k) {
    CHECK(pthread_join(threads[k], NULL) == 0);
    CHECK(same(jobs[k].end, expected[jobs[k].kind], MOST_STATES));
  }
}

// Differences of the importer's own: rates at angles that all move at once, and at another force.
TEST(DirectionalDerivativesAreDifferences) {
  Instance instance = {0};
  begin(&instance, MODEL_EXCHANGE);
  Run run;
  start_run(&run, &instance);
  go_on(&run, 0.02, integration_step);
  const double seeds[6] = {1.0, -0.5, 0.3, 0.2, -0.7, 0.4};
  const struct {
    const char* name;
    double step, allowed;
  } knowns[] = {{"state.joint_angle", 1e-5, 1e-6}, {"input.tip_force", 1.0, 1e-6}};
  const Variable* unknown = find("der(state.joint_rate)");
  for (int k = 0; k < 2; ++k) {
    const Variable* known = find(knowns[k].name);
    double derivatives[6], values[6], at[2][6], largest = 0.0;
    OK(calls()->get(instance.handle, known, values));
    OK(calls()->directional_derivative(instance.handle, unknown, known, seeds, derivatives));
    for (int side = 0; side < 2; ++side) {
      double moved[6];
      for (size_t i = 0; i < known->size; ++i) {
        moved[i] = values[i] + (side == 0 ? -1.0 : 1.0) * knowns[k].step * seeds[i];
      }
      OK(calls()->set(instance.handle, known, moved));
      OK(calls()->get(instance.handle, unknown, at[side]));
    }
    OK(calls()->set(instance.handle, known, values));
    for (int i = 0; i < 6; ++i) largest = fmax(largest, fabs(derivatives[i]));
    CHECK(largest > 0.0);
    for (int i = 0; i < 6; ++i) {
      const double difference = (at[1][i] - at[0][i]) / (2.0 * knowns[k].step);
      // The square of the step, and roundoff divided by it.
      CHECK_THAT(fabs(derivatives[i] - difference) <= knowns[k].allowed * largest,
                 "%s, axis %d: %.17g and %.17g", known->name, i + 1, derivatives[i], difference);
    }
  }
  destroy(&instance);
}

// In Germany 0.5 is 0,5: the FMU reads its resources, and messages tell numbers, as everywhere.
TEST(TheLocaleOfTheProcessDoesNotMatter) {
  double expected[MOST_STATES] = {0}, got[MOST_STATES] = {0};
  end_of_run(CO_SIMULATION, expected);
  const char* const names[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"};
  bool found = false;
  for (int k = 0; k < 3; ++k) found = found || setlocale(LC_ALL, names[k]) != NULL;
  if (!found) {
    printf("no locale here has a decimal comma\n");
    exit(77);
  }
  CHECK(strcmp(localeconv()->decimal_point, ",") == 0);
  end_of_run(CO_SIMULATION, got);
  CHECK(same(expected, got, MOST_STATES));
}
