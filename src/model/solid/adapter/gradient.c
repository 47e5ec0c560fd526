#include "model/solid/adapter/gradient.h"

#include "model/solid/assembly/assemble.h"
#include "model/solid/equilibrium/adjoint.h"
#include "result/columns.h"

#include <math.h>
#include <string.h>

// The film
// -----------------------------------------------------------------------------------------

static const char *const extremes[DEA_FILM_EXTREMES] = {
    [DEA_FILM_FIELD] = "true_field_V_per_m",
    [DEA_FILM_MARGIN] = "breakdown_margin",
    [DEA_FILM_TENSION] = "min_tension_N_per_m",
};

void dea_gradient_places_find(const struct dea_gradient_film *film, struct dea_gradient_places *out)
{
  for (int i = 0; i < DEA_FILM_EXTREMES; i++) {
    out->known[i] =
        dea_solid_extreme_find(film->solid, film->films, (enum dea_film_extreme)i, &out->at[i]);
  }
}

dea_status dea_gradient_film_slope(struct dea_context *ctx, const struct dea_gradient_film *film,
                                   const struct dea_gradient_places *places, int column,
                                   double *out, double *pressures, bool *known)
{
  const char *key = dea_point_columns[column].key;
  int extreme = 0;
  while (extreme < DEA_FILM_EXTREMES && strcmp(key, extremes[extreme]) != 0) {
    extreme++;
  }
  if (extreme < DEA_FILM_EXTREMES) {
    *known = places->known[extreme];
    if (*known) {
      dea_solid_extreme_slope(film->solid, film->films, (enum dea_film_extreme)extreme,
                              &places->at[extreme], out, pressures);
    }
  } else if (strcmp(key, "capacitance_F") == 0) {
    DEA_TRY(ctx, dea_solid_capacitance_slope(ctx, film->solid, out, known));
    for (size_t i = 0; i < film->solid->problem.dofs; i++) {
      out[i] *= film->copies;
    }
  } else { // forces of the energy are 0
    *known = strcmp(key, "energy_J") == 0 || strcmp(key, "nominal_field_V_per_m") == 0;
  }
  return DEA_OK;
}

static bool asks(const struct dea_gradient_ask *ask, const char *key)
{
  for (size_t i = 0; i < ask->column_count; i++) {
    if (strcmp(dea_point_columns[ask->columns[i]].key, key) == 0) {
      return true;
    }
  }
  return false;
}

dea_status dea_gradient_film_at(struct dea_context *ctx, const struct dea_gradient_film *film,
                                const struct dea_gradient_places *places,
                                const struct dea_gradient_ask *ask, double voltage_V,
                                struct dea_load_point *out)
{
  double *const values[DEA_FILM_EXTREMES] = {
      [DEA_FILM_FIELD] = &out->true_field_V_per_m,
      [DEA_FILM_MARGIN] = &out->breakdown_margin,
      [DEA_FILM_TENSION] = &out->min_tension_N_per_m,
  };
  for (int i = 0; i < DEA_FILM_EXTREMES; i++) {
    if (places->known[i]) {
      *values[i] = dea_solid_extreme_at(film->solid, film->films, (enum dea_film_extreme)i,
                                        &places->at[i], voltage_V);
    }
  }
  if (asks(ask, "capacitance_F")) {
    DEA_TRY(ctx, dea_solid_capacitance_wide(ctx, film->solid, &out->capacitance_F));
    out->capacitance_F *= film->copies;
  }
  return DEA_OK;
}

dea_status dea_gradient_rest_energy(struct dea_solid *s, const struct dea_gradient_ask *ask,
                                    double *u, double *multipliers, double *energy_J)
{
  double *own = s->state.multiplier;
  if (!asks(ask, "energy_J")) {
    return DEA_OK;
  }
  s->state.multiplier = multipliers;
  dea_status status = dea_solid_energy(s, u, 0, energy_J);
  s->state.multiplier = own;
  return status;
}

// Gradients ---------------------------------------------------------------------------------------

struct work {
  const struct dea_gradient_owner *owner;
  const struct dea_gradient_ask *ask;
  struct dea_adjoint *adjoint;
  bool *known;    // [dea_gradient_width] there is an answer
  double *side;   // [2][dea_gradient_width]
  double *motion; // [monitor_count]
};

/* The answers of all quantities. */
static dea_status answer(struct dea_context *ctx, struct work *w)
{
  for (size_t i = 0; i < w->ask->column_count; i++) {
    DEA_TRY(ctx, w->owner->slope(ctx, w->owner->model, w->ask->columns[i],
                                 dea_adjoint_slope(w->adjoint, i),
                                 dea_adjoint_pressure_slope(w->adjoint, i), &w->known[i]));
  }
  for (size_t i = 0; i < w->ask->monitor_count; i++) {
    const size_t at = w->ask->column_count + i;
    w->known[at] = false;
    if (w->owner->monitor_slope != NULL) {
      DEA_TRY(ctx, w->owner->monitor_slope(ctx, w->owner->model, i,
                                           dea_adjoint_slope(w->adjoint, at), &w->known[at]));
    }
  }
  DEA_TRY(ctx, dea_adjoint_solve(ctx, w->adjoint, w->known));
  return DEA_OK;
}

/* J - lambda . R - mu . C of every quantity on one side of a change. */
static dea_status evaluate(struct dea_context *ctx, struct work *w, double voltage_V, double *out)
{
  struct dea_solid *s = w->owner->solid;
  struct dea_load_point point;
  double energy_J;
  s->state.voltage_V = voltage_V;
  DEA_TRY(ctx, dea_adjoint_assemble(ctx, w->adjoint, voltage_V, &energy_J));
  for (size_t i = 0; i < dea_gradient_width(w->ask); i++) {
    out[i] = w->known[i] ? -dea_adjoint_product(w->adjoint, i) : NAN;
  }
  DEA_TRY(ctx, w->owner->point(ctx, w->owner->model, voltage_V, energy_J, &point));
  for (size_t i = 0; i < w->ask->column_count; i++) {
    out[i] += dea_point_get(&point, w->ask->columns[i]);
  }
  if (w->owner->monitors != NULL && w->ask->monitor_count > 0) {
    DEA_TRY(ctx, w->owner->monitors(ctx, w->owner->model, w->motion));
    for (size_t i = 0; i < w->ask->monitor_count; i++) {
      out[w->ask->column_count + i] += w->motion[i];
    }
  }
  return DEA_OK;
}

/* Both sides of a change. */
static dea_status difference(struct dea_context *ctx, struct work *w,
                             const struct dea_design_change *change)
{
  for (int k = 0; k < 2; k++) {
    dea_status status = w->owner->enter(ctx, w->owner->model, change->device[k]);
    if (status == DEA_OK) {
      status =
          evaluate(ctx, w, change->voltage_V[k], w->side + (size_t)k * dea_gradient_width(w->ask));
    }
    w->owner->solid->state.voltage_V = w->owner->voltage_V;
    w->owner->leave(ctx, w->owner->model);
    DEA_TRY(ctx, status);
  }
  return DEA_OK;
}

static dea_status find(struct dea_context *ctx, struct work *w, double *out)
{
  size_t count = dea_gradient_width(w->ask);
  DEA_TRY(ctx, answer(ctx, w));
  for (size_t c = 0; c < w->ask->change_count; c++) {
    size_t errors = dea_finding_trial_begin(ctx);
    dea_status status = difference(ctx, w, &w->ask->changes[c]);
    dea_finding_trial_end(ctx, errors);
    bool follows = status != DEA_E_ARGUMENT && status != DEA_E_UNSUPPORTED;
    if (!follows) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                                   "model 3d: no gradient by one of the numbers: %s",
                                   dea_context_message(ctx)));
      dea_context_clear(ctx);
    } else {
      DEA_TRY(ctx, status);
    }
    for (size_t i = 0; i < count; i++) {
      out[c * count + i] =
          follows ? (w->side[count + i] - w->side[i]) / w->ask->changes[c].width : NAN;
    }
  }
  return DEA_OK;
}

dea_status dea_gradient_find(struct dea_context *ctx, const struct dea_gradient_owner *owner,
                             const struct dea_gradient_ask *ask, double *out)
{
  struct dea_solid *s = owner->solid;
  struct dea_arena memory = {.ctx = ctx};
  struct work w = {.owner = owner, .ask = ask};
  double energy_J, force_N = s->found.force_largest_N, all_J = s->found.energy_largest_J;
  w.known = dea_arena_alloc(&memory, dea_gradient_width(ask), sizeof *w.known);
  w.side = dea_arena_alloc(&memory, 2 * dea_gradient_width(ask), sizeof *w.side);
  w.motion = dea_arena_alloc(&memory, ask->monitor_count + 1, sizeof *w.motion);
  dea_status status = dea_solid_agree(ctx, dea_arena_status(&memory));
  if (status == DEA_OK) {
    status = dea_adjoint_create(ctx, s, dea_gradient_width(ask), &w.adjoint);
  }
  if (status == DEA_OK) {
    status = find(ctx, &w, out);
  }
  s->found.force_largest_N = force_N; // scales and reactions are those of the equilibrium again
  s->found.energy_largest_J = all_J;
  if (status == DEA_OK) {
    status = dea_solid_assemble(ctx, s, owner->voltage_V, DEA_FORCE, &energy_J);
  }
  dea_adjoint_destroy(ctx, w.adjoint);
  dea_arena_free(&memory);
  return status == DEA_OK ? DEA_OK : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
