// An integrator for Model Exchange. It asks little of its own accuracy: what counts is the order of
// calls, and that events come as the standard says.
#include <math.h>
#include <string.h>

#include "importer.h"

// What holds on the present branches: what sticks has no rate and no acceleration, and no indicator
// is zero.
static void check_branches(const Run* run) {
  const Calls* call = calls();
  void* handle = run->instance->handle;
  double z[MOST_INDICATORS];
  OK(call->indicators(handle, z, fmu.n_indicators));
  for (size_t k = 0; k < fmu.n_indicators; ++k) {
    CHECK_THAT(z[k] > 0.0, "indicator %zu is %g right after an event at %.17g", k, z[k], run->t);
  }
  const Variable* rotors = find("state.rotor_rate");
  if (rotors == NULL) return;  // no friction
  int friction[6];
  double rotor_rates[6], accelerations[6];
  OK(call->get_integer(handle, find("branch.friction"), friction));
  OK(call->get(handle, find("rotor_rate"), rotor_rates));
  // Axes with elastic gears have rotors of their own.
  OK(call->get(handle, find("der(state.joint_rate)"), accelerations));
  OK(call->get(handle, find("der(state.rotor_rate)"), accelerations));
  for (int axis = 0; axis < 6; ++axis) {
    if (friction[axis] != 0) continue;
    CHECK_THAT(rotor_rates[axis] == 0.0, "axis %d sticks at rate %g", axis + 1, rotor_rates[axis]);
    CHECK_THAT(accelerations[axis] == 0.0, "axis %d sticks at acceleration %g", axis + 1,
               accelerations[axis]);
  }
}

static void handle_event(Run* run) {
  const Calls* call = calls();
  void* handle = run->instance->handle;
  Update update = {0};
  OK(call->update(handle, &update));
  run->next_time = update.next_time_defined ? update.next_time : INFINITY;
  CHECK(run->next_time > run->t);
  double x[MOST_STATES];
  OK(call->get_states(handle, x, fmu.n_states));
  CHECK(update.states_changed || memcmp(x, run->x, fmu.n_states * sizeof *x) == 0);
  memcpy(run->x, x, fmu.n_states * sizeof *x);
  // It is a fixed point.
  OK(call->update(handle, &update));
  CHECK(!update.states_changed);
  OK(call->enter_continuous_time(handle));
  check_branches(run);
}

void start_run(Run* run, Instance* instance) {
  *run = (Run){.instance = instance};
  OK(calls()->get_states(instance->handle, run->x, fmu.n_states));
  handle_event(run);
}

static void evaluate(const Run* run, double t, const double* x, double* dx) {
  OK(calls()->set_time(run->instance->handle, t));
  OK(calls()->set_states(run->instance->handle, x, fmu.n_states));
  OK(calls()->derivatives(run->instance->handle, dx, fmu.n_states));
}

// A step from where the run is to t1; returns whether an indicator has fired there.
static bool step(const Run* run, double t1, double* x1) {
  const double h = t1 - run->t;
  double k1[MOST_STATES], k2[MOST_STATES], z[MOST_INDICATORS];
  evaluate(run, run->t, run->x, k1);
  for (size_t i = 0; i < fmu.n_states; ++i) x1[i] = run->x[i] + h * k1[i];
  evaluate(run, t1, x1, k2);
  for (size_t i = 0; i < fmu.n_states; ++i) x1[i] = run->x[i] + 0.5 * h * (k1[i] + k2[i]);
  OK(calls()->set_states(run->instance->handle, x1, fmu.n_states));
  OK(calls()->indicators(run->instance->handle, z, fmu.n_indicators));
  for (size_t i = 0; i < fmu.n_indicators; ++i) {
    if (z[i] <= 0.0) return true;
  }
  return false;
}

void go_on(Run* run, double until, double longest) {
  while (run->t < until) {
    double x1[MOST_STATES];
    double t1 = fmin(fmin(run->t + longest, run->next_time), until);
    const bool fired = step(run, t1, x1);
    if (fired) {
      double inside = run->t;
      while (t1 - inside > 4e-16 + 1e-13 * t1) {
        const double middle = 0.5 * (inside + t1);
        if (step(run, middle, x1)) {
          t1 = middle;
        } else {
          inside = middle;
        }
      }
      CHECK(step(run, t1, x1));
    }
    run->t = t1;
    memcpy(run->x, x1, fmu.n_states * sizeof *x1);
    const bool time_event = t1 == run->next_time;
    run->state_events += fired;
    run->time_events += time_event;
    if (!fired && !time_event) continue;
    OK(calls()->enter_event(run->instance->handle));
    handle_event(run);
  }
}
