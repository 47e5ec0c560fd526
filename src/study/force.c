/* Study "force": a rigid tip is brought to a depth, or pressed until it feels a preload, at 0 V; it
 * is held there while the voltage goes through the sweep. Depth after depth that gives force
 * against voltage at fixed depths and force against depth at fixed voltages: the actuator's load
 * lines. To a deeper depth the tip goes on from the one before, at 0 V again; otherwise from rest.
 */
#include "study/force.h"
#include "base/schema.h"
#include "result/columns.h"
#include "result/observation.h"
#include "result/trust.h"
#include "study/study.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

static const char study_name[] = "force";

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.force; without depths and preloads nothing is computed. */
struct settings {
  struct dea_choice indenter; // enum dea_indenter_shape
  struct dea_choice side;     // 0: it comes from the fibres' side, 1: from the other
  struct dea_quantity radius_m, edge_radius_m;
  struct dea_quantity depths_m[DEA_DESIGN_STOPS_MAX], preloads_N[DEA_DESIGN_STOPS_MAX];
  size_t depth_count, preload_count;
};

#define AT(member) offsetof(struct settings, member)

// In the order of enum dea_indenter_shape.
static const char *const tips[] = {"sphere", "flat", "cylinder", NULL};
static const char *const sides[] = {"fibres", "back", NULL};

static const struct dea_field fields[] = {
    DEA_CHOICE_ROW("indenter", AT(indenter), tips, "sphere",
                   "shape of the tip; a cylinder lies on its side along the first fibre",
                   .alias = "tip", .default_text = "sphere"),
    DEA_NUMBER_ROW("radius", AT(radius_m), "m", "1.5 mm", "radius of the tip", .above_min = true,
                   .max = 0.1, .default_text = "1.5 mm"),
    DEA_NUMBER_ROW("edge_radius", AT(edge_radius_m), "m", "0.2 mm",
                   "radius of the rounded edge of a flat tip", .above_min = true, .max = 0.1,
                   .default_text = "0.2 mm"),
    DEA_CHOICE_ROW("side", AT(side), sides, "fibres",
                   "where the tip comes from: the side of the fibres or the other",
                   .default_text = "fibres"),
    DEA_NUMBER_ROW(
        "depth", AT(depths_m), "m", "[0 mm, 1 mm, 2 mm]",
        "how far the tip is pressed beyond touching the flat film, at 0 V; negative: a gap",
        .min = -0.1, .max = 0.1,
        DEA_LIST(1, DEA_DESIGN_STOPS_MAX, struct dea_quantity, AT(depth_count))),
    DEA_NUMBER_ROW("preload", AT(preloads_N), "N", "[0.18 N]",
                   "forces that the tip is pressed to at 0 V, instead of depths or besides",
                   .above_min = true, .max = 100,
                   DEA_LIST(1, DEA_DESIGN_STOPS_MAX, struct dea_quantity, AT(preload_count))),
};

/* The electrode of a disc is the part that moves. */
static dea_status fit(struct dea_context *ctx, const struct dea_settings *given,
                      const struct dea_device *device)
{
  static const double touching = 1e-9; // as in device/geometry.c
  const struct settings *force = given->values;
  if (force->depth_count + force->preload_count == 0) {
    return DEA_OK;
  }
  if (!device->disc || force->radius_m.si <= device->electrode_radius_m * (1 + touching)) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, force->radius_m.location,
                         "the tip, %.4g mm in radius, is larger than the electrode, the part that "
                         "moves: at most %.4g mm (stretched)",
                         1e3 * force->radius_m.si, 1e3 * device->electrode_radius_m);
}

static const struct dea_design_section section = {
    .record = {study_name, "force on a rigid tip against the middle of the film (3d)", fields,
               DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .fit = fit};

static const struct settings *settings_of(const struct dea_design *design)
{
  const struct dea_settings *given = dea_design_settings(design, &section);
  return given != NULL ? given->values : NULL;
}

size_t dea_force_stops(const struct dea_design *design)
{
  const struct settings *force = settings_of(design);
  return force != NULL ? force->depth_count + force->preload_count : 0;
}

double dea_force_first_depth_m(const struct dea_design *design)
{
  const struct settings *force = settings_of(design);
  return force != NULL && force->depth_count > 0 ? force->depths_m[0].si : 0;
}

struct dea_probe dea_force_indenter(const struct dea_design *design)
{
  const struct settings *force = settings_of(design);
  return force == NULL ? (struct dea_probe){0}
                       : (struct dea_probe){.shape = (enum dea_probe_shape)force->indenter.value,
                                            .radius_m = force->radius_m.si,
                                            .edge_radius_m = force->edge_radius_m.si,
                                            .from_fibre_side = force->side.value == 0};
}

// Study ------------------------------------------------------------------------------------------

enum { PRELOAD_TRIALS = 12 };
static const double preload_close = 1e-3; // of the preload

/* Depth at which the tip feels the preload at 0 V: secant steps from two touches. Leaves the tip
 * there. */
static dea_status find_preload(struct dea_context *ctx, const struct dea_model_type *type,
                               struct dea_model *model, const struct dea_probe *tip,
                               double preload_N, double first_m)
{
  struct dea_load_point point;
  double depth_m = first_m, last_m = 0, last_N = 0;
  for (int i = 0; i < PRELOAD_TRIALS; i++) {
    DEA_TRY(ctx, dea_model_indent(ctx, type, model, tip, depth_m, &point));
    if (fabs(point.force_N - preload_N) <= preload_close * preload_N) {
      return DEA_OK;
    }
    double slope = (point.force_N - last_N) / (depth_m - last_m);
    double next = slope > 0 ? depth_m + (preload_N - point.force_N) / slope : 2 * depth_m;
    last_m = depth_m;
    last_N = point.force_N;
    depth_m = fmin(fmax(next, 0.3 * last_m), 3 * last_m);
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "no depth gives the preload of %.4g mN",
                  1e3 * preload_N);
}

dea_status dea_force_indent(struct dea_context *ctx, const struct dea_model_type *type,
                            struct dea_model *model, const struct dea_design *design, size_t stop)
{
  const struct settings *force = settings_of(design);
  if (force == NULL || stop >= force->depth_count + force->preload_count) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "the design has no stop %zu of compute.force", stop + 1);
  }
  size_t depths = force->depth_count;
  const struct dea_probe tip = dea_force_indenter(design);
  struct dea_load_point point;
  if (stop < depths) {
    return DEA_CHAIN(ctx,
                     dea_model_indent(ctx, type, model, &tip, force->depths_m[stop].si, &point));
  }
  return DEA_CHAIN(
      ctx, find_preload(ctx, type, model, &tip, force->preloads_N[stop - depths].si, tip.radius_m));
}

/* A model that goes from stop to stop, and where it was last pressed to at 0 V. */
struct press {
  struct dea_study_job job; // whose model is that; NULL: none yet
  struct dea_state at;      // what it was at 0 V, where it is kept
  bool kept;
};

/* Whether a stop is a depth beyond that of the stop before, which the tip comes by anyway. */
static bool goes_deeper(const struct dea_design *design, size_t stop)
{
  const struct settings *force = settings_of(design);
  return force != NULL && stop > 0 && stop < force->depth_count &&
         force->depths_m[stop].si > force->depths_m[stop - 1].si;
}

/* The model at 0 V, at rest or where the stop before has pressed it to. */
static dea_status ready(struct dea_context *ctx, struct press *p, size_t stop)
{
  struct dea_study_job *job = &p->job;
  bool kept = p->kept && goes_deeper(job->result->design, stop);
  dea_status status = kept ? job->type->load(ctx, job->model, &p->at) : DEA_OK;
  dea_state_free_values(ctx, &p->at);
  p->kept = false;
  if (!kept && job->model != NULL) {
    job->type->destroy(ctx, job->model);
    job->model = NULL;
  }
  return kept ? status
              : dea_model_create(ctx, job->type, job->result->design, job->result->device,
                                 &job->model);
}

/* Keeps where the tip is pressed to if the next stop goes on from there. */
static dea_status keep_pressed(struct dea_context *ctx, struct press *p, size_t stop)
{
  struct dea_state now = {0};
  if (p->job.type->load == NULL || !goes_deeper(p->job.result->design, stop + 1)) {
    return DEA_OK;
  }
  DEA_TRY(ctx, p->job.type->save(ctx, p->job.model, &now));
  DEA_TRY(ctx, dea_state_copy_values(ctx, &now, &p->at));
  p->kept = true;
  return DEA_OK;
}

/* Presses in for one stop at 0 V, and goes through all voltages from there. */
static dea_status follow(struct dea_context *ctx, struct press *p, size_t stop,
                         struct dea_curve *curve)
{
  const struct dea_study_job *job = &p->job;
  const struct dea_design *design = job->result->design;
  DEA_TRY(ctx, ready(ctx, p, stop));
  DEA_TRY(ctx, dea_force_indent(ctx, job->type, job->model, design, stop));
  DEA_TRY(ctx, keep_pressed(ctx, p, stop));
  return dea_study_add_points(ctx, job, job->result->device, design->compute.voltages_V,
                              design->compute.voltage_count, curve);
}

/* One stop after the other, since each goes on from the one before. */
static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const size_t stops = dea_force_stops(job->result->design);
  struct press press = {.job = *job};
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_result_add_curve(ctx, job->result, job->type->name, study_name, &curve));
  dea_status status = DEA_OK;
  for (size_t i = 0; i < stops && status == DEA_OK; i++) {
    status = follow(ctx, &press, i, curve);
    if (status == DEA_OK) {
      dea_study_progress(ctx, job, study_name, i + 1, stops);
    }
  }
  dea_state_free_values(ctx, &press.at);
  if (press.job.model != NULL) {
    job->type->destroy(ctx, press.job.model);
  }
  return dea_curve_end(ctx, curve, status);
}

// Figures ----------------------------------------------------------------------------------------

/* Of a curve; count 0 when there is none. */
struct stops {
  const struct dea_curve *curve; // lent
  size_t count;
  size_t first[DEA_DESIGN_STOPS_MAX + 1]; // first point of each, and one past the last
  size_t by_depth[DEA_DESIGN_STOPS_MAX];  // their numbers, the least deep one first
};

/* Depths are few: insertion. */
static void sort(struct stops *stops)
{
  for (size_t i = 0; i < stops->count; i++) {
    size_t k = i;
    double depth = stops->curve->points[stops->first[i]].tip_depth_m;
    for (; k > 0 && stops->curve->points[stops->first[stops->by_depth[k - 1]]].tip_depth_m > depth;
         k--) {
      stops->by_depth[k] = stops->by_depth[k - 1];
    }
    stops->by_depth[k] = i;
  }
}

static void find_stops(const struct dea_curve *curve, struct stops *out)
{
  *out = (struct stops){.curve = curve};
  const struct dea_load_point *p = curve != NULL ? curve->points : NULL;
  for (size_t i = 0; p != NULL && i < curve->count && out->count < DEA_DESIGN_STOPS_MAX; i++) {
    if (i == 0 || p[i].tip_depth_m != p[i - 1].tip_depth_m) { // held exactly while V rises
      out->first[out->count++] = i;
    }
    out->first[out->count] = i + 1;
  }
  sort(out);
}

/* The points of one stop as a curve of their own; lent. */
static struct dea_curve one_stop(const struct stops *stops, size_t i)
{
  struct dea_curve part = *stops->curve;
  part.points = stops->curve->points + stops->first[i];
  part.std = stops->curve->std != NULL ? stops->curve->std + stops->first[i] : NULL;
  part.count = stops->first[i + 1] - stops->first[i];
  return part;
}

/* Look of the i-th curve, without title. */
static struct dea_series stop_style(size_t i)
{
  static const enum dea_colour order[] = {DEA_BLUE,   DEA_VERMILLION, DEA_GREEN,
                                          DEA_PURPLE, DEA_ORANGE,     DEA_BLACK};
  return (struct dea_series){
      .style = DEA_LINE_MARKED, .colour = order[i % 6], .marker = (int)(i % 6)};
}

static dea_status build_tip_force(struct dea_context *ctx, const struct dea_result *result,
                                  struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct stops stops;
  int column = dea_point_column_find("force_N");
  find_stops(dea_study_first_curve(result, study_name, 1), &stops);
  for (size_t i = 0; i < stops.count; i++) {
    struct dea_curve part = one_stop(&stops, i);
    struct dea_series look = stop_style(i);
    snprintf(look.title, sizeof look.title, "%.4g mm", 1e3 * part.points[0].tip_depth_m);
    DEA_TRY(ctx, dea_figure_add(ctx, panel, &part, column, dea_point_columns[column].factor, 0.0,
                                &look));
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Force on the tip {/:Italic F} (mN)");
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

enum { SHOWN_MAX = 6 };

/* Force over depth at the k-th voltage of each stop that came so far; a line with a point that is
 * not to be trusted says so. */
static dea_status add_line(struct dea_context *ctx, struct dea_panel *panel,
                           const struct stops *stops, size_t k, size_t number)
{
  const struct dea_series look = stop_style(number);
  struct dea_series *series;
  const struct dea_load_point *points = stops->curve->points;
  bool trusted = true;
  DEA_TRY(ctx, dea_panel_add_as(ctx, panel, stops->count, &look, &series));
  for (size_t i = 0; i < stops->count; i++) {
    size_t at = stops->first[stops->by_depth[i]] + k;
    if (at < stops->first[stops->by_depth[i] + 1] &&
        points[at].voltage_V == points[k].voltage_V) { // else it was interrupted
      series->values[i] = 1e3 * points[at].tip_depth_m;
      series->values[stops->count + i] = 1e3 * points[at].force_N;
      trusted = trusted && dea_load_point_valid(&points[at]);
    }
  }
  snprintf(series->title, sizeof series->title, "%.4g kV%s", 1e-3 * points[k].voltage_V,
           trusted ? "" : " (?)");
  return DEA_OK;
}

static dea_status build_load_line(struct dea_context *ctx, const struct dea_result *result,
                                  struct dea_plot *plot)
{
  struct dea_panel *panel = &plot->panels[0];
  struct stops stops;
  find_stops(dea_study_first_curve(result, study_name, 1), &stops);
  if (stops.count < 2) { // one depth is no line
    return DEA_OK;
  }
  size_t voltages = stops.first[1] - stops.first[0];
  size_t shown = voltages < SHOWN_MAX ? voltages : SHOWN_MAX;
  for (size_t i = 0; i < shown; i++) {
    size_t k = shown < 2 ? 0 : (i * (voltages - 1) + (shown - 1) / 2) / (shown - 1);
    DEA_TRY(ctx, add_line(ctx, panel, &stops, k, i));
  }
  snprintf(panel->x_label, sizeof panel->x_label, "Depth of the tip (mm)");
  snprintf(panel->y_label, sizeof panel->y_label, "Force on the tip {/:Italic F} (mN)");
  dea_panel_place_key(panel);
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("tip_force", study_name, build_tip_force,
                     "force on the tip against the voltage, for each depth that it is held at"),
    DEA_STUDY_FIGURE("load_line", study_name, build_load_line,
                     "force on the tip against the depth that it is held at, for some voltages (?: "
                     "not to be trusted at one of the depths)"),
};

// Table ------------------------------------------------------------------------------------------

static const struct dea_result_column line_columns[] = {
    DEA_MM("tip_depth_m", "depth", "how far the tip is pressed beyond touching the flat film"),
    DEA_RESULT_COLUMN(COUNT, "voltages", "voltages", .meaning = "points of the line"),
    DEA_MN("first_force_N", "first force", "force on the tip at the first voltage"),
    DEA_MN("last_force_N", "last force", "and at the last one"),
    DEA_KV("trusted_voltage_V", "trusted to",
           "last voltage before the first point that is not to be trusted"),
};
static const struct dea_result_table_type line_table =
    DEA_RESULT_TABLE(study_name, "lines", line_columns,
                     .title = "force on the tip at the first and the last voltage",
                     .where = DEA_IN_JSON | DEA_IN_SCREEN);

/* A film that is pressed further than it stretches lets the tip pass: no force, and nothing amiss
 * in its state. */
static dea_status warn_of_no_touch(struct dea_context *ctx, const char *model,
                                   const struct dea_load_point *first)
{
  if (!(first->tip_depth_m > 0) || first->force_N > 0) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                         "model %s: at a depth of %.4g mm the tip touches no film at %.4g kV: it "
                         "has passed it, or the film hangs away from it",
                         model, 1e3 * first->tip_depth_m, 1e-3 * first->voltage_V);
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  struct stops stops;
  struct dea_result_table *table;
  find_stops(dea_result_find(result, model, study_name), &stops);
  if (stops.count == 0) {
    return DEA_OK;
  }
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &line_table, model, 0, &table));
  for (size_t i = 0; i < stops.count; i++) {
    const struct dea_curve part = one_stop(&stops, i);
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(part.points[0].tip_depth_m),
                               DEA_CELL((double)part.count), DEA_CELL(part.points[0].force_N),
                               DEA_CELL(part.points[part.count - 1].force_N),
                               DEA_CELL(dea_curve_trust(&part).trusted_V)));
    DEA_TRY(ctx, warn_of_no_touch(ctx, model, &part.points[0]));
  }
  return DEA_OK;
}

// The study --------------------------------------------------------------------------------------

static bool asked(const struct dea_design *design)
{
  return dea_force_stops(design) > 0;
}

const struct dea_study dea_study_force = {
    .name = study_name,
    .keys = &section,
    .asked = asked,
    .needs = "compute.force.depth or compute.force.preload",
    .own_models = true,
    .ability = "indentation by a tip",
    .able_by = offsetof(struct dea_model_type, indent),
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
