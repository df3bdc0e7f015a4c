/* MuJoCo's stages in loops over rows, called from Python: see mujoco_peer.py.

   Each function takes the number of rows, the inputs, and where the results go; where that is null they stay in mjData. */
#include <mujoco/mujoco.h>
#include <string.h>

static void placed(const mjModel *m, mjData *d, const mjtNum *q) {
  memcpy(d->qpos, q, sizeof(mjtNum) * m->nq);
  mj_kinematics(m, d);
  mj_comPos(m, d);
}

static void moving(const mjModel *m, mjData *d, const mjtNum *v) {
  memcpy(d->qvel, v, sizeof(mjtNum) * m->nv);
  mj_comVel(m, d);
}

void inverse_dynamics(const mjModel *m, mjData *d, long count, const mjtNum *q, const mjtNum *v, const mjtNum *a,
                      mjtNum *out) {
  const int n = m->nv;
  for (long k = 0; k < count; k++) {
    placed(m, d, q + k * n);
    moving(m, d, v + k * n);
    memcpy(d->qacc, a + k * n, sizeof(mjtNum) * n);
    mj_rne(m, d, 1, out ? out + k * n : d->qfrc_inverse);
  }
}

void forward_dynamics(const mjModel *m, mjData *d, long count, const mjtNum *q, const mjtNum *v, const mjtNum *tau,
                      mjtNum *out) {
  const int n = m->nv;
  for (long k = 0; k < count; k++) {
    placed(m, d, q + k * n);
    mj_makeM(m, d);
    mj_factorM(m, d);
    moving(m, d, v + k * n);
    mj_rne(m, d, 0, d->qfrc_bias);
    for (int i = 0; i < n; i++) d->qfrc_smooth[i] = tau[k * n + i] - d->qfrc_bias[i];
    mj_solveM(m, d, out ? out + k * n : d->qacc, d->qfrc_smooth, 1);
  }
}

void mass_matrix(const mjModel *m, mjData *d, long count, const mjtNum *q, mjtNum *out) {
  const int n = m->nv;
  for (long k = 0; k < count; k++) {
    placed(m, d, q + k * n);
    mj_makeM(m, d);
    if (out) mj_fullM(m, d, out + k * n * n);
  }
}

void jacobian(const mjModel *m, mjData *d, long count, const mjtNum *q, mjtNum *out) {
  const int n = m->nv;
  mjtNum kept[6 * 64];
  for (long k = 0; k < count; k++) {
    mjtNum *J = out ? out + k * 6 * n : kept;
    placed(m, d, q + k * n);
    mj_jacSite(m, d, J, J + 3 * n, 0);
  }
}

/* steps that are too long are found by what comes of them */
static void unsaid(const char *warning) { (void)warning; }

/* Motors and links of elastic joints, each joint as two hinges: the motor's angle, and how far the link is ahead of it.
   targets: a row a period, references of the motors' angles, then of their speeds.  record: a row a period, links' q. */
void closed_loop(const mjModel *m, mjData *d, long periods, long substeps, double kp, double kd, const mjtNum *targets,
                 mjtNum *record) {
  const int n = m->nv / 2;
  mju_user_warning = unsaid;
  for (long k = 0; k < periods; k++, targets += 2 * n, record += n) {
    for (int i = 0; i < n; i++) {
      record[i] = d->qpos[2 * i] + d->qpos[2 * i + 1];
      d->qfrc_applied[2 * i] = kp * (targets[i] - d->qpos[2 * i]) + kd * (targets[n + i] - d->qvel[2 * i]);
    }
    for (long step = 0; step < substeps; step++) mj_step(m, d);
  }
}
