/* Study "modal": frequencies and shapes of small vibrations about voltages. */
#include "study/modal.h"
#include "base/schema.h"
#include "study/observe.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "modal";

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.modal. */
struct settings {
  struct dea_quantity count;                            // modes
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: 0 and quarters of the highest
  size_t voltage_count;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    DEA_INTEGER_ROW("count", AT(count), "6", "how many modes, from the lowest on", .min = 1,
                    .max = DEA_DESIGN_MODES_MAX, .default_text = "6"),
    DEA_STUDY_STOPS_FIELD("0 V and the quarters of the highest",
                          "voltages that the actuator vibrates about, in the order to be computed",
                          "[0 kV, 4 kV, 8 kV]"),
};

static const struct dea_design_section section = {
    .record = {study_name,
               "study of vibrations, made when this section is there ({}) or with --study: "
               "frequencies and shapes about voltages (3d)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings)};

bool dea_modal_asked(const struct dea_design *design)
{
  const struct dea_settings *settings = dea_design_settings(design, &section);
  return settings != NULL && settings->written;
}

// Study ------------------------------------------------------------------------------------------

/* The modes at one voltage. */
static dea_status solve_modes(struct dea_context *ctx, const struct dea_study_job *job,
                              const struct dea_load_point *at, size_t stop, struct dea_curve *curve)
{
  const struct dea_model_type *type = job->type;
  const struct settings *settings = dea_design_settings(job->result->design, &section)->values;
  size_t count = (size_t)settings->count.si;
  struct dea_load_point points[DEA_DESIGN_MODES_MAX];
  struct dea_field_mesh *shapes;
  char name[DEA_NAME_SIZE];
  DEA_TRY(ctx, type->modes(ctx, job->model, at, count, points, &shapes));
  snprintf(name, sizeof name, "%.50s" DEA_SHAPES_SUFFIX, type->name);
  DEA_TRY(ctx, dea_result_add_surface(ctx, job->result, name, stop, at->voltage_V, shapes));
  struct dea_monitor_set set;
  dea_status status = dea_monitor_set_init(ctx, type, job->result->device, &set);
  for (size_t k = 0; k < count && status == DEA_OK; k++) {
    status = dea_monitor_set_read(ctx, &set, type, job->model, false, &points[k]);
    status = status == DEA_OK ? dea_curve_add_point(ctx, curve, &points[k]) : status;
  }
  dea_monitor_set_free(&set);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_design *design = job->result->design;
  const struct settings *settings = dea_design_settings(design, &section)->values;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  size_t count =
      dea_study_stops(design, settings->voltages_V, settings->voltage_count, true, voltages_V);
  return DEA_CHAIN(
      ctx, dea_study_stop_by_stop(ctx, job, study_name, true, voltages_V, count, solve_modes));
}

// Table ------------------------------------------------------------------------------------------

static const struct dea_result_column mode_columns[] = {
    DEA_KV("voltage_V", "V", "voltage that it vibrates about"),
    DEA_RESULT_COLUMN(COUNT, "mode", "mode", .meaning = "from the lowest on"),
    DEA_NUMBER_COLUMN("frequency_Hz", "Hz", "Hz", 1, "frequency", "in vacuo; negative: unstable"),
    DEA_NUMBER_COLUMN("mode_out_of_plane", "1", "%", 100, "out of plane",
                      "share of its kinetic energy that is out of the plane"),
    DEA_NUMBER_COLUMN("mode_centre", "1", "%", 100, "centre",
                      "displacement of the centre out of the plane over its largest one"),
    DEA_TEXT_COLUMN("flags", "flags", "why the state that it vibrates about is not to be trusted"),
};
static const struct dea_result_table_type mode_table =
    DEA_RESULT_TABLE(study_name, "modes", mode_columns, .title = "modes in vacuo",
                     .where = DEA_IN_SCREEN); // CSV and JSON have its points

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  const struct dea_curve *curve = dea_result_find(result, model, study_name);
  struct dea_result_table *table;
  if (curve == NULL || curve->count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &mode_table, model, 0, &table));
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    char flags[DEA_FLAGS_SIZE];
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(p->voltage_V), DEA_CELL(p->mode),
                               DEA_CELL(p->frequency_Hz), DEA_CELL(p->mode_out_of_plane),
                               DEA_CELL(p->mode_centre),
                               DEA_TEXT_CELL(dea_flags_text(dea_load_point_flags(p), flags))));
  }
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

enum { COLOURS = 6, MARKERS = 5 }; // the first of them

/* The k-th mode of a curve; nothing where it has no such one. */
static dea_status add_mode(struct dea_context *ctx, struct dea_panel *panel,
                           const struct dea_curve *curve, int k)
{
  struct dea_series *series;
  size_t count = 0;
  for (size_t i = 0; i < curve->count; i++) {
    count += (int)curve->points[i].mode == k;
  }
  if (count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_panel_add(ctx, panel, count, DEA_LINE_MARKED,
                             (enum dea_colour)((k - 1) % COLOURS), "", &series));
  series->marker = (k - 1) % MARKERS;
  snprintf(series->title, sizeof series->title, "%d", k);
  for (size_t i = 0, n = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    if ((int)p->mode == k) {
      series->values[n] = 1e-3 * p->voltage_V;
      series->values[count + n++] = p->frequency_Hz > 0 ? p->frequency_Hz : 0; // unstable
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  for (size_t i = 0; i < result->curve_count; i++) {
    const struct dea_curve *curve = &result->curves[i];
    for (int k = 1; k <= DEA_DESIGN_MODES_MAX && strcmp(curve->kind, study_name) == 0; k++) {
      DEA_TRY(ctx, add_mode(ctx, panel, curve, k));
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Frequency {/:Italic f} (Hz)");
  dea_panel_voltage_axis(panel);
  panel->y_min = 0;
  panel->key = "above horizontal maxrows 1 samplen 1.5";
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("modes", study_name, build,
                     "frequencies of the lowest modes in vacuo against the voltage; 0: unstable"),
};

// The study --------------------------------------------------------------------------------------

static dea_status refuse(struct dea_context *ctx, const struct dea_design *design,
                         const struct dea_device *device)
{
  const struct settings *settings = dea_design_settings(design, &section)->values;
  return dea_device_refuse_densities(ctx, settings->count.location, device);
}

const struct dea_study dea_study_modal = {
    .name = study_name,
    .keys = &section,
    .own_models = true,
    .ability = "vibrations",
    .able_by = offsetof(struct dea_model_type, modes),
    .refuse = refuse,
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
