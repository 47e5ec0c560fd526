/* A solid: creation, what it lends. */
#include "model/solid/assembly/solid.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/channels.h"
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
  struct dea_solid_problem *p = &s->problem;
  double squares = 0, extent[3];
  p->modulus_Pa = INFINITY;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    double modulus = dea_part_material_modulus(dea_solid_part_material(s, e));
    double volume_m3 = dea_solid_volume_of(s, e); // an inverted one: dea_solid_check speaks of it
    squares += modulus * modulus * volume_m3 * volume_m3;
    p->modulus_Pa = fmin(p->modulus_Pa, modulus);
  }
  p->energy_floor_J = DBL_EPSILON * sqrt(squares);
  p->length_m = INFINITY;
  for (int i = 0; i < 3; i++) {
    double least = INFINITY, most = -INFINITY;
    for (size_t e = 0; e < p->grid->element_count; e++) {
      const int *nodes;
      int count = dea_solid_nodes(s, e, &nodes);
      for (int n = 0; n < count; n++) {
        least = fmin(least, p->grid->X[3 * nodes[n] + i]);
        most = fmax(most, p->grid->X[3 * nodes[n] + i]);
      }
    }
    extent[i] = most - least;
    p->length_m = extent[i] > 0 ? fmin(p->length_m, extent[i]) : p->length_m;
  }
}

/* All arrays whose size does not hang on what the options answer. */
static dea_status allocate(struct dea_solid *s, const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  struct dea_arena *memory = &s->memory;
  const size_t elements = p->grid->element_count;
  dea_solid_alloc_doubles(memory, p->dofs,
                          (double **[]){&s->state.u, &s->state.force, &s->state.force_goal,
                                        &s->state.u_goal, &s->work.trial, &s->work.g, &s->work.step,
                                        &s->work.increment, &s->work.extrapolated,
                                        &s->found.reaction, NULL});
  struct dea_part_material *part_materials =
      dea_arena_alloc(memory, options->part_material_count, sizeof *part_materials);
  if (part_materials != NULL) {
    memcpy(part_materials, options->part_materials,
           options->part_material_count * sizeof *part_materials);
  }
  p->part_materials = part_materials;
  p->part_material_count = options->part_material_count;
  p->part_material_of = dea_arena_alloc(memory, elements, sizeof *p->part_material_of);
  p->kind = dea_arena_alloc(memory, elements, sizeof *p->kind);
  p->held = dea_arena_alloc(memory, p->dofs, sizeof *p->held);
  dea_solid_alloc_doubles(memory, dea_solid_pressure_count(s),
                          (double **[]){&s->state.multiplier, &s->state.theta, NULL});
  s->work.element = dea_arena_alloc(memory, 1, sizeof *s->work.element);
  s->work.piece = dea_arena_alloc(memory, 1, sizeof *s->work.piece);
  return dea_arena_status(memory);
}

static dea_status fill_solid(struct dea_context *ctx, struct dea_solid *s,
                             const struct dea_solid_options *options)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_grid *grid = p->grid;
  DEA_TRY(ctx, dea_solid_settings_check(ctx, &s->settings));
  DEA_TRY(ctx, allocate(s, options));
  for (size_t e = 0; e < grid->element_count; e++) {
    int region = grid->region[e], ply = grid->ply[e];
    p->part_material_of[e] = options->part_material_of != NULL
                                 ? options->part_material_of(options->self, region, ply)
                                 : 0;
  }
  DEA_TRY(ctx, dea_solid_channels_create(ctx, s, options));
  DEA_TRY(ctx, dea_solid_bodies_create(ctx, s, options));
  for (size_t n = 0; n < grid->node_count; n++) {
    int bits = dea_solid_is_of_body(s, n) ? 0 : options->held(options->self, grid->X + 3 * n);
    for (int i = 0; i < 3; i++) {
      p->held[3 * n + (size_t)i] = (bits >> i) & 1;
    }
  }
  DEA_TRY(ctx, dea_solid_frames_create(ctx, s, options));
  DEA_TRY(ctx, dea_solid_bodies_hold(ctx, s));
  DEA_TRY(ctx, dea_solid_set_kinds(ctx, s));
  DEA_TRY(ctx, dea_solid_find_laminates(ctx, s));
  DEA_TRY(ctx, dea_solid_create_springs(ctx, s));
  DEA_TRY(ctx, dea_solid_field_create(ctx, s, options));
  for (size_t i = 0; i < options->load_count; i++) {
    DEA_TRY(ctx, dea_solid_add_load(ctx, s, &options->loads[i]));
  }
  find_sizes(s);
  return DEA_OK;
}

dea_status dea_solid_create(struct dea_context *ctx, const struct dea_grid *grid,
                            const struct dea_solid_options *options, struct dea_solid **out)
{
  *out = NULL;
  struct dea_solid *s = dea_solid_alloc(ctx, 1, sizeof *s);
  DEA_TRY_MEMORY(s != NULL);
  struct dea_solid_problem *p = &s->problem;
  s->memory.ctx = ctx;
  s->settings = options->settings != NULL ? *options->settings : dea_solid_settings_default();
  s->state.bulk_factor = 1;
  p->grid = grid;
  p->per_node = options->field == DEA_SOLID_FIELD_COUPLED ? 4 : 3;
  p->dofs = (size_t)p->per_node * grid->node_count;
  dea_status status =
      dea_element_set_create(ctx, grid->order, options->order_z, &s->memory, &p->elements);
  status = status == DEA_OK ? fill_solid(ctx, s, options) : status;
  struct dea_solid_row_lengths lengths = {.memory = {.ctx = ctx}};
  status = dea_solid_create_matrix(ctx, s, status, &lengths);
  status = status == DEA_OK ? dea_solid_field_matrix(ctx, s, &lengths) : status;
  dea_arena_free(&lengths.memory);
  DEA_TRY_ELSE(ctx, status, dea_solid_destroy(ctx, s));
  *out = s;
  return DEA_OK;
}

void dea_solid_destroy(struct dea_context *ctx, struct dea_solid *s)
{
  if (s == NULL) {
    return;
  }
  dea_solid_field_destroy(s);
  dea_solid_destroy_matrix(s);
  dea_arena_free(&s->work.load_steps.memory);
  dea_free(ctx, s->problem.loads);
  dea_arena_free(&s->memory);
  dea_free(ctx, s);
}

struct dea_solid_settings *dea_solid_settings_of(struct dea_solid *solid)
{
  return &solid->settings;
}

double dea_solid_voltage(const struct dea_solid *solid)
{
  return solid->state.voltage_V;
}

double *dea_solid_displacement(struct dea_solid *solid)
{
  return solid->state.u;
}

double *dea_solid_force(struct dea_solid *solid)
{
  return solid->state.force_goal;
}

const double *dea_solid_reaction(const struct dea_solid *solid)
{
  return solid->found.reaction;
}

static dea_status check_components(struct dea_context *ctx, const struct dea_solid *solid,
                                   size_t node, int components)
{
  if (node >= solid->problem.grid->node_count || (components & ~7) != 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no such node or component: %zu, %d", node, components);
  }
  return solid->problem.held[3 * node] != DEA_FOLLOWS
             ? DEA_OK
             : dea_fail(ctx, DEA_E_ARGUMENT, "node %zu follows a body: hold or free the body",
                        node);
}

dea_status dea_solid_prescribe(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                               int components, const double displacement_m[3])
{
  DEA_TRY(ctx, check_components(ctx, solid, node, components));
  for (size_t i = 0; i < 3; i++) {
    if ((components >> i) & 1) {
      solid->problem.held[3 * node + i] = DEA_PRESCRIBED;
      solid->state.u_goal[3 * node + i] = displacement_m[i];
    }
  }
  return DEA_OK;
}

dea_status dea_solid_release(struct dea_context *ctx, struct dea_solid *solid, size_t node,
                             int components)
{
  DEA_TRY(ctx, check_components(ctx, solid, node, components));
  for (size_t i = 0; i < 3; i++) {
    if ((components >> i) & 1) {
      solid->problem.held[3 * node + i] = DEA_FREE;
    }
  }
  solid->found.checked = false;
  return DEA_OK;
}

/* The body, if there are such components of it. */
static dea_status find_body(struct dea_context *ctx, const struct dea_solid *s, size_t body,
                            int components, const struct dea_solid_body **out)
{
  if (body >= s->problem.body_count || (components & ~63) != 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "no such body or component: %zu", body);
  }
  *out = &s->problem.bodies[body];
  return DEA_OK;
}

dea_status dea_solid_body_prescribe(struct dea_context *ctx, struct dea_solid *solid, size_t body,
                                    int components, const double shift_m[3],
                                    const double turn_rad[3])
{
  const struct dea_solid_body *b = NULL;
  DEA_TRY(ctx, find_body(ctx, solid, body, components, &b));
  const double L = b->length_m, turn_m[3] = {L * turn_rad[0], L * turn_rad[1], L * turn_rad[2]};
  DEA_TRY(ctx, dea_solid_prescribe(ctx, solid, b->node, components & 7, shift_m));
  return DEA_CHAIN(ctx, dea_solid_prescribe(ctx, solid, b->node + 1, components >> 3, turn_m));
}

dea_status dea_solid_body_release(struct dea_context *ctx, struct dea_solid *solid, size_t body,
                                  int components)
{
  const struct dea_solid_body *b = NULL;
  DEA_TRY(ctx, find_body(ctx, solid, body, components, &b));
  DEA_TRY(ctx, dea_solid_release(ctx, solid, b->node, components & 7));
  return DEA_CHAIN(ctx, dea_solid_release(ctx, solid, b->node + 1, components >> 3));
}

dea_status dea_solid_add_load(struct dea_context *ctx, struct dea_solid *solid,
                              const struct dea_solid_load *load)
{
  struct dea_solid_load *loads =
      dea_resize(ctx, solid->problem.loads, solid->problem.load_count + 1, sizeof *loads);
  DEA_TRY_MEMORY(loads != NULL);
  solid->problem.loads = loads;
  loads[solid->problem.load_count++] = *load;
  return DEA_OK;
}
