#include "explore/quantity.h"

#include "base/text.h"
#include "study/critical.h"

#include <stdio.h>
#include <string.h>

dea_status dea_explore_unknown(struct dea_context *ctx, const struct dea_label *label,
                               const char *what, const char *const names[], size_t count)
{
  const char *nearest = dea_nearest_name(label->text, names, count);
  return dea_finding_add(ctx, DEA_ERROR, label->location, "'%.60s' is no %s%s%s%s", label->text,
                         what, nearest != NULL ? "; did you mean '" : "",
                         nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

static dea_status no_quantity(struct dea_context *ctx, const struct dea_label *label)
{
  const size_t count = (size_t)dea_column_count(ctx);
  const char **keys = dea_column_keys(ctx);
  const char **all =
      keys != NULL ? dea_resize(ctx, keys, count + DEA_CRITICAL_KINDS, sizeof *all) : NULL;
  if (all == NULL) {
    dea_free(ctx, keys);
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < DEA_CRITICAL_KINDS; i++) {
    all[count + i] = dea_critical_kinds[i].key;
  }
  const dea_status status =
      dea_explore_unknown(ctx, label, "quantity", all, count + DEA_CRITICAL_KINDS);
  dea_free(ctx, all);
  return status;
}

/* Monitor whose name or part of a key the text begins with; NULL: none. */
static const struct dea_layout_monitor *monitor_of(const struct dea_device *device,
                                                   const char *text)
{
  const struct dea_layout *layout = device->layout;
  for (size_t i = 0; i < layout->monitor_count; i++) {
    const struct dea_layout_monitor *monitor = &layout->monitors[i];
    char part[DEA_KEY_PART_SIZE];
    const size_t length = strlen(monitor->name);
    dea_key_part(monitor->name, part);
    if ((strncmp(text, monitor->name, length) == 0 && text[length] == '.') ||
        (strncmp(text, part, strlen(part)) == 0 && text[strlen(part)] == '_')) {
      return monitor;
    }
  }
  return NULL;
}

/* What a monitor does have; of no monitor the nearest quantity. */
static dea_status refuse(struct dea_context *ctx, const struct dea_device *device,
                         const struct dea_label *label)
{
  const struct dea_layout_monitor *monitor = monitor_of(device, label->text);
  struct dea_text known = {.ctx = ctx};
  if (monitor == NULL) {
    return no_quantity(ctx, label);
  }
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    if (dea_observed_has(monitor->kind, (enum dea_observed)k)) {
      dea_text_add(&known, "%s%s", known.length > 0 ? ", " : "", dea_observed_columns[k].key);
    }
  }
  const dea_status status = known.failed
                                ? DEA_E_MEMORY
                                : dea_finding_add(ctx, DEA_ERROR, label->location,
                                                  "'%.60s' is no quantity: of '%.40s' there are %s",
                                                  label->text, monitor->name, dea_text_get(&known));
  dea_text_free(&known);
  return status;
}

static bool find_critical(struct dea_explored *out)
{
  for (int i = 0; i < DEA_CRITICAL_KINDS; i++) {
    const struct dea_critical_kind *critical = &dea_critical_kinds[i];
    if (strcmp(out->key, critical->key) == 0) {
      out->is_critical = true;
      out->event = critical->kind;
      out->shown =
          (struct dea_column){out->key, "V", "kV", 1e-3, critical->title, critical->meaning};
      return true;
    }
  }
  return false;
}

dea_status dea_explored_find(struct dea_context *ctx, const struct dea_device *device,
                             const struct dea_label *label, struct dea_explored *out, bool *good)
{
  *good = false;
  *out = (struct dea_explored){.column = -1};
  if (strlen(label->text) >= sizeof out->key) {
    return no_quantity(ctx, label);
  }
  snprintf(out->key, sizeof out->key, "%.79s", label->text);
  if (find_critical(out)) {
    *good = true;
    return DEA_OK;
  }
  if (dea_device_is_observed(device)) { // adds its columns to those that are looked through
    DEA_TRY(ctx, dea_layout_column_find(ctx, device->layout, -1, &out->of, &out->is_seen));
  }
  out->column = dea_column_find(ctx, label->text);
  if (out->column >= 0 && dea_device_is_observed(device)) {
    DEA_TRY(ctx, dea_layout_column_find(ctx, device->layout, out->column, &out->of, &out->is_seen));
    out->is_seen = out->is_seen && out->of.source != DEA_OF_MONITOR_ERROR;
  }
  if (out->column < 0 || (out->column >= DEA_LOAD_POINT_COLUMNS && !out->is_seen)) {
    return refuse(ctx, device, label);
  }
  out->shown = *dea_column_at(ctx, out->column);
  out->shown.key = out->key; // as the file has it
  out->is_frequency = out->column == dea_point_column_find("frequency_Hz");
  *good = true;
  return DEA_OK;
}
