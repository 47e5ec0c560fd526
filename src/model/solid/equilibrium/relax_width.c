#include "model/solid/equilibrium/relax_width.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/bodies.h"
#include "model/solid/assembly/controls.h"
#include "model/solid/assembly/elements.h"
#include "model/solid/assembly/matrix.h"
#include "model/solid/equilibrium/follow.h"

#include <math.h>
#include <string.h>

/* Whether an element is of a film that has no tension somewhere. */
static bool wrinkles(const struct dea_solid *s, size_t e)
{
  static const double none = 1e-12; // of the modulus
  const struct dea_element *element = dea_solid_element(s, e);
  const struct dea_part_material *film = dea_solid_part_material(s, e);
  struct dea_solid_element_place place;
  struct dea_element_input in;
  struct dea_membrane_state state;
  if (!film->relaxed) {
    return false;
  }
  dea_solid_element_input(s, e, s->state.u, s->state.voltage_V, &place, &in);
  bool any = element->type->membrane_state(element, &in, &state) != DEA_OK;
  for (int p = 0; !any && p < state.count; p++) {
    any = state.tension[p] <= none * dea_part_material_modulus(film) * film->thickness_m;
  }
  return any;
}

/* Nothing leaves its height: of a body neither shift nor turn. */
static void hold_heights(struct dea_solid *s)
{
  for (size_t n = 0; n < s->problem.grid->node_count; n++) {
    const bool turns = dea_solid_turns_body(s, n);
    for (size_t i = 0; i < 3; i++) {
      unsigned char *held = &s->problem.held[3 * n + i];
      *held = *held == DEA_FREE && (i == 2) != turns ? DEA_HELD : *held;
    }
  }
}

/* Whether forces of compression in the plane meet motions without stiffness: K has next to none of
 * them, and they lead further than the solid is wide. films: those that bear compression. */
static dea_status find_freedom(struct dea_context *ctx, struct dea_solid *s,
                               const struct dea_part_material *films, bool *free)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_part_material *own = p->part_materials;
  const size_t nodes = p->grid->node_count;
  double energy, far = 0, wide = 0;
  *free = true;
  if (!s->found.factor_fits) {
    return DEA_OK;
  }
  p->part_materials = films;
  dea_status status = dea_solid_assemble(ctx, s, s->state.voltage_V, DEA_FORCE, &energy);
  p->part_materials = own;
  DEA_TRY(ctx, status);
  for (size_t k = 0; k < 3 * nodes; k++) {
    s->work.trial[k] = (k % 3 == 2) == dea_solid_turns_body(s, k / 3) ? -s->work.g[k] : 0;
    wide = fmax(wide, fabs(p->grid->X[k]));
  }
  DEA_TRY(ctx, dea_solid_solve_linear(ctx, s, s->work.trial, s->work.step));
  for (size_t k = 0; k < 3 * nodes; k++) {
    far = fmax(far, fabs(s->work.step[k]));
  }
  *free = far > wide;
  return DEA_OK;
}

/* The equilibrium in the plane of films that bear compression, then that of the films as they are.
 */
static dea_status relax_width(struct dea_context *ctx, struct dea_solid *s, unsigned char *held,
                              struct dea_part_material *stiff, struct dea_solid_report *report)
{
  struct dea_solid_problem *p = &s->problem;
  const struct dea_part_material *own = p->part_materials;
  const size_t components = 3 * p->grid->node_count;
  struct dea_solid_report flat = {0};
  bool free;
  memcpy(held, p->held, components);
  memcpy(stiff, own, p->part_material_count * sizeof *stiff);
  for (size_t i = 0; i < p->part_material_count; i++) {
    stiff[i].relaxed = false;
  }
  DEA_TRY(ctx, find_freedom(ctx, s, stiff, &free));
  if (!free) {
    return DEA_OK;
  }
  p->part_materials = stiff;
  hold_heights(s);
  dea_solid_forget(s);
  dea_status status = dea_solid_equilibrate(ctx, s, &flat);
  p->part_materials = own;
  memcpy(p->held, held, components);
  dea_solid_forget(s);
  return status == DEA_OK ? dea_solid_equilibrate(ctx, s, report) : status;
}

dea_status dea_solid_relax_width(struct dea_context *ctx, struct dea_solid *s,
                                 struct dea_solid_report *report)
{
  const struct dea_solid_problem *p = &s->problem;
  struct dea_load_steps *path = &s->work.load_steps;
  struct dea_solid_report after = *report;
  bool any = false;
  for (size_t k = 0; k < p->own_count && s->state.inertia == NULL && !any; k++) {
    any = wrinkles(s, p->own[k]);
  }
  if (!dea_solid_allreduce_any(any)) {
    return DEA_OK;
  }
  struct dea_part_material *stiff = dea_solid_alloc(ctx, p->part_material_count, sizeof *stiff);
  unsigned char *held = dea_solid_alloc(ctx, 3 * p->grid->node_count, sizeof *held);
  dea_status status = stiff != NULL && held != NULL ? DEA_OK : DEA_E_MEMORY;
  dea_solid_state_get(s, path->keep);
  status = status == DEA_OK ? relax_width(ctx, s, held, stiff, &after) : status;
  if (status == DEA_OK) {
    *report = after;
  } else if (dea_solid_may_shorten(status)) {
    dea_context_clear(ctx);
    dea_solid_state_set(s, path->keep);
    status = DEA_OK;
  }
  s->found.predicts_tangent = s->found.extrapolated = false;
  path->last_V = path->before_last_V; // the path has a bend of another kind
  dea_free(ctx, stiff);
  dea_free(ctx, held);
  return DEA_CHAIN(ctx, status);
}
