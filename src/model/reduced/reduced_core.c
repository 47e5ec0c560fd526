#include "model/reduced/reduced_core.h"

#include <math.h>
#include <stddef.h>

enum { TRIALS = 60 };
static const double near = 1e-7, beyond = 1e-9; // of the range

static int cell_of(const struct dea_reduced_spline *s, int k, double x, double *at, double *width)
{
  int i = 0;
  while (i + 1 < s->cells[k] && x >= s->breaks[k][i + 1]) {
    i++;
  }
  *width = s->breaks[k][i + 1] - s->breaks[k][i];
  *at = (x - s->breaks[k][i]) / *width;
  return i;
}

/* Value, slope and second slope of a polynomial. */
static void horner(const double c[DEA_REDUCED_TERMS], double x, double out[3])
{
  double f = 0, d = 0, dd = 0;
  for (int i = DEA_REDUCED_TERMS - 1; i >= 0; i--) {
    dd = dd * x + d;
    d = d * x + f;
    f = f * x + c[i];
  }
  out[0] = f;
  out[1] = d;
  out[2] = 2 * dd;
}

/* A spline along x in one of its cells at one y: value and slopes by y as polynomials. */
struct line {
  double at[3][DEA_REDUCED_TERMS];
};

static void line_at(const struct dea_reduced_spline *spline, int i, int j, double t, double width,
                    struct line *out)
{
  const double *c = spline->c + (i * spline->cells[1] + j) * DEA_REDUCED_TERMS * DEA_REDUCED_TERMS;
  for (int k = 0; k < DEA_REDUCED_TERMS; k++) {
    double by[3];
    horner(c + k * DEA_REDUCED_TERMS, t, by);
    out->at[0][k] = by[0];
    out->at[1][k] = by[1] / width;
    out->at[2][k] = by[2] / (width * width);
  }
}

static void point_of_line(const struct line *line, double s, double width, double out[6])
{
  double f = 0, f_s = 0, f_ss = 0, g = 0, g_s = 0, h = 0; // g, h: slopes by y
  const double per = 1 / width;
  for (int i = DEA_REDUCED_TERMS - 1; i >= 0; i--) {
    f_ss = f_ss * s + f_s;
    f_s = f_s * s + f;
    f = f * s + line->at[0][i];
    g_s = g_s * s + g;
    g = g * s + line->at[1][i];
    h = h * s + line->at[2][i];
  }
  out[0] = f;
  out[1] = f_s * per;
  out[2] = g;
  out[3] = 2 * f_ss * per * per;
  out[4] = g_s * per;
  out[5] = h;
}

void dea_reduced_spline_at(const struct dea_reduced_spline *spline, double x, double y,
                           double out[6])
{
  double at[2], width[2];
  struct line line;
  const int i = cell_of(spline, 0, x, &at[0], &width[0]),
            j = cell_of(spline, 1, y, &at[1], &width[1]);
  line_at(spline, i, j, at[1], width[1], &line);
  point_of_line(&line, at[0], width[0], out);
}

static int is_outside(const struct dea_reduced_spline *s, int k, double x)
{
  const double low = s->breaks[k][0], high = s->breaks[k][s->cells[k]];
  return !(x >= low - beyond * (high - low) && x <= high + beyond * (high - low));
}

/* The energy at a voltage, for many forces. */
struct section {
  const struct dea_reduced *model;
  double voltage_V, t, width;
  int i, j; // i: cell of the line; -1: none yet
  struct line line;
};

static int section_begin(const struct dea_reduced *model, double voltage_V, struct section *out)
{
  const double y = model->even ? voltage_V * voltage_V : voltage_V;
  if (is_outside(&model->energy, 1, y)) {
    return DEA_REDUCED_BEYOND_VOLTAGE;
  }
  out->model = model;
  out->voltage_V = voltage_V;
  out->i = -1;
  out->j = cell_of(&model->energy, 1, y, &out->t, &out->width);
  return DEA_REDUCED_OK;
}

static int section_at(struct section *of, double force, struct dea_reduced_point *out)
{
  const struct dea_reduced *model = of->model;
  const double V = of->voltage_V, y_V = model->even ? 2 * V : 1, y_VV = model->even ? 2 : 0;
  double f[6], s, width;
  if (is_outside(&model->energy, 0, force)) {
    return DEA_REDUCED_BEYOND_FORCE;
  }
  const int i = cell_of(&model->energy, 0, force, &s, &width);
  if (i != of->i) {
    line_at(&model->energy, i, of->j, of->t, of->width, &of->line);
    of->i = i;
  }
  point_of_line(&of->line, s, width, f);
  out->force = force;
  out->voltage_V = V;
  out->q = -f[1];
  out->charge_C = -f[2] * y_V;
  out->energy_J = f[0] - force * f[1];
  out->by_force = -f[3];
  out->by_voltage = -f[4] * y_V;
  out->charge_by_voltage = -f[5] * y_V * y_V - f[2] * y_VV;
  return DEA_REDUCED_OK;
}

int dea_reduced_at(const struct dea_reduced *model, double force, double voltage_V,
                   struct dea_reduced_point *out)
{
  struct section section;
  const int end = section_begin(model, voltage_V, &section);
  return end != DEA_REDUCED_OK ? end : section_at(&section, force, out);
}

/* The next force of Newton's method, which stays in the range; a second time at its end: 0. */
static int correct(const struct dea_reduced *model, double step, double *force)
{
  const struct dea_reduced_spline *s = &model->energy;
  const double low = s->breaks[0][0], high = s->breaks[0][s->cells[0]], was = *force;
  *force = fmin(fmax(was - step, low), high);
  return *force != was || was - step == was;
}

/* Whether a step of Newton's method is the last one: what it leaves goes with its square, so that
 * the slopes take the point there. */
static int is_last(const struct dea_reduced *model, double step)
{
  const struct dea_reduced_spline *s = &model->energy;
  return fabs(step) <= near * (s->breaks[0][s->cells[0]] - s->breaks[0][0]);
}

static void move_to(double force, struct dea_reduced_point *p)
{
  const double by = force - p->force;
  p->q += p->by_force * by;
  p->charge_C += p->by_voltage * by;
  p->energy_J += (p->force + 0.5 * by) * p->by_force * by;
  p->force = force;
}

static int hold(struct section *section, double q, struct dea_reduced_point *out)
{
  const struct dea_reduced *model = section->model;
  double force = out->force;
  for (int i = 0; i < TRIALS; i++) {
    const int end = section_at(section, force, out);
    const double step = (out->q - q) / out->by_force;
    if (end != DEA_REDUCED_OK) {
      return end;
    }
    if (!correct(model, step, &force)) {
      return DEA_REDUCED_BEYOND_FORCE;
    }
    if (is_last(model, step)) {
      move_to(force, out);
      return DEA_REDUCED_OK;
    }
  }
  return DEA_REDUCED_NOT_CONVERGED;
}

int dea_reduced_held(const struct dea_reduced *model, double q, double voltage_V,
                     struct dea_reduced_point *out)
{
  struct section section;
  const int end = section_begin(model, voltage_V, &section);
  return end != DEA_REDUCED_OK ? end : hold(&section, q, out);
}

double dea_reduced_polynomial(const double c[3], double x)
{
  return c[0] + x * (c[1] + x * c[2]);
}

static double strain(const struct dea_reduced *model, double q)
{
  const double *c = model->strain, x = q - model->middle;
  return x * (c[0] + x * (c[1] / 2 + x * c[2] / 3));
}

/* What branches at p pull back with, and its slope by q where p = known + share e. */
static double pull(const struct dea_reduced *model, const double *p, const double *share, double q,
                   double *slope)
{
  const double x = q - model->middle, e = strain(model, q),
               d = dea_reduced_polynomial(model->strain, x);
  const double dd = model->strain[1] + 2 * model->strain[2] * x;
  double sum = 0;
  *slope = 0;
  for (int i = 0; i < model->branch_count; i++) {
    const double k = model->branch_N_per_m[i];
    sum += k * (e - p[i]) * d;
    *slope += k * ((1 - share[i]) * d * d + (e - p[i]) * dd);
  }
  return sum;
}

/* Inertia m a + m' v^2/2 and its slope by q, with a and v by q. */
static double inertia_at(const struct dea_reduced *model, const double mass[3], double q, double v,
                         double a, double a_q, double v_q, double *slope)
{
  const double x = q - model->middle, m = dea_reduced_polynomial(mass, x),
               d = mass[1] + 2 * mass[2] * x;
  *slope = m * a_q + d * a + d * v * v_q + mass[2] * v * v;
  return m * a + d * v * v / 2;
}

static double branch_J(const struct dea_reduced *model, const struct dea_reduced_copy *at)
{
  double sum = 0;
  for (int i = 0; i < model->branch_count; i++) {
    const double r = strain(model, at->at.q) - at->p[i];
    sum += model->branch_N_per_m[i] * r * r / 2;
  }
  return sum;
}

// Copies ------------------------------------------------------------------------------------------

/* Of the force from outside a copy has a part, so that each mode has its own of dq/dF. */
static double force_on(const struct dea_reduced *model, int k, double external)
{
  const struct dea_reduced_mode *mode = &model->modes[k == 0 ? 0 : (k - 1) / 2];
  return k == 0 ? external : mode->share / mode->voltage_share * external;
}

double dea_reduced_weight(const struct dea_reduced *model, int k, double *energy)
{
  const struct dea_reduced_mode *mode = &model->modes[k == 0 ? 0 : (k - 1) / 2];
  const double share = mode->voltage_share, sign = k % 2 == 1 ? 1 : -1;
  *energy = k == 0 ? 1 : sign * share * share / mode->share;
  return k == 0 ? 1 : sign * share;
}

static int copies_of(const struct dea_reduced *model)
{
  return 1 + 2 * model->mode_count;
}

/* The device from its copies. */
static void add_up(const struct dea_reduced *model, struct dea_reduced_state *s)
{
  s->at = s->copy[0].at;
  s->at.force = s->external;
  s->at.q = s->at.charge_C = s->at.energy_J = 0;
  s->rate = s->branch_J = s->kinetic_J = s->loss_J = 0;
  for (int k = 0; k < copies_of(model); k++) {
    const struct dea_reduced_copy *c = &s->copy[k];
    double w;
    const double share = dea_reduced_weight(model, k, &w);
    s->at.q += share * c->at.q;
    s->rate += share * c->rate;
    s->at.charge_C += w * c->at.charge_C;
    s->at.energy_J += w * c->at.energy_J;
    s->branch_J += w * branch_J(model, c);
    s->loss_J += w * c->loss_J;
    if (k % 2 == 1) {
      const double m = dea_reduced_polynomial(model->modes[k / 2].mass, c->at.q - model->middle);
      s->kinetic_J += w * m * c->rate * c->rate / 2;
    }
  }
}

int dea_reduced_begin(const struct dea_reduced *model, double voltage_V, double external,
                      struct dea_reduced_state *out)
{
  *out = (struct dea_reduced_state){.external = external};
  for (int k = 0; k < copies_of(model); k++) {
    struct dea_reduced_copy *c = &out->copy[k];
    const int end = dea_reduced_at(model, force_on(model, k, external), voltage_V, &c->at);
    if (end != DEA_REDUCED_OK) {
      return end;
    }
    for (int i = 0; i < model->branch_count; i++) {
      c->p[i] = strain(model, c->at.q);
    }
  }
  add_up(model, out);
  return DEA_REDUCED_OK;
}

// Steps -------------------------------------------------------------------------------------------

/* A step of a copy: p = known + share e at its end, and the state before. */
struct step {
  const struct dea_reduced *model;
  struct section section; // at the voltage of its end
  const struct dea_reduced_copy *from;
  const double *mass; // of the copy, or NULL
  double h, external[2];
  double gone[DEA_REDUCED_BRANCHES], share[DEA_REDUCED_BRANCHES]; // gone: 1 - exp(-h/tau)
  double known[DEA_REDUCED_BRANCHES], lost[DEA_REDUCED_BRANCHES][3];
  double was; // what the begin of the step adds to the residual
  double a_m, a_f, gamma;
  double a_q, a_a, v_q; // slopes of the acceleration by q and by that before, of the rate by q
};

/* What the device does not balance of the force at a state, its branches at p. */
static double imbalance(const struct step *s, const struct dea_reduced_copy *at, double external,
                        double *slope)
{
  const double back = pull(s->model, at->p, s->share, at->at.q, slope);
  return at->at.force + back + s->model->damping * at->rate - external;
}

/* The residual at to->at, of which the rest of `to` follows, and its slope by q. */
static double residual(const struct step *s, struct dea_reduced_copy *to, double *slope)
{
  const struct dea_reduced_copy *n = s->from;
  const double h = s->h, c = s->model->damping, q = to->at.q;
  double by_q, inertia_q;
  const double e = strain(s->model, q);
  for (int i = 0; i < s->model->branch_count; i++) {
    to->p[i] = s->known[i] + s->share[i] * e;
  }
  if (s->mass == NULL) {
    to->rate = h > 0 ? (q - n->at.q) / h : 0;
    const double r = imbalance(s, to, s->external[1], &by_q);
    *slope = 1 / to->at.by_force + by_q + (h > 0 ? c / h : 0);
    return r;
  }
  const double a_q = s->a_q, v_q = s->v_q;
  to->acceleration = (q - n->at.q - h * n->rate) * a_q - s->a_a * n->acceleration;
  to->rate = n->rate + h * ((1 - s->gamma) * n->acceleration + s->gamma * to->acceleration);
  const double now =
      inertia_at(s->model, s->mass, q, to->rate, to->acceleration, a_q, v_q, &inertia_q);
  const double r = imbalance(s, to, s->external[1], &by_q);
  *slope = (1 - s->a_m) * inertia_q + (1 - s->a_f) * (1 / to->at.by_force + by_q + c * v_q);
  return s->was + (1 - s->a_m) * now + (1 - s->a_f) * r;
}

/* The acceleration from the forces: by a difference of places, over h^2, short steps lose digits.
 */
static void balance(const struct step *s, struct dea_reduced_copy *to)
{
  double slope;
  const double r = residual(s, to, &slope);
  if (s->mass != NULL) {
    const double m = dea_reduced_polynomial(s->mass, to->at.q - s->model->middle),
                 a = r / ((1 - s->a_m) * m);
    to->acceleration -= a;
    to->rate -= s->gamma * s->h * a;
  }
}

static int solve(struct step *s, struct dea_reduced_copy *to)
{
  const struct dea_reduced_copy *n = s->from;
  double force = n->at.force, slope;
  if (s->mass != NULL) {
    s->was =
        s->a_m * inertia_at(s->model, s->mass, n->at.q, n->rate, n->acceleration, 0, 0, &slope) +
        s->a_f * imbalance(s, n, s->external[0], &slope);
  }
  for (int i = 0; i < TRIALS; i++) {
    const int end = section_at(&s->section, force, &to->at);
    if (end != DEA_REDUCED_OK) {
      return end;
    }
    const double step = residual(s, to, &slope) / (slope * to->at.by_force);
    if (!correct(s->model, step, &force)) {
      return DEA_REDUCED_BEYOND_FORCE;
    }
    if (is_last(s->model, step)) {
      move_to(force, &to->at);
      balance(s, to);
      return DEA_REDUCED_OK;
    }
  }
  return DEA_REDUCED_NOT_CONVERGED;
}

/* The place stays, and the acceleration follows the forces. */
static int jump(struct step *s, struct dea_reduced_copy *to)
{
  double slope;
  const int end = hold(&s->section, s->from->at.q, &to->at);
  const double x = to->at.q - s->model->middle, m = dea_reduced_polynomial(s->mass, x);
  const double d = s->mass[1] + 2 * s->mass[2] * x;
  to->acceleration = -(imbalance(s, to, s->external[1], &slope) + d * to->rate * to->rate / 2) / m;
  return end;
}

/* What branches lose while e goes straight by d: with y = h/tau r = e - p is r exp(-t/tau) + d/y (1
 * - exp(-t/tau)), in a form that loses no digits in short steps. */
static double loss(const struct step *s, const struct dea_reduced_copy *to)
{
  const double h = s->h, e = strain(s->model, s->from->at.q), d = strain(s->model, to->at.q) - e;
  const double v = 0.5 * (s->from->rate + to->rate);
  double sum = s->model->damping * v * v * h;
  for (int i = 0; i < s->model->branch_count; i++) {
    const double r = e - s->from->p[i], *lost = s->lost[i];
    sum += s->model->branch_N_per_m[i] * (r * (r * lost[0] + d * lost[1]) + d * d * lost[2]);
  }
  return sum;
}

/* s: all but what is of the copy. */
static int step_copy(struct step *s, struct dea_reduced_copy *to)
{
  const double h = s->h, e = strain(s->model, s->from->at.q);
  for (int i = 0; i < s->model->branch_count; i++) {
    s->known[i] = (1 - s->gone[i]) * s->from->p[i] + (s->gone[i] - s->share[i]) * e;
  }
  *to = *s->from;
  const int end = s->mass != NULL && !(h > 0) ? jump(s, to) : solve(s, to);
  if (end == DEA_REDUCED_OK && h > 0) {
    to->loss_J += loss(s, to);
  }
  return end;
}

/* Whether a copy is where the first one is: without a force it then stays so. */
static int is_as_first(const struct dea_reduced *model, const struct dea_reduced_state *s, int k)
{
  int same = s->copy[k].at.q == s->copy[0].at.q;
  for (int i = 0; i < model->branch_count; i++) {
    same = same && s->copy[k].p[i] == s->copy[0].p[i];
  }
  return same;
}

int dea_reduced_step(const struct dea_reduced *model, const struct dea_reduced_state *from,
                     double length_s, double voltage_V, double external, int inertia, double rho,
                     struct dea_reduced_state *to)
{
  const struct dea_reduced_state n = *from;
  struct step s = {.model = model, .h = length_s};
  const int loaded = n.external != 0 || external != 0;
  int end = section_begin(model, voltage_V, &s.section);
  if (end != DEA_REDUCED_OK) {
    return end;
  }
  for (int i = 0; i < model->branch_count; i++) {
    const double y = length_s / model->branch_s[i];
    const double E = -expm1(-y),
                 last = y > 1e-3 ? y - E - E * E / 2 : y * y * y * (1.0 / 3 - y / 4);
    s.gone[i] = E;
    s.share[i] = y > 1e-4 ? 1 - E / y : y / 2 - y * y / 6;
    s.lost[i][0] = E - E * E / 2;
    s.lost[i][1] = y > 0 ? E * E / y : 0;
    s.lost[i][2] = y > 0 ? last / (y * y) : 0;
  }
  s.a_m = (2 * rho - 1) / (rho + 1);
  s.a_f = rho / (rho + 1);
  const double beta = (1 - s.a_m + s.a_f) * (1 - s.a_m + s.a_f) / 4;
  s.gamma = 0.5 - s.a_m + s.a_f;
  s.a_q = length_s > 0 ? 1 / (beta * length_s * length_s) : 0;
  s.v_q = s.gamma * length_s * s.a_q;
  s.a_a = 0.5 / beta - 1;
  to->external = external;
  for (int k = 0; k < copies_of(model); k++) {
    if (k > 0 && !loaded && (k % 2 == 0 || !inertia) && is_as_first(model, &n, k)) {
      to->copy[k] = to->copy[0];
      continue;
    }
    s.from = &n.copy[k];
    s.mass = inertia && k % 2 == 1 ? model->modes[k / 2].mass : NULL;
    s.external[0] = force_on(model, k, n.external);
    s.external[1] = force_on(model, k, external);
    end = step_copy(&s, &to->copy[k]);
    if (end != DEA_REDUCED_OK) {
      return end;
    }
  }
  add_up(model, to);
  to->time_s = n.time_s + length_s;
  to->external_J = n.external_J + 0.5 * (n.external + external) * (to->at.q - n.at.q);
  return DEA_REDUCED_OK;
}
