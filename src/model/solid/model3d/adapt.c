/* Estimated errors of the model "3d", and a model whose mesh is made by them (docs/theory/trust.md,
 * "Adaptive refinement"). */
#include "model/make.h"
#include "model/solid/model3d/solid_fields.h"
#include "model/solid/model3d/solid_model.h"

#include <math.h>
#include <string.h>

// Estimated errors -------------------------------------------------------------------------------

/* Whether the mesh is all that a point's error is of; a membrane has one too. */
static bool has_error(const struct dea_load_point *point)
{
  struct dea_load_point solid = *point;
  solid.own_flags &= ~(1u << DEA_FLAG_PREVIEW);
  return dea_load_point_trusted(&solid);
}

/* Of the main motion of a monitor at a point without a doubt; otherwise, and of a body that is held
 * along it, NAN. part: of each element, may be NULL. */
static dea_status find_error(struct dea_context *ctx, struct dea_model *model, size_t monitor,
                             const double *values, double *error, double *part)
{
  const struct dea_layout_monitor *m = &model->layout->monitors[monitor];
  enum dea_observed motion = dea_observed_main(values);
  *error = NAN;
  if (m->kind == DEA_MONITOR_BODY) {
    size_t node = model->bodies[m->body].node;
    if ((model->solid->problem.held[3 * node + (size_t)motion]) != 0) {
      return DEA_OK;
    }
  }
  double *weight = dea_solid_alloc(ctx, model->solid->problem.dofs, sizeof *weight);
  DEA_TRY_MEMORY(weight != NULL);
  dea_observer_gradient(model->observer, model->solid, monitor, motion, weight);
  struct dea_recover_quantity one = {.z = weight};
  one.probe_count = dea_observer_probes(model->observer, model->solid, monitor, motion, one.probes);
  dea_status status = dea_solid_errors(ctx, model->solid, &one, 1, error, part);
  dea_free(ctx, weight);
  return status == DEA_E_DOMAIN ? DEA_OK : status; // at the end of a law none is known
}

dea_status dea_solid_model_errors(struct dea_context *ctx, struct dea_model *model, double *error)
{
  struct dea_load_point point;
  struct dea_observation seen;
  DEA_TRY(ctx, dea_solid_model_report(ctx, model, model->at.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
  for (size_t i = 0; i < seen.monitor_count; i++) {
    error[i] = NAN;
    if (has_error(&point)) {
      DEA_TRY(ctx, find_error(ctx, model, i, seen.monitor[i], &error[i], NULL));
    }
  }
  return DEA_OK;
}

// Sizes ------------------------------------------------------------------------------------------

/* Of the ratio of sizes between one mesh and the next: estimates do not see further. */
static const double finest = 0.35, coarsest = 1.4;
static const double share = 0.8; // of the error wanted: meshes do not come out as asked for

/* Area and middle of an element of the plane mesh by its corners. */
static double area_of(const struct dea_plane_mesh *plane, size_t q, double middle[2])
{
  int line = plane->order + 1;
  const int corner[4] = {0, line - 1, line * line - 1, line * (line - 1)};
  const double *x[4];
  double area = 0;
  middle[0] = middle[1] = 0;
  for (int k = 0; k < 4; k++) {
    x[k] = plane->x + 2 * plane->quads[q * (size_t)(line * line) + (size_t)corner[k]];
    middle[0] += 0.25 * x[k][0];
    middle[1] += 0.25 * x[k][1];
  }
  for (int k = 0; k < 4; k++) {
    const double *a = x[k], *b = x[(k + 1) % 4];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

/* What the elements above an element of the plane mesh add together: each layer of a ply has those
 * of the plane mesh in their order. */
static void gather(const struct dea_layout_mesh *mesh, const double *part, double *sum)
{
  const struct dea_plane_mesh *plane = mesh->plane;
  for (size_t e = 0; e < mesh->grid->element_count;) {
    const size_t ply = (size_t)mesh->grid->ply[e];
    for (size_t q = 0; q < plane->quad_count; q++) {
      if (mesh->present[(size_t)plane->region[q] * mesh->layout->ply_count + ply]) {
        sum[q] += fabs(part[e++]);
      }
    }
  }
}

/* Sizes of the next mesh. part: [element_count], as dea_recover_errors; wanted: error that it
 * should have, > 0. at: [quad_count of the plane mesh] x, y, size [m]. */
static dea_status find_sizes(struct dea_arena *memory, const struct dea_layout_mesh *mesh,
                             const double *part, double wanted, double (*at)[3])
{
  size_t count = mesh->plane->quad_count;
  double *sum = dea_arena_alloc(memory, count, sizeof *sum), roots = 0;
  DEA_TRY_STATUS(dea_arena_status(memory));
  gather(mesh, part, sum);
  for (size_t q = 0; q < count; q++) {
    roots += sqrt(sum[q]);
  }
  for (size_t q = 0; q < count; q++) {
    double ratio = sqrt(share * wanted / (roots * sqrt(sum[q])));
    double size = sqrt(area_of(mesh->plane, q, at[q]));
    at[q][2] = size * fmin(coarsest, fmax(finest, ratio)); // coarsest where the sum is 0
  }
  return DEA_OK;
}

// Adaptive refinement ----------------------------------------------------------------------------

/* One mesh after the other, each finer where the error of the last one came from. */
struct adaptation {
  struct dea_arena memory; // of sizes and errors
  const struct dea_device *device;
  struct dea_model_settings settings; // with the sizes of the present mesh
  size_t monitor;                     // of the layout
  struct dea_adapt_pass *pass;        // [settings.adapt.passes], owned
  size_t count;
  double (*next)[3]; // [next_count] sizes of the next mesh
  size_t next_count;
};

static dea_status build(struct dea_context *ctx, const struct dea_device *device,
                        const struct dea_model_settings *settings, struct dea_model **out)
{
  return DEA_CHAIN(ctx, dea_model_build(ctx, sizeof **out, device, settings,
                                        dea_solid_model_prepare, dea_solid_model_destroy, out));
}

/* The error on a mesh at the voltage, and the sizes of the next one. */
static dea_status estimate_mesh_error(struct dea_context *ctx, struct adaptation *a,
                                      struct dea_model *model, struct dea_adapt_pass *pass)
{
  struct dea_load_point point;
  struct dea_observation seen;
  const struct dea_grid *grid = model->mesh.grid;
  double *part = dea_arena_alloc(&a->memory, grid->element_count, sizeof *part);
  a->next_count = model->mesh.plane->quad_count;
  a->next = dea_arena_alloc(&a->memory, a->next_count, sizeof *a->next);
  DEA_TRY(ctx, dea_solid_allreduce(ctx, dea_arena_status(&a->memory)));
  DEA_TRY(ctx, dea_solid_model_solve(ctx, model, a->settings.adapt.voltage_V, &point));
  DEA_TRY(ctx, dea_observer_read(ctx, model->observer, model->solid, &seen));
  const double *values = seen.monitor[a->monitor];
  enum dea_observed motion = dea_observed_main(values);
  bool ratio = motion == DEA_OBSERVED_STRETCH || motion == DEA_OBSERVED_AREA_STRETCH;
  *pass = (struct dea_adapt_pass){.elements = grid->element_count,
                                  .unknowns = 3 * grid->node_count,
                                  .value = values[motion],
                                  .error = NAN};
  if (has_error(&point)) {
    DEA_TRY(ctx, find_error(ctx, model, a->monitor, values, &pass->error, part));
  }
  double wanted = a->settings.adapt.tolerance * fabs(pass->value - (ratio ? 1 : 0));
  if (!(wanted > 0) || isnan(pass->error)) {
    pass->error = NAN; // of what does not move, too
    return DEA_OK;
  }
  pass->within = pass->error <= wanted;
  return DEA_CHAIN(ctx, find_sizes(&a->memory, &model->mesh, part, wanted, a->next));
}

static dea_status find_monitor(struct dea_context *ctx, struct adaptation *a)
{
  const struct dea_layout *l = a->device->layout;
  const char *name = a->settings.adapt.monitor;
  while (a->monitor < l->monitor_count && strcmp(l->monitors[a->monitor].name, name) != 0) {
    a->monitor++;
  }
  return a->monitor < l->monitor_count
             ? DEA_OK
             : dea_fail(ctx, DEA_E_DESIGN, "compute.solid.adapt: there is no monitor '%s'", name);
}

/* Where the error of a mesh is not known the last one is as good as any. */
static dea_status report_end(struct dea_context *ctx, const struct adaptation *a)
{
  const struct dea_adapt_pass *last = &a->pass[a->count - 1];
  if (!isnan(last->error) && last->within) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         isnan(last->error)
                             ? "model 3d: no error of the monitor '%s' is known at %.4g kV: its "
                               "mesh stays as it is"
                             : "model 3d: the error of the monitor '%s' at %.4g kV is not yet that "
                               "of compute.solid.adapt.tolerance (compute.solid.adapt.passes)",
                         a->settings.adapt.monitor, 1e-3 * a->settings.adapt.voltage_V);
}

/* To the mesh that is exact enough; *model: on it, at rest. */
static dea_status adapt(struct dea_context *ctx, struct adaptation *a, struct dea_model **model)
{
  size_t most = (size_t)a->settings.adapt.passes;
  a->pass = dea_solid_alloc(ctx, most, sizeof *a->pass);
  DEA_TRY_MEMORY(a->pass != NULL);
  for (bool on = true; on;) {
    struct dea_adapt_pass *pass = &a->pass[a->count];
    DEA_TRY(ctx, estimate_mesh_error(ctx, a, *model, pass));
    a->count++;
    on = a->count < most && !pass->within && !isnan(pass->error);
    if (on) {
      a->settings.sizes = (const double(*)[3])a->next;
      a->settings.size_count = a->next_count;
    }
    dea_solid_model_destroy(ctx, *model);
    *model = NULL;
    DEA_TRY(ctx, build(ctx, a->device, &a->settings, model)); // the last one too: to be at rest
  }
  return DEA_CHAIN(ctx, report_end(ctx, a));
}

dea_status dea_solid_model_create(struct dea_context *ctx, const struct dea_device *device,
                                  const struct dea_model_settings *settings, struct dea_model **out)
{
  static const struct dea_model_settings usual = {0};
  struct adaptation a = {
      .memory = {.ctx = ctx}, .device = device, .settings = settings != NULL ? *settings : usual};
  bool asked = a.settings.adapt.monitor != NULL;
  *out = NULL;
  dea_status status = asked ? find_monitor(ctx, &a) : DEA_OK;
  status = status == DEA_OK ? build(ctx, device, &a.settings, out) : status;
  if (asked && status == DEA_OK) {
    status = adapt(ctx, &a, out);
  }
  if (status == DEA_OK) {
    (*out)->passes = a.pass;
    (*out)->pass_count = a.count;
    a.pass = NULL;
  } else if (*out != NULL) {
    dea_solid_model_destroy(ctx, *out);
    *out = NULL;
  }
  dea_free(ctx, a.pass);
  dea_arena_free(&a.memory);
  return DEA_CHAIN(ctx, status);
}
