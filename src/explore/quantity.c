#include "explore/quantity.h"

#include "base/text.h"
#include "study/critical.h"
#include "study/observe.h"

#include <stdio.h>
#include <string.h>

static const struct dea_result_column motions[] = {DEA_OBSERVED_COLUMNS};

/* Whether a monitor has such a quantity. */
static bool has(enum dea_layout_monitor_kind kind, int observed)
{
  switch (kind) {
  case DEA_MONITOR_POINT:
    return observed <= DEA_OBSERVED_Z;
  case DEA_MONITOR_LINE:
    return observed == DEA_OBSERVED_STRETCH;
  case DEA_MONITOR_REGION:
    return observed <= DEA_OBSERVED_Z ||
           (observed >= DEA_OBSERVED_STRETCH_X && observed <= DEA_OBSERVED_AREA_STRETCH);
  default:
    return observed <= DEA_OBSERVED_TURN_Z || observed >= DEA_OBSERVED_FORCE_X;
  }
}

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
  const char *keys[DEA_LOAD_POINT_COLUMNS + DEA_CRITICAL_KINDS];
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    keys[c] = dea_point_columns[c].key;
  }
  for (int i = 0; i < DEA_CRITICAL_KINDS; i++) {
    keys[DEA_LOAD_POINT_COLUMNS + i] = dea_critical_kinds[i].key;
  }
  return dea_explore_unknown(ctx, label, "quantity", keys,
                             DEA_LOAD_POINT_COLUMNS + DEA_CRITICAL_KINDS);
}

/* What a monitor does have. */
static dea_status no_motion(struct dea_context *ctx, const struct dea_label *label,
                            const struct dea_layout_monitor *monitor)
{
  struct dea_text known = {.ctx = ctx};
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    if (has(monitor->kind, k)) {
      dea_text_add(&known, "%s%s", known.length > 0 ? ", " : "", motions[k].key);
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

static dea_status of_monitor(struct dea_context *ctx, const struct dea_layout *layout,
                             const struct dea_label *label, const char *dot,
                             struct dea_explored *out, bool *good)
{
  const size_t length = (size_t)(dot - label->text);
  const struct dea_layout_monitor *monitor = NULL;
  for (size_t i = 0; i < layout->monitor_count; i++) {
    const char *name = layout->monitors[i].name;
    if (strlen(name) == length && memcmp(name, label->text, length) == 0) {
      monitor = &layout->monitors[i];
      out->monitor = i;
    }
  }
  if (monitor == NULL) {
    return dea_finding_add(ctx, DEA_ERROR, label->location,
                           "'%.60s' is no quantity: the design has no monitor '%.*s'", label->text,
                           (int)(length < 40 ? length : 40), label->text);
  }
  for (int k = 0; k < DEA_OBSERVED_COUNT; k++) {
    if (strcmp(motions[k].key, dot + 1) == 0 && has(monitor->kind, k)) {
      out->observed = (enum dea_observed)k;
      out->column = -1;
      snprintf(out->header, sizeof out->header, "%.40s %s", monitor->name, motions[k].title);
      out->shown =
          (struct dea_column){out->key,          motions[k].si_unit, motions[k].display_unit,
                              motions[k].factor, out->header,        motions[k].meaning};
      *good = true;
      return DEA_OK;
    }
  }
  return no_motion(ctx, label, monitor);
}

dea_status dea_explored_find(struct dea_context *ctx, const struct dea_device *device,
                             const struct dea_label *label, struct dea_explored *out, bool *good)
{
  const char *dot = strrchr(label->text, '.');
  *good = false;
  *out = (struct dea_explored){.column = dea_point_column_find(label->text)};
  if (strlen(label->text) >= sizeof out->key) {
    return no_quantity(ctx, label);
  }
  snprintf(out->key, sizeof out->key, "%.79s", label->text);
  if (out->column >= 0) {
    out->shown = dea_point_columns[out->column];
    out->is_frequency = strcmp(out->key, "frequency_Hz") == 0;
    *good = true;
    return DEA_OK;
  }
  for (int i = 0; i < DEA_CRITICAL_KINDS; i++) {
    const struct dea_critical_kind *critical = &dea_critical_kinds[i];
    if (strcmp(label->text, critical->key) == 0) {
      out->is_critical = true;
      out->event = critical->kind;
      out->shown =
          (struct dea_column){out->key, "V", "kV", 1e-3, critical->title, critical->meaning};
      *good = true;
      return DEA_OK;
    }
  }
  return dot != NULL && device->general ? of_monitor(ctx, device->layout, label, dot, out, good)
                                        : no_quantity(ctx, label);
}
