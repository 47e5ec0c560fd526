#include "job/report_reduced.h"

#include "base/file.h"
#include "base/json.h"
#include "base/write_file.h"
#include "model/reduced/reduced.h"
#include "result/observation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FILE_MAX = 1 << 26 };

/* Title of a column of load points (column), or of a monitor's motion (column 0). */
static json_t *title_json(struct dea_context *ctx, const struct dea_device *device, int column,
                          size_t monitor, int motion)
{
  char name[DEA_KEY_PART_SIZE], key[DEA_KEY_PART_SIZE + 32];
  if (column == 0) {
    dea_key_part(device->layout->monitors[monitor].name, name);
    snprintf(key, sizeof key, "%s_%s", name, dea_observed_columns[motion].key);
    column = dea_column_find(ctx, key);
  }
  const struct dea_column *of = column >= 0 ? dea_column_at(ctx, column) : &dea_point_columns[0];
  return json_pack("{s:s, s:s, s:s, s:f}", "key", of->key, "title", of->header, "unit",
                   of->display_unit, "factor", of->factor);
}

/* The file with the titles of its numbers, its coordinate's first. */
static dea_status add_titles(struct dea_context *ctx, const struct dea_reduced_order *o,
                             const char *bytes, size_t length, struct dea_report_run *io)
{
  json_t *root = json_loadb(bytes, length, 0, NULL), *titles = json_array();
  const struct dea_control *c = &o->coordinate;
  json_array_append_new(titles, title_json(ctx, io->device, c->column, c->body, c->component));
  for (size_t i = 0; i < o->output_count; i++) {
    const struct dea_reduced_output *of = &o->outputs[i];
    json_array_append_new(titles,
                          title_json(ctx, io->device, of->column, of->monitor, (int)of->motion));
  }
  json_object_set_new(root, "quantities", titles);
  return dea_json_text(ctx, root, &io->reduced);
}

/* Of a displacement: the largest force that holds it where it is at 0 V, at voltages of the sweep
 * to be trusted and below breakdown. */
static void find_blocked(const struct dea_reduced_order *o, const struct dea_curve *sweep,
                         struct dea_report_run *io)
{
  struct dea_reduced_point rest = {0};
  bool turns = dea_reduced_order_turns(o);
  io->blocked_N = io->blocked_V = NAN;
  if (turns || dea_reduced_at(&o->core, 0, 0, &rest) != DEA_REDUCED_OK) {
    return;
  }
  for (size_t i = 0; i < sweep->count; i++) {
    const struct dea_load_point *p = &sweep->points[i];
    struct dea_reduced_point held = {0};
    if (dea_load_point_trusted(p) && dea_load_point_safe(p) &&
        dea_reduced_held(&o->core, rest.q, p->voltage_V, &held) == DEA_REDUCED_OK &&
        !(fabs(held.force) <= io->blocked_N)) {
      io->blocked_N = fabs(held.force);
      io->blocked_V = p->voltage_V;
    }
  }
}

dea_status dea_report_reduced(struct dea_context *ctx, struct dea_report_run *io)
{
  const struct dea_curve *sweep = dea_result_find(io->run->result, "reduced", "sweep");
  if (io->device == NULL || sweep == NULL) {
    return DEA_OK;
  }
  const struct dea_model_settings settings = dea_model_settings_of(io->design);
  const char *file = settings.reduced.file;
  struct dea_reduced_order *order;
  char *bytes = NULL;
  size_t length;
  if (file == NULL || !dea_path_exists(file)) {
    return DEA_OK;
  }
  dea_status status = dea_reduced_order_read(ctx, file, io->device, &settings, &order);
  if (status != DEA_OK && status != DEA_E_MEMORY) { // made anew for another design since
    dea_context_clear(ctx);
    return DEA_OK;
  }
  status = status != DEA_OK ? status : dea_file_read(ctx, file, FILE_MAX, &bytes, &length);
  if (status == DEA_OK) {
    find_blocked(order, sweep, io);
    status = add_titles(ctx, order, bytes, length, io);
  }
  dea_free(ctx, bytes);
  dea_reduced_order_destroy(ctx, order);
  return status;
}
