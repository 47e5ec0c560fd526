/* A solid: creation, what it lends. */
#include "model/solid/assembly/solid.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/mass.h"
#include "model/solid/assembly/potential.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- creation ---- */

/* Sets modulus_Pa, length_m and energy_floor. */
static void find_sizes(struct dea_solid *s)
{
  double squares = 0, extent[3];
  s->modulus_Pa = INFINITY;
  for (size_t e = 0; e < s->grid->element_count; e++) {
    double modulus = dea_constituent_modulus(&s->layers[s->layer[e]]);
    double volume_m3 = dea_solid_volume_of(s, e); // an inverted one: dea_solid_check speaks of it
    squares += modulus * modulus * volume_m3 * volume_m3;
    s->modulus_Pa = fmin(s->modulus_Pa, modulus);
  }
  s->energy_floor = DBL_EPSILON * sqrt(squares);
  s->length_m = INFINITY;
  for (int i = 0; i < 3; i++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t n = 0; n < s->grid->node_count; n++) {
      least = fmin(least, s->grid->X[3 * n + (size_t)i]);
      most = fmax(most, s->grid->X[3 * n + (size_t)i]);
    }
    extent[i] = most - least;
    s->length_m = extent[i] > 0 ? fmin(s->length_m, extent[i]) : s->length_m;
  }
}

static dea_status fill_solid(struct dea_context *ctx, struct dea_solid *s,
                             const struct dea_solid_options *options)
{
  const struct dea_grid *grid = s->grid;
  size_t elements = grid->element_count, pressures = (size_t)s->elements.pressures;
  s->layers = dea_alloc(ctx, options->layer_count, sizeof *s->layers);
  s->layer = dea_alloc(ctx, elements, sizeof *s->layer);
  s->active = dea_alloc(ctx, elements, sizeof *s->active);
  s->kind = dea_alloc(ctx, elements, sizeof *s->kind);
  s->held = dea_alloc(ctx, s->dofs, 1);
  s->u = dea_alloc(ctx, s->dofs, sizeof(double));
  s->trial = dea_alloc(ctx, s->dofs, sizeof(double));
  s->g = dea_alloc(ctx, s->dofs, sizeof(double));
  s->step = dea_alloc(ctx, s->dofs, sizeof(double));
  s->force = dea_alloc(ctx, s->dofs, sizeof(double));
  s->multiplier = dea_alloc(ctx, elements * pressures, sizeof(double));
  s->theta = dea_alloc(ctx, elements * pressures, sizeof(double));
  s->force_goal = dea_alloc(ctx, s->dofs, sizeof(double));
  s->place = dea_alloc(ctx, s->dofs, sizeof(double));
  s->reaction = dea_alloc(ctx, s->dofs, sizeof(double));
  s->drive = dea_alloc(ctx, s->dofs, sizeof(double));
  s->element = dea_alloc(ctx, 1, sizeof *s->element);
  s->piece = dea_alloc(ctx, 1, sizeof *s->piece);
  if (s->layers == NULL || s->layer == NULL || s->kind == NULL || s->active == NULL ||
      s->held == NULL || s->u == NULL || s->trial == NULL || s->g == NULL || s->step == NULL ||
      s->force == NULL || s->multiplier == NULL || s->theta == NULL || s->force_goal == NULL ||
      s->place == NULL || s->reaction == NULL || s->drive == NULL || s->element == NULL ||
      s->piece == NULL) {
    return DEA_E_MEMORY;
  }
  s->layer_count = options->layer_count;
  memcpy(s->layers, options->layers, options->layer_count * sizeof *s->layers);
  for (size_t e = 0; e < elements; e++) {
    int region = grid->region[e], ply = grid->ply[e];
    s->layer[e] = options->layer_of != NULL ? options->layer_of(options->self, region, ply) : 0;
    s->active[e] = options->active != NULL && options->active(options->self, region, ply);
  }
  for (size_t n = 0; n < grid->node_count; n++) {
    int bits = options->held(options->self, grid->X + 3 * n);
    for (int i = 0; i < 3; i++) {
      s->held[3 * n + (size_t)i] = (bits >> i) & 1;
    }
  }
  DEA_TRY(ctx, dea_solid_frames_create(ctx, s, options));
  DEA_TRY(ctx, dea_solid_set_kinds(ctx, s));
  DEA_TRY(ctx, dea_solid_create_springs(ctx, s));
  DEA_TRY(ctx, dea_solid_field_create(ctx, s, options));
  find_sizes(s);
  return DEA_OK;
}

dea_status dea_solid_create(struct dea_context *ctx, const struct dea_grid *grid,
                            const struct dea_solid_options *options, struct dea_solid **out)
{
  *out = NULL;
  struct dea_solid *s = dea_alloc(ctx, 1, sizeof *s);
  if (dea_solid_any(s == NULL)) {
    dea_free(ctx, s);
    return DEA_E_MEMORY;
  }
  s->grid = grid;
  s->per_node = options->field == DEA_SOLID_FIELD_COUPLED ? 4 : 3;
  s->dofs = (size_t)s->per_node * grid->node_count;
  dea_status status = dea_element_set_create(ctx, grid->order, options->order_z, &s->elements);
  if (status == DEA_OK) {
    status = fill_solid(ctx, s, options);
  }
  struct dea_solid_row_lengths lengths = {0};
  status = dea_solid_create_matrix(ctx, s, status, &lengths);
  if (status == DEA_OK) {
    status = dea_solid_field_matrix(ctx, s, &lengths);
  }
  dea_free(ctx, lengths.own);
  dea_free(ctx, lengths.others);
  if (status != DEA_OK) {
    dea_solid_destroy(ctx, s);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = s;
  return DEA_OK;
}

void dea_solid_destroy(struct dea_context *ctx, struct dea_solid *s)
{
  if (s == NULL) {
    return;
  }
  dea_solid_field_destroy(ctx, s);
  dea_solid_destroy_matrix(s);
  dea_load_steps_release(ctx, &s->path);
  void *const memory[] = {s->layers,  s->layer,      s->active, s->held,       s->u,
                          s->trial,   s->g,          s->step,   s->multiplier, s->theta,
                          s->force,   s->force_goal, s->place,  s->reaction,   s->drive,
                          s->element, s->piece,      s->loads,  s->own,        s->frame,
                          s->frames,  s->predicted,  s->spring, s->kind};
  dea_element_set_release(ctx, &s->elements);
  for (size_t i = 0; i < sizeof memory / sizeof memory[0]; i++) {
    dea_free(ctx, memory[i]);
  }
  dea_free(ctx, s);
}

double dea_solid_voltage(const struct dea_solid *solid)
{
  return solid->voltage_V;
}

double *dea_solid_displacement(struct dea_solid *solid)
{
  return solid->u;
}

double *dea_solid_force(struct dea_solid *solid)
{
  return solid->force_goal;
}

const double *dea_solid_reaction(const struct dea_solid *solid)
{
  return solid->reaction;
}

dea_status dea_solid_prescribe(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                               int components, const double displacement_m[3])
{
  if (node >= solid->grid->node_count || (components & ~7) != 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no such node or component: %zu, %d", node, components);
  }
  for (size_t i = 0; i < 3; i++) {
    if ((components >> i) & 1) {
      solid->held[3 * node + i] = DEA_PRESCRIBED;
      solid->place[3 * node + i] = displacement_m[i];
    }
  }
  return DEA_OK;
}

dea_status dea_solid_release(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                             int components)
{
  if (node >= solid->grid->node_count || (components & ~7) != 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no such node or component: %zu, %d", node, components);
  }
  for (size_t i = 0; i < 3; i++) {
    if ((components >> i) & 1) {
      solid->held[3 * node + i] = DEA_FREE;
    }
  }
  solid->checked = false;
  return DEA_OK;
}

dea_status dea_solid_add_load(struct dea_context *ctx, struct dea_solid *solid,
                              const struct dea_solid_load *load)
{
  struct dea_solid_load *loads =
      dea_resize(ctx, solid->loads, solid->load_count + 1, sizeof *loads);
  if (loads == NULL) {
    return DEA_E_MEMORY;
  }
  solid->loads = loads;
  loads[solid->load_count++] = *load;
  return DEA_OK;
}
