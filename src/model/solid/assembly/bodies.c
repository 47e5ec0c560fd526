/* Rigid bodies: u_n = t + (R(w) - 1) r_n with r_n = X_n - X_0, derivatives, and what of the nodes
 * goes to t and w (docs/theory/bodies.md).
 *
 * Symbol    meaning                                                              unit
 * t, w      shift, rotation vector                                               m, 1
 * L         length of the body, L w is an unknown                                m
 * s         w . w                                                                1
 * a, b      R r = r + a w x r + b (w (w . r) - s r); with ' by s                  1
 * g, r      force on a node, its place from X_0                                  N, m */
#include "model/solid/assembly/bodies.h"

#include "model/solid/mesh/grid.h"

#include <math.h>
#include <string.h>

/* ---- rotations ---- */

struct rotation {
  double w[3], s;
  double a[3], b[3]; // with first and second derivatives by s
};

/* a = sum (-s)^k/(2k + 1)!, b = sum (-s)^k/(2k + 2)!: entire functions, so that w = 0 is no special
 * case; up to a full turn (s = 4 pi^2) the sums lose three digits at most. */
static void rotation_of(const double w[3], struct rotation *out)
{
  enum { TERMS = 32 };
  double s = dea_dot(w, w), inverse = 1; // (-1)^k/(2k)!
  double power[3] = {1, 0, 0};           // s^k and its derivatives
  *out = (struct rotation){.w = {w[0], w[1], w[2]}, .s = s};
  for (int k = 0; k < TERMS; k++) {
    double of_a = inverse / (2 * k + 1), of_b = of_a / (2 * k + 2);
    for (int d = 0; d < 3; d++) {
      out->a[d] += of_a * power[d];
      out->b[d] += of_b * power[d];
    }
    power[2] = s * power[2] + 2 * power[1];
    power[1] = s * power[1] + power[0];
    power[0] *= s;
    inverse = -of_b;
  }
}

/* M = [v x]. */
static void cross_matrix(const double v[3], double M[9])
{
  const double rows[9] = {0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0};
  memcpy(M, rows, sizeof rows);
}

/* R - 1. */
static void turn_matrix(const struct rotation *q, double M[9])
{
  cross_matrix(q->w, M);
  for (int i = 0; i < 9; i++) {
    double square = q->w[i / 3] * q->w[i % 3] - (i % 4 == 0 ? q->s : 0);
    M[i] = q->a[0] * M[i] + q->b[0] * square;
  }
}

/* dR/dw_j. */
static void slope_matrix(const struct rotation *q, int j, double M[9])
{
  const double e[3] = {j == 0, j == 1, j == 2}, *w = q->w;
  double along[9];
  cross_matrix(w, along);
  cross_matrix(e, M);
  for (int i = 0; i < 9; i++) {
    double one = i % 4 == 0;
    double square = w[i / 3] * w[i % 3] - one * q->s;
    double by_w = e[i / 3] * w[i % 3] + w[i / 3] * e[i % 3] - 2 * one * w[j];
    M[i] = q->a[0] * M[i] + 2 * q->a[1] * w[j] * along[i] + 2 * q->b[1] * w[j] * square +
           q->b[0] * by_w;
  }
}

/* H_jk = sum g . d^2 R/dw_j dw_k r from P = sum g r^T. */
static void curvature(const struct rotation *q, const double P[9], double H[9])
{
  const double *w = q->w, *a = q->a, *b = q->b;
  const double moment[3] = {P[7] - P[5], P[2] - P[6], P[3] - P[1]}; // r x g
  double trace = P[0] + P[4] + P[8], h = -q->s * trace, by[3]; // g . (w (w . r) - s r), its slopes
  double turned = dea_dot(w, moment);                          // g . (w x r)
  for (int k = 0; k < 3; k++) {
    by[k] = -2 * w[k] * trace;
    for (int i = 0; i < 3; i++) {
      by[k] += (P[3 * k + i] + P[3 * i + k]) * w[i];
      h += w[k] * P[3 * k + i] * w[i];
    }
  }
  for (int j = 0; j < 3; j++) {
    for (int k = 0; k < 3; k++) {
      double one = j == k;
      H[3 * j + k] = (4 * a[2] * w[j] * w[k] + 2 * a[1] * one) * turned +
                     2 * a[1] * (w[j] * moment[k] + w[k] * moment[j]) +
                     (4 * b[2] * w[j] * w[k] + 2 * b[1] * one) * h +
                     2 * b[1] * (w[j] * by[k] + w[k] * by[j]) +
                     b[0] * (P[3 * j + k] + P[3 * k + j] - 2 * one * trace);
    }
  }
}

/* ---- bodies and their nodes ---- */

bool dea_solid_turns_body(const struct dea_solid *s, size_t node)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t i = 0; i < p->body_count; i++) {
    if (node == p->bodies[i].node + 1) {
      return true;
    }
  }
  return false;
}

bool dea_solid_is_of_body(const struct dea_solid *s, size_t node)
{
  return dea_solid_turns_body(s, node) || dea_solid_turns_body(s, node + 1);
}

/* The body that a node follows, SIZE_MAX: none. */
static size_t body_of(const struct dea_solid *s, size_t node)
{
  return s->problem.body_count > 0 && s->problem.body_of[node] > 0
             ? (size_t)s->problem.body_of[node] - 1
             : SIZE_MAX;
}

/* X_n - X_0. */
static void arm_of(const struct dea_solid *s, size_t body, size_t node, double r[3])
{
  const double *X = s->problem.grid->X, *at = X + 3 * node;
  const double *from = X + 3 * s->problem.bodies[body].node;
  for (int i = 0; i < 3; i++) {
    r[i] = at[i] - from[i];
  }
}

/* The rotation of a body at u. */
static void rotation_at(const struct dea_solid *s, size_t body, const double *u,
                        struct rotation *out)
{
  const struct dea_solid_body *b = &s->problem.bodies[body];
  const double *turn = u + 3 * (b->node + 1);
  const double w[3] = {turn[0] / b->length_m, turn[1] / b->length_m, turn[2] / b->length_m};
  rotation_of(w, out);
}

void dea_solid_bodies_place(const struct dea_solid *s, double *u)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < p->body_count; k++) {
    struct rotation q;
    double M[9], r[3];
    const double *t = u + 3 * p->bodies[k].node;
    rotation_at(s, k, u, &q);
    turn_matrix(&q, M);
    for (size_t n = 0; n < p->grid->node_count; n++) {
      if (body_of(s, n) == k) {
        arm_of(s, k, n, r);
        for (size_t i = 0; i < 3; i++) {
          u[3 * n + i] = t[i] + M[3 * i] * r[0] + M[3 * i + 1] * r[1] + M[3 * i + 2] * r[2];
        }
      }
    }
  }
}

void dea_solid_bodies_prepare(const struct dea_solid *s)
{
  for (size_t k = 0; k < s->problem.body_count; k++) {
    struct rotation q;
    rotation_at(s, k, s->state.u, &q);
    for (int j = 0; j < 3; j++) {
      double *M = s->work.body_slope[k] + 9 * j;
      slope_matrix(&q, j, M);
      for (int i = 0; i < 9; i++) {
        M[i] /= s->problem.bodies[k].length_m;
      }
    }
  }
}

/* Slopes of a follower's displacement by L w_j, B[3 i + j], from dR/d(L w_j). */
static void slopes_of(const struct dea_solid *s, size_t body, size_t node, double B[9])
{
  double r[3];
  arm_of(s, body, node, r);
  for (int i = 0; i < 3; i++) {
    for (int j = 0; j < 3; j++) {
      B[3 * i + j] = dea_dot(s->work.body_slope[body] + 9 * j + 3 * i, r);
    }
  }
}

void dea_solid_bodies_transfer(const struct dea_solid *s, double *v)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t n = 0; n < p->grid->node_count && p->body_count > 0; n++) {
    size_t k = body_of(s, n);
    double B[9];
    if (k != SIZE_MAX) {
      const double *q = v + 3 * p->bodies[k].node;
      slopes_of(s, k, n, B);
      for (size_t i = 0; i < 3; i++) {
        v[3 * n + i] = q[i] + B[3 * i] * q[3] + B[3 * i + 1] * q[4] + B[3 * i + 2] * q[5];
      }
    }
  }
}

void dea_solid_bodies_collect(const struct dea_solid *s, double *g)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t n = 0; n < p->grid->node_count && p->body_count > 0; n++) {
    size_t k = body_of(s, n);
    double B[9];
    if (k != SIZE_MAX) {
      double *q = g + 3 * p->bodies[k].node;
      slopes_of(s, k, n, B);
      for (size_t i = 0; i < 3; i++) {
        for (size_t j = 0; j < 3; j++) {
          q[3 + j] += B[3 * i + j] * g[3 * n + i];
        }
        q[i] += g[3 * n + i];
      }
      memset(g + 3 * n, 0, 3 * sizeof *g);
    }
  }
}

int dea_solid_bodies_nodes(const struct dea_solid *s, int count, const int *nodes, int *joint)
{
  int all = count;
  memcpy(joint, nodes, (size_t)count * sizeof *joint);
  for (int n = 0; n < count && s->problem.body_count > 0; n++) {
    size_t k = body_of(s, (size_t)nodes[n]);
    int first = k != SIZE_MAX ? (int)s->problem.bodies[k].node : -1;
    bool there = first < 0;
    for (int i = count; i < all && !there; i += 2) {
      there = joint[i] == first;
    }
    if (!there && all + 2 <= DEA_JOINT_NODES_MAX) { // more: dea_solid_bodies_create says so
      joint[all++] = first;
      joint[all++] = first + 1;
    }
  }
  return all;
}

/* ---- K ---- */

/* Adds line n of followers, `step` numbers apart, to lines t and L w of their body. */
static void add_line(const double B[9], const double *from, double *to, int step)
{
  for (int i = 0; i < 3; i++) {
    to[i * step] += from[i * step];
    for (int j = 0; j < 3; j++) {
      to[(3 + j) * step] += B[3 * i + j] * from[i * step];
    }
  }
}

/* A^T K A by columns, then by rows. */
void dea_solid_bodies_join(const struct dea_solid *s, int count, int all, const int *joint,
                           const double *K, double *out)
{
  const int old = 3 * count, dofs = 3 * all;
  for (int i = old - 1; i >= 0; i--) { // from the end: nothing is written before it is read
    memmove(out + i * dofs, K + i * old, (size_t)old * sizeof *K);
    memset(out + i * dofs + old, 0, (size_t)(dofs - old) * sizeof *K);
  }
  memset(out + old * dofs, 0, (size_t)((dofs - old) * dofs) * sizeof *out);
  for (int pass = 0; pass < 2; pass++) {
    for (int n = 0; n < count; n++) {
      size_t k = body_of(s, (size_t)joint[n]);
      int to = count;
      double B[9];
      if (k == SIZE_MAX) {
        continue;
      }
      while (joint[to] != (int)s->problem.bodies[k].node) {
        to += 2;
      }
      slopes_of(s, k, (size_t)joint[n], B);
      for (int i = 0; i < (pass == 0 ? old : dofs); i++) {
        int line = pass == 0 ? i * dofs : i, apart = pass == 0 ? 1 : dofs;
        add_line(B, out + line + 3 * n * apart, out + line + 3 * to * apart, apart);
      }
    }
  }
}

/* Adds a symmetric block [6][6] of a body to A, without held components; they get `spring`. */
static dea_status add_block(struct dea_context *ctx, struct dea_solid *s, Mat A, size_t body,
                            double block[36], double spring)
{
  const size_t node = s->problem.bodies[body].node;
  const PetscInt rows[2] = {(PetscInt)node, (PetscInt)node + 1};
  for (size_t i = 0; i < 6; i++) {
    for (size_t j = 0; j < 6 && s->problem.held[3 * node + i]; j++) {
      block[6 * i + j] = block[6 * j + i] = i == j ? spring : 0;
    }
  }
  if (dea_solid_rank() != 0) { // all ranks have the same
    return DEA_OK;
  }
  DEA_PETSC(ctx, MatSetValuesBlocked(A, 2, rows, 2, rows, block, ADD_VALUES));
  return DEA_OK;
}

/* Stiffness of what is held [N/m]: any above 0 will do. */
static double pin_stiffness(const struct dea_solid *s)
{
  return s->problem.modulus_Pa * s->problem.length_m;
}

dea_status dea_solid_bodies_add_pins(struct dea_context *ctx, struct dea_solid *s, Mat A)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t i = 3 * p->first_node; i < 3 * p->end_node && p->body_count > 0; i++) {
    PetscInt row = (PetscInt)i;
    if (p->held[i] == DEA_FOLLOWS) {
      DEA_PETSC(ctx, MatSetValue(A, row, row, pin_stiffness(s), ADD_VALUES));
    }
  }
  return DEA_OK;
}

/* H of forces g [dofs] on the followers of a body, by L w. */
static void geometric_of(const struct dea_solid *s, size_t body, const double *g, double H[9])
{
  const double length_m = s->problem.bodies[body].length_m;
  double P[9] = {0}, r[3];
  struct rotation q;
  for (size_t n = 0; n < s->problem.grid->node_count; n++) {
    if (body_of(s, n) == body) {
      arm_of(s, body, n, r);
      for (size_t i = 0; i < 9; i++) {
        P[i] += g[3 * n + i / 3] * r[i % 3];
      }
    }
  }
  rotation_at(s, body, s->state.u, &q);
  curvature(&q, P, H);
  for (int i = 0; i < 9; i++) {
    H[i] /= length_m * length_m;
  }
}

double dea_solid_bodies_curvature(const struct dea_solid *s, const double *g, const double *v)
{
  double sum = 0;
  for (size_t k = 0; k < s->problem.body_count; k++) {
    const double *turn = v + 3 * (s->problem.bodies[k].node + 1);
    double H[9];
    geometric_of(s, k, g, H);
    for (int i = 0; i < 9; i++) {
      sum += turn[i / 3] * H[i] * turn[i % 3];
    }
  }
  return sum;
}

dea_status dea_solid_bodies_add_geometric(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                          const double *increment, double *g)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < p->body_count; k++) {
    const size_t turn = 3 * (p->bodies[k].node + 1);
    double H[9], block[36] = {0};
    geometric_of(s, k, g, H);
    for (int i = 0; i < 9; i++) {
      block[6 * (3 + i / 3) + 3 + i % 3] = H[i];
    }
    for (size_t i = 0; i < 9 && increment != NULL; i++) {
      g[turn + i / 3] += H[i] * increment[turn + i % 3];
    }
    DEA_TRY(ctx, add_block(ctx, s, A, k, block, pin_stiffness(s)));
  }
  return DEA_OK;
}

dea_status dea_solid_bodies_add_diagonal(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                         double factor, const double *d, size_t apart)
{
  const struct dea_solid_problem *p = &s->problem;
  dea_solid_bodies_prepare(s);
  for (size_t k = 0; k < p->body_count; k++) {
    double block[36] = {0}, B[9];
    for (size_t n = 0; n < p->grid->node_count; n++) {
      if (body_of(s, n) != k || d[apart * n] == 0) {
        continue;
      }
      slopes_of(s, k, n, B);
      for (int i = 0; i < 3; i++) {
        double A_n[6] = {i == 0, i == 1, i == 2, B[3 * i], B[3 * i + 1], B[3 * i + 2]};
        for (int e = 0; e < 36; e++) {
          block[e] += factor * d[apart * n] * A_n[e / 6] * A_n[e % 6];
        }
      }
    }
    DEA_TRY(ctx, add_block(ctx, s, A, k, block, 0));
  }
  return DEA_OK;
}

/* ---- creation ---- */

/* Its nodes have no elements and follow nothing; some nodes follow it. Sets its length. */
static dea_status check_body(struct dea_context *ctx, struct dea_solid *s, size_t body)
{
  struct dea_solid_problem *p = &s->problem;
  struct dea_solid_body *b = &p->bodies[body];
  size_t followers = 0;
  double most = 0, r[3];
  if (b->node + 1 >= p->grid->node_count || (b->held & ~63) != 0 || !(b->length_m >= 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "body %zu has no such nodes, components or length", body);
  }
  for (size_t e = 0; e < p->grid->element_count; e++) {
    for (int i = 0; i < dea_grid_nodes_of(p->grid, e); i++) {
      size_t n = (size_t)p->grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)i];
      if (n == b->node || n == b->node + 1) {
        return dea_fail(ctx, DEA_E_ARGUMENT,
                        "body %zu needs two nodes of its own: element %zu has node %zu", body, e,
                        n);
      }
    }
  }
  for (size_t n = 0; n < p->grid->node_count; n++) {
    if (body_of(s, n) == body) {
      arm_of(s, body, n, r);
      most = fmax(most, sqrt(dea_dot(r, r)));
      followers++;
    }
  }
  b->length_m = b->length_m > 0 ? b->length_m : most > 0 ? most : 1;
  return followers > 0 ? DEA_OK : dea_fail(ctx, DEA_E_ARGUMENT, "no node follows body %zu", body);
}

/* Supports on followers of a body, as on its nodes in a plane of symmetry, say nothing new where
 * what the body may do keeps them: tried with a large motion u [dofs]. */
static dea_status check_follower(struct dea_context *ctx, const struct dea_solid *s, size_t node,
                                 double length_m, const double *u)
{
  const struct dea_solid_problem *p = &s->problem;
  const double *Q = p->frame != NULL && p->frame[node] != 0 ? p->frames[p->frame[node] - 1] : NULL;
  const double *v = u + 3 * node, *X = p->grid->X + 3 * node;
  for (size_t i = 0; i < 3; i++) {
    double displacement = Q != NULL ? dea_dot(Q + 3 * i, v) : v[i];
    if (p->held[3 * node + i] && fabs(displacement) > 1e-9 * length_m) {
      return dea_fail(ctx, DEA_E_ARGUMENT,
                      "the node at (%.4g, %.4g, %.4g) mm is held and follows a body that may move "
                      "it: hold the body instead",
                      1e3 * X[0], 1e3 * X[1], 1e3 * X[2]);
    }
  }
  return DEA_OK;
}

dea_status dea_solid_bodies_hold(struct dea_context *ctx, struct dea_solid *s)
{
  static const double large[6] = {0.3, -0.7, 0.5, 0.9, -0.6, 0.4};
  struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < p->body_count; k++) {
    const struct dea_solid_body *b = &p->bodies[k];
    for (size_t i = 0; i < 6; i++) {
      const bool held = (b->held >> i) & 1;
      p->held[3 * b->node + i] = held ? DEA_HELD : DEA_FREE;
      s->work.trial[3 * b->node + i] = held ? 0 : large[i] * b->length_m;
    }
  }
  dea_solid_bodies_place(s, s->work.trial);
  for (size_t n = 0; n < p->grid->node_count; n++) {
    const size_t k = body_of(s, n);
    if (k != SIZE_MAX) {
      DEA_TRY(ctx, check_follower(ctx, s, n, p->bodies[k].length_m, s->work.trial));
      memset(p->held + 3 * n, DEA_FOLLOWS, 3);
    }
  }
  return DEA_OK;
}

static dea_status check_elements(struct dea_context *ctx, const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    size_t seen[DEA_BODIES_MAX], count = 0;
    for (int i = 0; i < dea_grid_nodes_of(p->grid, e); i++) {
      size_t k = body_of(s, (size_t)p->grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)i]), at = 0;
      while (at < count && seen[at] != k) {
        at++;
      }
      if (k != SIZE_MAX && at == count) {
        if (count == DEA_BODIES_MAX) {
          return dea_fail(ctx, DEA_E_UNSUPPORTED, "element %zu touches more than %d bodies", e,
                          DEA_BODIES_MAX);
        }
        seen[count++] = k;
      }
    }
  }
  return DEA_OK;
}

dea_status dea_solid_bodies_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  size_t count = options->body_count, nodes = p->grid->node_count;
  if (options->point_mass_kg != NULL) {
    p->point_mass = dea_arena_alloc(&s->memory, nodes, sizeof *p->point_mass);
    DEA_TRY(ctx, dea_arena_status(&s->memory));
    memcpy(p->point_mass, options->point_mass_kg, nodes * sizeof *p->point_mass);
  }
  if (count == 0) {
    return DEA_OK;
  }
  if (options->field == DEA_SOLID_FIELD_COUPLED) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "rigid bodies take the field V/h, not a coupled one");
  }
  p->bodies = dea_arena_alloc(&s->memory, count, sizeof *p->bodies);
  p->body_of = dea_arena_alloc(&s->memory, nodes, sizeof *p->body_of);
  s->work.body_slope = dea_arena_alloc(&s->memory, count, sizeof *s->work.body_slope);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  p->body_count = count;
  memcpy(p->bodies, options->bodies, count * sizeof *p->bodies);
  memcpy(p->body_of, options->body_of, nodes * sizeof *p->body_of);
  for (size_t n = 0; n < nodes; n++) {
    if (p->body_of[n] < 0 || (size_t)p->body_of[n] > count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "node %zu follows body %d of %zu", n, p->body_of[n],
                      count);
    }
    if (p->body_of[n] > 0 && dea_solid_is_of_body(s, n)) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "node %zu of a body follows another one", n);
    }
  }
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(ctx, check_body(ctx, s, k));
  }
  return DEA_CHAIN(ctx, check_elements(ctx, s));
}

/* ---- what callers ask of a body ---- */

void dea_solid_body_place(const struct dea_solid *solid, size_t body, double shift_m[3],
                          double turn_rad[3])
{
  const struct dea_solid_body *b = &solid->problem.bodies[body];
  for (size_t i = 0; i < 3; i++) {
    shift_m[i] = solid->state.u[3 * b->node + i];
    turn_rad[i] = solid->state.u[3 * b->node + 3 + i] / b->length_m;
  }
}

void dea_solid_body_push(struct dea_solid *solid, size_t body, const double force_N[3],
                         const double moment_N_m[3])
{
  const struct dea_solid_body *b = &solid->problem.bodies[body];
  for (size_t i = 0; i < 3; i++) {
    solid->state.force_goal[3 * b->node + i] = force_N[i];
    solid->state.force_goal[3 * b->node + 3 + i] = moment_N_m[i] / b->length_m;
  }
}

/* T^-T, by which what is conjugate to w becomes a moment: that is T^T times the moment, where T dw
 * is the small turn on top of R: T = a 1 + b [w x] + c w w^T with c = (1 - a)/s. */
static void moment_matrix(const struct rotation *q, double M[9])
{
  double T[9], c = 0, power = 1. / 6;
  for (int k = 0; k < 32; k++) { // c = sum (-s)^k/(2k + 3)!
    c += power;
    power *= -q->s / ((2 * k + 4) * (2 * k + 5));
  }
  cross_matrix(q->w, T);
  for (int i = 0; i < 9; i++) {
    T[i] = q->b[0] * T[i] + c * q->w[i / 3] * q->w[i % 3] + (i % 4 == 0 ? q->a[0] : 0);
  }
  const double det = dea_cofactors(T, M);
  for (int i = 0; i < 9; i++) {
    M[i] /= det;
  }
}

void dea_solid_body_reaction(const struct dea_solid *solid, size_t body, double force_N[3],
                             double moment_N_m[3])
{
  const struct dea_solid_body *b = &solid->problem.bodies[body];
  const double *reaction = solid->found.reaction + 3 * b->node;
  struct rotation q;
  double M[9], m[3];
  rotation_at(solid, body, solid->state.u, &q);
  moment_matrix(&q, M);
  for (size_t i = 0; i < 3; i++) {
    force_N[i] = reaction[i];
    m[i] = b->length_m * reaction[3 + i];
  }
  for (size_t i = 0; i < 3; i++) {
    moment_N_m[i] = dea_dot(M + 3 * i, m);
  }
}

bool dea_solid_body_force_direction(const struct dea_solid *solid, size_t body, size_t component,
                                    double *direction)
{
  const struct dea_solid_body *b = &solid->problem.bodies[body];
  const unsigned char *held = solid->problem.held + 3 * b->node;
  struct rotation q;
  double M[9];
  if (component < 3) {
    direction[3 * b->node + component] = 1;
    return true;
  }
  rotation_at(solid, body, solid->state.u, &q);
  moment_matrix(&q, M);
  for (size_t i = 0; i < 3; i++) {
    direction[3 * b->node + 3 + i] = b->length_m * M[3 * (component - 3) + i];
  }
  return held[3] && held[4] && held[5];
}
