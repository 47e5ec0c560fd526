#include "model/solid/model3d/solid_state.h"

#include "model/solid/assembly/controls.h"
#include "model/solid/equilibrium/newton.h"

#include <string.h>

enum {
  PART_MATERIAL_NUMBERS = 8
}; // beside the parameters of the law, and pre_shear if there is one

static size_t used_part_materials(const struct dea_solid *s)
{
  const struct dea_solid_problem *p = &s->problem;
  size_t count = 0;
  for (size_t e = 0; e < p->grid->element_count; e++) {
    count = count > (size_t)p->part_material_of[e] ? count : (size_t)p->part_material_of[e] + 1;
  }
  return count;
}

/* All numbers that the energy of the part materials depends on. */
static dea_status mark_materials(struct dea_context *ctx, const struct dea_solid *s,
                                 struct dea_state *out)
{
  double *to = out->numbers + out->number_count;
  size_t count = 0, capacity = DEA_STATE_NUMBERS_MAX - out->number_count;
  for (size_t i = 0; i < used_part_materials(s); i++) {
    const struct dea_part_material *l = &s->problem.part_materials[i];
    const double own[PART_MATERIAL_NUMBERS] = {
        l->pre_stretch[0], l->pre_stretch[1],       l->p0_Pa,       l->kappa_s_Pa,
        l->kappa_Pa,       l->permittivity_F_per_m, l->thickness_m, l->permittivity_slope_F_per_m};
    size_t params = l->law->param_count, more = 0;
    const double rare[] = {l->pre_shear, l->layers > 1 ? l->layers : 0,
                           l->law->anisotropic ? l->direction[0] : 0,
                           l->law->anisotropic ? l->direction[1] : 0};
    for (int k = 0; k < 4; k++) {
      more += rare[k] != 0;
    }
    if (count + PART_MATERIAL_NUMBERS + params + more > capacity) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "the state of a solid takes fewer part materials");
    }
    memcpy(to + count, own, sizeof own);
    memcpy(to + count + PART_MATERIAL_NUMBERS, l->param, params * sizeof *to);
    count += PART_MATERIAL_NUMBERS + params;
    for (int k = 0; k < 4; k++) {
      if (rare[k] != 0) {
        to[count++] = rare[k];
      }
    }
  }
  out->number_count += count;
  return DEA_CHAIN(ctx, dea_state_add_mark(ctx, out, "materials", to, count * sizeof *to));
}

dea_status dea_solid_save(struct dea_context *ctx, struct dea_solid *s, struct dea_state *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_grid *grid = p->grid;
  struct dea_load_steps *path = &s->work.load_steps;
  DEA_TRY(ctx, dea_load_steps_prepare(ctx, s));
  dea_solid_state_get(s, path->keep);
  dea_solid_controls_get(s, path->controls);
  const double own[] = {s->found.force_largest_N, s->found.energy_largest_J};
  DEA_TRY(ctx,
          dea_state_add_mark(ctx, out, "mesh", grid->X, 3 * grid->node_count * sizeof(double)));
  DEA_TRY(ctx, dea_state_add_mark(ctx, out, "elements", grid->nodes,
                                  grid->element_count * DEA_HEX_NODES_MAX * sizeof(int)));
  DEA_TRY(ctx, dea_state_add_mark(ctx, out, "layers of the elements", p->part_material_of,
                                  grid->element_count * sizeof *p->part_material_of));
  DEA_TRY(ctx, dea_state_add_mark(ctx, out, "electrodes", p->active,
                                  grid->element_count * sizeof *p->active));
  DEA_TRY(ctx, dea_state_add_mark(ctx, out, "supports", p->held, p->dofs));
  DEA_TRY(ctx, mark_materials(ctx, s, out));
  DEA_TRY(ctx, dea_state_add(ctx, out, "state", path->keep, path->state_count));
  DEA_TRY(ctx, dea_state_add(ctx, out, "controls", path->controls, path->control_count));
  bool before = s->found.factor_before && (s->found.factor_fits || s->found.stiff_factor_fits);
  DEA_TRY(ctx, dea_state_add(ctx, out, "state of the factor", before ? path->factored : path->keep,
                             path->state_count));
  return DEA_CHAIN(ctx, dea_state_add_numbers(ctx, out, "solid", own, sizeof own / sizeof own[0]));
}

/* The factor that the equilibrium has left for the start of the next step: it is of `factored`, the
 * state before the last step to `now`, or that itself. */
static dea_status factorise(struct dea_context *ctx, struct dea_solid *s, const double *factored,
                            const double *now)
{
  struct dea_solid_report report = {0};
  size_t size = s->work.load_steps.state_count * sizeof *now;
  dea_solid_state_set(s, factored);
  dea_status status = dea_solid_count_unstable(ctx, s, false, &report);
  dea_solid_state_set(s, now);
  DEA_TRY(ctx, status);
  memcpy(s->work.load_steps.factored, factored, size);
  s->found.factor_before = memcmp(factored, now, size) != 0;
  return DEA_OK;
}

dea_status dea_solid_load(struct dea_context *ctx, struct dea_solid *s,
                          const struct dea_state *state)
{
  struct dea_load_steps *path = &s->work.load_steps;
  DEA_TRY(ctx, dea_load_steps_prepare(ctx, s));
  const double *now = dea_state_find(state, "state", path->state_count);
  const double *factored = dea_state_find(state, "state of the factor", path->state_count);
  const double *controls = dea_state_find(state, "controls", path->control_count);
  const double *own = dea_state_find(state, "solid", 2);
  if (now == NULL || factored == NULL || controls == NULL || own == NULL) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the state is not one of this mesh and these loads");
  }
  dea_solid_controls_set(s, controls);
  s->found.force_largest_N = own[0];
  s->found.energy_largest_J = own[1];
  return DEA_CHAIN(ctx, factorise(ctx, s, factored, now));
}
