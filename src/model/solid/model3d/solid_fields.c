#include "model/solid/model3d/solid_fields.h"

#include "model/solid/assembly/matrix.h"
#include "model/solid/assembly/potential.h"

#include <math.h>

/* Potentials of a coupled field [V], owned by the caller; NULL for thin films. */
static dea_status find_potentials(struct dea_context *ctx, const struct dea_solid *s, double **out)
{
  const struct dea_solid_problem *p = &s->problem;
  *out = NULL;
  if (p->field == NULL) {
    return DEA_OK;
  }
  *out = dea_alloc(ctx, p->grid->node_count, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  for (size_t n = 0; n < p->grid->node_count; n++) {
    (*out)[n] = dea_solid_field_scale(s) * s->state.u[3 * p->grid->node_count + n];
  }
  return DEA_OK;
}

/* What recovery is made of; filled by prepare. */
struct recovery {
  struct dea_recover_input in;
  double *potential_V, *across_V;
};

static dea_status prepare(struct dea_context *ctx, const struct dea_solid *s, struct recovery *out)
{
  const struct dea_solid_problem *p = &s->problem;
  *out =
      (struct recovery){.across_V = dea_alloc(ctx, p->grid->element_count, sizeof *out->across_V)};
  dea_status status =
      out->across_V != NULL ? find_potentials(ctx, s, &out->potential_V) : DEA_E_MEMORY;
  for (size_t e = 0; e < p->grid->element_count && status == DEA_OK; e++) {
    out->across_V[e] = dea_solid_voltage_across(s, e, s->state.voltage_V);
  }
  out->in = (struct dea_recover_input){.grid = p->grid,
                                       .elements = &p->elements,
                                       .kind = p->kind,
                                       .part_materials = p->part_materials,
                                       .bulk_factor = s->state.bulk_factor,
                                       .part_material = p->part_material_of,
                                       .active = p->active,
                                       .u = s->state.u,
                                       .multiplier = s->state.multiplier,
                                       .across_V = out->across_V,
                                       .potential_V = out->potential_V,
                                       .uneven = s->state.drop_V != NULL};
  return status;
}

static void release(struct dea_context *ctx, struct recovery *recovery)
{
  dea_free(ctx, recovery->across_V);
  dea_free(ctx, recovery->potential_V);
}

dea_status dea_solid_fields(struct dea_context *ctx, const struct dea_solid *s, int ply,
                            struct dea_field_mesh **out)
{
  struct recovery work;
  *out = NULL;
  dea_status status = prepare(ctx, s, &work);
  status = status != DEA_OK       ? status
           : ply == DEA_ALL_PLIES ? dea_recover_volume(ctx, &work.in, out)
                                  : dea_recover_surface(ctx, &work.in, ply, out);
  release(ctx, &work);
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
  struct recovery work = {0};
  double(*mirror)[3] = dea_alloc(ctx, p->grid->node_count, sizeof *mirror);
  dea_status status = mirror != NULL ? prepare(ctx, s, &work) : DEA_E_MEMORY;
  for (size_t n = 0; status == DEA_OK && n < p->grid->node_count; n++) {
    find_mirror(p, n, mirror[n]);
  }
  for (size_t k = 0; k < count && status == DEA_OK; k++) {
    dea_solid_release_held(s, of[k].z);
    status = dea_solid_solve_linear(ctx, s, of[k].z, of[k].z);
  }
  if (status == DEA_OK) {
    status =
        dea_recover_errors(ctx, &work.in, (const double(*)[3])mirror, of, count, error_m, part);
  }
  release(ctx, &work);
  dea_free(ctx, mirror);
  return status;
}
