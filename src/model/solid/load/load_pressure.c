/* Follower pressure: E = (p/3) int r . (x,1 x x,2) dxi, r = x - o; of a part of a flat face in its
 * place E = -p v, v = -int r_z (x,1 x x,2)_z dxi; of an enclosed volume E = U(v), p = -U'(v)
 * (docs/theory/loads.md). */
#include "model/solid/load/loads.h"

#include <math.h>
#include <string.h>

struct dea_pressure {
  const struct dea_surface *surface;
  struct dea_face_shape shape;
  double origin[3], now, goal; // o, p [Pa]
  bool flat;
  const struct dea_enclosed *enclosed; // NULL: p is given
  struct dea_enclosed own;             // what that is
  double lambda;                       // multiplier of a liquid [Pa]
  double v, energy, stiffness;         // where it was prepared: v, U, U''
  double pressure;                     // and p
};

dea_status dea_pressure_create(struct dea_context *ctx, const struct dea_surface *surface,
                               const double origin_m[3], bool flat, struct dea_arena *memory,
                               struct dea_pressure **out)
{
  *out = dea_arena_alloc(memory, 1, sizeof **out);
  DEA_TRY(ctx, dea_arena_status(memory));
  (*out)->surface = surface;
  (*out)->flat = flat;
  memcpy((*out)->origin, origin_m, sizeof(*out)->origin);
  dea_face_shape_create(surface->order, DEA_FACE_GAUSS, &(*out)->shape);
  return DEA_OK;
}

void dea_pressure_set(struct dea_pressure *pressure, double pressure_Pa)
{
  pressure->goal = pressure_Pa;
}

/* r and its slopes at a point of a face. */
struct place {
  double r[3], A[3], B[3];
};

static void place_at(const struct dea_pressure *p, int q, const double *x, struct place *out)
{
  const struct dea_face_shape *s = &p->shape;
  memset(out, 0, sizeof *out);
  for (int n = 0; n < s->nodes; n++) {
    for (int i = 0; i < 3; i++) {
      out->r[i] += s->value[q][n] * (x[3 * n + i] - p->origin[i]);
      out->A[i] += s->slope[q][0][n] * x[3 * n + i];
      out->B[i] += s->slope[q][1][n] * x[3 * n + i];
    }
  }
}

/* K_ni,mj += f eps_ijk c_k. */
static void add_tangent(const struct dea_face_shape *s, int q, double f, const struct place *at,
                        int dofs, double *K)
{
  for (int n = 0; n < s->nodes; n++) {
    double N = s->value[q][n], N1 = s->slope[q][0][n], N2 = s->slope[q][1][n];
    for (int m = 0; m < s->nodes; m++) {
      double M = s->value[q][m], M1 = s->slope[q][0][m], M2 = s->slope[q][1][m];
      for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double c = f * ((N * M1 - N1 * M) * at->B[k] + (N2 * M - N * M2) * at->A[k] +
                        (N1 * M2 - N2 * M1) * at->r[k]);
        K[(3 * n + i) * dofs + 3 * m + j] += c;
        K[(3 * n + j) * dofs + 3 * m + i] -= c;
      }
    }
  }
}

/* One point of a patch of a flat face: E += f r_z J, J = (A x B)_z, and its derivatives. */
static void add_flat(const struct dea_face_shape *s, int q, double f, const struct place *at,
                     enum dea_eval_order level, struct dea_load_piece *out)
{
  double J = at->A[0] * at->B[1] - at->A[1] * at->B[0], slope[DEA_FACE_NODES_MAX][2]; // of J
  int dofs = 3 * s->nodes;
  out->energy_J += f * at->r[2] * J;
  for (int n = 0; n < s->nodes; n++) {
    const double N1 = s->slope[q][0][n], N2 = s->slope[q][1][n];
    slope[n][0] = N1 * at->B[1] - N2 * at->A[1];
    slope[n][1] = N2 * at->A[0] - N1 * at->B[0];
    out->g[3 * n] += f * at->r[2] * slope[n][0];
    out->g[3 * n + 1] += f * at->r[2] * slope[n][1];
    out->g[3 * n + 2] += f * s->value[q][n] * J;
  }
  for (int n = 0; n < s->nodes && level >= DEA_TANGENT; n++) {
    for (int m = 0; m < s->nodes; m++) {
      double mixed = s->slope[q][0][n] * s->slope[q][1][m] - s->slope[q][1][n] * s->slope[q][0][m];
      for (int i = 0; i < 2; i++) {
        double c = f * s->value[q][m] * slope[n][i];
        out->K[(3 * n + i) * dofs + 3 * m + 2] += c;
        out->K[(3 * m + 2) * dofs + 3 * n + i] += c;
      }
      out->K[3 * n * dofs + 3 * m + 1] += f * at->r[2] * mixed;
      out->K[(3 * m + 1) * dofs + 3 * n] += f * at->r[2] * mixed;
    }
  }
}

/* v of a piece; its part of dv, for nodal motions [nodes][3], to *along, or its slopes added. */
static double volume_of(const struct dea_pressure *p, size_t piece, const double *u,
                        const double *motion, double *along, double *slope)
{
  const struct dea_face_shape *s = &p->shape;
  double x[3 * DEA_FACE_NODES_MAX], X[3 * DEA_FACE_NODES_MAX], v = 0;
  struct dea_load_piece out;
  const int *nodes = p->surface->nodes + piece * DEA_FACE_NODES_MAX;
  memset(out.g, 0, sizeof out.g);
  dea_face_gather(p->surface, piece, p->surface->grid->X, X);
  dea_face_gather(p->surface, piece, u, x);
  dea_add(3 * (size_t)s->nodes, 1, X, x);
  out.energy_J = 0;
  for (int q = 0; q < s->points; q++) {
    struct place at;
    place_at(p, q, x, &at);
    add_flat(s, q, -s->weight[q], &at, DEA_FORCE, &out);
  }
  v = out.energy_J;
  for (int i = 0; i < 3 * s->nodes; i++) {
    const size_t at = 3 * (size_t)nodes[i / 3] + (size_t)(i % 3);
    if (motion != NULL) {
      *along += out.g[i] * motion[at];
    }
    if (slope != NULL) {
      slope[at] += out.g[i];
    }
  }
  return v;
}

double dea_pressure_volume_m3(const struct dea_pressure *p, const double *u)
{
  double v = 0;
  for (size_t k = 0; k < p->surface->face_count; k++) {
    v += volume_of(p, k, u, NULL, NULL, NULL);
  }
  return v;
}

/* U, p, and U'' at u. Gas: U = pa v - (p0 + pa) V0 ln(1 + v/V0); a liquid: U = -lambda x + k x^2/2,
 * x = v less what it is to be. */
static void prepare(void *self, const double *u)
{
  struct dea_pressure *p = self;
  const struct dea_enclosed *e = p->enclosed;
  p->v = dea_pressure_volume_m3(p, u);
  if (e->liquid) {
    const double x = p->v - p->now, k = e->stiffness_Pa_per_m3;
    p->energy = (0.5 * k * x - p->lambda) * x;
    p->pressure = p->lambda - k * x;
    p->stiffness = k;
    return;
  }
  const double V = e->volume_m3 + p->v, amount = (p->now + e->ambient_Pa) * e->volume_m3;
  p->energy = e->ambient_Pa * p->v - amount * log1p(p->v / e->volume_m3);
  p->pressure = amount / V - e->ambient_Pa;
  p->stiffness = amount / (V * V);
}

double dea_pressure_at_Pa(struct dea_pressure *pressure, const double *u)
{
  if (pressure->enclosed == NULL) {
    return pressure->now;
  }
  prepare(pressure, u);
  return pressure->pressure;
}

void dea_pressure_volume_slope(const struct dea_pressure *p, const double *u, double *slope)
{
  for (size_t k = 0; k < p->surface->face_count; k++) {
    volume_of(p, k, u, NULL, NULL, slope);
  }
}

void dea_pressure_hold(struct dea_pressure *pressure, const struct dea_pressure *other)
{
  pressure->lambda = other->lambda;
  pressure->own.stiffness_Pa_per_m3 = other->own.stiffness_Pa_per_m3;
}

void dea_pressure_stiffen(struct dea_pressure *p, const double *u, double times)
{
  if (p->enclosed != NULL && p->own.liquid) {
    prepare(p, u);
    p->own.stiffness_Pa_per_m3 *= times;
    p->lambda = p->pressure + p->own.stiffness_Pa_per_m3 * (p->v - p->now);
  }
}

static double whole(const void *self, const double *u, double *slope)
{
  const struct dea_pressure *p = self;
  if (slope != NULL) {
    dea_pressure_volume_slope(p, u, slope);
  }
  return p->stiffness;
}

static double along(const void *self, const double *u, const double *motion)
{
  const struct dea_pressure *p = self;
  double sum = 0;
  for (size_t k = 0; k < p->surface->face_count; k++) {
    volume_of(p, k, u, motion, &sum, NULL);
  }
  return sum;
}

/* The multiplier takes over the penalty. What is left of the volume over what is allowed. */
static double update(void *self, const double *u)
{
  static const double allowed = 1e-9;
  struct dea_pressure *p = self;
  prepare(p, u);
  p->lambda = p->pressure;
  return fabs(p->v - p->now) / (allowed * fmax(fabs(p->now), p->own.volume_m3));
}

static void predict(void *self, const double *u, const double *step, double fraction)
{
  struct dea_pressure *p = self;
  const double x = dea_pressure_volume_m3(p, u) - p->now;
  p->lambda -= fraction * p->own.stiffness_Pa_per_m3 * (x + along(p, u, step));
}

static dea_status evaluate(const void *self, size_t piece, const double *u,
                           enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct dea_pressure *p = self;
  const struct dea_face_shape *s = &p->shape;
  const double pressure = p->enclosed != NULL ? p->pressure : p->now;
  int dofs = 3 * s->nodes;
  double x[3 * DEA_FACE_NODES_MAX], X[3 * DEA_FACE_NODES_MAX];
  out->node_count = pressure != 0 || p->enclosed != NULL ? s->nodes : 0;
  if (out->node_count == 0) {
    return DEA_OK;
  }
  if (p->enclosed != NULL && !p->own.liquid && !(p->own.volume_m3 + p->v > 0)) {
    return DEA_E_DOMAIN;
  }
  memcpy(out->nodes, p->surface->nodes + piece * DEA_FACE_NODES_MAX,
         (size_t)s->nodes * sizeof *out->nodes);
  dea_face_gather(p->surface, piece, p->surface->grid->X, X);
  dea_face_gather(p->surface, piece, u, x);
  dea_add((size_t)dofs, 1, X, x);
  out->energy_J = 0;
  memset(out->g, 0, (size_t)dofs * sizeof *out->g);
  memset(out->K, 0, level >= DEA_TANGENT ? (size_t)(dofs * dofs) * sizeof *out->K : 0);
  for (int q = 0; q < s->points; q++) {
    struct place at;
    double AB[3], Br[3], rA[3], f = pressure / 3 * s->weight[q];
    place_at(p, q, x, &at);
    if (p->flat) {
      add_flat(s, q, 3 * f, &at, level, out);
      continue;
    }
    dea_cross(at.A, at.B, AB);
    dea_cross(at.B, at.r, Br);
    dea_cross(at.r, at.A, rA);
    for (int i = 0; i < 3; i++) {
      out->energy_J += f * at.r[i] * AB[i];
      for (int n = 0; n < s->nodes; n++) {
        out->g[3 * n + i] +=
            f * (s->value[q][n] * AB[i] + s->slope[q][0][n] * Br[i] + s->slope[q][1][n] * rA[i]);
      }
    }
    if (level >= DEA_TANGENT) {
      add_tangent(s, q, f, &at, dofs, out->K);
    }
  }
  if (p->enclosed != NULL) { // of all pieces at once
    out->energy_J = piece == 0 ? p->energy : 0;
  }
  return DEA_OK;
}

void dea_pressure_enclose(struct dea_pressure *pressure, const struct dea_enclosed *enclosed)
{
  pressure->own = *enclosed;
  pressure->enclosed = &pressure->own;
}

struct dea_solid_load dea_pressure_load(struct dea_pressure *pressure)
{
  struct dea_solid_load load = {.self = pressure,
                                .piece_count = pressure->surface->face_count,
                                .evaluate = evaluate,
                                .parameter_count = 1,
                                .now = &pressure->now,
                                .goal = &pressure->goal};
  if (pressure->enclosed != NULL) {
    load.prepare = prepare;
    load.whole = whole;
    load.along = along;
  }
  if (pressure->enclosed != NULL && pressure->own.liquid) {
    load.multiplier_count = 1;
    load.multiplier = &pressure->lambda;
    load.update = update;
    load.predict = predict;
  }
  return load;
}
