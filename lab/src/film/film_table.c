#include "film/film_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 16, POINTS_MAX = 400 }; // up to the design's highest voltage; in all

struct dea_model {
  const struct dea_model_type *type;
  struct dea_model *model; // owned, at the last point, of that type
  struct dea_film_motion motion;
  double step_V;
  struct dea_load_point points[POINTS_MAX]; // [count] at multiples of step_V
  size_t count;
  dea_status end; // why there are no more
  char why[400];
  struct dea_circuit circuit;
  struct dea_circuit_state last, trial; // accepted, and of the last step
  double largest_V;                     // of the source
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

dea_status dea_film_motion_init(struct dea_context *ctx, const struct dea_model_type *type,
                                const struct dea_device *device, const char *monitor,
                                struct dea_film_motion *out)
{
  DEA_TRY(ctx, dea_monitor_set_init(ctx, type, device, &out->set));
  out->column = monitor != NULL ? dea_column_find(ctx, monitor) : first_height(&out->set);
  if (monitor == NULL ||
      (out->column >= 0 && strcmp(dea_column_at(ctx, out->column)->si_unit, "m") == 0)) {
    return DEA_OK;
  }
  const char *nearest;
  DEA_TRY(ctx, dea_column_nearest(ctx, monitor, &nearest));
  return dea_fail(ctx, DEA_E_DESIGN, "'%.60s' is no displacement of a monitor of the film%s%.60s%s",
                  monitor, nearest != NULL ? "; did you mean '" : "",
                  nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

dea_status dea_film_motion_read(struct dea_context *ctx, struct dea_film_motion *motion,
                                const struct dea_model_type *type, struct dea_model *model,
                                struct dea_load_point *point)
{
  DEA_TRY(ctx, dea_monitor_set_read(ctx, &motion->set, type, model, false, point));
  const double z = motion->column >= 0 ? dea_point_get(point, motion->column) : NAN;
  point->centre_z_m = point->fibre_tip_z_m = z;
  point->monitors = NULL; // the set's
  return DEA_OK;
}

static void destroy(struct dea_context *ctx, struct dea_model *table)
{
  if (table != NULL) {
    if (table->model != NULL) {
      table->type->destroy(ctx, table->model);
    }
    dea_monitor_set_free(&table->motion.set);
    dea_free(ctx, table);
  }
}

dea_status dea_film_table_create(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_device *device, const char *monitor,
                                 struct dea_model **out)
{
  const double highest_V = dea_design_highest_V(design);
  struct dea_model *table = dea_alloc(ctx, 1, sizeof *table);
  *out = NULL;
  DEA_TRY_MEMORY(table != NULL);
  table->type = dea_model_find("3d");
  table->step_V = (highest_V > 0 ? highest_V : 4e3) / STEPS;
  dea_status status = dea_model_create(ctx, table->type, design, device, &table->model);
  if (status == DEA_OK) {
    status = dea_film_motion_init(ctx, table->type, device, monitor, &table->motion);
  }
  if (status != DEA_OK) {
    destroy(ctx, table);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = table;
  return DEA_OK;
}

/* The next voltage. */
static dea_status extend(struct dea_context *ctx, struct dea_model *table)
{
  struct dea_load_point *point = &table->points[table->count];
  if (table->count == POINTS_MAX) {
    return dea_fail(ctx, DEA_E_DOMAIN, "the film is not computed beyond %.4g kV",
                    1e-3 * (POINTS_MAX - 1) * table->step_V);
  }
  DEA_TRY(ctx, table->type->solve(ctx, table->model, (double)table->count * table->step_V, point));
  DEA_TRY(ctx, dea_film_motion_read(ctx, &table->motion, table->type, table->model, point));
  table->count++;
  return DEA_OK;
}

static dea_status reach(struct dea_context *ctx, struct dea_model *table, size_t count)
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

/* A point at a voltage of either sign. Fails where a voltage on the way does, from then on too. */
static dea_status solve(struct dea_context *ctx, struct dea_model *table, double voltage_V,
                        struct dea_load_point *out)
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

// In time ----------------------------------------------------------------------------------------

static dea_status begin(struct dea_context *ctx, struct dea_model *table,
                        const struct dea_time_options *time, struct dea_load_point *out)
{
  DEA_TRY(ctx, solve(ctx, table, 0, out));
  table->circuit = time->circuit;
  table->last = (struct dea_circuit_state){.capacitance_F = out->capacitance_F};
  table->largest_V = 0;
  return DEA_OK;
}

/* The capacitance rises with |V| and the voltage that a charge makes falls with it: by bisection
 * between the film's voltage and the source's. */
static dea_status charge(struct dea_context *ctx, struct dea_model *table,
                         const struct dea_circuit_state *last, double length_s, double source_V,
                         struct dea_circuit_state *out)
{
  const struct dea_time_step step = {.length_s = length_s, .source_voltage_V = source_V};
  double ends[2] = {last->voltage_V, source_V}, middle_V = source_V, slope;
  const double up = source_V >= last->voltage_V ? 1 : -1;
  struct dea_load_point point;
  for (int i = 0; i < 60 && !dea_circuit_is_ideal(&table->circuit); i++) {
    middle_V = 0.5 * (ends[0] + ends[1]);
    DEA_TRY(ctx, solve(ctx, table, middle_V, &point));
    const struct dea_circuit_film film = {.capacitance_F = point.capacitance_F};
    const double end_V = dea_circuit_voltage(&table->circuit, last, &step, &film, &slope);
    ends[up * (end_V - middle_V) > 0 ? 0 : 1] = middle_V;
  }
  DEA_TRY(ctx, solve(ctx, table, middle_V, &point));
  const struct dea_circuit_film film = {.capacitance_F = point.capacitance_F};
  dea_circuit_advance(&table->circuit, last, &step, &film, out);
  return DEA_OK;
}

/* The film follows at once; its charge by one step and by two, whose difference is the error. */
static dea_status advance(struct dea_context *ctx, struct dea_model *table,
                          const struct dea_time_step *step, struct dea_load_point *out,
                          double *error)
{
  const double to_V = step->source_voltage_V, half_s = 0.5 * step->length_s;
  const double middle_V = 0.5 * (table->last.source_voltage_V + to_V);
  struct dea_circuit_state whole, half;
  DEA_TRY(ctx, charge(ctx, table, &table->last, step->length_s, to_V, &whole));
  DEA_TRY(ctx, charge(ctx, table, &table->last, half_s, middle_V, &half));
  DEA_TRY(ctx, charge(ctx, table, &half, half_s, to_V, &table->trial));
  DEA_TRY(ctx, solve(ctx, table, table->trial.voltage_V, out));
  table->largest_V = fmax(table->largest_V, fabs(to_V));
  *error = fabs(table->trial.voltage_V - whole.voltage_V) / fmax(table->largest_V, 1);
  out->current_A = table->circuit.series_resistance_ohm > 0 ? table->trial.current_A : (double)NAN;
  return DEA_OK;
}

static void accept(struct dea_model *table)
{
  table->last = table->trial;
}

const struct dea_model_type dea_film_table_type = {.name = "3d",
                                                   .long_name = "3D solid, at rest",
                                                   .any_layout = true,
                                                   .destroy = destroy,
                                                   .solve = solve,
                                                   .begin = begin,
                                                   .advance = advance,
                                                   .accept = accept};
