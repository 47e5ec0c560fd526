/* summary.json: what a study in time says of itself. */
#include "output/summary_studies.h"

#include "result/columns.h"
#include "result/time_series.h"

#include <math.h>

static json_t *cycle_json(const struct dea_cycle *cycle)
{
  json_t *object = json_object();
  dea_json_put(object, "start_s", cycle->start_s);
  dea_json_put(object, "end_s", cycle->end_s);
  dea_json_put(object, "level_V", cycle->level_V);
  dea_json_put(object, "amplitude", cycle->amplitude);
  dea_json_put(object, "farthest", cycle->farthest);
  dea_json_put(object, "highest", cycle->highest);
  dea_json_put(object, "lowest", cycle->lowest);
  dea_json_put(object, "rise_time_10_90_s", cycle->rise_time_s);
  return object;
}

/* From the first to the last cycle of each voltage. */
static json_t *creep_json(const struct dea_cycle *cycles, size_t count)
{
  json_t *list = json_array();
  for (size_t first = 0, last; first < count; first = last + 1) {
    last = dea_time_series_level_end(cycles, count, first);
    json_t *object = json_object();
    dea_json_put(object, "level_V", cycles[first].level_V);
    json_object_set_new(object, "cycles", json_integer((json_int_t)(last - first + 1)));
    dea_json_put(object, "first", cycles[first].farthest);
    dea_json_put(object, "last", cycles[last].farthest);
    dea_json_put(object, "creep", cycles[last].farthest - cycles[first].farthest);
    json_array_append_new(list, object);
  }
  return list;
}

static json_t *energy_json(const struct dea_energy_balance *energy)
{
  json_t *object = json_object();
  dea_json_put(object, "supply_work_J", energy->supply_work_J);
  dea_json_put(object, "stored_J", energy->stored_J);
  dea_json_put(object, "kinetic_J", energy->kinetic_J);
  dea_json_put(object, "dissipated_J", energy->dissipated_J);
  dea_json_put(object, "not_accounted", energy->error);
  return object;
}

dea_status dea_summary_put_transient(struct dea_context *ctx, const struct dea_result *result,
                                     const char *model, json_t *parent)
{
  const struct dea_curve *curve = dea_result_find(result, model, "transient");
  struct dea_energy_balance energy;
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  json_t *object = json_object();
  json_object_set_new(object, "points", json_integer((json_int_t)curve->count));
  dea_json_put(object, "end_s", curve->points[curve->count - 1].time_s);
  if (dea_time_series_balance(curve, &energy)) {
    json_object_set_new(object, "energy", energy_json(&energy));
  }
  json_object_set_new(parent, "transient", object);
  int column = dea_time_series_column(curve);
  if (result->design == NULL || result->design->drive.waveform == NULL || column < 0) {
    return DEA_OK;
  }
  struct dea_cycle *cycles;
  size_t count;
  DEA_TRY(ctx, dea_time_series_cycles(ctx, curve, result->design->drive.waveform, column, &cycles,
                                      &count));
  json_t *list = json_array();
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(list, cycle_json(&cycles[i]));
  }
  dea_json_put_text(object, "quantity", dea_point_columns[column].key);
  json_object_set_new(object, "cycles", list);
  json_object_set_new(object, "creep", creep_json(cycles, count));
  dea_free(ctx, cycles);
  return DEA_OK;
}
