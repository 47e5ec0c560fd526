#include "model/solid/model3d/solid_observe.h"

#include "base/quadrature.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/element/membrane.h"
#include "model/solid/model3d/solid_fields.h"
#include "result/columns.h"

#include <math.h>
#include <string.h>

enum { PLANE_MAX = DEA_ELEMENT_LEVEL_MAX };

/* A point of a ply: the mean of two layers of its nodes, or one of them twice. */
struct probe {
  int count;
  int node[2][PLANE_MAX];
  double weight[PLANE_MAX];
  size_t element; // one of the ply there, and where in it
  double at[2];
  size_t copy; // of the sector, that the point lies in
};

/* The column of load points that a monitor of a disc is, and that of its error, or -1. */
struct of_disc {
  int column, error_column;
  enum dea_observed motion;
};

struct dea_observer {
  const struct dea_layout_mesh *mesh;
  struct dea_pressure *const *pressures;
  struct dea_contact *const *contacts;
  size_t count;              // of all monitors, those of a disc too
  struct of_disc *of_disc;   // [disc_monitor_count]
  struct probe (*probes)[2]; // [count] of points and lines
  double (*monitor)[DEA_OBSERVED_COUNT];
  double (*body)[DEA_OBSERVED_COUNT];
  struct dea_channel_values *channel;
  double *work;         // of channels
  size_t channel_count; // of the solid, ground counted; at least those of the layout
};

// Where points are -------------------------------------------------------------------------------

/* Local coordinates of a place in a quadrilateral of nodes [(order + 1)^2] by Newton's method,
 * which goes far outside on its way in a narrow one along an arc; false where it is not in it. */
static bool locate(const struct dea_grid *grid, const int *nodes, const double x_m[2], double at[2])
{
  const int order[2] = {grid->order, grid->order};
  double value[PLANE_MAX], slope[2][PLANE_MAX];
  int count = (grid->order + 1) * (grid->order + 1);
  at[0] = at[1] = 0;
  for (int i = 0; i < 20; i++) {
    double r[2] = {x_m[0], x_m[1]}, J[4] = {0};
    dea_face_basis(order, at, value, slope);
    for (int n = 0; n < count; n++) {
      const double *X = grid->X + 3 * nodes[n];
      for (int k = 0; k < 2; k++) {
        r[k] -= value[n] * X[k];
        J[2 * k] += slope[0][n] * X[k];
        J[2 * k + 1] += slope[1][n] * X[k];
      }
    }
    double det = J[0] * J[3] - J[1] * J[2];
    double step[2] = {(J[3] * r[0] - J[1] * r[1]) / det, (J[0] * r[1] - J[2] * r[0]) / det};
    at[0] += step[0];
    at[1] += step[1];
    if (fmax(fabs(step[0]), fabs(step[1])) < 1e-12) {
      break;
    }
  }
  return fabs(at[0]) < 1 + 1e-6 && fabs(at[1]) < 1 + 1e-6;
}

static bool could_be_in(const struct dea_grid *grid, const int *nodes, const double x_m[2])
{
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int n = 0; n < (grid->order + 1) * (grid->order + 1); n++) {
    for (int k = 0; k < 2; k++) {
      low[k] = fmin(low[k], grid->X[3 * nodes[n] + k]);
      high[k] = fmax(high[k], grid->X[3 * nodes[n] + k]);
    }
  }
  bool inside = true;
  for (int k = 0; k < 2; k++) { // sides are curved
    double more = 0.2 * (high[k] - low[k]);
    inside = inside && x_m[k] > low[k] - more && x_m[k] < high[k] + more;
  }
  return inside;
}

/* The elements of a ply: those of its lowest layer, [first, end), and how many further in the grid
 * the highest ones above them are. Each layer has those of the plane mesh in their order. */
struct layers {
  size_t first, end, to_highest;
};

static struct layers layers_of(const struct dea_layout_mesh *mesh, size_t ply)
{
  const struct dea_grid *grid = mesh->grid;
  struct layers out = {0};
  size_t count = 0, layer = 0;
  for (size_t q = 0; q < mesh->plane->quad_count; q++) {
    layer += mesh->present[(size_t)mesh->plane->region[q] * mesh->layout->ply_count + ply];
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    if ((size_t)grid->ply[e] == ply) {
      out.first = count == 0 ? e : out.first;
      count++;
    }
  }
  out.end = out.first + layer;
  out.to_highest = count - layer;
  return out;
}

/* Nodes of the faces of a ply below and above an element of its lowest layer. */
static void ply_faces(const struct dea_grid *grid, const struct layers *layers, size_t e,
                      const int *face[2])
{
  const size_t top = e + layers->to_highest;
  face[0] = grid->nodes + e * DEA_HEX_NODES_MAX;
  face[1] = grid->nodes + top * DEA_HEX_NODES_MAX +
            (grid->levels[top] - 1) * (grid->order + 1) * (grid->order + 1);
}

/* From a copy into the sector: a mirror is its own inverse, a rotation goes back. */
static struct dea_motion back_to_sector(const struct dea_layout_mesh *mesh, size_t copy)
{
  struct dea_motion out = dea_layout_sector_copy(&mesh->sector, copy);
  out.sine = out.mirrored ? out.sine : -out.sine;
  return out;
}

/* In the sector itself: the layers of nodes that are nearest to what is wanted, from below and from
 * above. */
static bool find_in_sector(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                           const double x_m[2], struct probe *out)
{
  const struct dea_grid *grid = mesh->grid;
  const double *face_m = mesh->face_m[m->ply], middle_m = 0.5 * (face_m[0] + face_m[1]);
  const int order[2] = {grid->order, grid->order};
  const double near_m = 1e-6 * mesh->layout->plies[m->ply].thickness_m;
  const double wanted_m[2] = {m->level == DEA_LEVEL_TOP      ? face_m[1]
                              : m->level == DEA_LEVEL_MIDDLE ? middle_m
                                                             : face_m[0],
                              m->level == DEA_LEVEL_MIDDLE ? middle_m : face_m[1]};
  double best[2] = {INFINITY, INFINITY};
  out->count = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX,
              per = (grid->order + 1) * (grid->order + 1);
    double at[2], slope[2][PLANE_MAX];
    if ((size_t)grid->ply[e] != m->ply || !could_be_in(grid, nodes, x_m) ||
        !locate(grid, nodes, x_m, at)) {
      continue;
    }
    for (int k = 0; k < 2 * grid->levels[e]; k++) { // those on the side of one found are no nearer
      const int *layer = nodes + k / 2 * per;
      const double away_m = (k % 2 == 0 ? -1 : 1) * (grid->X[3 * layer[0] + 2] - wanted_m[k % 2]);
      if (away_m >= -near_m && fabs(away_m) < best[k % 2]) { // above each other: the same places
        best[k % 2] = fabs(away_m);
        out->count = per;
        out->element = e;
        memcpy(out->at, at, sizeof out->at);
        memcpy(out->node[k % 2], layer, (size_t)per * sizeof *layer);
        dea_face_basis(order, at, out->weight, slope);
      }
    }
  }
  for (int n = 0; n < out->count; n++) { // at a node without what is left of rounding
    const double nearest = round(out->weight[n]);
    out->weight[n] = fabs(out->weight[n] - nearest) < 1e-12 ? nearest : out->weight[n];
  }
  return out->count > 0;
}

/* A point of any copy of the sector, reflected into it. */
static bool find_probe(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                       const double x_m[2], struct probe *out)
{
  const double *centre = mesh->sector.centre_m, from[2] = {x_m[0] - centre[0], x_m[1] - centre[1]};
  for (size_t k = 0; k < dea_layout_sector_copies(&mesh->sector); k++) {
    struct dea_motion back = back_to_sector(mesh, k);
    double x[2] = {x_m[0], x_m[1]};
    if (k > 0) {
      dea_layout_sector_turn(&back, from, x);
      x[0] += centre[0];
      x[1] += centre[1];
    }
    out->copy = k;
    if (find_in_sector(mesh, m, x, out)) {
      return true;
    }
  }
  return false;
}

/* Where monitors are read, and the columns that those of a disc are. */
static dea_status find_places(struct dea_context *ctx, struct dea_observer *o)
{
  const struct dea_layout *l = o->mesh->layout;
  for (size_t i = 0; i < l->disc_monitor_count; i++) {
    struct of_disc *of = &o->of_disc[i];
    of->column = dea_observed_of_disc(&l->monitors[l->monitor_count + i], &of->motion);
    of->error_column = dea_point_error_column(ctx, of->column);
  }
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  for (size_t i = 0; i < o->count; i++) {
    const struct dea_layout_monitor *m = &l->monitors[i];
    const int points = m->kind == DEA_MONITOR_LINE                                     ? 2
                       : m->kind == DEA_MONITOR_POINT || m->kind == DEA_MONITOR_RADIUS ? 1
                                                                                       : 0;
    for (int k = 0; k < points; k++) {
      if (!find_probe(o->mesh, m, m->at_m[k], &o->probes[i][k])) {
        DEA_TRY(ctx,
                dea_finding_add(ctx, DEA_ERROR, m->location,
                                "monitor '%s': the ply '%s' is not at (%.6g, %.6g) mm", m->name,
                                l->plies[m->ply].name, 1e3 * m->at_m[k][0], 1e3 * m->at_m[k][1]));
      }
    }
  }
  return dea_finding_count(ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "a monitor is off its ply");
}

dea_status dea_observer_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                               struct dea_pressure *const *pressures,
                               struct dea_contact *const *contacts, struct dea_arena *memory,
                               struct dea_observer **out)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_observer *o = *out = dea_arena_alloc(memory, 1, sizeof *o);
  DEA_TRY(ctx, dea_arena_status(memory));
  *o = (struct dea_observer){.mesh = mesh, .pressures = pressures, .contacts = contacts};
  o->count = l->monitor_count + l->disc_monitor_count;
  o->of_disc = dea_arena_alloc(memory, l->disc_monitor_count, sizeof *o->of_disc);
  o->probes = dea_arena_alloc(memory, o->count + 1, sizeof *o->probes);
  o->monitor = dea_arena_alloc(memory, l->monitor_count + 1, sizeof *o->monitor);
  o->body = dea_arena_alloc(memory, l->body_count + 1, sizeof *o->body);
  o->channel = dea_arena_alloc(memory, l->channel_count, sizeof *o->channel);
  o->channel_count = l->channel_count > 1 ? l->channel_count : 2; // a solid has one beside ground
  o->work = dea_arena_alloc(memory, (o->channel_count + 2) * o->channel_count, sizeof(double));
  DEA_TRY(ctx, dea_arena_status(memory));
  return DEA_CHAIN(ctx, find_places(ctx, o));
}

// Values -----------------------------------------------------------------------------------------

static void nothing_observed(double *values)
{
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    values[k] = NAN;
  }
}

static void displacement_at(const struct dea_layout_mesh *mesh, const struct probe *probe,
                            const double *u, double out[3])
{
  for (int i = 0; i < 3; i++) {
    out[i] = 0;
    for (int n = 0; n < probe->count; n++) {
      out[i] +=
          0.5 * probe->weight[n] * (u[3 * probe->node[0][n] + i] + u[3 * probe->node[1][n] + i]);
    }
  }
  if (probe->copy > 0) {
    struct dea_motion copy = dea_layout_sector_copy(&mesh->sector, probe->copy);
    dea_layout_sector_turn(&copy, out, out);
  }
}

/* Outwards from the centre of a radius, whose length it returns. */
static double radius_of(const struct dea_layout_monitor *m, double along[3])
{
  const double d[2] = {m->at_m[0][0] - m->at_m[1][0], m->at_m[0][1] - m->at_m[1][1]};
  const double length = hypot(d[0], d[1]);
  along[0] = d[0] / length;
  along[1] = d[1] / length;
  along[2] = 0;
  return length;
}

/* From one end of a line to the other; returns its length in the flat state. */
static double line_between(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                           const struct probe probe[2], const double *u, double now[3])
{
  double v[2][3], flat = 0;
  displacement_at(mesh, &probe[0], u, v[0]);
  displacement_at(mesh, &probe[1], u, v[1]);
  for (int i = 0; i < 3; i++) {
    const double d = i < 2 ? m->at_m[1][i] - m->at_m[0][i] : 0;
    now[i] = d + v[1][i] - v[0][i];
    flat += d * d;
  }
  return sqrt(flat);
}

/* The middle surface of a region, halfway between the faces of the ply whatever number of elements
 * it has, at a point of an element: nodes of the faces, the nodal basis and its gradients, the
 * gradient dx/dX, and the area that the point stands for. */
struct middle {
  const int *face[2];
  int nodes; // of a face
  double value[PLANE_MAX], slope[2][PLANE_MAX], F[3][2], dA;
};

/* Of an element whose faces are there. weight: of the point. */
static void find_middle(const struct dea_grid *grid, const double at[2], double weight,
                        const double *u, struct middle *out)
{
  double X[2][2] = {{0}};
  dea_face_basis((const int[2]){grid->order, grid->order}, at, out->value, out->slope);
  for (int n = 0; n < out->nodes; n++) {
    for (int i = 0; i < 4; i++) {
      X[i / 2][i % 2] += out->slope[i % 2][n] * grid->X[3 * out->face[0][n] + i / 2];
    }
  }
  const double det = X[0][0] * X[1][1] - X[0][1] * X[1][0];
  memset(out->F, 0, sizeof out->F);
  out->F[0][0] = out->F[1][1] = 1;
  out->dA = det * weight;
  for (int n = 0; n < out->nodes; n++) {
    const double d[2] = {out->slope[0][n], out->slope[1][n]};
    out->slope[0][n] = (d[0] * X[1][1] - d[1] * X[1][0]) / det;
    out->slope[1][n] = (d[1] * X[0][0] - d[0] * X[0][1]) / det;
    for (int i = 0; i < 6; i++) {
      out->F[i / 2][i % 2] += 0.5 * out->slope[i % 2][n] *
                              (u[3 * out->face[0][n] + i / 2] + u[3 * out->face[1][n] + i / 2]);
    }
  }
}

/* Adds what a number changes by with a node of the middle surface to its nodes of both faces. */
static void add_to_faces(const struct middle *at, int n, int axis, double amount, double *weight)
{
  weight[3 * at->face[0][n] + axis] += 0.5 * amount;
  weight[3 * at->face[1][n] + axis] += 0.5 * amount;
}

/* The area stretch J = sqrt(det C), C = F^T F. Adds what it changes by times the area to weight,
 * which may be NULL: dJ = J C^-1 : F^T dF. */
static double area_stretch(const struct middle *at, double *weight)
{
  double C[3] = {0};
  for (int i = 0; i < 3; i++) {
    C[0] += at->F[i][0] * at->F[i][0];
    C[1] += at->F[i][1] * at->F[i][1];
    C[2] += at->F[i][0] * at->F[i][1];
  }
  const double J = sqrt(C[0] * C[1] - C[2] * C[2]);
  for (int n = 0; n < at->nodes && weight != NULL; n++) { // C^-1 slope times J
    const double d[2] = {at->slope[0][n], at->slope[1][n]};
    const double c[2] = {(C[1] * d[0] - C[2] * d[1]) / J, (C[0] * d[1] - C[2] * d[0]) / J};
    for (int i = 0; i < 3; i++) {
      add_to_faces(at, n, i, at->dA * (at->F[i][0] * c[0] + at->F[i][1] * c[1]), weight);
    }
  }
  return J;
}

/* The same of the length of the tangent along x or y, in the mean over the copies of the sector: of
 * the direction a in the sector d|F a| = F a . dF a / |F a|. */
static double tangent_length(const struct dea_layout_mesh *mesh, bool along_y,
                             const struct middle *at, double *weight)
{
  const size_t copies = dea_layout_sector_copies(&mesh->sector);
  const double axis[2] = {along_y ? 0 : 1, along_y ? 1 : 0};
  double mean = 0;
  for (size_t k = 0; k < copies; k++) {
    double a[2] = {axis[0], axis[1]}, along[3];
    if (k > 0) {
      struct dea_motion back = back_to_sector(mesh, k);
      dea_layout_sector_turn(&back, axis, a);
    }
    for (int i = 0; i < 3; i++) {
      along[i] = at->F[i][0] * a[0] + at->F[i][1] * a[1];
    }
    const double length = sqrt(dea_dot(along, along));
    mean += length / (double)copies;
    for (int i = 0; i < 3 * at->nodes && weight != NULL; i++) {
      const int n = i / 3;
      const double by =
          at->dA * (at->slope[0][n] * a[0] + at->slope[1][n] * a[1]) / (length * (double)copies);
      add_to_faces(at, i / 3, i % 3, by * along[i % 3], weight);
    }
  }
  return mean;
}

/* The same of the displacement along x, y or z, of which share[3] is along the axes of the sector
 * in the mean over its copies. */
static double displacement_along(const struct middle *at, const double share[3], const double *u,
                                 double *weight)
{
  double sum = 0;
  for (int i = 0; i < 3 * at->nodes; i++) {
    const double by = at->value[i / 3] * share[i % 3];
    sum += 0.5 * by * (u[3 * at->face[0][i / 3] + i % 3] + u[3 * at->face[1][i / 3] + i % 3]);
    if (weight != NULL) {
      add_to_faces(at, i / 3, i % 3, at->dA * by, weight);
    }
  }
  return sum;
}

/* How much of a displacement of the sector lies along x, y or z in the mean over its copies. */
static void share_of_copies(const struct dea_layout_sector *sector, int along, double share[3])
{
  size_t copies = dea_layout_sector_copies(sector);
  memset(share, 0, 3 * sizeof *share);
  for (size_t k = 0; k < copies; k++) {
    for (int i = 0; i < 3; i++) {
      double axis[3] = {i == 0, i == 1, i == 2};
      if (k > 0) {
        struct dea_motion copy = dea_layout_sector_copy(sector, k);
        dea_layout_sector_turn(&copy, axis, axis);
      }
      share[i] += axis[along] / (double)copies;
    }
  }
}

/* Means over a region: of displacements, of the lengths of its two tangents, of its area. */
enum { REGION_MOTIONS = 6 };
static const enum dea_observed region_motions[REGION_MOTIONS] = {
    DEA_OBSERVED_X,         DEA_OBSERVED_Y,         DEA_OBSERVED_Z,
    DEA_OBSERVED_STRETCH_X, DEA_OBSERVED_STRETCH_Y, DEA_OBSERVED_AREA_STRETCH};

/* All of them into values or, with a weight, 0 before, only `motion` and how it changes with each
 * displacement into weight. */
static void observe_region(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                           const double *u, double *values, enum dea_observed motion,
                           double *weight)
{
  const struct dea_grid *grid = mesh->grid;
  const size_t points = (size_t)grid->order + 1;
  const struct layers layers = layers_of(mesh, m->ply);
  struct middle at = {.nodes = (int)(points * points)};
  double place[DEA_HEX_LINE_MAX], part[DEA_HEX_LINE_MAX], share[3][3];
  double sum[REGION_MOTIONS] = {0}, area = 0;
  dea_gauss_rule(points, place, part);
  for (int k = 0; k < 3; k++) {
    share_of_copies(&mesh->sector, k, share[k]);
  }
  for (size_t e = layers.first; e < layers.end; e++) {
    ply_faces(grid, &layers, e, at.face);
    for (size_t p = 0; p < points * points && dea_layout_mesh_within(mesh, e, m->region); p++) {
      find_middle(grid, (const double[2]){place[p % points], place[p / points]},
                  part[p % points] * part[p / points], u, &at);
      area += at.dA;
      for (int k = 0; k < REGION_MOTIONS; k++) {
        if (weight == NULL || region_motions[k] == motion) {
          sum[k] += at.dA * (k < 3   ? displacement_along(&at, share[k], u, weight)
                             : k < 5 ? tangent_length(mesh, k == 4, &at, weight)
                                     : area_stretch(&at, weight));
        }
      }
    }
  }
  for (int k = 0; k < REGION_MOTIONS; k++) {
    values[region_motions[k]] = sum[k] / area;
  }
  for (size_t i = 0; i < 3 * grid->node_count && weight != NULL; i++) {
    weight[i] /= area;
  }
}

/* Forces of a sector become those of the whole: what acts along what keeps the symmetry is the same
 * in all copies, the rest they take from each other. */
static void sum_up_forces(const struct dea_layout_mesh *mesh, int count, double *out)
{
  const int keeps = dea_layout_sector_keeps(&mesh->sector);
  for (int k = 0; k < count; k++) {
    out[k] *= (keeps >> k) & 1 ? (double)dea_layout_sector_copies(&mesh->sector) : 0;
  }
}

static void observe_body(const struct dea_layout_mesh *mesh, const struct dea_solid *solid,
                         size_t body, double *out)
{
  dea_solid_body_place(solid, body, out + DEA_OBSERVED_X, out + DEA_OBSERVED_TURN_X);
  dea_solid_body_reaction(solid, body, out + DEA_OBSERVED_FORCE_X, out + DEA_OBSERVED_MOMENT_X);
  sum_up_forces(mesh, 6, out + DEA_OBSERVED_FORCE_X);
}

static void observe_contact(const struct dea_observer *o, size_t contact, const double *u,
                            double *values)
{
  if (o->contacts[contact] != NULL) {
    double force_N[3];
    dea_contact_force(o->contacts[contact], u, force_N);
    sum_up_forces(o->mesh, 3, force_N);
    values[DEA_OBSERVED_CONTACT_FORCE] = sqrt(dea_dot(force_N, force_N));
    values[DEA_OBSERVED_CONTACT_AREA] =
        (double)dea_layout_sector_copies(&o->mesh->sector) * dea_contact_area(o->contacts[contact]);
  }
}

/* Of a coupled field, which has one channel: energies are by the voltage of the solve, of which the
 * channel has its ratio. */
static dea_status charge_coupled(struct dea_context *ctx, const struct dea_observer *o,
                                 struct dea_solid *solid, const double *voltage, double *charge,
                                 double *capacitance)
{
  const size_t count = o->channel_count;
  const double ratio = count > 1 ? o->mesh->layout->channels[1].ratio : 0;
  double total_F;
  DEA_TRY(ctx, dea_solid_capacitance(ctx, solid, false, &total_F));
  for (size_t k = 0; k < count && ratio != 0; k++) {
    capacitance[k * count + k] = total_F / (ratio * ratio);
    charge[k] = (k == 0 ? -1 : 1) * total_F / (ratio * ratio) * voltage[1];
  }
  return DEA_OK;
}

static dea_status observe_channels(struct dea_context *ctx, struct dea_observer *o,
                                   struct dea_solid *solid)
{
  size_t count = o->channel_count;
  double copies = (double)dea_layout_sector_copies(&o->mesh->sector);
  double *voltage = o->work, *charge = voltage + count, *capacitance = charge + count;
  dea_solid_channel_voltages(solid, voltage);
  if (solid->problem.field == NULL) {
    DEA_TRY(ctx, dea_solid_flows(ctx, solid, NULL, charge, NULL));
    DEA_TRY(ctx, dea_solid_capacitances(ctx, solid, true, capacitance));
  } else {
    DEA_TRY(ctx, charge_coupled(ctx, o, solid, voltage, charge, capacitance));
  }
  for (size_t k = 0; k < o->mesh->layout->channel_count; k++) {
    o->channel[k] = (struct dea_channel_values){voltage[k], copies * charge[k],
                                                copies * capacitance[k * count + k], NAN};
  }
  return DEA_OK;
}

static void observe_volume(const struct dea_observer *o, size_t pressure, const double *u,
                           double *values, double *weight)
{
  const double copies = (double)dea_layout_sector_copies(&o->mesh->sector);
  if (o->pressures[pressure] != NULL) {
    values[DEA_OBSERVED_PRESSURE] = dea_pressure_at_Pa(o->pressures[pressure], u);
    values[DEA_OBSERVED_VOLUME] = copies * dea_pressure_volume_m3(o->pressures[pressure], u);
  }
  if (o->pressures[pressure] != NULL && weight != NULL) {
    dea_pressure_volume_slope(o->pressures[pressure], u, weight);
    for (size_t i = 0; i < 3 * o->mesh->grid->node_count; i++) {
      weight[i] *= copies;
    }
  }
}

/* A point's displacement, or of a radius what that is outwards, and its stretch. */
static void observe_point(const struct dea_observer *o, size_t monitor, const double *u,
                          double *values)
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[monitor];
  double v[3], along[3];
  displacement_at(o->mesh, &o->probes[monitor][0], u, v);
  if (m->kind == DEA_MONITOR_POINT) {
    memcpy(values + DEA_OBSERVED_X, v, sizeof v);
    return;
  }
  const double length = radius_of(m, along);
  values[DEA_OBSERVED_OUTWARDS] = v[0] * along[0] + v[1] * along[1];
  values[DEA_OBSERVED_STRETCH] = 1 + values[DEA_OBSERVED_OUTWARDS] / length;
}

/* How a point's displacement along an axis, or a line's stretch, changes with the displacements of
 * the probes in the sector, along [probes][3]. Returns how many. */
static size_t ways_of_probes(const struct dea_observer *o, const double *u, size_t monitor,
                             enum dea_observed motion, double along[2][3])
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[monitor];
  const struct probe *probes = o->probes[monitor];
  const size_t count = m->kind == DEA_MONITOR_LINE ? 2 : 1;
  double now[3], flat = 0, size = 0;
  if (count == 2) {
    flat = line_between(o->mesh, m, probes, u, now);
    size = sqrt(dea_dot(now, now));
  }
  for (size_t p = 0; p < count; p++) {
    for (int i = 0; i < 3; i++) {
      along[p][i] = count == 1 ? i == (int)(motion - DEA_OBSERVED_X)
                               : (p == 0 ? -1 : 1) * now[i] / (size * flat);
    }
    if (m->kind == DEA_MONITOR_RADIUS) {
      const double length = radius_of(m, along[p]);
      for (int i = 0; i < 3; i++) {
        along[p][i] /= motion == DEA_OBSERVED_STRETCH ? length : 1;
      }
    }
    if (probes[p].copy > 0) {
      const struct dea_motion back = back_to_sector(o->mesh, probes[p].copy);
      dea_layout_sector_turn(&back, along[p], along[p]);
    }
  }
  return count;
}

static void gradient_of_probes(const struct dea_observer *o, const double *u, size_t monitor,
                               enum dea_observed motion, double *weight)
{
  double along[2][3];
  const size_t count = ways_of_probes(o, u, monitor, motion, along);
  for (size_t p = 0; p < count; p++) {
    const struct probe *probe = &o->probes[monitor][p];
    for (int i = 0; i < 2 * 3 * probe->count; i++) {
      weight[3 * probe->node[i % 2][i / 6] + i / 2 % 3] +=
          0.5 * probe->weight[i / 6] * along[p][i / 2 % 3];
    }
  }
}

/* All that a monitor shows into values, and into weight, 0 before, how `motion` changes with each
 * displacement; NULL: not wanted. */
static void observe_monitor(struct dea_observer *o, struct dea_solid *solid, size_t i,
                            double *values, enum dea_observed motion, double *weight)
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[i];
  const double *u = dea_solid_displacement(solid);
  double now[3];
  nothing_observed(values);
  switch (m->kind) {
  case DEA_MONITOR_POINT:
  case DEA_MONITOR_RADIUS:
    observe_point(o, i, u, values);
    break;
  case DEA_MONITOR_LINE:
    values[DEA_OBSERVED_STRETCH] = 1 / line_between(o->mesh, m, o->probes[i], u, now);
    values[DEA_OBSERVED_STRETCH] *= sqrt(dea_dot(now, now));
    break;
  case DEA_MONITOR_REGION:
    observe_region(o->mesh, m, u, values, motion, weight);
    return;
  case DEA_MONITOR_BODY:
    observe_body(o->mesh, solid, m->body, values);
    if (weight != NULL) { // turns are unknowns times the length
      const struct dea_solid_body *body = &solid->problem.bodies[m->body];
      weight[3 * body->node + (size_t)motion] =
          motion < DEA_OBSERVED_TURN_X ? 1 : 1 / body->length_m;
    }
    return;
  case DEA_MONITOR_VOLUME:
    observe_volume(o, m->pressure, u, values, weight);
    return;
  case DEA_MONITOR_CONTACT: // forces have no slope
    observe_contact(o, m->contact, u, values);
    return;
  }
  if (weight != NULL) {
    gradient_of_probes(o, u, i, motion, weight);
  }
}

bool dea_observer_gradient(struct dea_observer *o, struct dea_solid *solid, size_t monitor,
                           enum dea_observed motion, double *weight)
{
  double values[DEA_OBSERVED_COUNT];
  const bool known = dea_observed_has(o->mesh->layout->monitors[monitor].kind, motion) &&
                     (motion < DEA_OBSERVED_FORCE_X || motion == DEA_OBSERVED_VOLUME);
  memset(weight, 0, solid->problem.dofs * sizeof *weight);
  if (known) {
    observe_monitor(o, solid, monitor, values, motion, weight);
  }
  return known;
}

dea_status dea_observer_differentiate(struct dea_context *ctx, struct dea_observer *o,
                                      struct dea_solid *solid, const double *const v[2],
                                      double (*out)[2])
{
  const size_t count = 3 * o->mesh->grid->node_count;
  double *weight = dea_solid_alloc(ctx, solid->problem.dofs, sizeof *weight);
  DEA_TRY_MEMORY(weight != NULL);
  for (size_t k = 0; k < o->mesh->layout->monitor_count * DEA_OBSERVED_MOTIONS; k++) {
    const bool known = dea_observer_gradient(o, solid, k / DEA_OBSERVED_MOTIONS,
                                             (enum dea_observed)(k % DEA_OBSERVED_MOTIONS), weight);
    out[k][0] = out[k][1] = known ? 0 : NAN;
    for (size_t i = 0; i < count && known; i++) {
      out[k][0] += weight[i] * v[0][i];
      out[k][1] += weight[i] * v[1][i];
    }
  }
  dea_free(ctx, weight);
  return DEA_OK;
}

size_t dea_observer_probes(const struct dea_observer *o, struct dea_solid *solid, size_t monitor,
                           enum dea_observed motion, struct dea_recover_probe out[2])
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[monitor];
  double along[2][3];
  if (m->kind != DEA_MONITOR_POINT && m->kind != DEA_MONITOR_LINE) {
    return 0;
  }
  const size_t count = ways_of_probes(o, dea_solid_displacement(solid), monitor, motion, along);
  for (size_t p = 0; p < count; p++) {
    const struct probe *probe = &o->probes[monitor][p];
    out[p] = (struct dea_recover_probe){.element = probe->element,
                                        .at = {probe->at[0], probe->at[1]},
                                        .along = {along[p][0], along[p][1], along[p][2]}};
  }
  return count;
}

bool dea_observer_force_direction(const struct dea_observer *o, const struct dea_solid *solid,
                                  size_t monitor, enum dea_observed motion, double *direction)
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[monitor];
  const size_t component = (size_t)(motion - DEA_OBSERVED_FORCE_X);
  if (m->kind != DEA_MONITOR_BODY || motion < DEA_OBSERVED_FORCE_X) {
    return false;
  }
  if (((dea_layout_sector_keeps(&o->mesh->sector) >> component) & 1) == 0) {
    return true; // it is 0
  }
  const bool known = dea_solid_body_force_direction(solid, m->body, component, direction);
  for (size_t i = 0; i < solid->problem.dofs && known; i++) {
    direction[i] *= (double)dea_layout_sector_copies(&o->mesh->sector);
  }
  return known;
}

// Columns ---------------------------------------------------------------------------------------

/* The monitor of a disc that is a column; SIZE_MAX: none is. */
static size_t of_column(const struct dea_observer *o, int column)
{
  const struct dea_layout *l = o->mesh->layout;
  for (size_t i = 0; i < l->disc_monitor_count; i++) {
    if (o->of_disc[i].column == column) {
      return l->monitor_count + i;
    }
  }
  return SIZE_MAX;
}

double dea_observer_column(const struct dea_observer *o, int column, const double *u)
{
  double values[DEA_OBSERVED_COUNT];
  const size_t i = of_column(o, column);
  if (i == SIZE_MAX) {
    return NAN;
  }
  observe_point(o, i, u, values);
  return values[o->of_disc[i - o->mesh->layout->monitor_count].motion];
}

void dea_observer_describe(const struct dea_observer *o, const double *u,
                           struct dea_load_point *out)
{
  for (size_t i = 0; i < o->mesh->layout->disc_monitor_count; i++) {
    const int column = o->of_disc[i].column;
    dea_point_set(out, column, dea_observer_column(o, column, u));
  }
}

bool dea_observer_column_gradient(struct dea_observer *o, struct dea_solid *solid, int column,
                                  double *weight)
{
  const size_t i = of_column(o, column);
  return i != SIZE_MAX &&
         dea_observer_gradient(o, solid, i, o->of_disc[i - o->mesh->layout->monitor_count].motion,
                               weight);
}

dea_status dea_observer_errors(struct dea_context *ctx, struct dea_observer *o,
                               struct dea_solid *solid, struct dea_load_point *out)
{
  enum { MOST = 4 };
  const size_t count = o->mesh->layout->disc_monitor_count, dofs = solid->problem.dofs;
  struct dea_recover_quantity each[MOST];
  double error[MOST];
  int columns[MOST];
  size_t asked = 0;
  if (count == 0 || !dea_load_point_trusted(out) || out->voltage_V == 0) {
    return DEA_OK;
  }
  double *weights = dea_solid_alloc(ctx, MOST * dofs, sizeof *weights);
  DEA_TRY_MEMORY(weights != NULL);
  for (size_t i = 0; i < count && asked < MOST; i++) {
    if (o->of_disc[i].error_column >= 0) {
      each[asked] = (struct dea_recover_quantity){.z = weights + asked * dofs};
      dea_observer_column_gradient(o, solid, o->of_disc[i].column, weights + asked * dofs);
      columns[asked++] = o->of_disc[i].error_column;
    }
  }
  const dea_status status = dea_solid_errors(ctx, solid, each, asked, error, NULL);
  for (size_t k = 0; k < asked && status == DEA_OK; k++) {
    dea_point_set(out, columns[k], error[k]);
  }
  dea_free(ctx, weights);
  return status;
}

dea_status dea_observer_read(struct dea_context *ctx, struct dea_observer *o,
                             struct dea_solid *solid, struct dea_observation *out)
{
  const struct dea_layout *l = o->mesh->layout;
  for (size_t i = 0; i < l->body_count; i++) {
    nothing_observed(o->body[i]);
    observe_body(o->mesh, solid, i, o->body[i]);
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    observe_monitor(o, solid, i, o->monitor[i], DEA_OBSERVED_COUNT, NULL);
  }
  DEA_TRY(ctx, observe_channels(ctx, o, solid));
  *out = (struct dea_observation){.monitor_count = l->monitor_count,
                                  .body_count = l->body_count,
                                  .channel_count = l->channel_count,
                                  .monitor = (const double(*)[DEA_OBSERVED_COUNT])o->monitor,
                                  .body = (const double(*)[DEA_OBSERVED_COUNT])o->body,
                                  .channel = o->channel};
  return DEA_OK;
}

void dea_observer_set_currents(struct dea_observer *o, const double *current_A)
{
  for (size_t k = 0; k < o->mesh->layout->channel_count; k++) {
    o->channel[k].current_A = current_A[k];
  }
}
