#include "film/film_table.h"

#include "study/observe.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 16, POINTS_MAX = 400 }; // up to the design's highest voltage; in all

struct dea_film_table {
  const struct dea_model_type *type;
  struct dea_model *model; // owned, at the last point
  struct dea_monitor_set set;
  int column; // of the motion; -1: none
  double step_V;
  struct dea_load_point points[POINTS_MAX]; // [count] at multiples of step_V
  size_t count;
  dea_status end; // why there are no more
  char why[400];
};

/* The first monitor's z; -1: none. */
static int first_height(const struct dea_monitor_set *set)
{
  for (size_t i = 0; i < set->count; i++) {
    const struct dea_monitor_column *c = &set->columns[i];
    if (c->source == DEA_OF_MONITOR && c->number == DEA_OBSERVED_Z) {
      return c->column;
    }
  }
  return -1;
}

static dea_status find_column(struct dea_context *ctx, const char *monitor,
                              struct dea_film_table *table)
{
  table->column = monitor != NULL ? dea_column_find(ctx, monitor) : first_height(&table->set);
  if (monitor == NULL ||
      (table->column >= 0 && strcmp(dea_column_at(ctx, table->column)->si_unit, "m") == 0)) {
    return DEA_OK;
  }
  const char *nearest;
  DEA_TRY(ctx, dea_column_nearest(ctx, monitor, &nearest));
  return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' is no displacement of a monitor of the film%s%.60s%s",
                  monitor, nearest != NULL ? "; did you mean '" : "",
                  nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

dea_status dea_film_table_create(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, const char *monitor,
                                 struct dea_film_table **out)
{
  const double highest_V = dea_design_highest_V(design);
  struct dea_film_table *table = dea_alloc(ctx, 1, sizeof *table);
  *out = NULL;
  if (table == NULL) {
    return DEA_E_MEMORY;
  }
  table->type = dea_model_find("3d");
  table->step_V = (highest_V > 0 ? highest_V : 4e3) / STEPS;
  dea_status status = dea_model_create(ctx, table->type, design, device, &table->model);
  if (status == DEA_OK) {
    status = dea_monitor_set_init(ctx, table->type, device, &table->set);
  }
  if (status == DEA_OK) {
    status = find_column(ctx, monitor, table);
  }
  if (status != DEA_OK) {
    dea_film_table_destroy(ctx, table);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = table;
  return DEA_OK;
}

void dea_film_table_destroy(struct dea_context *ctx, struct dea_film_table *table)
{
  if (table != NULL) {
    if (table->model != NULL) {
      table->type->destroy(ctx, table->model);
    }
    dea_monitor_set_free(&table->set);
    dea_free(ctx, table);
  }
}

/* The next voltage. */
static dea_status extend(struct dea_context *ctx, struct dea_film_table *table)
{
  struct dea_load_point *point = &table->points[table->count];
  if (table->count == POINTS_MAX) {
    return dea_fail(ctx, DEA_E_DOMAIN, "the film is not computed beyond %.4g kV",
                    1e-3 * (POINTS_MAX - 1) * table->step_V);
  }
  DEA_TRY(ctx, table->type->solve(ctx, table->model, (double)table->count * table->step_V, point));
  DEA_TRY(ctx, dea_monitor_set_read(ctx, &table->set, table->type, table->model, false, point));
  const double z = table->column >= 0 ? dea_point_get(point, table->column) : NAN;
  point->centre_z_m = point->fibre_tip_z_m = z;
  point->monitors = NULL; // the set's
  table->count++;
  return DEA_OK;
}

static dea_status reach(struct dea_context *ctx, struct dea_film_table *table, size_t count)
{
  if (table->end != DEA_OK && table->count < count) {
    return dea_fail(ctx, table->end, "%s", table->why);
  }
  while (table->count < count) {
    const dea_status status = extend(ctx, table);
    if (status != DEA_OK) {
      table->end = dea_verdict_of(status)[0] != '\0' ? status : DEA_OK;
      snprintf(table->why, sizeof table->why, "%.399s", dea_context_message(ctx));
      return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
    }
  }
  return DEA_OK;
}

dea_status dea_film_table_at(struct dea_context *ctx, struct dea_film_table *table,
                             double voltage_V, struct dea_load_point *out)
{
  const double at = fabs(voltage_V) / table->step_V;
  const size_t below = at < POINTS_MAX ? (size_t)at : POINTS_MAX;
  DEA_TRY(ctx, reach(ctx, table, below + 2));
  const double a = (double)below, share = (at * at - a * a) / (2 * a + 1);
  const struct dea_load_point *low = &table->points[below], *high = low + 1;
  *out = *low;
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) { // even in the voltage: by its square
    const double from = dea_point_get(low, c), to = dea_point_get(high, c);
    dea_point_set(out, c, from + share * (to - from));
  }
  out->voltage_V = voltage_V;
  out->charge_C = out->capacitance_F * voltage_V;
  return DEA_OK;
}

static dea_status charge_at(struct dea_context *ctx, struct dea_film_table *table, double voltage_V,
                            double *out)
{
  struct dea_load_point point;
  DEA_TRY(ctx, dea_film_table_at(ctx, table, voltage_V, &point));
  *out = point.charge_C;
  return DEA_OK;
}

/* Implicit Euler: charge(V) = charge before + length clamp((to - V)/R, +-limit), which rises with V
 * on the left and falls on the right; by bisection between the film's voltage and the source's. */
dea_status dea_film_table_charge(struct dea_context *ctx, struct dea_film_table *table,
                                 const struct dea_film_step *step, double *film_V)
{
  double low = step->film_V, high = step->to_V, before, now;
  DEA_TRY(ctx, charge_at(ctx, table, step->film_V, &before));
  DEA_TRY(ctx, charge_at(ctx, table, step->to_V, &now));
  const double most = step->limit_A * step->length_s, up = high >= low ? 1 : -1;
  const bool ideal = !(step->resistance_ohm > 0);
  if (ideal && (isinf(step->limit_A) || fabs(now - before) <= most)) {
    *film_V = step->to_V;
    return DEA_OK;
  }
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    const double wanted =
        ideal ? INFINITY : step->length_s * fabs(step->to_V - middle) / step->resistance_ohm;
    DEA_TRY(ctx, charge_at(ctx, table, middle, &now));
    *(up * (now - before) < fmin(wanted, most) ? &low : &high) = middle;
  }
  *film_V = 0.5 * (low + high);
  return DEA_OK;
}
