/* A reduced-order model as a subcircuit of ngspice, at any amplitude
 * (docs/theory/reduced-model.md).
 *
 * Nodes of a copy k, without a force from outside:
 *
 *   x    q - middle, in millionths     f    its force, over the largest of the range
 *   v    rate of x, over the mode's angular frequency         p    branches, in millionths
 *
 * A capacitor at a node integrates the current into it: 1 nF, for which the charges of states are
 * well above the smallest that ngspice's control of steps regards. */
#include "base/version.h"
#include "model/reduced/reduced.h"

#include <math.h>

enum { N = DEA_REDUCED_TERMS };
static const double unit = 1e-6, nC = 1e-9, farad = 1e-9;

struct circuit {
  struct dea_text *text;
  const struct dea_reduced *core;
  double force, y; // units of the nodes f, and of y, which is V or V^2
};

/* Horner's form of a derivative of Phi in a cell: by F (d = 1, 0) or by y (0, 1). */
static void add_cell(struct circuit *c, int k, int i, int j, const int d[2])
{
  static const char open[] = "((((("; // [N - 1]
  const struct dea_reduced_spline *e = &c->core->energy;
  const double *terms = e->c + (i * e->cells[1] + j) * N * N;
  const double from[2] = {e->breaks[0][i], e->breaks[1][j]};
  const double width[2] = {e->breaks[0][i + 1] - from[0], e->breaks[1][j + 1] - from[1]};
  dea_text_add(c->text, "%s", open + d[0]);
  for (int a = N - 1; a >= d[0]; a--) {
    dea_text_add(c->text, "\n+ %s%s", a < N - 1 ? "+" : "", open + d[1]);
    for (int b = N - 1; b >= d[1]; b--) {
      const double factor = (d[0] ? a / width[0] : 1) * (d[1] ? b / width[1] : 1);
      dea_text_add(c->text, "%+.15g", factor * terms[a * N + b]);
      if (b > d[1]) {
        dea_text_add(c->text, ")*(%.15g*V(y)%+.15g)", c->y / width[1], -from[1] / width[1]);
      }
    }
    if (a > d[0]) {
      dea_text_add(c->text, ")*(%.15g*V(f%d)%+.15g)", c->force / width[0], k, -from[0] / width[0]);
    }
  }
}

/* The same in its cells; beyond the range that of the nearest. */
static void add_slope(struct circuit *c, int k, int by_F, int by_y)
{
  const struct dea_reduced_spline *e = &c->core->energy;
  for (int i = 0; i < e->cells[0]; i++) {
    const bool last = i + 1 == e->cells[0];
    if (!last) {
      dea_text_add(c->text, "V(f%d)<%.15g?(", k, e->breaks[0][i + 1] / c->force);
    }
    for (int j = 0; j < e->cells[1]; j++) {
      const bool top = j + 1 == e->cells[1];
      if (!top) {
        dea_text_add(c->text, "V(y)<%.15g?", e->breaks[1][j + 1] / c->y);
      }
      dea_text_add(c->text, "(");
      add_cell(c, k, i, j, (const int[2]){by_F, by_y});
      dea_text_add(c->text, top ? ")" : "):");
    }
    dea_text_add(c->text, last ? "" : "):");
  }
}

static void add_polynomial(struct circuit *c, int k, const double of[3])
{
  dea_text_add(c->text, "(%.15g+V(x%d)*(%.15g+V(x%d)*%.15g))", of[0], k, of[1] * unit, k,
               of[2] * unit * unit);
}

/* Branches of a copy at V(e), and what they pull back with over the unit of f. */
static void add_branches(struct circuit *c, int k)
{
  const double *s = c->core->strain, whole[3] = {s[0], s[1] / 2, s[2] / 3};
  dea_text_add(c->text, "Be%d e%d 0 V=V(x%d)*", k, k, k);
  add_polynomial(c, k, whole);
  dea_text_add(c->text, "\nBb%d b%d 0 V=0", k, k);
  for (int i = 0; i < c->core->branch_count; i++) {
    dea_text_add(c->text, "\n+ +%.15g*(V(e%d)-V(p%d_%d))*",
                 c->core->branch_N_per_m[i] * unit / c->force, k, k, i);
    add_polynomial(c, k, s);
  }
  for (int i = 0; i < c->core->branch_count; i++) {
    dea_text_add(c->text, "\nC%d_%d p%d_%d 0 1n\nG%d_%d 0 p%d_%d e%d p%d_%d %.15g", k, i, k, i, k,
                 i, k, i, k, k, i, farad / c->core->branch_s[i]);
  }
  dea_text_add(c->text, "\n");
}

/* at: the device at the bias, by which a mode has its damping. mode: NULL: without mass. */
static void add_motion(struct circuit *c, int k, const struct dea_reduced_mode *mode,
                       const struct dea_reduced_point *at, double damping_ratio)
{
  const struct dea_reduced *core = c->core;
  dea_text_add(c->text, mode != NULL ? "Bf%d f%d 0 I=-V(x%d)" : "Bx%d x%d 0 V=0*V(f%d)", k, k, k);
  dea_text_add(c->text, "%+.15g-%.15g*(", -core->middle / unit, 1 / unit);
  add_slope(c, k, 1, 0);
  if (mode == NULL) {
    dea_text_add(c->text, ")\nBf%d f%d 0 V=-V(b%d)\n", k, k, k);
    return;
  }
  const double x = at->q - core->middle, K = 1 / at->by_force, *m = mode->mass;
  const double mass = dea_reduced_polynomial(m, x), w = sqrt(K / mass);
  const double damping = core->damping + 2 * damping_ratio * sqrt(K * mass);
  dea_text_add(c->text, ")\nC%d x%d 0 1n\nG%d 0 x%d v%d 0 %.15g\nCv%d v%d 0 1n\nBv%d 0 v%d ", k, k,
               k, k, k, w * farad, k, k, k, k);
  dea_text_add(
      c->text, "I=-1n*(%.15g*(V(f%d)+V(b%d))+V(v%d)*(%.15g+V(v%d)*(%.15g+V(x%d)*%.15g)))\n+ /",
      c->force / (unit * w), k, k, k, damping, k, m[1] * unit * w / 2, k, m[2] * unit * w * unit);
  add_polynomial(c, k, m);
  dea_text_add(c->text, "\n");
}

/* The copies, and what they add to coordinate and charge. */
static void add_copies(struct circuit *c, const struct dea_reduced_point *at, double damping_ratio)
{
  const struct dea_reduced *core = c->core;
  double rest[2] = {1, 1}, share[1 + DEA_REDUCED_MODES];
  for (int k = core->mode_count; k >= 0; k--) {
    double weight = rest[1];
    share[k] = rest[0];
    if (k > 0) {
      share[k] = dea_reduced_weight(core, 2 * k - 1, &weight);
      rest[0] -= share[k];
      rest[1] -= weight;
    }
    add_branches(c, k);
    add_motion(c, k, k > 0 ? &core->modes[k - 1] : NULL, at, damping_ratio);
    dea_text_add(c->text, "Bc%d c%d 0 V=%.15g%s*(", k, k, (core->even ? -2 : -1) * weight / nC,
                 core->even ? "*V(p,n)" : "");
    add_slope(c, k, 0, 1);
    dea_text_add(c->text, ")\n");
  }
  dea_text_add(c->text, "Bq q 0 V=%.15g", core->middle / unit);
  for (int k = 0; k <= core->mode_count; k++) {
    dea_text_add(c->text, "%+.15g*V(x%d)", share[k], k);
  }
  dea_text_add(c->text, "\nBc c 0 V=0");
  for (int k = 0; k <= core->mode_count; k++) {
    dea_text_add(c->text, "+V(c%d)", k);
  }
}

dea_status dea_reduced_add_spice(const struct dea_reduced_export *e, struct dea_text *out)
{
  const struct dea_reduced_order *o = e->order;
  const double V = o->voltage_V[1];
  struct circuit c = {.text = out,
                      .core = &o->core,
                      .force = fmax(-o->force[0], o->force[1]),
                      .y = o->core.even ? V * V : V};
  dea_text_add(out,
               "* a film, by dea %s: %.6g to %.6g V; beyond that it is extrapolated\n"
               "* p, n: its electrodes; q: displacement, 1 V a micrometre (a turn: a microradian)\n"
               ".subckt dea_film p n q\nBy y 0 V=%.15g*V(p,n)%s\n",
               DEA_VERSION, o->voltage_V[0], V, 1 / c.y, o->core.even ? "*V(p,n)" : "");
  add_copies(&c, &e->at, e->damping_ratio);
  dea_text_add(out, "\nCi c d 1n\nVi d 0 0\nFi p n Vi 1\n.ends\n");
  return DEA_OK;
}
