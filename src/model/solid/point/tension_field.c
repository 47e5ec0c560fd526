#include "model/solid/point/tension_field.h"

#include "base/context.h"

#include <string.h>

/* ---- the energy of the film by its metric ---- */

/* Principal stresses S_a = f_a/l_a, their derivatives D_ab = 2 dS_a/dx_b by the squares x of the
 * stretches, and shear modulus m. */
struct principal {
  double W, S[2], D[2][2], m;
};

static dea_status principal_at(const struct dea_tension *film, double x1, double x2,
                               struct principal *out)
{
  const double l1 = sqrt(x1), l2 = sqrt(x2);
  struct dea_plane f, electric = {0};
  DEA_TRY_STATUS(dea_plane_elastic(film->material, l1, l2, &f));
  if (film->nominal_field_V_per_m != 0) {
    dea_plane_electric(film->material, film->nominal_field_V_per_m, l1, l2, &electric);
  }
  out->W = f.W + electric.W;
  out->S[0] = (f.s1 + electric.s1) / l1;
  out->S[1] = (f.s2 + electric.s2) / l2;
  out->D[0][0] = (f.k11 + electric.k11 - out->S[0]) / x1;
  out->D[1][1] = (f.k22 + electric.k22 - out->S[1]) / x2;
  out->D[0][1] = out->D[1][0] = (f.k12 + electric.k12) / (l1 * l2);
  return DEA_OK;
}

/* m = (S_2 - S_1)/(x_2 - x_1). Where the difference would lose digits it is the mean of
 * (D_11 - 2 D_12 + D_22)/4 between the two, by three Gauss points on [-d, d]; two of them are the
 * same state. */
static dea_status set_shear(const struct dea_tension *film, double mean, double d,
                            struct principal *out)
{
  static const double near = 0.01, node[2] = {0, 0.7745966692414834}, weight[2] = {4. / 9, 5. / 9};
  if (d > near * mean) {
    out->m = 0.5 * (out->S[0] - out->S[1]) / d;
    return DEA_OK;
  }
  out->m = 0;
  for (int i = 0; i < 2; i++) {
    struct principal at;
    DEA_TRY_STATUS(principal_at(film, mean + node[i] * d, mean - node[i] * d, &at));
    out->m += weight[i] * 0.25 * (at.D[0][0] - 2 * at.D[0][1] + at.D[1][1]);
  }
  return DEA_OK;
}

/* S and D from principal values: N_1 N_1 = (1 + T)/2 and N_2 N_2 = (1 - T)/2 with T_11 = -T_22 =
 * cos and T_12 = sin of twice the angle of N_1. */
static void assemble(const struct principal *p, double cosine, double sine,
                     struct dea_tension_point *out)
{
  const double N[2][3] = {{0.5 * (1 + cosine), 0.5 * (1 - cosine), 0.5 * sine},
                          {0.5 * (1 - cosine), 0.5 * (1 + cosine), -0.5 * sine}};
  const double G[3] = {-0.5 * sine, 0.5 * sine, 0.5 * cosine};
  for (int a = 0; a < 3; a++) {
    out->S[a] = p->S[0] * N[0][a] + p->S[1] * N[1][a];
    for (int b = 0; b < 3; b++) {
      out->D[a][b] = 4 * p->m * G[a] * G[b] + p->D[0][0] * N[0][a] * N[0][b] +
                     p->D[1][1] * N[1][a] * N[1][b] +
                     p->D[0][1] * (N[0][a] * N[1][b] + N[1][a] * N[0][b]);
    }
  }
}

/* 1/2 (B : C + B_33/det C): S = B - k C^-1 with k = B_33/det C. */
static void add_branches(const struct dea_tension *film, const double C[3],
                         struct dea_tension_point *out)
{
  static const int row[3] = {0, 1, 0}, column[3] = {0, 1, 1};
  const double *B = film->B, det = C[0] * C[1] - C[2] * C[2], k = film->B_across / det;
  const double inverse[2][2] = {{C[1] / det, -C[2] / det}, {-C[2] / det, C[0] / det}};
  out->W += 0.5 * (B[0] * C[0] + B[1] * C[1] + k) + B[2] * C[2];
  for (int a = 0; a < 3; a++) {
    const int i = row[a], j = column[a];
    out->S[a] += B[a] - k * inverse[i][j];
    for (int b = 0; b < 3; b++) {
      const int m = row[b], n = column[b];
      out->D[a][b] += k * (2 * inverse[i][j] * inverse[m][n] + inverse[i][m] * inverse[j][n] +
                           inverse[i][n] * inverse[j][m]);
    }
  }
}

/* Mohr's circle: eigenvalues mean + d and mean - d, and cos and sin of twice the angle of the axis
 * of the first. */
struct circle {
  double mean, d, cosine, sine;
};

static struct circle circle_of(const double t[3])
{
  const double half = 0.5 * (t[0] - t[1]), d = hypot(half, t[2]);
  return (struct circle){0.5 * (t[0] + t[1]), d, d > 0 ? half / d : 1, d > 0 ? t[2] / d : 0};
}

dea_status dea_tension_taut(const struct dea_tension *film, const double C[3],
                            struct dea_tension_point *out)
{
  const struct circle c = circle_of(C);
  struct principal p;
  if (!(c.mean - c.d > 0)) {
    return DEA_E_DOMAIN;
  }
  DEA_TRY_STATUS(principal_at(film, c.mean + c.d, c.mean - c.d, &p));
  DEA_TRY_STATUS(set_shear(film, c.mean, c.d, &p));
  out->W = p.W;
  assemble(&p, c.cosine, c.sine, out);
  add_branches(film, C, out);
  memcpy(out->own, C, sizeof out->own);
  out->state = DEA_TAUT;
  return DEA_OK;
}

/* ---- its envelope ---- */

static double contract(const double t[3], const double weight[3])
{
  return t[0] * weight[0] + t[1] * weight[1] + t[2] * weight[2];
}

/* What a symmetric tensor is contracted with for its components along and across a direction n. */
struct frame {
  double nn[3], tn[3], tt[3];
};

static struct frame frame_of(double angle)
{
  const double c = cos(angle), s = sin(angle);
  return (struct frame){
      {c * c, s * s, 2 * c * s}, {-c * s, c * s, c * c - s * s}, {s * s, c * c, -2 * c * s}};
}

/* D : t for such a t. */
static void contract_tangent(double D[3][3], const double weight[3], double out[3])
{
  for (int a = 0; a < 3; a++) {
    out[a] = contract(D[a], weight);
  }
}

/* Metrics C*(y) among which the least g is looked for. C = NULL: y are their eigenvalues on the
 * axis `angle` and across it; else C + y_0 n n with n at the angle y_1. */
struct family {
  const struct dea_tension *film;
  const double *C;
  double angle;
};

/* What g is there, and its derivatives by y. */
struct slope {
  struct dea_tension_point at;
  struct frame frame;
  double g[2], h[2][2];
};

static dea_status slope_at(const struct family *f, const double y[2], struct slope *out)
{
  const bool slack = f->C == NULL;
  const struct frame r = frame_of(slack ? f->angle : y[1]);
  struct dea_tension_point *at = &out->at;
  double own[3], Dn[3], D2[3];
  for (int a = 0; a < 3; a++) {
    const double share = a < 2 ? 1 : 0.5; // a weight counts 12 twice
    own[a] = share * (slack ? y[0] * r.nn[a] + y[1] * r.tt[a] : y[0] * r.nn[a]);
    own[a] += slack ? 0 : f->C[a];
  }
  DEA_TRY_STATUS(dea_tension_taut(f->film, own, at));
  out->frame = r;
  contract_tangent(at->D, r.nn, Dn);
  contract_tangent(at->D, slack ? r.tt : r.tn, D2);
  const double Snn = contract(at->S, r.nn), Stt = contract(at->S, r.tt);
  const double Stn = contract(at->S, r.tn), turn = y[0] * (Stt - Snn + y[0] * contract(D2, r.tn));
  out->g[0] = 0.5 * Snn;
  out->g[1] = slack ? 0.5 * Stt : y[0] * Stn;
  out->h[0][0] = 0.25 * contract(Dn, r.nn);
  out->h[0][1] = out->h[1][0] =
      slack ? 0.25 * contract(Dn, r.tt) : Stn + 0.5 * y[0] * contract(Dn, r.tn);
  out->h[1][1] = slack ? 0.25 * contract(D2, r.tt) : turn;
  return DEA_OK;
}

/* Newton's step, downhill where g is not convex, and not too far. */
static void step_of(const struct slope *s, const double limit[2], double step[2])
{
  const double a = s->h[0][0], b = s->h[0][1], c = s->h[1][1], det = a * c - b * b;
  const bool convex = a > 0 && det > 1e-12 * fabs(a * c);
  step[0] = convex ? (b * s->g[1] - c * s->g[0]) / det : -s->g[0] / (fabs(a) + 1e-300);
  step[1] = convex ? (b * s->g[0] - a * s->g[1]) / det : -s->g[1] / (fabs(c) + 1e-300);
  const double far = fmax(fabs(step[0]) / limit[0], fabs(step[1]) / limit[1]);
  for (int i = 0; i < 2 && far > 1; i++) {
    step[i] /= far;
  }
}

/* The next minimum of g downhill from y. DEA_E_DOMAIN: none before the film is stretched 20 times,
 * which no elastomer is. */
static dea_status minimise(const struct family *f, double y[2], struct slope *out)
{
  enum { ITERATIONS_MAX = 100, HALVINGS_MAX = 40 };
  static const double most = 400, close = 1e-8, rounding = 1e-13;
  dea_status status = slope_at(f, y, out);
  for (int i = 0; i < ITERATIONS_MAX && status == DEA_OK; i++) {
    const double size = out->at.own[0] + out->at.own[1];
    const double limit[2] = {f->C != NULL ? 0.5 * size : 0.5 * fmin(y[0], y[1]),
                             f->C != NULL ? 0.3 : 0.5 * fmin(y[0], y[1])};
    struct slope next;
    double step[2], at[2], share = 1, down, there = 0;
    step_of(out, limit, step);
    down = out->g[0] * step[0] + out->g[1] * step[1];
    const bool last = fabs(step[0]) <= close * limit[0] &&
                      (fabs(step[1]) <= close * limit[1] ||
                       (f->C != NULL && y[0] * fabs(step[1]) <= rounding * size));
    for (int k = 0; k < HALVINGS_MAX; k++) {
      at[0] = fmax(y[0] + share * step[0], 0.1 * y[0]);
      at[1] = y[1] + share * step[1];
      status = slope_at(f, at, &next);
      there = next.g[0] * step[0] + next.g[1] * step[1];
      if (status == DEA_OK && (last || there <= -0.9 * down)) {
        break;
      }
      share *= 0.5;
    }
    memcpy(y, at, sizeof at);
    if (status == DEA_OK) {
      *out = next;
    }
    if (status != DEA_OK || last || size > most) {
      return status == DEA_OK && last ? DEA_OK : DEA_E_DOMAIN;
    }
  }
  return DEA_E_DOMAIN;
}

/* Uniaxial tension across n at the natural width, of which mu is the share that is folded: S n = 0
 * goes on, so D loses what (S n n, S t n) of a change of mu and of n take up. */
static dea_status set_wrinkled(struct slope *s, double mu, struct dea_tension_point *out)
{
  static const double rounding = 1e-9;
  const struct frame *r = &s->frame;
  double q[2][3], tension = contract(s->at.S, r->tt), Dt[3];
  contract_tangent(s->at.D, r->nn, q[0]);
  contract_tangent(s->at.D, r->tn, q[1]);
  contract_tangent(s->at.D, r->tt, Dt);
  if (!(tension >= -rounding * fabs(contract(Dt, r->tt)))) {
    return DEA_E_DOMAIN;
  }
  tension = fmax(tension, 0);
  const double a = contract(q[0], r->nn), b = contract(q[0], r->tn);
  const double c = contract(q[1], r->tn) + tension / mu, det = a * c - b * b;
  if (!(a > 0 && det > 0)) {
    return DEA_E_DOMAIN;
  }
  *out = s->at;
  out->state = DEA_WRINKLED;
  for (int i = 0; i < 3; i++) {
    out->S[i] = tension * (i < 2 ? 1 : 0.5) * r->tt[i];
    for (int j = 0; j < 3; j++) {
      out->D[i][j] -= (c * q[0][i] * q[0][j] - b * (q[0][i] * q[1][j] + q[1][i] * q[0][j]) +
                       a * q[1][i] * q[1][j]) /
                      det;
    }
  }
  return DEA_OK;
}

/* Where to look for the wrinkles first: the share mu of the width that is folded, and the angle of
 * n. natural: the film without any tension, NULL if there is none. */
static void begin_wrinkled(const double C[3], const double natural[3], double y[2])
{
  const struct circle place = circle_of(C);
  const double x1 = place.mean + place.d, x2 = place.mean - place.d;
  y[0] = fmax(1 / sqrt(x1) - x2, 0.01 * x2);
  y[1] = 0.5 * atan2(-place.sine, -place.cosine);
  if (natural != NULL) {
    const double apart[3] = {natural[0] - C[0], natural[1] - C[1], natural[2] - C[2]};
    const struct circle c = circle_of(apart);
    if (c.mean + c.d > 0) {
      y[0] = c.mean + c.d;
      y[1] = 0.5 * atan2(c.sine, c.cosine);
    }
  }
}

dea_status dea_tension_relaxed(const struct dea_tension *film, const double C[3],
                               struct dea_tension_point *out)
{
  static const double rounding = 1e-11; // below what counts as an unstable mode
  const struct circle axes = circle_of(film->B);
  struct family of = {.film = film, .angle = 0.5 * atan2(axes.sine, axes.cosine)};
  struct slope s;
  const struct circle place = circle_of(C);
  const double start = fmax(place.mean + place.d, 1); // not smaller than the place, as the film is
  double y[2] = {start, start};
  if (dea_tension_taut(film, C, out) == DEA_OK) {
    const struct circle S = circle_of(out->S);
    if (S.mean - S.d >= -rounding * (fabs(out->D[0][0]) + fabs(out->D[1][1]))) {
      return DEA_OK;
    }
  }
  const bool natural = minimise(&of, y, &s) == DEA_OK;
  if (natural) {
    const double apart[3] = {s.at.own[0] - C[0], s.at.own[1] - C[1], s.at.own[2] - C[2]};
    const struct circle c = circle_of(apart);
    if (c.mean - c.d >= 0) {
      *out = (struct dea_tension_point){.W = s.at.W, .state = DEA_SLACK};
      memcpy(out->own, s.at.own, sizeof out->own);
      return DEA_OK;
    }
  }
  begin_wrinkled(C, natural ? s.at.own : NULL, y);
  of.C = C;
  DEA_TRY_STATUS(minimise(&of, y, &s));
  return set_wrinkled(&s, y[0], out);
}
