/* Contact with a rigid tip, without friction: E = int (<p - k g>^2 - p^2)/(2k) dA at the nodes of
 * the faces, and p <- <p - k g> in the outer loop. */
#include "model/solid/load/loads.h"

#include <math.h>
#include <string.h>

static const double tolerance_default = 1e-3;
static const double gap_none = 1e-9; // of the tip's radius

struct dea_contact {
  const struct dea_surface *surface;
  struct dea_face_shape shape;
  struct dea_indenter tip;
  double stiffness, tolerance; // k, of the pressure
  bool held;                   // what has a pressure stays in touch, of any sign, without k
  double now[3], goal[3];      // place of the tip
  double *weight, *pressure;   // [face_count][points] areas; p
};

dea_status dea_contact_create(struct dea_context *ctx, const struct dea_surface *surface,
                              const struct dea_contact_options *options, struct dea_contact **out)
{
  struct dea_indenter tip = options->tip;
  *out = NULL;
  DEA_TRY(ctx, dea_indenter_check(ctx, &tip));
  if (!(options->stiffness_Pa_per_m > 0) || !(options->tolerance >= 0)) {
    return dea_fail(ctx, DEA_E_ARGUMENT,
                    "contact needs a stiffness above 0 and a tolerance of 0 or more");
  }
  struct dea_contact *c = dea_alloc(ctx, 1, sizeof *c);
  DEA_TRY_MEMORY(c != NULL);
  c->surface = surface;
  c->tip = tip;
  c->stiffness = options->stiffness_Pa_per_m;
  c->tolerance = options->tolerance > 0 ? options->tolerance : tolerance_default;
  memcpy(c->now, options->place_m, sizeof c->now);
  memcpy(c->goal, options->place_m, sizeof c->goal);
  dea_face_shape_create(surface, DEA_FACE_AT_NODES, &c->shape);
  c->weight = dea_surface_weights(ctx, surface, &c->shape);
  c->pressure = dea_alloc(ctx, surface->face_count * (size_t)c->shape.points, sizeof *c->pressure);
  if (c->weight == NULL || c->pressure == NULL) {
    dea_contact_destroy(ctx, c);
    return DEA_E_MEMORY;
  }
  *out = c;
  return DEA_OK;
}

void dea_contact_destroy(struct dea_context *ctx, struct dea_contact *contact)
{
  if (contact != NULL) {
    dea_free(ctx, contact->weight);
    dea_free(ctx, contact->pressure);
    dea_free(ctx, contact);
  }
}

void dea_contact_move(struct dea_contact *contact, const double place_m[3])
{
  memcpy(contact->goal, place_m, sizeof contact->goal);
}

void dea_contact_hold(struct dea_contact *contact, const struct dea_contact *other)
{
  const size_t count = contact->surface->face_count * (size_t)contact->shape.points;
  memcpy(contact->pressure, other->pressure, count * sizeof *contact->pressure);
  contact->held = true;
}

/* Gap at a point of a face, which is one of its nodes. */
static double gap_at(const struct dea_contact *c, size_t face, int point, const double *u,
                     double normal[3], double *hessian)
{
  size_t node = (size_t)c->surface->nodes[face * DEA_FACE_NODES_MAX + (size_t)point];
  const double *X = c->surface->grid->X + 3 * node, *v = u + 3 * node;
  const double x[3] = {X[0] + v[0], X[1] + v[1], X[2] + v[2]};
  return dea_indenter_distance(&c->tip, c->now, x, normal, hessian);
}

static dea_status evaluate(const void *self, size_t piece, const double *u,
                           enum dea_eval_order level, struct dea_load_piece *out)
{
  const struct dea_contact *c = self;
  int points = c->shape.points, dofs = 3 * points;
  double k = c->stiffness;
  bool any = false;
  out->energy_J = 0;
  memset(out->g, 0, (size_t)dofs * sizeof *out->g);
  memset(out->K, 0, level >= DEA_TANGENT ? (size_t)(dofs * dofs) * sizeof *out->K : 0);
  for (int q = 0; q < points; q++) {
    size_t at = piece * (size_t)points + (size_t)q;
    double n[3], H[9], w = c->weight[at], p = c->pressure[at];
    double gap = gap_at(c, piece, q, u, n, level >= DEA_TANGENT ? H : NULL);
    // NAN becomes 0 here: u is checked by the elements
    double push = c->held ? p : fmax(p - k * gap, 0);
    double bends = level == DEA_TANGENT_PREDICTED ? p : push;
    // (push^2 - p^2) / (2 k), without the difference where k is small
    out->energy_J -= w * (push != 0 ? gap * (p + push) / 2 : p * p / (2 * k));
    any = any || push != 0 || p != 0;
    for (int i = 0; i < 3 && push != 0; i++) {
      out->g[3 * q + i] -= w * push * n[i];
      for (int j = 0; j < 3 && level >= DEA_TANGENT; j++) {
        out->K[(3 * q + i) * dofs + 3 * q + j] +=
            w * ((c->held ? 0 : k) * n[i] * n[j] - bends * H[3 * i + j]);
      }
    }
  }
  out->node_count = any ? points : 0;
  memcpy(out->nodes, c->surface->nodes + piece * DEA_FACE_NODES_MAX,
         (size_t)points * sizeof *out->nodes);
  return DEA_OK;
}

/* The pressures take over the penalty. How far they went, in the mean over the contact, over what
 * is allowed; where a contact ends there is none to compare with, and a round more is asked for. */
static double update(void *self, const double *u)
{
  struct dea_contact *c = self;
  size_t points = (size_t)c->shape.points;
  double way = 0, whole = 0, largest = 0, n[3];
  for (size_t at = 0; at < c->surface->face_count * points; at++) {
    double p = c->pressure[at], gap = gap_at(c, at / points, (int)(at % points), u, n, NULL);
    c->pressure[at] = fmax(p - c->stiffness * gap, 0);
    way += c->weight[at] * fabs(c->pressure[at] - p);
    largest = fmax(largest, fabs(c->pressure[at] - p));
    whole += c->weight[at] * c->pressure[at];
  }
  double gap_error = largest / (c->stiffness * gap_none * c->tip.radius_m);
  return whole > 0 ? fmin(gap_error, way / (c->tolerance * whole)) : gap_error;
}

/* A step takes the gap away where the surface touches: p - k (g + n . step), docs/theory/loads.md.
 */
static void predict(void *self, const double *u, const double *step, double share)
{
  struct dea_contact *c = self;
  size_t points = (size_t)c->shape.points;
  for (size_t at = 0; at < c->surface->face_count * points; at++) {
    size_t face = at / points, point = at % points;
    const double *s = step + 3 * c->surface->nodes[face * DEA_FACE_NODES_MAX + point];
    double p = c->pressure[at], n[3], gap = gap_at(c, face, (int)point, u, n, NULL);
    double left = gap + n[0] * s[0] + n[1] * s[1] + n[2] * s[2];
    c->pressure[at] = p > c->stiffness * gap ? fmax(p - share * c->stiffness * left, 0) : 0;
  }
}

/* C = -w g: the pressure keeps the gap closed. */
static void constraint(const void *self, size_t at, const double *u,
                       struct dea_load_constraint *out)
{
  const struct dea_contact *c = self;
  size_t points = (size_t)c->shape.points;
  double n[3], gap = gap_at(c, at / points, (int)(at % points), u, n, NULL), w = c->weight[at];
  *out = (struct dea_load_constraint){
      .held = c->pressure[at] > c->stiffness * gap,
      .node = c->surface->nodes[at / points * DEA_FACE_NODES_MAX + at % points],
      .value = -w * gap,
      .slope = {-w * n[0], -w * n[1], -w * n[2]},
      .weight = w,
      .stiffness = c->stiffness};
}

void dea_contact_force_slope(const struct dea_contact *contact, const double *u, int component,
                             double factor, double *by_u, double *by_pressure)
{
  size_t points = (size_t)contact->shape.points;
  for (size_t at = 0; at < contact->surface->face_count * points; at++) {
    double n[3], H[9], w = factor * contact->weight[at], p = contact->pressure[at];
    size_t face = at / points, point = at % points;
    if (p > 0) {
      double *by = by_u + 3 * (size_t)contact->surface->nodes[face * DEA_FACE_NODES_MAX + point];
      gap_at(contact, face, (int)point, u, n, H);
      by_pressure[at] -= w * n[component];
      for (int j = 0; j < 3; j++) {
        by[j] -= w * p * H[3 * component + j];
      }
    }
  }
}

void dea_contact_force(const struct dea_contact *contact, const double *u, double force_N[3])
{
  size_t points = (size_t)contact->shape.points;
  force_N[0] = force_N[1] = force_N[2] = 0;
  for (size_t at = 0; at < contact->surface->face_count * points; at++) {
    double n[3], push = contact->weight[at] * contact->pressure[at];
    if (push > 0) {
      gap_at(contact, at / points, (int)(at % points), u, n, NULL);
      for (int i = 0; i < 3; i++) {
        force_N[i] -= push * n[i];
      }
    }
  }
}

struct dea_solid_load dea_contact_load(struct dea_contact *contact)
{
  return (struct dea_solid_load){.self = contact,
                                 .piece_count = contact->surface->face_count,
                                 .evaluate = evaluate,
                                 .parameter_count = 3,
                                 .now = contact->now,
                                 .goal = contact->goal,
                                 .multiplier_count =
                                     contact->surface->face_count * (size_t)contact->shape.points,
                                 .multiplier = contact->pressure,
                                 .update = update,
                                 .predict = predict,
                                 .constraint = constraint};
}
