/* Contact without friction, with a rigid tip or with another surface: E = int (<p - k g>^2 -
 * p^2)/(2k) dA at the nodes of the faces, and p <- <p - k g> in the outer loop. */
#include "model/solid/load/loads.h"

#include "base/quadrature.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const double tolerance_default = 1e-3;
static const double gap_none = 1e-9; // of the length that gaps are compared with

struct dea_contact {
  const struct dea_surface *surface, *other; // other: NULL: the tip
  struct dea_face_shape shape;
  struct dea_indenter tip;
  double stiffness, tolerance; // k, of the pressure
  bool held;                   // what has a pressure stays in touch, of any sign, without k
  double now[3], goal[3];      // place of the tip
  double *weight, *pressure;   // [face_count][points] areas; p
  size_t *opposite;            // [face_count] face of the other surface
  double (*start)[2];          // [face_count][points] place of it that is nearest at rest
};

// The gap ----------------------------------------------------------------------------------------

static size_t points_of(const struct dea_contact *c)
{
  return (size_t)c->shape.points;
}

static size_t count_of(const struct dea_contact *c)
{
  return c->surface->face_count * points_of(c);
}

/* What the gap of a point depends on: its node, and those of the face that is opposite. */
static int nodes_of(const struct dea_contact *c, size_t at, int nodes[DEA_PIECE_NODES_MAX])
{
  const size_t face = at / points_of(c);
  nodes[0] = c->surface->nodes[face * DEA_FACE_NODES_MAX + at % points_of(c)];
  if (c->other == NULL) {
    return 1;
  }
  memcpy(nodes + 1, c->other->nodes + c->opposite[face] * DEA_FACE_NODES_MAX,
         (size_t)c->other->face_nodes * sizeof *nodes);
  return 1 + c->other->face_nodes;
}

/* Values and slopes of order 1 and 2 along one axis of a face, [3][order + 1]. */
static void line_at(int order, double x, double out[3][DEA_HEX_ORDER_MAX + 1])
{
  const size_t count = (size_t)order + 1;
  double nodes[DEA_HEX_ORDER_MAX + 1], value[DEA_HEX_ORDER_MAX + 1], slope[DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)order, nodes);
  dea_lagrange(count, nodes, x, out[0], out[1]);
  memset(out[2], 0, count * sizeof *out[2]);
  for (size_t i = 0; i < count; i++) { // a slope is the sum of what it is at the nodes
    dea_lagrange(count, nodes, nodes[i], value, slope);
    for (size_t j = 0; j < count; j++) {
      out[2][j] += slope[j] * out[1][i];
    }
  }
}

/* Where a face is nearest to a place: basis N [0], its slopes along both axes [1, 2] and what these
 * and the place itself are there: x, a_1, a_2; curved: x,11, x,12, x,22. */
struct nearest {
  double N[3][DEA_FACE_NODES_MAX], x[3][3], curved[3][3];
  double at[2];
};

static void sum_up(const double *N, const double (*x)[3], int count, double out[3])
{
  memset(out, 0, 3 * sizeof *out);
  for (int a = 0; a < count; a++) {
    for (int i = 0; i < 3; i++) {
      out[i] += N[a] * x[a][i];
    }
  }
}

static void face_at(const int order[2], const double (*x)[3], struct nearest *out)
{
  double line[2][3][DEA_HEX_ORDER_MAX + 1], second[3][DEA_FACE_NODES_MAX];
  const int count = (order[0] + 1) * (order[1] + 1);
  line_at(order[0], out->at[0], line[0]);
  line_at(order[1], out->at[1], line[1]);
  for (int a = 0; a < count; a++) {
    const int i = a % (order[0] + 1), j = a / (order[0] + 1);
    out->N[0][a] = line[0][0][i] * line[1][0][j];
    out->N[1][a] = line[0][1][i] * line[1][0][j];
    out->N[2][a] = line[0][0][i] * line[1][1][j];
    second[0][a] = line[0][2][i] * line[1][0][j];
    second[1][a] = line[0][1][i] * line[1][1][j];
    second[2][a] = line[0][0][i] * line[1][2][j];
  }
  for (int k = 0; k < 3; k++) {
    sum_up(out->N[k], x, count, out->x[k]);
    sum_up(second[k], x, count, out->curved[k]);
  }
}

/* inverse of the symmetric {m[0], m[1]; m[1], m[2]}. */
static void invert(const double m[3], double out[3])
{
  const double det = m[0] * m[2] - m[1] * m[1];
  out[0] = m[2] / det;
  out[1] = -m[1] / det;
  out[2] = m[0] / det;
}

/* The place of a face (x [nodes][3]) that is nearest to p, by Newton's method from near->at on. Far
 * from the face, where it may not settle, there is no contact. */
static void find_nearest(const int order[2], const double (*x)[3], const double p[3],
                         struct nearest *near)
{
  enum { TRIALS = 20 };
  static const double close = 1e-13;
  double step = 1;
  for (int trial = 0; trial < TRIALS && step > close; trial++) {
    double d[3], A[3], H[3];
    face_at(order, x, near);
    for (int i = 0; i < 3; i++) {
      d[i] = p[i] - near->x[0][i];
    }
    const double *a = near->x[1], *b = near->x[2];
    const double r[2] = {dea_dot(d, a), dea_dot(d, b)};
    A[0] = dea_dot(a, a) - dea_dot(d, near->curved[0]);
    A[1] = dea_dot(a, b) - dea_dot(d, near->curved[1]);
    A[2] = dea_dot(b, b) - dea_dot(d, near->curved[2]);
    invert(A, H);
    const double s[2] = {H[0] * r[0] + H[1] * r[1], H[1] * r[0] + H[2] * r[1]};
    step = fmax(fabs(s[0]), fabs(s[1]));
    const double most = fmin(1, 1 / step); // no more than half of the face at once
    near->at[0] += most * s[0];
    near->at[1] += most * s[1];
  }
  face_at(order, x, near);
}

/* Second slopes of the gap by all displacements (docs/theory/loads.md):
 * -[T' H M + M' H T + g M' H M + T' S T]. */
static void bend(const struct nearest *near, const double n[3], double gap, int count, double *out)
{
  enum { DOFS = DEA_PIECE_DOFS_MAX };
  double T[2][DOFS], M[2][DOFS], A[3], B[3], C[3], G[3], H[3], S[2][2];
  const int dofs = 3 * count;
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < dofs; i++) {
      const int a = i / 3 - 1; // of the face
      T[k][i] = (a < 0 ? 1 : -near->N[0][a]) * near->x[1 + k][i % 3];
      M[k][i] = a < 0 ? 0 : near->N[1 + k][a] * n[i % 3];
    }
  }
  for (int k = 0; k < 3; k++) {
    A[k] = dea_dot(near->x[k < 2 ? 1 : 2], near->x[k < 1 ? 1 : 2]);
    B[k] = dea_dot(n, near->curved[k]);
    C[k] = A[k] - gap * B[k];
  }
  invert(A, G);
  invert(C, H);
  const double BH[2][2] = {{B[0] * H[0] + B[1] * H[1], B[0] * H[1] + B[1] * H[2]},
                           {B[1] * H[0] + B[2] * H[1], B[1] * H[1] + B[2] * H[2]}};
  for (int k = 0; k < 2; k++) {
    S[0][k] = G[0] * BH[0][k] + G[1] * BH[1][k];
    S[1][k] = G[1] * BH[0][k] + G[2] * BH[1][k];
  }
  for (int i = 0; i < dofs; i++) {
    for (int j = 0; j < dofs; j++) {
      double sum = 0;
      for (int k = 0; k < 2; k++) {
        for (int l = 0; l < 2; l++) {
          const double h = H[k + l];
          sum += h * (T[k][i] * M[l][j] + M[k][i] * T[l][j] + gap * M[k][i] * M[l][j]) +
                 S[k][l] * T[k][i] * T[l][j];
        }
      }
      out[i * dofs + j] = -sum;
    }
  }
}

/* Places of a point's nodes at displacements u. */
static void place_nodes(const struct dea_contact *c, const int *nodes, int count, const double *u,
                        double (*x)[3])
{
  for (int a = 0; a < count; a++) {
    for (int i = 0; i < 3; i++) {
      const size_t k = 3 * (size_t)nodes[a] + (size_t)i;
      x[a][i] = c->surface->grid->X[k] + u[k];
    }
  }
}

/* Of a point to the face that is opposite, whose outward normal points to it. */
static double facing_gap(const struct dea_contact *c, int count, const double (*x)[3],
                         struct nearest *near, double *slope, double *hessian)
{
  double n[3], from[3];
  find_nearest(c->other->order, x + 1, x[0], near);
  const double *a = near->x[1], *b = near->x[2];
  dea_cross(a, b, n);
  const double length = sqrt(dea_dot(n, n));
  for (int i = 0; i < 3; i++) {
    from[i] = x[0][i] - near->x[0][i];
    n[i] /= length;
  }
  for (int i = 0; i < 3 * count; i++) {
    slope[i] = (i < 3 ? 1 : -near->N[0][i / 3 - 1]) * n[i % 3];
  }
  if (hessian != NULL) {
    bend(near, n, dea_dot(n, from), count, hessian);
  }
  return dea_dot(n, from);
}

/* What the gap at a point is, and its slopes by the displacements of its nodes. */
struct gap {
  int count, nodes[DEA_PIECE_NODES_MAX];
  double value, slope[DEA_PIECE_DOFS_MAX]; // [3 count]
};

/* hessian: [3 count][3 count], NULL where it is not wanted. */
static struct gap gap_at(const struct dea_contact *c, size_t at, const double *u, double *hessian)
{
  struct gap gap;
  double x[DEA_PIECE_NODES_MAX][3];
  gap.count = nodes_of(c, at, gap.nodes);
  place_nodes(c, gap.nodes, gap.count, u, x);
  if (c->other == NULL) {
    gap.value = dea_indenter_distance(&c->tip, c->now, x[0], gap.slope, hessian);
  } else {
    struct nearest near = {.at = {c->start[at][0], c->start[at][1]}};
    gap.value = facing_gap(c, gap.count, (const double(*)[3])x, &near, gap.slope, hessian);
  }
  return gap;
}

// Making and moving ------------------------------------------------------------------------------

/* Which columns of the plane mesh a face is over: the same sum and the same least one. */
static void columns_of(const struct dea_surface *surface, size_t face, size_t out[2])
{
  out[0] = 0;
  out[1] = SIZE_MAX;
  for (int n = 0; n < surface->face_nodes; n++) {
    const size_t node = (size_t)surface->nodes[face * DEA_FACE_NODES_MAX + (size_t)n],
                 column = (size_t)surface->grid->column[node];
    out[0] += column;
    out[1] = column < out[1] ? column : out[1];
  }
}

/* The place of a point on the face that is opposite: at the node of the same column. */
static void find_start(struct dea_contact *c, size_t at)
{
  const int *order = c->other->order, *column = c->surface->grid->column;
  int nodes[DEA_PIECE_NODES_MAX];
  const int count = nodes_of(c, at, nodes);
  double line[2][DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)order[0], line[0]);
  dea_lobatto_nodes((size_t)order[1], line[1]);
  for (int a = 0; a + 1 < count; a++) {
    if (column[nodes[a + 1]] == column[nodes[0]]) {
      c->start[at][0] = line[0][a % (order[0] + 1)];
      c->start[at][1] = line[1][a / (order[0] + 1)];
    }
  }
}

/* The face of the other surface in the same column, and the places of it that points begin at. */
static dea_status find_opposite(struct dea_context *ctx, struct dea_contact *c)
{
  for (size_t face = 0; face < c->surface->face_count; face++) {
    size_t own[2], other[2] = {0}, k = 0;
    columns_of(c->surface, face, own);
    for (; k < c->other->face_count; k++) {
      columns_of(c->other, k, other);
      if (own[0] == other[0] && own[1] == other[1]) {
        break;
      }
    }
    if (k == c->other->face_count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "a face in contact has no other one opposite");
    }
    c->opposite[face] = k;
    for (size_t q = 0; q < points_of(c); q++) {
      find_start(c, face * points_of(c) + q);
    }
  }
  return DEA_OK;
}

dea_status dea_contact_create(struct dea_context *ctx, const struct dea_surface *surface,
                              const struct dea_contact_options *options, struct dea_arena *memory,
                              struct dea_contact **out)
{
  struct dea_indenter tip = options->tip;
  DEA_TRY(ctx, options->other == NULL ? dea_indenter_check(ctx, &tip) : DEA_OK);
  if (!(options->stiffness_Pa_per_m > 0) || !(options->tolerance >= 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "contact needs a stiffness above 0 and a tolerance of 0 or more");
  }
  struct dea_contact *c = *out = dea_arena_alloc(memory, 1, sizeof *c);
  DEA_TRY(ctx, dea_arena_status(memory));
  c->surface = surface;
  c->other = options->other;
  c->tip = tip;
  c->stiffness = options->stiffness_Pa_per_m;
  c->tolerance = options->tolerance > 0 ? options->tolerance : tolerance_default;
  memcpy(c->now, options->place_m, sizeof c->now);
  memcpy(c->goal, options->place_m, sizeof c->goal);
  dea_face_shape_create(surface->order, DEA_FACE_AT_NODES, &c->shape);
  c->weight = dea_surface_weights(memory, surface, &c->shape);
  c->pressure = dea_arena_alloc(memory, count_of(c), sizeof *c->pressure);
  c->opposite = dea_arena_alloc(memory, surface->face_count, sizeof *c->opposite);
  c->start = dea_arena_alloc(memory, count_of(c), sizeof *c->start);
  DEA_TRY(ctx, dea_arena_status(memory));
  return c->other != NULL ? DEA_CHAIN(ctx, find_opposite(ctx, c)) : DEA_OK;
}

void dea_contact_move(struct dea_contact *contact, const double place_m[3])
{
  memcpy(contact->goal, place_m, sizeof contact->goal);
}

void dea_contact_hold(struct dea_contact *contact, const struct dea_contact *other)
{
  memcpy(contact->pressure, other->pressure, count_of(contact) * sizeof *contact->pressure);
  contact->held = true;
}

// As a load --------------------------------------------------------------------------------------

static dea_status evaluate(const void *self, size_t at, const double *u, enum dea_eval_order level,
                           struct dea_load_piece *out)
{
  const struct dea_contact *c = self;
  const bool bends = level >= DEA_TANGENT;
  const struct gap gap = gap_at(c, at, u, bends ? out->K : NULL);
  const double k = c->stiffness, w = c->weight[at], p = c->pressure[at];
  const int dofs = 3 * gap.count;
  // NAN becomes 0 here: u is checked by the elements
  const double push = c->held ? p : fmax(p - k * gap.value, 0);
  const double turn = level == DEA_TANGENT_PREDICTED && push != 0 ? p : push;
  // (push^2 - p^2) / (2 k), without the difference where k is small
  out->energy_J = -w * (push != 0 ? gap.value * (p + push) / 2 : p * p / (2 * k));
  // of two surfaces K has room for each, in touch or not
  out->node_count = push != 0 || p != 0 || c->other != NULL ? gap.count : 0;
  memcpy(out->nodes, gap.nodes, (size_t)gap.count * sizeof *out->nodes);
  for (int i = 0; i < dofs; i++) {
    out->g[i] = push != 0 ? -w * push * gap.slope[i] : 0;
    for (int j = 0; j < dofs && bends; j++) {
      double *K = &out->K[i * dofs + j];
      *K = push != 0 ? w * ((c->held ? 0 : k) * gap.slope[i] * gap.slope[j] - turn * *K) : 0;
    }
  }
  return DEA_OK;
}

/* The pressures take over the penalty. How far they went, in the mean over the contact, over what
 * is allowed; where a contact ends there is none to compare with, and a round more is asked for. */
static double update(void *self, const double *u)
{
  struct dea_contact *c = self;
  double changed = 0, whole = 0, largest = 0;
  for (size_t at = 0; at < count_of(c); at++) {
    const double p = c->pressure[at], gap = gap_at(c, at, u, NULL).value;
    c->pressure[at] = fmax(p - c->stiffness * gap, 0);
    changed += c->weight[at] * fabs(c->pressure[at] - p);
    largest = fmax(largest, fabs(c->pressure[at] - p));
    whole += c->weight[at] * c->pressure[at];
  }
  double gap_error = largest / (c->stiffness * gap_none * c->tip.radius_m);
  return whole > 0 ? fmin(gap_error, changed / (c->tolerance * whole)) : gap_error;
}

static double change_of(const struct gap *gap, const double *step)
{
  double sum = gap->value;
  for (int i = 0; i < 3 * gap->count; i++) {
    sum += gap->slope[i] * step[3 * gap->nodes[i / 3] + i % 3];
  }
  return sum;
}

/* A step takes the gap away where the surface touches: p - k (g + n . step), docs/theory/loads.md.
 */
static void predict(void *self, const double *u, const double *step, double fraction)
{
  struct dea_contact *c = self;
  for (size_t at = 0; at < count_of(c); at++) {
    const double p = c->pressure[at], k = c->stiffness;
    const struct gap gap = gap_at(c, at, u, NULL);
    c->pressure[at] = p > k * gap.value ? fmax(p - fraction * k * change_of(&gap, step), 0) : 0;
  }
}

/* C = -w g: the pressure keeps the gap closed. */
static void constraint(const void *self, size_t at, const double *u,
                       struct dea_load_constraint *out)
{
  const struct dea_contact *c = self;
  const struct gap gap = gap_at(c, at, u, NULL);
  const double w = c->weight[at];
  *out = (struct dea_load_constraint){.held = c->pressure[at] > c->stiffness * gap.value,
                                      .node_count = gap.count,
                                      .value = -w * gap.value,
                                      .weight = w,
                                      .stiffness = c->stiffness};
  memcpy(out->nodes, gap.nodes, (size_t)gap.count * sizeof *out->nodes);
  for (int i = 0; i < 3 * gap.count; i++) {
    out->slope[i] = -w * gap.slope[i];
  }
}

static int couples(const void *self, size_t at, int nodes[DEA_PIECE_NODES_MAX])
{
  return nodes_of(self, at, nodes);
}

struct dea_solid_load dea_contact_load(struct dea_contact *contact)
{
  return (struct dea_solid_load){.self = contact,
                                 .piece_count = count_of(contact),
                                 .evaluate = evaluate,
                                 .couples = contact->other != NULL ? couples : NULL,
                                 .parameter_count = contact->other == NULL ? 3 : 0,
                                 .now = contact->now,
                                 .goal = contact->goal,
                                 .multiplier_count = count_of(contact),
                                 .multiplier = contact->pressure,
                                 .update = update,
                                 .predict = predict,
                                 .constraint = constraint};
}

// What it does -----------------------------------------------------------------------------------

void dea_contact_force_slope(const struct dea_contact *contact, const double *u, int component,
                             double factor, double *by_u, double *by_pressure)
{
  for (size_t at = 0; at < count_of(contact); at++) {
    const double w = factor * contact->weight[at], p = contact->pressure[at];
    double H[DEA_PIECE_DOFS_MAX * DEA_PIECE_DOFS_MAX];
    if (p > 0) {
      const struct gap gap = gap_at(contact, at, u, H);
      by_pressure[at] -= w * gap.slope[component];
      for (int j = 0; j < 3 * gap.count; j++) {
        by_u[3 * gap.nodes[j / 3] + j % 3] -= w * p * H[3 * gap.count * component + j];
      }
    }
  }
}

void dea_contact_force(const struct dea_contact *contact, const double *u, double force_N[3])
{
  force_N[0] = force_N[1] = force_N[2] = 0;
  for (size_t at = 0; at < count_of(contact); at++) {
    const double push = contact->weight[at] * contact->pressure[at];
    if (push > 0) {
      const struct gap gap = gap_at(contact, at, u, NULL);
      for (int i = 0; i < 3; i++) {
        force_N[i] -= push * gap.slope[i];
      }
    }
  }
}

double dea_contact_area(const struct dea_contact *contact)
{
  double sum = 0;
  for (size_t at = 0; at < count_of(contact); at++) {
    sum += contact->pressure[at] > 0 ? contact->weight[at] : 0;
  }
  return sum;
}

double dea_contact_slide(const struct dea_contact *contact, const double *u)
{
  double most = 0;
  for (size_t at = 0; at < count_of(contact) && contact->other != NULL; at++) {
    if (contact->pressure[at] > 0) {
      const double *start = contact->start[at];
      int nodes[DEA_PIECE_NODES_MAX];
      double x[DEA_PIECE_NODES_MAX][3];
      struct nearest near = {.at = {start[0], start[1]}};
      place_nodes(contact, nodes, nodes_of(contact, at, nodes), u, x);
      find_nearest(contact->other->order, (const double(*)[3])(x + 1), x[0], &near);
      most = fmax(most, fmax(fabs(near.at[0] - start[0]), fabs(near.at[1] - start[1])) / 2);
    }
  }
  return most;
}
