#include "model/solid/assembly/elements.h"

#include "model/solid/assembly/internal_variables.h"
#include "model/solid/assembly/potential.h"

static dea_status set_kind(struct dea_context *ctx, struct dea_solid *s, size_t e)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_constituent *constituent = dea_solid_constituent(s, e);
  enum dea_element_kind kind = p->grid->kind[e];
  const struct dea_element_type *type = dea_element_types[kind];
  if (p->per_node > type->per_node && constituent->permittivity_F_per_m > 0) {
    if (type->with_potential == kind) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "a %s takes the field V/h, not a coupled one",
                      type->name);
    }
    kind = type->with_potential;
  }
  p->kind[e] = kind;
  type = dea_element_types[kind];
  dea_status status = type->check(constituent);
  return status == DEA_OK ? DEA_OK
                          : dea_fail(ctx, status, "a %s takes %s", type->name, type->takes);
}

dea_status dea_solid_set_kinds(struct dea_context *ctx, struct dea_solid *s)
{
  for (size_t e = 0; e < s->problem.grid->element_count; e++) {
    DEA_TRY(ctx, set_kind(ctx, s, e));
  }
  return DEA_OK;
}

void dea_solid_element_input(const struct dea_solid *s, size_t e, const double *u, double voltage_V,
                             struct dea_solid_element_place *place, struct dea_element_input *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_element *element = dea_solid_element(s, e);
  const int *nodes;
  int count = dea_solid_nodes(s, e, &nodes);
  place->constituent = dea_solid_constituent_at(s, e);
  dea_solid_gather(s, e, p->grid->X, place->X);
  dea_solid_gather(s, e, u, place->u);
  for (int n = 0; n < count && element->type->per_node > 3; n++) {
    place->potential[n] = u[dea_solid_at(s, nodes[n], 3)];
  }
  *out = (struct dea_element_input){
      .constituent = &place->constituent,
      .X = place->X,
      .u = place->u,
      .multiplier = s->state.multiplier + e * (size_t)p->elements.pressures,
      .potential = place->potential,
      .potential_V_per_m = dea_solid_field_scale(s),
      .voltage_V = dea_solid_voltage_across(s, e, voltage_V),
  };
}
