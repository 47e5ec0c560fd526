#include "model/solid/model3d/solid_observe.h"

#include "base/quadrature.h"
#include "model/solid/assembly/channels.h"
#include "model/solid/assembly/film_state.h"
#include "model/solid/assembly/problem.h"
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
  struct dea_arena memory;
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

/* Nodal basis of a quadrilateral at local coordinates, and its slopes; [(order + 1)^2]. */
static void basis(int order, const double at[2], double *value, double (*slope)[2])
{
  double places[DEA_HEX_LINE_MAX], v[2][DEA_HEX_LINE_MAX], d[2][DEA_HEX_LINE_MAX];
  size_t line = (size_t)order + 1;
  dea_lobatto_nodes((size_t)order, places);
  for (int k = 0; k < 2; k++) {
    dea_lagrange(line, places, at[k], v[k], d[k]);
  }
  for (size_t j = 0; j < line; j++) {
    for (size_t i = 0; i < line; i++) {
      value[j * line + i] = v[0][i] * v[1][j];
      slope[j * line + i][0] = d[0][i] * v[1][j];
      slope[j * line + i][1] = v[0][i] * d[1][j];
    }
  }
}

/* Local coordinates of a place in a quadrilateral of nodes [(order + 1)^2] by Newton's method,
 * which goes far outside on its way in a narrow one along an arc; false where it is not in it. */
static bool locate(const struct dea_grid *grid, const int *nodes, const double x_m[2], double at[2])
{
  double value[PLANE_MAX], slope[PLANE_MAX][2];
  int count = (grid->order + 1) * (grid->order + 1);
  at[0] = at[1] = 0;
  for (int i = 0; i < 20; i++) {
    double r[2] = {x_m[0], x_m[1]}, J[4] = {0};
    basis(grid->order, at, value, slope);
    for (int n = 0; n < count; n++) {
      const double *X = grid->X + 3 * nodes[n];
      for (int k = 0; k < 2; k++) {
        r[k] -= value[n] * X[k];
        J[2 * k] += slope[n][0] * X[k];
        J[2 * k + 1] += slope[n][1] * X[k];
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

/* Lower and upper nodes of an element in the plane. */
static void faces(const struct dea_grid *grid, size_t e, const int **lower, const int **upper)
{
  int per = (grid->order + 1) * (grid->order + 1);
  *lower = grid->nodes + e * DEA_HEX_NODES_MAX;
  *upper = *lower + (grid->levels[e] - 1) * per;
}

/* The elements of a ply: those of its lowest layer, [first, end), and how many further in the grid
 * the highest ones above them are. */
struct layers {
  size_t first, end, to_highest;
};

static struct layers layers_of(const struct dea_grid *grid, size_t ply)
{
  struct layers out = {0};
  size_t count = 0, layer = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    if ((size_t)grid->ply[e] == ply) {
      out.first = count == 0 ? e : out.first;
      const int *first = grid->nodes + out.first * DEA_HEX_NODES_MAX,
                *own = grid->nodes + e * DEA_HEX_NODES_MAX;
      const int last = (grid->order + 1) * (grid->order + 1) - 1;
      const bool above = count > 0 && grid->column[own[0]] == grid->column[first[0]] &&
                         grid->column[own[last]] == grid->column[first[last]];
      layer = above && layer == 0 ? count : layer;
      count++;
    }
  }
  layer = layer == 0 ? count : layer;
  out.end = out.first + layer;
  out.to_highest = count - layer;
  return out;
}

/* Nodes of the faces of a ply below and above an element of its lowest layer. */
static void ply_faces(const struct dea_grid *grid, const struct layers *layers, size_t e,
                      const int *face[2])
{
  const int *own;
  faces(grid, e, &face[0], &own);
  faces(grid, e + layers->to_highest, &own, &face[1]);
}

/* From a copy into the sector: a mirror is its own inverse, a rotation goes back. */
static struct dea_motion back_to_sector(const struct dea_layout_mesh *mesh, size_t copy)
{
  struct dea_motion out = dea_layout_sector_copy(&mesh->sector, copy);
  out.sine = out.mirrored ? out.sine : -out.sine;
  return out;
}

/* How near a layer of nodes comes to what is wanted below (side 0) or above: of the middle plane
 * the nearest ones to both sides, or itself. */
static double nearness(enum dea_monitor_level level, int side, double z_m, double middle_m,
                       double near_m)
{
  const bool here = side == 0 ? z_m <= middle_m + near_m : z_m >= middle_m - near_m;
  switch (level) {
  case DEA_LEVEL_TOP:
    return z_m;
  case DEA_LEVEL_MIDDLE:
    return here ? -fabs(z_m - middle_m) : -INFINITY;
  default:
    return side == 0 ? -z_m : z_m;
  }
}

/* In the sector itself. */
static bool find_in_sector(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                           const double x_m[2], struct probe *out)
{
  const struct dea_grid *grid = mesh->grid;
  const double *face_m = mesh->face_m[m->ply], middle_m = 0.5 * (face_m[0] + face_m[1]);
  const double near_m = 1e-6 * mesh->layout->plies[m->ply].thickness_m;
  double best[2] = {-INFINITY, -INFINITY};
  out->count = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *face[2], per = (grid->order + 1) * (grid->order + 1);
    double at[2], slope[PLANE_MAX][2];
    faces(grid, e, &face[0], &face[1]);
    if ((size_t)grid->ply[e] != m->ply || !could_be_in(grid, face[0], x_m) ||
        !locate(grid, face[0], x_m, at)) {
      continue;
    }
    for (int k = 0; k < 2 * grid->levels[e]; k++) { // those on the side of one found are no nearer
      const int *layer = face[0] + k / 2 * per;
      const double near = nearness(m->level, k % 2, grid->X[3 * layer[0] + 2], middle_m, near_m);
      if (near > best[k % 2]) { // elements above each other have the same places
        best[k % 2] = near;
        out->count = per;
        out->element = e;
        memcpy(out->at, at, sizeof out->at);
        memcpy(out->node[k % 2], layer, (size_t)per * sizeof *layer);
        basis(grid->order, at, out->weight, slope);
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

static dea_status find_probes(struct dea_context *ctx, struct dea_observer *o)
{
  const struct dea_layout *l = o->mesh->layout;
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

static void find_columns(const struct dea_context *ctx, struct dea_observer *o)
{
  const struct dea_layout *l = o->mesh->layout;
  for (size_t i = 0; i < l->disc_monitor_count; i++) {
    struct of_disc *of = &o->of_disc[i];
    of->column = dea_observed_of_disc(&l->monitors[l->monitor_count + i], &of->motion);
    of->error_column = dea_point_error_column(ctx, of->column);
  }
}

dea_status dea_observer_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                               struct dea_pressure *const *pressures,
                               struct dea_contact *const *contacts, struct dea_observer **out)
{
  const struct dea_layout *l = mesh->layout;
  struct dea_observer *o = dea_alloc(ctx, 1, sizeof *o);
  *out = NULL;
  DEA_TRY_MEMORY(o != NULL);
  *o = (struct dea_observer){
      .memory = {.ctx = ctx}, .mesh = mesh, .pressures = pressures, .contacts = contacts};
  o->count = l->monitor_count + l->disc_monitor_count;
  o->of_disc = dea_arena_alloc(&o->memory, l->disc_monitor_count, sizeof *o->of_disc);
  o->probes = dea_arena_alloc(&o->memory, o->count + 1, sizeof *o->probes);
  o->monitor = dea_arena_alloc(&o->memory, l->monitor_count + 1, sizeof *o->monitor);
  o->body = dea_arena_alloc(&o->memory, l->body_count + 1, sizeof *o->body);
  o->channel = dea_arena_alloc(&o->memory, l->channel_count, sizeof *o->channel);
  o->channel_count = l->channel_count > 1 ? l->channel_count : 2; // a solid has one beside ground
  o->work = dea_arena_alloc(&o->memory, (o->channel_count + 2) * o->channel_count, sizeof(double));
  dea_status status = dea_arena_status(&o->memory);
  if (status == DEA_OK) {
    find_columns(ctx, o);
    status = find_probes(ctx, o);
  }
  if (status != DEA_OK) {
    dea_observer_destroy(ctx, o);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = o;
  return DEA_OK;
}

void dea_observer_destroy(struct dea_context *ctx, struct dea_observer *o)
{
  if (o != NULL) {
    dea_arena_free(&o->memory);
    dea_free(ctx, o);
  }
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

static double length_of(const double v[3])
{
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
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

/* Adds displacement v, lengths of the two tangents and area by their products C (11 22 12) times
 * dA: their mean over the copies of the sector. */
static void add_copies(const struct dea_layout_mesh *mesh, const double v[3], const double C[3],
                       double dA, double sum[6])
{
  size_t copies = dea_layout_sector_copies(&mesh->sector);
  for (size_t k = 0; k < copies; k++) {
    double values[6] = {v[0], v[1], v[2], sqrt(C[0]), sqrt(C[1]), sqrt(C[0] * C[1] - C[2] * C[2])};
    if (k > 0) {
      struct dea_motion copy = dea_layout_sector_copy(&mesh->sector, k);
      struct dea_motion back = back_to_sector(mesh, k);
      dea_layout_sector_turn(&copy, v, values);
      for (int i = 0; i < 2; i++) { // along x and y, as they lie in the sector
        const double axis[2] = {i == 0, i == 1};
        double a[2];
        dea_layout_sector_turn(&back, axis, a);
        values[3 + i] = sqrt(a[0] * a[0] * C[0] + 2 * a[0] * a[1] * C[2] + a[1] * a[1] * C[1]);
      }
    }
    for (int i = 0; i < 6; i++) {
      sum[i] += dA * values[i] / (double)copies;
    }
  }
}

/* Means over the middle surface, halfway between the faces of the ply whatever number of elements
 * it has: of displacements, of the lengths of its two tangents, of its area. */
static void observe_region(const struct dea_layout_mesh *mesh, const struct dea_layout_monitor *m,
                           const double *u, double *out)
{
  const struct dea_grid *grid = mesh->grid;
  size_t points = (size_t)grid->order + 1;
  double place[DEA_HEX_LINE_MAX], weight[DEA_HEX_LINE_MAX], sum[6] = {0}, area = 0;
  int per = (grid->order + 1) * (grid->order + 1);
  dea_gauss_rule(points, place, weight);
  const struct layers layers = layers_of(grid, m->ply);
  for (size_t e = layers.first; e < layers.end; e++) {
    if (!dea_layout_mesh_within(mesh, e, m->region)) {
      continue;
    }
    const int *face[2];
    ply_faces(grid, &layers, e, face);
    for (size_t p = 0; p < points * points; p++) {
      const double at[2] = {place[p % points], place[p / points]};
      double value[PLANE_MAX], slope[PLANE_MAX][2], X[3][2] = {{0}}, x[3][2] = {{0}}, v[3] = {0};
      basis(grid->order, at, value, slope);
      for (int n = 0; n < per; n++) {
        for (int i = 0; i < 3; i++) {
          double w = 0.5 * (u[3 * face[0][n] + i] + u[3 * face[1][n] + i]);
          double place_m = i < 2 ? grid->X[3 * face[0][n] + i] : 0;
          v[i] += value[n] * w;
          for (int k = 0; k < 2; k++) {
            X[i][k] += slope[n][k] * place_m;
            x[i][k] += slope[n][k] * (place_m + w);
          }
        }
      }
      double det = X[0][0] * X[1][1] - X[0][1] * X[1][0], F[3][2], c[2] = {0}, mixed = 0;
      for (int i = 0; i < 3; i++) { // dx/dX
        F[i][0] = (x[i][0] * X[1][1] - x[i][1] * X[1][0]) / det;
        F[i][1] = (x[i][1] * X[0][0] - x[i][0] * X[0][1]) / det;
        c[0] += F[i][0] * F[i][0];
        c[1] += F[i][1] * F[i][1];
        mixed += F[i][0] * F[i][1];
      }
      double dA = det * weight[p % points] * weight[p / points];
      const double C[3] = {c[0], c[1], mixed};
      area += dA;
      add_copies(mesh, v, C, dA, sum);
    }
  }
  for (int i = 0; i < 3; i++) {
    out[DEA_OBSERVED_X + i] = sum[i] / area;
    out[DEA_OBSERVED_STRETCH_X + i] = sum[3 + i] / area;
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
    values[DEA_OBSERVED_CONTACT_FORCE] = length_of(force_N);
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
  DEA_TRY(ctx, dea_solid_capacitance(ctx, solid, &total_F));
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
                           double *values)
{
  if (o->pressures[pressure] != NULL) {
    values[DEA_OBSERVED_PRESSURE] = dea_pressure_at_Pa(o->pressures[pressure], u);
    values[DEA_OBSERVED_VOLUME] = (double)dea_layout_sector_copies(&o->mesh->sector) *
                                  dea_pressure_volume_m3(o->pressures[pressure], u);
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
  struct dea_solid_quantity each[MOST];
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
      each[asked] = (struct dea_solid_quantity){.weight = weights + asked * dofs};
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

static void observe_monitors(struct dea_observer *o, struct dea_solid *solid)
{
  const struct dea_layout *l = o->mesh->layout;
  const double *u = dea_solid_displacement(solid);
  for (size_t i = 0; i < l->body_count; i++) {
    nothing_observed(o->body[i]);
    observe_body(o->mesh, solid, i, o->body[i]);
  }
  for (size_t i = 0; i < l->monitor_count; i++) {
    const struct dea_layout_monitor *m = &l->monitors[i];
    double *values = o->monitor[i], now[3];
    nothing_observed(values);
    switch (m->kind) {
    case DEA_MONITOR_POINT:
    case DEA_MONITOR_RADIUS:
      observe_point(o, i, u, values);
      break;
    case DEA_MONITOR_LINE:
      values[DEA_OBSERVED_STRETCH] = 1 / line_between(o->mesh, m, o->probes[i], u, now);
      values[DEA_OBSERVED_STRETCH] *= length_of(now);
      break;
    case DEA_MONITOR_REGION:
      observe_region(o->mesh, m, u, values);
      break;
    case DEA_MONITOR_BODY:
      memcpy(values, o->body[m->body], sizeof o->body[m->body]);
      break;
    case DEA_MONITOR_VOLUME:
      observe_volume(o, m->pressure, u, values);
      break;
    case DEA_MONITOR_CONTACT:
      observe_contact(o, m->contact, u, values);
      break;
    }
  }
}

dea_status dea_observer_read(struct dea_context *ctx, struct dea_observer *o,
                             struct dea_solid *solid, struct dea_observation *out)
{
  const struct dea_layout *l = o->mesh->layout;
  observe_monitors(o, solid);
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

/* By a difference over a motion as small as rounding lets it be: most of them are linear. */
dea_status dea_observer_differentiate(struct dea_context *ctx, struct dea_observer *o,
                                      struct dea_solid *solid, const double *v, double *out)
{
  static const double little = 1e-5; // of the size of the mesh
  const struct dea_grid *grid = o->mesh->grid;
  size_t count = 3 * grid->node_count;
  double *u = dea_solid_displacement(solid), *keep = dea_solid_alloc(ctx, count, sizeof *keep);
  double most = 0, size = 0;
  DEA_TRY_MEMORY(keep != NULL);
  memcpy(keep, u, count * sizeof *keep);
  for (size_t i = 0; i < count; i++) {
    most = fmax(most, fabs(v[i]));
    size = fmax(size, fabs(grid->X[i]));
  }
  double scale = most > 0 ? little * size / most : 0;
  for (int side = -1; side <= 1; side += 2) {
    for (size_t i = 0; i < count; i++) {
      u[i] = keep[i] + side * scale * v[i];
    }
    observe_monitors(o, solid);
    for (size_t i = 0; i < o->mesh->layout->monitor_count; i++) {
      for (int k = 0; k < DEA_OBSERVED_MOTIONS; k++) {
        double *to = &out[i * DEA_OBSERVED_MOTIONS + (size_t)k], value = o->monitor[i][k];
        *to = side < 0 ? -value : scale > 0 ? (*to + value) / (2 * scale) : 0 * value;
      }
    }
  }
  memcpy(u, keep, count * sizeof *u);
  dea_free(ctx, keep);
  return DEA_OK;
}

// Gradients --------------------------------------------------------------------------------------

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
    size = length_of(now);
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

/* The nodal basis and its gradients at a point of an element in the plane, its area by local
 * coordinates, and the gradients of the deformed middle surface dx/dX. */
static double slopes_of(const struct dea_grid *grid, const int *const face[2], const double at[2],
                        const double *u, double *value, double (*slope)[2], double F[3][2])
{
  double X[2][2] = {{0}};
  int per = (grid->order + 1) * (grid->order + 1);
  basis(grid->order, at, value, slope);
  for (int n = 0; n < per; n++) {
    for (int i = 0; i < 4; i++) {
      X[i / 2][i % 2] += slope[n][i % 2] * grid->X[3 * face[0][n] + i / 2];
    }
  }
  double det = X[0][0] * X[1][1] - X[0][1] * X[1][0];
  memset(F, 0, 3 * sizeof *F);
  F[0][0] = F[1][1] = 1;
  for (int n = 0; n < per; n++) {
    const double d[2] = {slope[n][0], slope[n][1]};
    slope[n][0] = (d[0] * X[1][1] - d[1] * X[1][0]) / det;
    slope[n][1] = (d[1] * X[0][0] - d[0] * X[0][1]) / det;
    for (int i = 0; i < 6; i++) {
      double w = 0.5 * (u[3 * face[0][n] + i / 2] + u[3 * face[1][n] + i / 2]);
      F[i / 2][i % 2] += slope[n][i % 2] * w;
    }
  }
  return det;
}

/* Adds to the nodes of an element what the area stretch J = sqrt(det C), C = F^T F, at a point of
 * the area dA changes by: dJ = J C^-1 : F^T dF. */
static void add_area_stretch(const int *const face[2], int nodes, double dA, double (*slope)[2],
                             double F[3][2], double *weight)
{
  double C[3] = {0};
  for (int i = 0; i < 3; i++) {
    C[0] += F[i][0] * F[i][0];
    C[1] += F[i][1] * F[i][1];
    C[2] += F[i][0] * F[i][1];
  }
  double J = sqrt(C[0] * C[1] - C[2] * C[2]);
  for (int n = 0; n < nodes; n++) { // C^-1 slope times J
    const double *d = slope[n];
    const double c[2] = {(C[1] * d[0] - C[2] * d[1]) / J, (C[0] * d[1] - C[2] * d[0]) / J};
    for (int i = 0; i < 3; i++) {
      double amount = 0.5 * dA * (F[i][0] * c[0] + F[i][1] * c[1]);
      weight[3 * face[0][n] + i] += amount;
      weight[3 * face[1][n] + i] += amount;
    }
  }
}

/* Adds the same of the length of the tangent along x or y, in the mean over the copies of the
 * sector: of the direction a in the sector d|F a| = F a . dF a / |F a|. */
static void add_tangent(const struct dea_layout_mesh *mesh, bool along_y, const int *const face[2],
                        int nodes, double dA, double (*slope)[2], double F[3][2], double *weight)
{
  const size_t copies = dea_layout_sector_copies(&mesh->sector);
  const double axis[2] = {along_y ? 0 : 1, along_y ? 1 : 0};
  for (size_t k = 0; k < copies; k++) {
    double a[2] = {axis[0], axis[1]}, along[3], size = 0;
    if (k > 0) {
      struct dea_motion back = back_to_sector(mesh, k);
      dea_layout_sector_turn(&back, axis, a);
    }
    for (int i = 0; i < 3; i++) {
      along[i] = F[i][0] * a[0] + F[i][1] * a[1];
      size += along[i] * along[i];
    }
    for (int n = 0; n < nodes; n++) {
      const double by =
          0.5 * dA * (slope[n][0] * a[0] + slope[n][1] * a[1]) / (sqrt(size) * (double)copies);
      for (int i = 0; i < 3; i++) {
        weight[3 * face[0][n] + i] += by * along[i];
        weight[3 * face[1][n] + i] += by * along[i];
      }
    }
  }
}

/* How much of a displacement of the sector lies along x, y or z in the mean over its copies. */
static void share_of_copies(const struct dea_layout_sector *sector, enum dea_observed motion,
                            double share[3])
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
      share[i] += axis[motion - DEA_OBSERVED_X] / (double)copies;
    }
  }
}

/* Of a region's mean stretch along x or y or area stretch, or of its mean displacement along x, y
 * or z. Returns the area that the means are over. */
static double gradient_of_region(const struct dea_layout_mesh *mesh,
                                 const struct dea_layout_monitor *m, enum dea_observed motion,
                                 const double *u, double *weight)
{
  const struct dea_grid *grid = mesh->grid;
  size_t points = (size_t)grid->order + 1;
  int per = (grid->order + 1) * (grid->order + 1);
  bool shift = motion <= DEA_OBSERVED_Z;
  double place[DEA_HEX_LINE_MAX], part[DEA_HEX_LINE_MAX], share[3], area = 0;
  if (shift) {
    share_of_copies(&mesh->sector, motion, share);
  }
  dea_gauss_rule(points, place, part);
  const struct layers layers = layers_of(grid, m->ply);
  for (size_t e = layers.first; e < layers.end; e++) {
    const int *face[2];
    ply_faces(grid, &layers, e, face);
    for (size_t p = 0; p < points * points && dea_layout_mesh_within(mesh, e, m->region); p++) {
      const double at[2] = {place[p % points], place[p / points]};
      double value[PLANE_MAX], slope[PLANE_MAX][2], F[3][2];
      double dA =
          slopes_of(grid, face, at, u, value, slope, F) * part[p % points] * part[p / points];
      area += dA;
      if (motion == DEA_OBSERVED_AREA_STRETCH) {
        add_area_stretch(face, per, dA, slope, F, weight);
      } else if (!shift) {
        add_tangent(mesh, motion == DEA_OBSERVED_STRETCH_Y, face, per, dA, slope, F, weight);
      }
      for (int i = 0; i < 3 * per && shift; i++) {
        weight[3 * face[0][i / 3] + i % 3] += 0.5 * dA * value[i / 3] * share[i % 3];
        weight[3 * face[1][i / 3] + i % 3] += 0.5 * dA * value[i / 3] * share[i % 3];
      }
    }
  }
  return area;
}

static bool knows_gradient(enum dea_layout_monitor_kind kind, enum dea_observed motion)
{
  const bool shift = motion <= DEA_OBSERVED_Z;
  return kind == DEA_MONITOR_POINT    ? shift
         : kind == DEA_MONITOR_RADIUS ? dea_observed_has(kind, motion)
         : kind == DEA_MONITOR_LINE   ? motion == DEA_OBSERVED_STRETCH
         : kind == DEA_MONITOR_REGION
             ? shift || (motion >= DEA_OBSERVED_STRETCH_X && motion <= DEA_OBSERVED_AREA_STRETCH)
         : kind == DEA_MONITOR_VOLUME ? motion == DEA_OBSERVED_VOLUME
                                      : kind == DEA_MONITOR_BODY && motion <= DEA_OBSERVED_TURN_Z;
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

bool dea_observer_gradient(struct dea_observer *o, struct dea_solid *solid, size_t monitor,
                           enum dea_observed motion, double *weight)
{
  const struct dea_layout_monitor *m = &o->mesh->layout->monitors[monitor];
  size_t count = 3 * o->mesh->grid->node_count;
  memset(weight, 0, count * sizeof *weight);
  if (!knows_gradient(m->kind, motion)) {
    return false;
  }
  switch (m->kind) {
  case DEA_MONITOR_POINT:
  case DEA_MONITOR_LINE:
  case DEA_MONITOR_RADIUS:
    gradient_of_probes(o, dea_solid_displacement(solid), monitor, motion, weight);
    break;
  case DEA_MONITOR_REGION: {
    double area = gradient_of_region(o->mesh, m, motion, dea_solid_displacement(solid), weight);
    for (size_t i = 0; i < count; i++) {
      weight[i] /= area;
    }
    break;
  }
  case DEA_MONITOR_BODY: {
    const struct dea_solid_body *body = &solid->problem.bodies[m->body];
    weight[3 * body->node + (size_t)motion] =
        motion < DEA_OBSERVED_TURN_X ? 1 : 1 / body->length_m; // turns are unknowns times that
    break;
  }
  case DEA_MONITOR_VOLUME:
    if (o->pressures[m->pressure] != NULL) {
      dea_pressure_volume_slope(o->pressures[m->pressure], dea_solid_displacement(solid), weight);
    }
    for (size_t i = 0; i < count; i++) {
      weight[i] *= (double)dea_layout_sector_copies(&o->mesh->sector);
    }
    break;
  case DEA_MONITOR_CONTACT: // forces alone
    break;
  }
  return true;
}
