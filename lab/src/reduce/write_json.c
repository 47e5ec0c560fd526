#include "reduce/output.h"

#include "base/version.h"
#include "base/write_file.h"
#include "plot/plot.h"

#include <stdio.h>

/* "NAME_UNIT", the number under it. */
static void add_kind(json_t *object, const char *name, enum dea_reduced_kind kind, double value)
{
  char key[48];
  snprintf(key, sizeof key, "%s_%s", name, dea_reduced_meanings[kind].si_unit);
  dea_json_add(object, key, value);
}

static json_t *recording_json(const struct dea_recording *recording)
{
  json_t *object = json_object();
  dea_json_add_text(object, "file", recording->file);
  dea_json_add_text(object, "title", recording->title);
  json_object_set_new(object, "complete", json_boolean(recording->complete));
  dea_json_add_text(object, "ended", recording->ended);
  dea_json_add_text(object, "design", recording->design_name);
  json_t *provenance =
      recording->provenance != NULL ? json_loads(recording->provenance, 0, NULL) : NULL;
  if (provenance != NULL) {
    json_object_set_new(object, "provenance", provenance);
  }
  return object;
}

static json_t *levelling_json(const struct dea_levelling *l)
{
  json_t *object = json_object();
  json_object_set_new(object, "by_frame", json_boolean(l->by_frame));
  dea_json_add(object, "centre_m", l->centre_m);
  dea_json_add(object, "tilt_rad", l->tilt_rad);
  dea_json_add(object, "offset_m", l->offset_m);
  dea_json_add(object, "offset_std_m", l->offset_std_m);
  dea_json_add(object, "frame_height_m", l->frame_height_m);
  dea_json_add(object, "left_edge_m", l->edges_m[0]);
  dea_json_add(object, "right_edge_m", l->edges_m[1]);
  dea_json_add(object, "beside_centre_m", l->beside_m);
  dea_json_add(object, "tip_radius_m", l->fibre_tip_radius_m);
  dea_json_add(object, "film_radius_m", l->film_radius_m);
  dea_json_add(object, "electrode_radius_m", l->electrode_radius_m);
  dea_json_add(object, "averaging_width_m", l->width_m);
  dea_json_add_count(object, "frames", l->frames);
  dea_json_add_count(object, "frames_at_rest", l->frames_at_rest);
  dea_json_add_count(object, "points", l->total);
  dea_json_add_count(object, "invalid_points", l->invalid);
  dea_json_add_count(object, "outliers", l->outliers);
  return object;
}

static json_t *level_json(const struct dea_voltage_level *level)
{
  json_t *object = json_object();
  dea_json_add(object, "voltage_V", level->voltage_V);
  dea_json_add_count(object, "step", level->step);
  dea_json_add_count(object, "cycles", level->cycles);
  dea_json_add(object, "shape", level->shape);
  dea_json_add(object, "shape_uncertainty", level->shape_uncertainty);
  dea_json_add(object, "capacitance_F", level->capacitance_F);
  dea_json_add(object, "capacitance_std_F", level->capacitance_std_F);
  dea_json_add(object, "sensed_stretch", level->sensed_stretch);
  for (int k = 0; k < DEA_REDUCED_KINDS; k++) {
    enum dea_reduced_kind kind = (enum dea_reduced_kind)k;
    if (isnan(level->mean[k])) {
      continue;
    }
    json_t *own = json_object();
    add_kind(own, "mean", kind, level->mean[k]);
    add_kind(own, "std", kind, level->std[k]);
    add_kind(own, "noise", kind, level->noise[k]);
    add_kind(own, "uncertainty", kind, level->uncertainty[k]);
    dea_json_add(own, "rise_s", level->rise_s[k]);
    dea_json_add(own, "fall_s", level->fall_s[k]);
    add_kind(own, "creep", kind, level->creep[k]);
    add_kind(own, "drift_per_cycle", kind, level->drift[k]);
    add_kind(own, "drift_uncertainty", kind, level->drift_uncertainty[k]);
    json_object_set_new(object, dea_reduced_meanings[k].key, own);
  }
  return object;
}

static json_t *cycle_json(const struct dea_reduced_cycle *cycle)
{
  json_t *object = json_object();
  dea_json_add_count(object, "step", cycle->cycle.step);
  dea_json_add_count(object, "number", cycle->cycle.number);
  dea_json_add(object, "start_s", cycle->cycle.start_s);
  dea_json_add(object, "end_s", cycle->cycle.end_s);
  dea_json_add(object, "under_voltage_s", cycle->under_voltage_s);
  dea_json_add(object, "asked_V", cycle->cycle.level_V);
  dea_json_add(object, "voltage_V", cycle->voltage_V);
  dea_json_add(object, "shape", cycle->shape);
  dea_json_add(object, "capacitance_F", cycle->capacitance_F);
  dea_json_add(object, "leakage_A", cycle->leakage_A);
  dea_json_add(object, "charge_C", cycle->charge_C);
  dea_json_add_count(object, "discharges", cycle->discharges);
  dea_json_add_count(object, "breakdowns", cycle->breakdowns);
  for (int k = 0; k < DEA_REDUCED_KINDS; k++) {
    const struct dea_cycle_value *v = &cycle->values[k];
    enum dea_reduced_kind kind = (enum dea_reduced_kind)k;
    if (isnan(v->amplitude)) {
      continue;
    }
    json_t *own = json_object();
    add_kind(own, "amplitude", kind, v->amplitude);
    add_kind(own, "uncertainty", kind, v->uncertainty);
    add_kind(own, "rest", kind, v->rest);
    add_kind(own, "active", kind, v->active);
    dea_json_add(own, "rise_s", v->rise_s);
    dea_json_add(own, "fall_s", v->fall_s);
    add_kind(own, "creep", kind, v->creep);
    json_object_set_new(object, dea_reduced_meanings[k].key, own);
  }
  return object;
}

static json_t *discharge_json(const struct dea_discharge *discharge)
{
  json_t *object = json_object();
  dea_json_add_text(object, "kind", discharge->kind == DEA_BREAKDOWN ? "breakdown" : "discharge");
  dea_json_add(object, "time_s", discharge->time_s);
  dea_json_add(object, "voltage_V", discharge->voltage_V);
  dea_json_add(object, "peak_A", discharge->peak_A);
  dea_json_add(object, "charge_C", discharge->charge_C);
  return object;
}

static json_t *notes_json(struct dea_context *ctx)
{
  json_t *notes = json_array();
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(notes, json_string(findings[i].text));
  }
  return notes;
}

static json_t *current_json(const struct dea_current_limits *limits)
{
  json_t *object = json_object();
  dea_json_add(object, "noise_A", limits->noise_A);
  dea_json_add(object, "threshold_in_noise", limits->factor);
  dea_json_add(object, "blind_after_corner_s", limits->blind_s);
  dea_json_add_count(object, "samples", limits->samples);
  return object;
}

json_t *dea_reduction_json(struct dea_context *ctx, const struct dea_recording *recording,
                           const struct dea_reduction *reduction, const char *command)
{
  json_t *root = json_object(), *noise = json_object(), *levels = json_array();
  json_t *cycles = json_array(), *discharges = json_array();
  json_object_set_new(root, "schema", json_integer(DEA_REDUCTION_SCHEMA));
  dea_json_add_text(root, "program", "dea " DEA_VERSION);
  dea_json_add_text(root, "command", command);
  json_object_set_new(root, "recording", recording_json(recording));
  dea_json_add(root, "settle", reduction->settle);
  if (reduction->levelling.frames > 0) {
    json_object_set_new(root, "levelling", levelling_json(&reduction->levelling));
  }
  dea_json_add(root, "force_offset_N", reduction->force_offset_N);
  dea_json_add(root, "preload_N", reduction->preload_N);
  for (int k = 0; k < DEA_REDUCED_KINDS; k++) {
    add_kind(noise, dea_reduced_meanings[k].key, (enum dea_reduced_kind)k, reduction->noise[k]);
  }
  json_object_set_new(root, "noise_of_a_sample", noise);
  if (reduction->current.samples > 0) {
    json_object_set_new(root, "current", current_json(&reduction->current));
  }
  for (size_t l = 0; l < reduction->level_count; l++) {
    json_array_append_new(levels, level_json(&reduction->levels[l]));
  }
  for (size_t k = 0; k < reduction->cycle_count; k++) {
    json_array_append_new(cycles, cycle_json(&reduction->cycles[k]));
  }
  for (size_t d = 0; d < reduction->discharge_count; d++) {
    json_array_append_new(discharges, discharge_json(&reduction->discharges[d]));
  }
  json_object_set_new(root, "levels", levels);
  json_object_set_new(root, "cycles", cycles);
  json_object_set_new(root, "discharges", discharges);
  json_object_set_new(root, "notes", notes_json(ctx));
  return root;
}

// The folder -------------------------------------------------------------------------------------

dea_status dea_reduction_folder(struct dea_context *ctx, const char *directory, bool force)
{
  static const char *const names[] = {
      "reduction.json", "measurement.csv", "means.csv",    "levels.csv",  "cycles.csv",
      "life.csv",       "discharges.csv",  "profiles.csv", "history.csv", "profiles",
      "history",        "history_force",   "amplitude",    "cycles"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    DEA_TRY(ctx, dea_gnuplot_create_folders(ctx, directory, names[i], force));
  }
  return dea_folder_create(ctx, directory);
}

dea_status dea_reduction_write(struct dea_context *ctx, const struct dea_recording *recording,
                               const struct dea_reduction *reduction, const char *command,
                               const struct dea_plot_format *format, const char *directory)
{
  char *text;
  DEA_TRY(ctx, dea_reduction_write_tables(ctx, recording, reduction, directory));
  DEA_TRY(ctx, dea_json_text(ctx, dea_reduction_json(ctx, recording, reduction, command), &text));
  dea_status status = dea_text_file_write(ctx, directory, "reduction.json", text);
  dea_free(ctx, text);
  DEA_TRY(ctx, status);
  return dea_reduction_draw(ctx, recording, reduction, format, directory);
}
