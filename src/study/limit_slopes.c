#include "study/limit_slopes.h"

#include "result/columns.h"
#include "study/design_gradient.h"
#include "study/number_rows.h"

#include <math.h>
#include <string.h>

static const char study_name[] = "sensitivity";

// Tables -----------------------------------------------------------------------------------------

#define LIMIT DEA_TEXT_COLUMN("limit", "limit", "slack, breakdown, pull_in or buckling")
#define LIMIT_VOLTAGE DEA_KV("voltage_V", "at", "voltage at which the film comes to it")

static const struct dea_result_column slope_columns[] = {
    LIMIT,
    LIMIT_VOLTAGE,
    DEA_NUMBER_IN_ROW,
    DEA_BARE("slope", "slope", "of the voltage by the number, V by its unit"),
    DEA_BARE("elasticity", "per cent by one per cent", "d ln(voltage) / d ln(number)"),
    DEA_NUMBER_TOLERANCE,
    DEA_NUMBER_COLUMN("change_V", "V", "V", 1, "change by tolerance", "of the voltage"),
};
static const struct dea_result_table_type slope_table = DEA_RESULT_TABLE(
    study_name, "limit_slopes", slope_columns,
    .title = "slopes of the limits by the design's numbers", .where = DEA_IN_JSON | DEA_IN_CSV);

static const struct dea_result_column matter_columns[] = {
    LIMIT,
    LIMIT_VOLTAGE,
    DEA_TEXT_COLUMN("number", "1 % of", "of the design"),
    DEA_TEXT_COLUMN("number_text", "value", "of the number"),
    DEA_BARE("change", "changes it by, %", "in per cent by one per cent"),
    DEA_TEXT_COLUMN("tolerance_text", "tolerance", "of the workshop"),
    DEA_TEXT_COLUMN("change_text", "changes", "of the voltage by the tolerance"),
};
static const struct dea_result_table_type matter_table = DEA_RESULT_TABLE(
    study_name, "limits", matter_columns, .title = "what moves the limits", .where = DEA_IN_SCREEN);

// One limit --------------------------------------------------------------------------------------

/* A limit that was found, with slopes [number_count] of its voltage. */
struct found {
  const struct dea_critical_kind *limit;
  double voltage_V;
  struct dea_design_number numbers[DEA_NUMBERS_MAX];
  size_t number_count;
  double slopes[DEA_NUMBERS_MAX];
};

static double elasticity(const struct found *f, size_t i)
{
  return f->slopes[i] * f->numbers[i].value / f->voltage_V;
}

static dea_status add_slopes(struct dea_context *ctx, const struct found *f,
                             struct dea_result_table *table)
{
  for (size_t i = 0; i < f->number_count; i++) {
    const struct dea_design_number *number = &f->numbers[i];
    if (!isnan(f->slopes[i])) {
      DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_TEXT_CELL(dea_event_name(f->limit->kind)),
                                 DEA_CELL(f->voltage_V), DEA_TEXT_CELL(number->key),
                                 DEA_CELL(number->value), DEA_TEXT_CELL(number->unit),
                                 DEA_CELL(f->slopes[i]), DEA_CELL(elasticity(f, i)),
                                 DEA_CELL(number->tolerance),
                                 DEA_CELL(f->slopes[i] * number->tolerance)));
    }
  }
  return DEA_OK;
}

/* Numbers by how much they matter, most first. */
static dea_status add_matter(struct dea_context *ctx, const struct found *f,
                             struct dea_result_table *table)
{
  double size[DEA_NUMBERS_MAX];
  size_t order[DEA_NUMBERS_MAX];
  for (size_t i = 0; i < f->number_count; i++) {
    size[i] = fabs(elasticity(f, i));
  }
  const size_t count = dea_numbers_order(size, f->number_count, order);
  for (size_t n = 0; n < count; n++) {
    const size_t best = order[n];
    const struct dea_design_number *number = &f->numbers[best];
    const struct dea_tolerated tolerated = dea_number_tolerated(number, f->slopes[best], "V");
    char value[48];
    dea_number_text(number->value, number->unit, value, sizeof value);
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_TEXT_CELL(f->limit->title), DEA_CELL(f->voltage_V),
                               DEA_TEXT_CELL(number->key), DEA_TEXT_CELL(value),
                               DEA_CELL(elasticity(f, best)), DEA_TEXT_CELL(tolerated.tolerance),
                               DEA_TEXT_CELL(tolerated.change)));
  }
  return DEA_OK;
}

static dea_status add_table(struct dea_context *ctx, const char *model, const struct found *f,
                            struct dea_result *result)
{
  struct dea_result_table *table;
  DEA_TRY(ctx, dea_result_get_table(ctx, result, &matter_table, model, &table));
  DEA_TRY(ctx, add_matter(ctx, f, table));
  DEA_TRY(ctx, dea_result_get_table(ctx, result, &slope_table, model, &table));
  return add_slopes(ctx, f, table);
}

/* Whether a curve has gone over to another state, as a film does that buckles. */
static bool leaves_a_state(const struct dea_curve *curve)
{
  for (size_t i = 0; i < curve->count; i++) {
    if ((curve->points[i].own_flags & 1u << DEA_FLAG_STATES) != 0) {
      return dea_curve_first_event(curve, DEA_EVENT_PULL_IN) == NULL;
    }
  }
  return false;
}

/* Whether the curves of a model have come to a limit; so of a result without curves. */
static bool comes_to(const struct dea_result *result, const char *model, enum dea_event_kind kind)
{
  bool any = false;
  for (size_t c = 0; c < result->curve_count; c++) {
    const struct dea_curve *curve = &result->curves[c];
    const bool is_sweep = strcmp(curve->kind, "sweep") == 0;
    if (strcmp(curve->model, model) != 0 || (!is_sweep && strcmp(curve->kind, "path") != 0)) {
      continue;
    }
    any = true;
    if (dea_curve_first_event(curve, kind) != NULL ||
        (kind == DEA_EVENT_BUCKLING && leaves_a_state(curve))) {
      return true;
    }
    const bool of_points = kind == DEA_EVENT_SLACK || kind == DEA_EVENT_BREAKDOWN;
    for (size_t i = 0; i < curve->count && of_points; i++) {
      const struct dea_load_point *p = &curve->points[i];
      if (kind == DEA_EVENT_SLACK ? p->min_tension_N_per_m <= 0 : p->breakdown_margin <= 0) {
        return true;
      }
    }
  }
  return !any && kind != DEA_EVENT_BUCKLING;
}

static dea_status find(struct dea_context *ctx, const struct dea_critical_request *ask,
                       const struct dea_result *result, struct found *f)
{
  struct dea_critical critical;
  dea_status status = dea_critical_find(ctx, ask, &critical);
  f->voltage_V = critical.voltage_V;
  if (status == DEA_OK && !isnan(f->voltage_V)) {
    status = dea_design_numbers(ctx, result->design, result->device, f->voltage_V, false,
                                f->numbers, &f->number_count);
    dea_numbers_at_rest(result->device, f->numbers, &f->number_count);
    const struct dea_design_gradient of = {.type = ask->type,
                                           .design = result->design,
                                           .device = result->device,
                                           .numbers = f->numbers,
                                           .number_count = f->number_count};
    status =
        status == DEA_OK ? dea_design_gradient_critical(ctx, &of, &critical, f->slopes) : status;
  }
  dea_critical_end(ctx, &critical);
  return status;
}

dea_status dea_limit_slopes_add(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_model_type *type = job->type;
  struct dea_result *result = job->result;
  struct dea_model_settings settings = dea_model_settings_of(result->design);
  const double highest_V = dea_design_highest_V(result->design);
  struct found *f = dea_alloc(ctx, 1, sizeof *f);
  dea_status status = f != NULL ? DEA_OK : DEA_E_MEMORY;
  settings.domain = result->device->disc ? settings.domain : DEA_DOMAIN_DISC;
  for (size_t i = 0; i < DEA_CRITICAL_KINDS && status == DEA_OK && highest_V > 0; i++) {
    const struct dea_critical_request ask = {.type = type,
                                             .device = result->device,
                                             .settings = &settings,
                                             .kind = dea_critical_kinds[i].kind,
                                             .first_V = highest_V / 4,
                                             .highest_V = highest_V};
    if (comes_to(result, type->name, dea_critical_kinds[i].kind)) {
      f->limit = &dea_critical_kinds[i];
      status = find(ctx, &ask, result, f);
      status =
          status == DEA_OK && !isnan(f->voltage_V) ? add_table(ctx, type->name, f, result) : status;
    }
  }
  dea_free(ctx, f);
  return DEA_CHAIN(ctx, status);
}
