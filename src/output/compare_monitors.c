/* Monitors of two runs of devices made of plies, set beside each other against the voltage. */
#include "output/compare_set.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Where a copy of a sweep carries what a monitor shows: devices made of plies have none of it. */
static const char carrier[] = "centre_z_m";

static const struct dea_result_table *monitors_of(const struct dea_result *result,
                                                  const char *model)
{
  return result != NULL ? dea_result_find_table(result, model, "sweep", "monitors") : NULL;
}

/* Name of the monitor that a row is of; lent. */
static const char *name_of(const struct dea_result_table *table, size_t row)
{
  for (size_t c = 0; c < table->type.column_count; c++) {
    const char *text = dea_result_table_cell(table, row, c)->text;
    if (table->type.columns[c].kind == DEA_CELL_TEXT && text != NULL) {
      return text;
    }
  }
  return "";
}

/* Whether a column is what monitors show: neither where nor its estimated error. */
static bool is_shown(const struct dea_result_column *column)
{
  return column->kind == DEA_CELL_NUMBER && !column->list &&
         strcmp(column->key, "voltage_V") != 0 && strstr(column->key, "error") == NULL;
}

static bool is_first(const struct dea_result_table *table, size_t row)
{
  for (size_t i = 0; i < row; i++) {
    if (strcmp(name_of(table, i), name_of(table, row)) == 0) {
      return false;
    }
  }
  return true;
}

/* The largest size of a column; name: of that monitor alone, NULL: of all. */
static double largest(const struct dea_result_table *table, const char *key, const char *name)
{
  double size = 0;
  for (size_t row = 0; row < table->row_count; row++) {
    if (name == NULL || strcmp(name_of(table, row), name) == 0) {
      size = fmax(size, fabs(dea_result_table_number(table, row, key, 0))); // not of NAN
    }
  }
  return size;
}

/* Whether a motion or force is rounding beside those of its unit: a centre that a mirror holds, to
 * 1e-20 m. Of numbers around 1 none is. */
static bool is_rounding(const struct dea_result_table *tables[2],
                        const struct dea_result_column *column, const char *name)
{
  static const double share = 1e-6, least_si = 1e-12;
  double own = 0, all = 0;
  for (size_t t = 0; t < 2; t++) {
    own = fmax(own, largest(tables[t], column->key, name));
    for (size_t c = 0; c < tables[t]->type.column_count; c++) {
      const struct dea_result_column *other = &tables[t]->type.columns[c];
      if (is_shown(other) && strcmp(other->si_unit, column->si_unit) == 0) {
        all = fmax(all, largest(tables[t], other->key, NULL));
      }
    }
  }
  return strcmp(column->si_unit, "1") != 0 && own <= fmax(least_si, share * all);
}

/* A copy of a model's sweep that carries what a monitor shows; its points are owned. */
static dea_status copy_sweep(struct dea_context *ctx, const struct dea_result *result,
                             const struct dea_result_table *table, const char *key,
                             const char *name, struct dea_curve *out)
{
  const struct dea_curve *sweep = dea_result_find(result, table->model, "sweep");
  const int column = dea_point_column_find(carrier);
  const size_t count = sweep != NULL ? sweep->count : 0;
  snprintf(out->model, sizeof out->model, "%s", table->model);
  snprintf(out->kind, sizeof out->kind, "sweep");
  out->points = dea_alloc(ctx, count + 1, sizeof *out->points);
  if (out->points == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < count; i++) {
    out->points[i] = sweep->points[i];
    dea_point_set(&out->points[i], column, NAN);
  }
  out->count = count;
  for (size_t row = 0, i = 0; row < table->row_count && i < count; row++) {
    if (strcmp(name_of(table, row), name) == 0) { // one at each point that was solved
      double voltage_V = dea_result_table_number(table, row, "voltage_V", 0);
      while (i < count && out->points[i].voltage_V != voltage_V) {
        i++;
      }
      if (i < count) {
        dea_point_set(&out->points[i++], column, dea_result_table_number(table, row, key, 0));
      }
    }
  }
  return DEA_OK;
}

void dea_set_monitor_destroy(struct dea_context *ctx, struct dea_set_monitor *monitor)
{
  if (monitor != NULL) {
    dea_comparison_destroy(ctx, monitor->comparison);
    dea_free(ctx, monitor->a.points);
    dea_free(ctx, monitor->b.points);
    dea_free(ctx, monitor);
  }
}

enum { KEY_SIZE = 2 * DEA_NAME_SIZE };

/* "hub.z_m". */
static void name_key(const struct dea_result_column *column, const char *name, char out[KEY_SIZE])
{
  snprintf(out, KEY_SIZE, "%.63s.%.40s", name, column->key);
}

/* "hub.z_m" and "hub, z". */
static dea_status name_quantity(struct dea_context *ctx, const struct dea_result_column *column,
                                const char *name, struct dea_column *out)
{
  char key[KEY_SIZE], header[KEY_SIZE];
  name_key(column, name, key);
  snprintf(header, sizeof header, "%.63s, %.40s", name, column->title);
  *out = (struct dea_column){.key = dea_intern(ctx, key),
                             .si_unit = column->si_unit,
                             .display_unit = column->display_unit,
                             .factor = column->factor,
                             .header = dea_intern(ctx, header),
                             .meaning = column->meaning};
  return out->key != NULL && out->header != NULL ? DEA_OK : DEA_E_MEMORY;
}

static bool is_asked(const struct dea_compare_ask *ask, const char *key)
{
  for (size_t i = 0; i < ask->monitor_count; i++) {
    if (strcmp(ask->monitors[i], key) == 0) {
      return true;
    }
  }
  return false;
}

/* Compares the two sweeps of a monitor that is filled but for that; nothing in common: no more. */
static dea_status finish(struct dea_context *ctx, struct dea_compare_set *set,
                         struct dea_set_monitor *monitor)
{
  dea_status status = dea_compare_curves(ctx, &monitor->a, &monitor->b, NULL,
                                         dea_point_column_find(carrier), &monitor->comparison);
  if (status == DEA_E_ARGUMENT) {
    dea_context_clear(ctx);
    dea_set_monitor_destroy(ctx, monitor);
    return DEA_OK;
  }
  struct dea_set_monitor **all =
      status == DEA_OK
          ? dea_resize(ctx, set->monitors, set->monitor_count + 1, sizeof(struct dea_set_monitor *))
          : NULL;
  if (all == NULL) {
    dea_set_monitor_destroy(ctx, monitor);
    return status == DEA_OK ? DEA_E_MEMORY : status;
  }
  monitor->comparison->misfits[0].quantity = &monitor->quantity;
  set->monitors = all;
  set->monitors[set->monitor_count++] = monitor;
  return DEA_OK;
}

static dea_status add(struct dea_context *ctx, struct dea_compare_set *set, size_t curve,
                      const struct dea_result_table *tables[2],
                      const struct dea_result_column *column, const char *name)
{
  struct dea_set_monitor *monitor = dea_alloc(ctx, 1, sizeof *monitor);
  if (monitor == NULL) {
    return DEA_E_MEMORY;
  }
  monitor->curve = curve;
  dea_status status = name_quantity(ctx, column, name, &monitor->quantity);
  status = status == DEA_OK ? copy_sweep(ctx, set->curves[curve].result, tables[0], column->key,
                                         name, &monitor->a)
                            : status;
  status = status == DEA_OK
               ? copy_sweep(ctx, set->reference_result, tables[1], column->key, name, &monitor->b)
               : status;
  if (status != DEA_OK) {
    dea_set_monitor_destroy(ctx, monitor);
    return status;
  }
  DEA_TRY(ctx, finish(ctx, set, monitor));
  return DEA_OK;
}

dea_status dea_compare_set_add_monitors(struct dea_context *ctx, struct dea_compare_set *set,
                                        size_t curve, const struct dea_compare_ask *ask)
{
  const struct dea_set_curve *c = &set->curves[curve];
  const struct dea_result_table *tables[2] = {
      monitors_of(c->result, c->model), monitors_of(set->reference_result, c->reference->model)};
  const bool all = ask->monitor_count == 0;
  if (tables[0] == NULL || tables[1] == NULL || (all && ask->column_count > 0)) {
    return DEA_OK;
  }
  for (size_t row = 0; row < tables[0]->row_count; row++) {
    const char *name = name_of(tables[0], row);
    for (size_t k = 0; k < tables[0]->type.column_count && is_first(tables[0], row); k++) {
      const struct dea_result_column *column = &tables[0]->type.columns[k];
      char key[KEY_SIZE];
      name_key(column, name, key);
      if (is_shown(column) && (all ? !is_rounding(tables, column, name) : is_asked(ask, key))) {
        DEA_TRY(ctx, add(ctx, set, curve, tables, column, name));
      }
    }
  }
  return DEA_OK;
}
