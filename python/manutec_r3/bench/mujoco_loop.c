// MuJoCo's forward dynamics in a loop: joint accelerations of `count` poses, nv values each.
#include <mujoco/mujoco.h>
#include <string.h>

// All stages of mj_forward, or only those that lead to smooth accelerations.
static void smooth(const mjModel* m, mjData* d) {
  mj_fwdPosition(m, d);
  mj_fwdVelocity(m, d);
  mj_fwdActuation(m, d);
  mj_fwdAcceleration(m, d);
}

void forward_dynamics(const mjModel* m, mjData* d, int only_smooth, int count, const double* q,
                      const double* qd, const double* tau, double* qdd) {
  const size_t size = m->nv * sizeof(double);
  for (int k = 0; k < count; ++k) {
    const size_t first = (size_t)k * m->nv;
    memcpy(d->qpos, q + first, size);
    memcpy(d->qvel, qd + first, size);
    memcpy(d->qfrc_applied, tau + first, size);
    if (only_smooth) {
      smooth(m, d);
    } else {
      mj_forward(m, d);
    }
    memcpy(qdd + first, only_smooth ? d->qacc_smooth : d->qacc, size);
  }
}
