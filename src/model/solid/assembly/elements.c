#include "model/solid/assembly/elements.h"

#include "model/solid/assembly/internal_variables.h"
#include "model/solid/assembly/potential.h"

#include <stdint.h>

static dea_status set_kind(struct dea_context *ctx, struct dea_solid *s, size_t e)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_part_material *part_material = dea_solid_part_material(s, e);
  enum dea_element_kind kind = p->grid->kind[e];
  const struct dea_element_type *type = dea_element_types[kind];
  if (p->per_node > type->per_node && part_material->permittivity_F_per_m > 0) {
    if (type->with_potential == kind) {
      return dea_fail(ctx, DEA_E_UNSUPPORTED, "a %s takes the field V/h, not a coupled one",
                      type->name);
    }
    kind = type->with_potential;
  }
  p->kind[e] = kind;
  type = dea_element_types[kind];
  dea_status status = type->check != NULL ? type->check(part_material) : DEA_OK;
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

/* Corner of the plane mesh below the first node of an element, and below the one across from it. */
static int corner_of(const struct dea_grid *grid, size_t e, bool across)
{
  const int plane = (grid->order + 1) * (grid->order + 1);
  return grid->column[grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)(across ? plane - 1 : 0)]];
}

/* Whether the element above has a corner in common with the one below, and no gap. */
static bool touches(const struct dea_grid *grid, size_t below, size_t above)
{
  const int plane = (grid->order + 1) * (grid->order + 1),
            corner = grid->nodes[above * DEA_HEX_NODES_MAX];
  const int *nodes = grid->nodes + below * DEA_HEX_NODES_MAX;
  return nodes[0] == corner || nodes[dea_grid_nodes_of(grid, below) - plane] == corner;
}

/* last: [columns] the highest element of a laminate whose first corner is there, -1: none; other:
 * [elements] that of another such laminate. */
static void find_laminates(struct dea_solid *s, size_t columns, int *last, int *other)
{
  const struct dea_grid *grid = s->problem.grid;
  int *next = s->problem.laminate;
  memset(last, -1, columns * sizeof *last);
  for (size_t e = 0; e < grid->element_count; e++) { // from the lowest ply to the highest
    int *below = &last[corner_of(grid, e, false)];
    while (*below >= 0 && (corner_of(grid, (size_t)*below, true) != corner_of(grid, e, true) ||
                           !touches(grid, (size_t)*below, e))) {
      below = &other[*below];
    }
    next[e] = *below >= 0 ? next[*below] : (int)e;
    other[e] = *below >= 0 ? other[*below] : -1;
    if (*below >= 0) {
      next[*below] = (int)e;
    }
    *below = (int)e;
  }
}

dea_status dea_solid_find_laminates(struct dea_context *ctx, struct dea_solid *s)
{
  struct dea_solid_problem *p = &s->problem;
  const size_t elements = p->grid->element_count, columns = dea_grid_columns(p->grid);
  p->laminate = dea_arena_alloc(&s->memory, elements, sizeof *p->laminate);
  DEA_TRY(ctx, dea_arena_status(&s->memory));
  int *capacity = dea_solid_alloc(ctx, columns + elements, sizeof *capacity);
  if (capacity == NULL) {
    return dea_fail_chain(ctx, DEA_E_MEMORY, __func__, __FILE__, __LINE__);
  }
  find_laminates(s, columns, capacity, capacity + columns);
  dea_free(ctx, capacity);
  return DEA_OK;
}

/* What an element is of, with its kappa and the step of its branches. */
static struct dea_part_material part_material_at(const struct dea_solid *s, size_t e)
{
  const struct dea_internal_variables *h = s->state.internal_variables;
  struct dea_part_material part_material = *dea_solid_part_material(s, e);
  part_material.kappa_Pa = dea_solid_bulk_modulus(s, e);
  if (h != NULL && h->first[e] != SIZE_MAX) {
    part_material.viscous = h->B[h->first[e]];
    part_material.viscous_Pa = h->b_Pa[s->problem.part_material_of[e]];
  }
  return part_material;
}

void dea_solid_element_input(const struct dea_solid *s, size_t e, const double *u, double voltage_V,
                             struct dea_solid_element_input *out)
{
  const struct dea_solid_problem *p = &s->problem;
  const struct dea_element *element = dea_solid_element(s, e);
  const int *nodes;
  int count = dea_solid_nodes(s, e, &nodes);
  out->part_material = part_material_at(s, e);
  dea_solid_gather(s, e, p->grid->X, out->X);
  dea_solid_gather(s, e, u, out->u);
  for (int n = 0; n < count && element->type->per_node > 3; n++) {
    out->potential[n] = u[dea_solid_at(s, nodes[n], 3)];
  }
  out->in = (struct dea_element_input){
      .part_material = &out->part_material,
      .X = out->X,
      .u = out->u,
      .multiplier = s->state.multiplier + e * (size_t)p->elements.pressures,
      .potential = out->potential,
      .potential_V_per_m = dea_solid_field_scale(s),
      .voltage_V = dea_solid_voltage_across(s, e, voltage_V),
  };
}

void dea_solid_element_middle(const struct dea_solid *s, size_t e, double x_mm[3])
{
  double X[DEA_HEX_DOFS_MAX] = {0};
  const int count = dea_solid_gather(s, e, s->problem.grid->X, X);
  x_mm[0] = x_mm[1] = x_mm[2] = 0;
  for (int i = 0; i < 3 * count; i++) {
    x_mm[i % 3] += 1e3 * X[i] / count;
  }
}

dea_status dea_solid_element_strains(const struct dea_solid *s, size_t e,
                                     struct dea_element_strains *out)
{
  const struct dea_element *element = dea_solid_element(s, e);
  struct dea_solid_element_input at;
  dea_solid_element_input(s, e, s->state.u, s->state.voltage_V, &at);
  return element->type->strains(element, &at.in, out);
}
