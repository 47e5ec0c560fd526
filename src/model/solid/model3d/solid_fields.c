#include "model/solid/model3d/solid_fields.h"

#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"

#include <math.h>

/* What recovery is made of. memory: of its arrays. */
static dea_status prepare(struct dea_context *ctx, const struct dea_solid *s,
                          struct dea_arena *memory, struct dea_recover_input *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const size_t nodes = p->grid->node_count, elements = p->grid->element_count;
  const bool coupled = p->field != NULL;
  double *across_V = dea_arena_alloc(memory, elements, sizeof *across_V);
  double *potential_V = coupled ? dea_arena_alloc(memory, nodes, sizeof *potential_V) : NULL;
  DEA_TRY(ctx, dea_arena_status(memory));
  for (size_t e = 0; e < elements; e++) {
    across_V[e] = dea_solid_voltage_across(s, e, s->state.voltage_V);
  }
  for (size_t n = 0; n < nodes && coupled; n++) {
    potential_V[n] = dea_solid_field_scale(s) * s->state.u[3 * nodes + n];
  }
  *out = (struct dea_recover_input){.grid = p->grid,
                                    .elements = &p->elements,
                                    .kind = p->kind,
                                    .part_materials = p->part_materials,
                                    .bulk_factor = s->state.bulk_factor,
                                    .part_material = p->part_material_of,
                                    .active = p->active,
                                    .u = s->state.u,
                                    .multiplier = s->state.multiplier,
                                    .across_V = across_V,
                                    .potential_V = potential_V,
                                    .uneven = s->state.drop_V != NULL};
  return DEA_OK;
}

dea_status dea_solid_fields(struct dea_context *ctx, const struct dea_solid *s, int ply,
                            struct dea_field_mesh **out)
{
  struct dea_arena memory = {.ctx = ctx};
  struct dea_recover_input in;
  *out = NULL;
  dea_status status = prepare(ctx, s, &memory, &in);
  status = status != DEA_OK       ? status
           : ply == DEA_ALL_PLIES ? dea_recover_volume(ctx, &in, out)
                                  : dea_recover_surface(ctx, &in, ply, out);
  dea_arena_free(&memory);
  return DEA_CHAIN(ctx, status);
}

/* The normal of the mirror plane that a node moves in: the one component that is held, if it lies
 * in the film's plane; zeros otherwise. */
static void find_mirror(const struct dea_solid_problem *p, size_t node, double normal[3])
{
  static const double global[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double *Q = p->frame != NULL && p->frame[node] > 0 ? p->frames[p->frame[node] - 1] : global;
  int held = 0, which = 0;
  for (int i = 0; i < 3; i++) {
    if (p->held[3 * node + (size_t)i] == DEA_HELD) {
      held++;
      which = i;
    }
  }
  for (int i = 0; i < 3; i++) {
    normal[i] = held == 1 && fabs(Q[3 * which + 2]) < 1e-6 ? Q[3 * which + i] : 0;
  }
}

dea_status dea_solid_errors(struct dea_context *ctx, struct dea_solid *s,
                            const struct dea_recover_quantity *of, size_t count, double *error_m,
                            double *part)
{
  const struct dea_solid_problem *p = &s->problem;
  for (size_t k = 0; k < count; k++) {
    error_m[k] = NAN;
  }
  if (dea_solid_allreduce_any(!s->found.factor_fits)) {
    return DEA_OK;
  }
  struct dea_arena memory = {.ctx = ctx};
  struct dea_recover_input in;
  double(*mirror)[3] = dea_arena_alloc(&memory, p->grid->node_count, sizeof *mirror);
  dea_status status = prepare(ctx, s, &memory, &in);
  for (size_t n = 0; status == DEA_OK && n < p->grid->node_count; n++) {
    find_mirror(p, n, mirror[n]);
  }
  for (size_t k = 0; k < count && status == DEA_OK; k++) {
    dea_solid_release_held(s, of[k].z);
    status = dea_solid_solve_linear(ctx, s, of[k].z, of[k].z);
  }
  if (status == DEA_OK) {
    status = dea_recover_errors(ctx, &in, (const double(*)[3])mirror, of, count, error_m, part);
  }
  dea_arena_free(&memory);
  return status;
}
