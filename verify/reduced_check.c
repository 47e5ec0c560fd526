/* Of a device's C source (dea reduce-order --c): reciprocity, balance of energy of a free motion,
 * steps a second: with -DLONG the first, in long double, without it the others.
 *   cc -O3 -DDEVICE='"DEVICE.c"' reduced_check.c -lm */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <time.h>
#ifdef LONG
#include <tgmath.h>
#define double long double
#endif
#include DEVICE

static const struct dea_reduced *const m = &dea_reduced_device;

/* dF/dV at q against -dQ/dq at V, by differences of sixth order; away from the breaks of the
 * spline. */
static double reciprocity(double V, double q, double dV, double dq)
{
  static const double weight[] = {-1, 9, -45, 0, 45, -9, 1};
  double by_V = 0, by_q = 0;
  struct dea_reduced_point p = {.force = 0};
  for (int i = 0; i < 7; i++) {
    dea_reduced_held(m, q, V + (i - 3) * dV, &p);
    by_V += weight[i] * p.force / (60 * dV);
    dea_reduced_held(m, q + (i - 3) * dq, V, &p);
    by_q += weight[i] * p.charge_C / (60 * dq);
  }
  return fabs(by_V / by_q + 1);
}

static double all_J(const struct dea_reduced_state *s)
{
  return s->at.energy_J + s->branch_J + s->kinetic_J + s->loss_J;
}

/* A small jump of the voltage, 20 cycles of the fastest mode. */
static double energy(double V)
{
  enum { STEPS = 40000 };
  struct dea_reduced_state s;
  double least = INFINITY, begin_J, worst_J = 0, kinetic_J = 0;
  dea_reduced_begin(m, 0.8 * V, 0, &s);
  for (int i = 0; i < m->mode_count; i++) {
    least = fmin(least, sqrt(s.at.by_force * m->modes[i].mass[0]));
  }
  dea_reduced_step(m, &s, 0, V, 0, 1, 1, &s);
  begin_J = all_J(&s);
  for (int i = 0; i < STEPS; i++) {
    if (dea_reduced_step(m, &s, 40 * acos(-1) * least / STEPS, V, 0, 1, 1, &s) != 0) {
      return NAN;
    }
    kinetic_J = fmax(kinetic_J, fabs(s.kinetic_J));
    worst_J = fmax(worst_J, fabs(all_J(&s) - begin_J));
  }
  return worst_J / kinetic_J;
}

static double speed(double V)
{
  enum { STEPS = 1000000 };
  struct dea_reduced_state s;
  const clock_t began = clock();
  dea_reduced_begin(m, 0.3 * V, 0, &s);
  for (int i = 1; i <= STEPS; i++) {
    dea_reduced_step(m, &s, 1e-4, V * (0.3 - 0.1 * sin(1e-3 * i)), 0, m->mode_count > 0, 0.9, &s);
  }
  return STEPS / ((double)(clock() - began) / CLOCKS_PER_SEC);
}

int main(void)
{
  const struct dea_reduced_spline *e = &m->energy;
  const double top = e->breaks[1][e->cells[1]], V = m->even ? sqrt(top) : top;
#ifdef LONG
  struct dea_reduced_point p;
  dea_reduced_at(m, 0.1 * e->breaks[0][e->cells[0]], 0.7 * V, &p);
  const double dq = p.by_force * e->breaks[0][e->cells[0]];
  double least = INFINITY;
  for (double h = 1.6e-2; h > 9e-4; h /= 2) { // long steps are cut off, short ones lose digits
    least = fmin(least, reciprocity(0.7 * V, p.q, h * V, h * dq));
  }
  printf("%.2Lg\n", least);
#else
  printf("%.2g %.3g\n", m->mode_count > 0 ? energy(0.7 * V) : 0, speed(V));
#endif
  return 0;
}
