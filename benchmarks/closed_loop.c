
/* Appended to forward dynamics that CasADi has generated, f(q, v, tau) of N joints: links and motors of elastic joints
   under motor-side control, held over a period, in Runge-Kutta steps of fourth order. */

static void rates(const double *x, const double *u, double stiffness, double inertia, double *out) {
  static casadi_int iw[SZ_IW];
  static double w[SZ_W];
  double spring[N];
  const double *arg[SZ_ARG];
  double *res[SZ_RES];
  for (int i = 0; i < N; i++) {
    spring[i] = stiffness * (x[2 * N + i] - x[i]);
    out[i] = x[N + i];
    out[2 * N + i] = x[3 * N + i];
    out[3 * N + i] = (u[i] - spring[i]) / inertia;
  }
  arg[0] = x, arg[1] = x + N, arg[2] = spring, res[0] = out + N;
  f(arg, res, iw, w, 0);
}

/* x: the state, q, v, theta, theta'.  targets: a row a period, of the motors' angles and speeds.  record: links' q. */
void closed_loop(long periods, long substeps, double period, double stiffness, double inertia, double kp, double kd,
                 double *x, const double *targets, double *record) {
  static const double ahead[] = {0.5, 0.5, 1.0}, weight[] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  const double h = period / (double)substeps;
  for (long k = 0; k < periods; k++, targets += 2 * N, record += N) {
    double u[N];
    for (int i = 0; i < N; i++) {
      record[i] = x[i];
      u[i] = kp * (targets[i] - x[2 * N + i]) + kd * (targets[N + i] - x[3 * N + i]);
    }
    for (long step = 0; step < substeps; step++) {
      double y[4 * N], total[4 * N], rate[4 * N];
      for (int i = 0; i < 4 * N; i++) y[i] = total[i] = x[i];
      for (int stage = 0; stage < 4; stage++) {
        rates(y, u, stiffness, inertia, rate);
        for (int i = 0; i < 4 * N; i++) total[i] += h * weight[stage] * rate[i];
        for (int i = 0; stage < 3 && i < 4 * N; i++) y[i] = x[i] + h * ahead[stage] * rate[i];
      }
      for (int i = 0; i < 4 * N; i++) x[i] = total[i];
    }
  }
}
