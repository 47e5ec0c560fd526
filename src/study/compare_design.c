/* Study "compare-design": the design, and others that it names, through the voltages of each. */
#include "base/file.h"
#include "device/device.h"
#include "result/observation.h"
#include "study/variant.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char study_name[] = "compare-design";

/* The name of the design itself: of the entry that changes nothing, or else of its file. */
static void name_base(const struct dea_design *design, char out[DEA_NAME_SIZE])
{
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    const struct dea_design_variant *variant = &design->compute.compare[i];
    if (variant->design == NULL) {
      snprintf(out, DEA_NAME_SIZE, "%s", variant->name.text);
      return;
    }
  }
  size_t length;
  const char *stem = dea_path_stem(design->file, &length);
  snprintf(out, DEA_NAME_SIZE, "%.*s", length < DEA_NAME_SIZE ? (int)length : DEA_NAME_SIZE - 1,
           stem);
}

static dea_status add(struct dea_context *ctx, const struct dea_study_job *job, const char *name,
                      const struct dea_design *design, const struct dea_device *device)
{
  const struct dea_variant_run run = {study_name,
                                      name,
                                      device,
                                      dea_model_settings_of(design),
                                      design->compute.voltages_V,
                                      design->compute.voltage_count};
  return dea_variant_run(ctx, job, &run);
}

/* The design itself: its sweep where that has been made, with the last profile. */
static dea_status add_base(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_result *result = job->result;
  char name[DEA_NAME_SIZE];
  name_base(result->design, name);
  return dea_result_find(result, job->type->name, "sweep") != NULL
             ? dea_variant_of_sweep(ctx, job, study_name, name)
             : add(ctx, job, name, result->design, result->device);
}

static dea_status add_other(struct dea_context *ctx, const struct dea_study_job *job,
                            const struct dea_design_variant *variant)
{
  struct dea_device *device;
  DEA_TRY(ctx, dea_device_build(ctx, variant->design, &device));
  dea_status status = add(ctx, job, variant->name.text, variant->design, device);
  dea_device_destroy(ctx, device);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_design *design = job->result->design;
  size_t total = design->compute.compare_count;
  dea_status first = add_base(ctx, job);
  for (size_t i = 0; i < total && !dea_status_ends(first); i++) {
    if (design->compute.compare[i].design != NULL) {
      dea_status status = add_other(ctx, job, &design->compute.compare[i]);
      first = first == DEA_OK || dea_status_ends(status) ? status : first;
    }
    dea_study_progress(ctx, job, study_name, i + 1, total);
  }
  return first;
}

// Tables -----------------------------------------------------------------------------------------

static const struct dea_result_column design_columns[] = {
    DEA_TEXT_COLUMN("name", "design", "name of the design"),
    DEA_RESULT_COLUMN(NUMBER, "refinement", "refinement", .hidden = DEA_IN_SCREEN,
                      .meaning = "of its mesh"),
    DEA_RESULT_COLUMN(COUNT, "elements", "elements", .hidden = DEA_IN_SCREEN,
                      .meaning = "of its mesh"),
    DEA_RESULT_COLUMN(COUNT, "nodes", "nodes", .hidden = DEA_IN_SCREEN, .meaning = "of its mesh"),
    DEA_RESULT_COLUMN(COUNT, "unknowns", "unknowns", .hidden = DEA_IN_SCREEN,
                      .meaning = "of its mesh"),
    DEA_RESULT_COLUMN(NUMBER, "wall_s", "time", .hidden = DEA_IN_SCREEN, .si_unit = "s",
                      .display_unit = "s", .meaning = "that it took"),
    DEA_RESULT_COLUMN(FLAG, "complete", "complete", .hidden = DEA_IN_SCREEN,
                      .meaning = "to the last point"),
    DEA_RESULT_COLUMN(POINTS, "points", "points", .meaning = "variant of the run"),
    DEA_RESULT_COLUMN(NUMBER, "last_voltage_V", "V", .hidden = DEA_IN_JSON, .si_unit = "V",
                      .display_unit = "kV", .factor = 1e-3, .meaning = "last voltage"),
    DEA_RESULT_COLUMN(NUMBER, "last_strain", "strain", .hidden = DEA_IN_JSON, .display_unit = "%",
                      .factor = 100, .meaning = "of the electrode's radius at the last voltage"),
    DEA_RESULT_COLUMN(NUMBER, "last_centre_z_m", "z centre", .hidden = DEA_IN_JSON, .si_unit = "m",
                      .display_unit = "um", .factor = 1e6, .meaning = "at the last voltage"),
    DEA_RESULT_COLUMN(NUMBER, "last_fibre_tip_z_m", "z tip", .hidden = DEA_IN_JSON, .si_unit = "m",
                      .display_unit = "um", .factor = 1e6, .meaning = "at the last voltage"),
    DEA_RESULT_COLUMN(NUMBER, "last_true_field_V_per_m", "field", .hidden = DEA_IN_JSON,
                      .si_unit = "V/m", .display_unit = "V/um", .factor = 1e-6,
                      .meaning = "at the last voltage"),
    DEA_RESULT_COLUMN(TEXT, "last_flags", "flags", .hidden = DEA_IN_JSON,
                      .meaning = "what a reader has to know of these numbers"),
    DEA_TEXT_COLUMN("stopped", "stopped", "why it stopped"),
};
static const struct dea_result_table_type design_table = DEA_RESULT_TABLE(
    study_name, "designs", design_columns, .key = "designs",
    .title = "designs at their last voltage", .where = DEA_IN_JSON | DEA_IN_SCREEN);

static const struct dea_result_column monitor_columns[] = {
    DEA_TEXT_COLUMN("name", "design", "name of the design"),
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "quantity", .meaning = "that a monitor shows most"),
    DEA_RESULT_COLUMN(VALUE, "value", "value", .meaning = "at the design's last voltage"),
};
static const struct dea_result_table_type monitor_table = DEA_RESULT_TABLE(
    study_name, "monitors", monitor_columns, .title = "monitors at their last voltage",
    .where = DEA_IN_SCREEN); // else of points
enum { HEADLINES_MAX = 16 };

/* What is only noise is 0. */
static double shown_z(double z_m)
{
  return fabs(z_m) < 1e-12 ? 0 : z_m;
}

static dea_status add_design(struct dea_context *ctx, const struct dea_variant *v, size_t index,
                             struct dea_result_table *table)
{
  const struct dea_load_point none = dea_load_point_empty();
  const struct dea_load_point *p =
      v->curve.count > 0 ? &v->curve.points[v->curve.count - 1] : &none;
  bool sized = v->size.nodes > 0;
  char flags[DEA_FLAGS_SIZE];
  return DEA_TABLE_ADD(ctx, table, DEA_TEXT_CELL(v->name), DEA_CELL(v->refinement),
                       DEA_CELL(sized ? (double)v->size.elements : NAN),
                       DEA_CELL(sized ? (double)v->size.nodes : NAN),
                       DEA_CELL(sized ? (double)v->size.unknowns : NAN), DEA_CELL(v->wall_s),
                       DEA_CELL(v->curve.complete), DEA_CELL((double)index), DEA_CELL(p->voltage_V),
                       DEA_CELL(p->electrode_stretch - 1), DEA_CELL(shown_z(p->centre_z_m)),
                       DEA_CELL(shown_z(p->fibre_tip_z_m)), DEA_CELL(p->true_field_V_per_m),
                       DEA_TEXT_CELL(dea_flags_text(dea_load_point_flags(p), flags)),
                       DEA_TEXT_CELL(v->curve.stopped));
}

static dea_status add_monitors(struct dea_context *ctx, const char *model,
                               const struct dea_variant *v, struct dea_result *result)
{
  int columns[HEADLINES_MAX];
  const size_t count = dea_curve_headlines(ctx, &v->curve, columns, HEADLINES_MAX);
  struct dea_result_table *table;
  for (size_t k = 0; k < count; k++) {
    const double last = dea_point_get(&v->curve.points[v->curve.count - 1], columns[k]);
    DEA_TRY(ctx, dea_result_get_table(ctx, result, &monitor_table, model, &table));
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_TEXT_CELL(v->name), DEA_CELL(columns[k]),
                               DEA_CELL(last)));
  }
  return DEA_OK;
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  struct dea_result_table *table = NULL;
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, study_name)) {
      if (table == NULL) {
        DEA_TRY(ctx, dea_result_add_table(ctx, result, &design_table, model, 0, &table));
      }
      DEA_TRY(ctx, add_design(ctx, &result->variants[i], i, table));
    }
  }
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, study_name)) {
      DEA_TRY(ctx, add_monitors(ctx, model, &result->variants[i], result));
    }
  }
  return DEA_OK;
}

// Figures ----------------------------------------------------------------------------------------

enum { SHOWN_MAX = 16 };

/* One curve of such a figure. */
struct shown {
  const struct dea_variant *variant; // lent
  struct dea_series look;            // without title
};

enum { TITLE_SHORT = 24 }; // signs, of which two fit side by side

/* Variants of the study in the order of models and designs, at most SHOWN_MAX; returns their
 * number. profiles: only models that have profiles. A colour a design; lines for the first model
 * that has something to show, lines with markers for the others. */
static size_t find_shown(const struct dea_result *result, bool profiles,
                         struct shown out[SHOWN_MAX])
{
  static const enum dea_colour order[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN, DEA_PURPLE,
                                          DEA_ORANGE, DEA_SKY,        DEA_BLACK, DEA_GREY};
  static const double widths[] = {1.7, 1.3, 1, 0.7}; // so that curves below others show
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t model_count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX), count = 0;
  for (size_t m = 0, shown = 0; m < model_count; m++) {
    size_t number = 0, before = count;
    for (size_t i = 0; i < result->variant_count; i++) {
      const struct dea_variant *variant = &result->variants[i];
      if (!dea_variant_is(variant, models[m], study_name)) {
        continue;
      }
      if (count < SHOWN_MAX && (!profiles || variant->profile.count > 0)) {
        out[count].variant = variant;
        out[count].look = dea_figure_style("", shown);
        out[count].look.colour = order[number % DEA_COUNT(order)];
        out[count].look.marker = (int)number;
        out[count++].look.width = number < 3 ? widths[number] : widths[3];
      }
      number++;
    }
    shown += count > before;
  }
  return count;
}

/* An entry of the key; of its series only a point shows, on a curve that is there. */
static dea_status add_entry(struct dea_context *ctx, struct dea_panel *panel,
                            const struct dea_series *look, const char *title)
{
  struct dea_series *entry;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, 1, look, &entry));
  snprintf(entry->title, sizeof entry->title, "%s", title);
  for (size_t s = 0; s + 1 < panel->series_count && isnan(entry->values[1]); s++) {
    const struct dea_series *shown = &panel->series[s];
    for (size_t i = 0; i < shown->count && isnan(entry->values[1]); i++) {
      entry->values[0] = shown->values[i];
      entry->values[1] = shown->values[shown->count + i];
    }
  }
  return DEA_OK;
}

static bool is_first(const struct shown list[], size_t i, bool by_name)
{
  for (size_t k = 0; k < i; k++) {
    const struct dea_variant *a = list[k].variant, *b = list[i].variant;
    if (by_name ? strcmp(a->name, b->name) == 0 : strcmp(a->curve.model, b->curve.model) == 0) {
      return false;
    }
  }
  return true;
}

/* A quantity of each against V, as dea_figure_add: where it is a bound, or where it is none. */
struct quantity {
  int column;
  double factor, shift;
  bool bounds;
  char label[DEA_LABEL_SIZE];
};

static dea_status add_shown(struct dea_context *ctx, struct dea_panel *panel,
                            const struct shown list[], size_t count, const struct quantity *q)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_curve *curve = &list[i].variant->curve;
    if (dea_figure_is_bound(curve, q->column) == q->bounds) {
      DEA_TRY(ctx,
              dea_figure_add(ctx, panel, curve, q->column, q->factor, q->shift, &list[i].look));
    }
  }
  return DEA_OK;
}

/* Whether the last point of a curve, where the profile is taken, is to be trusted. */
static bool ends_trusted(const struct dea_curve *curve)
{
  return curve->count == 0 || dea_load_point_valid(&curve->points[curve->count - 1]);
}

/* Adds key entries above the panel: of designs by their colours, with the voltage of their profiles
 * if asked, and of models by their markers where there are several. For a panel that has series. */
static dea_status add_key(struct dea_context *ctx, struct dea_panel *panel,
                          const struct shown list[], size_t count, bool voltages)
{
  size_t entries = 0;
  const bool several =
      count > 0 && strcmp(list[0].variant->curve.model, list[count - 1].variant->curve.model) != 0;
  for (size_t k = 0; k < (several ? 2 * count : count); k++) { // designs, then models
    const bool design = k < count;
    const size_t i = k % count;
    const struct dea_variant *variant = list[i].variant;
    struct dea_series look = list[i].look;
    char title[DEA_LABEL_SIZE];
    if (!is_first(list, i, design)) {
      continue;
    }
    dea_label_escape(design ? variant->name : variant->curve.model, title, sizeof title);
    look.style = design ? DEA_LINE : look.style;
    look.colour = design ? look.colour : DEA_GREY;
    if (design && voltages) {
      const size_t length = strlen(title);
      snprintf(title + length, sizeof title - length, ", %.3g kV%s",
               1e-3 * variant->profile.voltage_V, ends_trusted(&variant->curve) ? "" : " (?)");
    }
    DEA_TRY(ctx, add_entry(ctx, panel, &look, title));
    entries++;
  }
  size_t longest = 0;
  for (size_t i = 0; i < panel->series_count; i++) {
    size_t length = strlen(panel->series[i].title);
    longest = length > longest ? length : longest;
  }
  entries += panel->dashed != NULL;
  dea_panel_key_above(panel, entries > 3 && longest <= TITLE_SHORT ? (entries + 1) / 2 : entries);
  return DEA_OK;
}

/* True where some design has a displacement beyond noise that is no bound. */
static bool moves(const struct shown list[], size_t count, int column)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_curve *curve = &list[i].variant->curve;
    for (size_t k = 0; k < curve->count && !dea_figure_is_bound(curve, column); k++) {
      if (fabs(dea_point_get(&curve->points[k], column)) > 1e-9) {
        return true;
      }
    }
  }
  return false;
}

/* A panel a quantity that there is something of. */
static dea_status draw(struct dea_context *ctx, const struct shown list[], size_t count,
                       const struct quantity *quantities, size_t quantity_count,
                       struct dea_plot *plot)
{
  struct dea_panel *panels = plot->panels;
  size_t shown = 0;
  for (size_t k = 0; k < quantity_count; k++) {
    struct dea_panel *panel = &panels[shown];
    DEA_TRY(ctx, add_shown(ctx, panel, list, count, &quantities[k]));
    if (panel->series_count > 0) {
      snprintf(panel->y_label, DEA_LABEL_SIZE, "%s", quantities[k].label);
      dea_panel_voltage_axis(panel);
      shown++;
    }
  }
  plot->panel_count = shown > 0 ? shown : 1;
  if (shown == 2) { // they share the axis
    panels[0].x_max = panels[1].x_max = fmax(panels[0].x_max, panels[1].x_max);
    panels[1].dashed = panels[0].dashed != NULL ? NULL : panels[1].dashed; // said above
  }
  return shown > 0 ? add_key(ctx, &panels[0], list, count, false) : DEA_OK;
}

/* What the monitors of the first curve that has some show most, or else centre and strain. */
static dea_status build_designs(struct dea_context *ctx, const struct dea_result *result,
                                struct dea_plot *plot)
{
  struct shown list[SHOWN_MAX];
  int columns[DEA_PLOT_PANELS_MAX];
  size_t count = find_shown(result, false, list), found = 0;
  for (size_t i = 0; i < count && found == 0; i++) {
    found = dea_curve_headlines(ctx, &list[i].variant->curve, columns, DEA_PLOT_PANELS_MAX);
  }
  struct quantity monitors[DEA_PLOT_PANELS_MAX];
  for (size_t k = 0; k < found; k++) {
    const struct dea_column *column = dea_column_at(ctx, columns[k]);
    monitors[k] = (struct quantity){.column = columns[k], .factor = column->factor};
    dea_figure_label(column, monitors[k].label, DEA_LABEL_SIZE);
  }
  if (found > 0) {
    return draw(ctx, list, count, monitors, found, plot);
  }
  const struct quantity of_disc[] = {
      {dea_point_column_find("centre_z_m"), 1e6, 0, false, "Centre {/:Italic z} (\302\265m)"},
      {dea_point_column_find("electrode_stretch"), 100, -1, false, "Electrode strain (%)"}};
  // bounds of many times the size are in figure design_tips
  const size_t first = moves(list, count, of_disc[0].column) ? 0 : 1;
  return draw(ctx, list, count, of_disc + first, 2 - first, plot);
}

/* What models predict, and in a panel of its own, since it is many times as large, what they know
 * only a bound of. */
static dea_status build_design_tips(struct dea_context *ctx, const struct dea_result *result,
                                    struct dea_plot *plot)
{
  struct shown list[SHOWN_MAX];
  const int z = dea_point_column_find("fibre_tip_z_m");
  const struct quantity both[] = {{z, 1e6, 0, false, "Fibre tip {/:Italic z} (\302\265m)"},
                                  {z, 1e3, 0, true, "Bound of tip {/:Italic z} (mm)"}};
  plot->second_height = 0.7;
  return draw(ctx, list, find_shown(result, false, list), both, 2, plot);
}

static dea_status add_profile(struct dea_context *ctx, struct dea_panel *panel,
                              const struct shown *one, const double *values)
{
  const struct dea_profile_record *record = &one->variant->profile;
  struct dea_series *series;
  size_t n = record->count;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, n, &one->look, &series));
  for (size_t i = 0; i < n; i++) {
    series->values[i] = 1e3 * record->columns[i];
    series->values[n + i] = 1e6 * values[i];
  }
  return DEA_OK;
}

/* True where some profile leaves the plane beyond noise. */
static bool leaves_plane(const struct shown list[], size_t count)
{
  for (size_t i = 0; i < count; i++) {
    const struct dea_profile profile = dea_profile_of_record(&list[i].variant->profile);
    for (size_t k = 0; k < profile.count; k++) {
      if (fabs(profile.z_m[k]) > 1e-9) {
        return true;
      }
    }
  }
  return false;
}

static dea_status build_design_profiles(struct dea_context *ctx, const struct dea_result *result,
                                        struct dea_plot *plot)
{
  struct shown list[SHOWN_MAX];
  size_t count = find_shown(result, true, list);
  bool z = leaves_plane(list, count);
  plot->panel_count = z ? 2 : 1;
  struct dea_panel *last = &plot->panels[plot->panel_count - 1];
  for (size_t i = 0; i < count; i++) {
    const struct dea_profile profile = dea_profile_of_record(&list[i].variant->profile);
    DEA_TRY(ctx, z ? add_profile(ctx, &plot->panels[0], &list[i], profile.z_m) : DEA_OK);
    DEA_TRY(ctx, add_profile(ctx, last, &list[i], profile.displacement_m));
  }
  for (size_t i = 0; i < count; i++) {
    dea_figure_sides(last, &list[i].variant->profile);
  }
  snprintf(plot->panels[0].y_label, DEA_LABEL_SIZE, "Displacement {/:Italic z} (\302\265m)");
  snprintf(last->y_label, DEA_LABEL_SIZE, "Radial displacement {/:Italic u} (\302\265m)");
  for (size_t p = 0; p < plot->panel_count; p++) {
    snprintf(plot->panels[p].x_label, DEA_LABEL_SIZE,
             "Radius in the stretched flat film {/:Italic R} (mm)");
    dea_panel_even_tics(&plot->panels[p], 7);
  }
  return DEA_CHAIN(ctx, count > 0 ? add_key(ctx, &plot->panels[0], list, count, true) : DEA_OK);
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("designs", study_name, build_designs,
                     "displacement and strain of several designs against the voltage"),
    DEA_STUDY_FIGURE("design_tips", study_name, build_design_tips,
                     "displacement of the fibre tip of several designs against the voltage"),
    DEA_STUDY_FIGURE(
        "design_profiles", study_name, build_design_profiles,
        "displacements of several designs along the radius (of model 3d: to the right along a "
        "fibre, to the left between fibres; ?: not to be trusted)"),
};

// The study --------------------------------------------------------------------------------------

static bool asked(const struct dea_design *design)
{
  return design->compute.compare_count > 0;
}

const struct dea_study dea_study_compare_design = {
    .name = study_name,
    .asked = asked,
    .needs = "more design files on the command line, or compute.compare",
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
