/* Study "convergence": the same device on ever finer meshes, at a few voltages. What the sequence
 * of answers says of each mesh is found in result/richardson.h. */
#include "base/schema.h"
#include "result/richardson.h"
#include "study/variant.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

static const char study_name[] = "convergence";

// Keys -------------------------------------------------------------------------------------------

enum { MESHES_MAX = DEA_CONVERGENCE_MESHES_MAX };

/* Settings of compute.convergence. */
struct settings {
  struct dea_quantity refinements[MESHES_MAX];          // rising
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: quarters of the highest
  size_t refinement_count, voltage_count;
  struct dea_quantity tolerance; // relative
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    DEA_NUMBER_ROW("refinement", AT(refinements), "1", "[1, 2, 3]",
                   "meshes, as in compute.solid.refinement, rising; an order needs three", .min = 1,
                   .max = 6, .default_text = "[1, 1.5, 2]",
                   DEA_LIST(2, MESHES_MAX, struct dea_quantity, AT(refinement_count))),
    DEA_STUDY_STOPS_FIELD("quarters of the highest",
                          "voltages at which the meshes are compared, in the order to be computed",
                          "[2 kV, 4 kV, 6 kV]"),
    DEA_NUMBER_ROW("tolerance", AT(tolerance), "1", "0.02",
                   "relative error that is small enough for a displacement", .above_min = true,
                   .max = 1, .default_text = "0.02"),
};

static dea_status check(struct dea_context *ctx, const struct dea_design *design,
                        const struct dea_settings *given)
{
  (void)design;
  const struct settings *settings = given->values;
  for (size_t i = 1; i < settings->refinement_count; i++) {
    const struct dea_quantity *one = &settings->refinements[i];
    if (one->si <= one[-1].si) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, one->location,
                                   "refinement: %g after %g, but each mesh has to be finer than "
                                   "the one before",
                                   one->si, one[-1].si));
    }
  }
  return DEA_OK;
}

static const struct dea_design_section section = {
    .record = {"convergence",
               "study of convergence, made when this section is there ({}) or with --study: the "
               "same on ever finer meshes (3d)",
               fields, DEA_COUNT(fields)},
    .size = sizeof(struct settings),
    .check = check};

// Study ------------------------------------------------------------------------------------------

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  const struct dea_design *design = job->result->design;
  const struct settings *settings = dea_design_settings(design, &section)->values;
  size_t total = settings->refinement_count;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  char name[DEA_NAME_SIZE];
  dea_status first = DEA_OK;
  job->result->convergence_tolerance = settings->tolerance.si;
  struct dea_variant_run one = {.study = study_name,
                                .name = name,
                                .device = job->result->device,
                                .settings = dea_model_settings_of(design),
                                .voltages_V = voltages_V,
                                .voltage_count =
                                    dea_study_stops(design, settings->voltages_V,
                                                    settings->voltage_count, false, voltages_V)};
  for (size_t i = 0; i < total; i++) {
    one.settings.refinement = settings->refinements[i].si;
    snprintf(name, sizeof name, "refinement %.4g", one.settings.refinement);
    dea_status status = dea_variant_run(ctx, job, &one);
    first = first == DEA_OK ? status : first;
    if (dea_status_ends(status)) {
      break;
    }
    dea_study_progress(ctx, job, study_name, i + 1, total);
  }
  return first;
}

// Tables -----------------------------------------------------------------------------------------

enum { ALL = DEA_IN_JSON | DEA_IN_SCREEN };

static const struct dea_result_column fact_columns[] = {
    DEA_NUMBER_COLUMN("tolerance", NULL, "%", 100, "tolerance",
                      "relative error that is small enough for a displacement"),
    DEA_TEXT_COLUMN("verdict", "verdict", "voltage by voltage the mesh that is enough"),
};
static const struct dea_result_column mesh_columns[] = {
    DEA_TEXT_COLUMN("name", "mesh", "name of the mesh"),
    DEA_BARE("refinement", "refinement", "of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "elements", "elements", .meaning = "of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "nodes", "nodes", .meaning = "of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "unknowns", "unknowns", .meaning = "of the mesh"),
    DEA_NUMBER_COLUMN("wall_s", "s", "s", 1, "time", "that the mesh took"),
    DEA_RESULT_COLUMN(FLAG, "complete", "complete", .meaning = "to the last point"),
    DEA_TEXT_COLUMN("stopped", "stopped", "why it stopped"),
};
static const struct dea_result_column quantity_columns[] = {
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "quantity", .meaning = "of load points"),
    DEA_KV("voltage_V", "V", "voltage"),
    DEA_RESULT_COLUMN(VALUE, "values", "value", .list = true, .hidden = DEA_IN_SCREEN,
                      .meaning = "on each mesh"),
    DEA_RESULT_COLUMN(NUMBER, "errors", "error", .list = true, .display_unit = "%", .factor = 100,
                      .meaning = "estimated relative error on each mesh"),
    DEA_BARE("order", "order", "observed order of convergence"),
    DEA_RESULT_COLUMN(VALUE, "extrapolated", "extrapolated", .meaning = "value at element size 0"),
    DEA_TEXT_COLUMN("remark", "remark", "what is wrong with the sequence"),
};
static const struct dea_result_column enough_columns[] = {
    DEA_NUMBER_COLUMN("voltage_V", "V", NULL, 1, "V", "voltage"),
    DEA_RESULT_COLUMN(NUMBER, "refinement", "refinement", .null = true,
                      .meaning =
                          "coarsest mesh that is, with all finer ones, within the tolerance"),
};
static const struct dea_result_column error_columns[] = {
    DEA_RESULT_COLUMN(QUANTITY, "quantity", "quantity", .meaning = "of load points"),
    DEA_TEXT_COLUMN("unit", "unit", "of the value"),
    DEA_KV("voltage_V", "V", "voltage"),
    DEA_BARE("refinement", "refinement", "of the mesh"),
    DEA_RESULT_COLUMN(COUNT, "unknowns", "unknowns", .meaning = "of the mesh"),
    DEA_RESULT_COLUMN(VALUE, "value", "value", .meaning = "on this mesh"),
    DEA_NUMBER_COLUMN("error", NULL, "%", 100, "estimated error", "relative error on this mesh"),
    DEA_BARE("order", "observed order", "of convergence"),
    DEA_RESULT_COLUMN(VALUE, "extrapolated", "extrapolated", .meaning = "value at element size 0"),
    DEA_TEXT_COLUMN("remark", "remark", "on the sequence"),
};

static const struct dea_result_table_type fact_table = DEA_RESULT_TABLE(
    study_name, "", fact_columns, .title = "convergence", .where = ALL, .one_row = true);
static const struct dea_result_table_type mesh_table =
    DEA_RESULT_TABLE(study_name, "meshes", mesh_columns, .title = "meshes", .where = ALL);
static const struct dea_result_table_type quantity_table =
    DEA_RESULT_TABLE(study_name, "quantities", quantity_columns,
                     .title = "estimated errors on each mesh", .where = ALL);
static const struct dea_result_table_type enough_table = DEA_RESULT_TABLE(
    study_name, "enough", enough_columns, .title = "mesh that is enough", .where = DEA_IN_JSON);
static const struct dea_result_table_type error_table = DEA_RESULT_TABLE(
    study_name, "errors", error_columns, .title = "estimated errors", .where = DEA_IN_CSV);

static dea_status add_facts(struct dea_context *ctx, const struct dea_convergence *c,
                            struct dea_result_table *table)
{
  struct dea_text verdict = {.ctx = ctx};
  dea_convergence_verdict(c, &verdict);
  dea_status status = verdict.failed ? DEA_E_MEMORY
                                     : DEA_TABLE_ADD(ctx, table, DEA_CELL(c->tolerance),
                                                     DEA_TEXT_CELL(dea_text_get(&verdict)));
  dea_text_free(&verdict);
  return status;
}

static dea_status add_meshes(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_result_table *table)
{
  for (size_t m = 0; m < c->mesh_count; m++) {
    const struct dea_variant *mesh = c->meshes[m];
    bool sized = mesh->size.nodes > 0;
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_TEXT_CELL(mesh->name), DEA_CELL(mesh->refinement),
                               DEA_CELL(sized ? (double)mesh->size.elements : NAN),
                               DEA_CELL(sized ? (double)mesh->size.nodes : NAN),
                               DEA_CELL(sized ? (double)mesh->size.unknowns : NAN),
                               DEA_CELL(mesh->wall_s), DEA_CELL(mesh->curve.complete),
                               DEA_TEXT_CELL(mesh->curve.stopped)));
  }
  return DEA_OK;
}

static dea_status add_quantities(struct dea_context *ctx, const struct dea_convergence *c,
                                 struct dea_result_table *table)
{
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *r = &c->rows[i];
    DEA_TRY(ctx,
            DEA_TABLE_ADD(ctx, table, DEA_CELL(r->column), DEA_CELL(r->voltage_V),
                          DEA_LIST_CELL(r->values), DEA_LIST_CELL(r->errors), DEA_CELL(r->order),
                          DEA_CELL(r->extrapolated), DEA_TEXT_CELL(dea_order_text(r->kind))));
  }
  return DEA_OK;
}

/* Voltage by voltage the refinement that is enough, none where no mesh is. */
static dea_status add_enough(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_result_table *table)
{
  for (size_t i = 0; i < c->row_count; i++) {
    double voltage_V = c->rows[i].voltage_V;
    if (i == 0 || voltage_V != c->rows[i - 1].voltage_V) {
      size_t mesh = dea_convergence_enough(c, voltage_V);
      DEA_TRY(ctx,
              DEA_TABLE_ADD(ctx, table, DEA_CELL(voltage_V),
                            DEA_CELL(mesh < c->mesh_count ? c->meshes[mesh]->refinement : NAN)));
    }
  }
  return DEA_OK;
}

/* A line a quantity, voltage and mesh. */
static dea_status add_error_rows(struct dea_context *ctx, const struct dea_convergence *c,
                                 struct dea_result_table *table)
{
  for (size_t i = 0; i < c->row_count * c->mesh_count; i++) {
    const struct dea_convergence_row *r = &c->rows[i / c->mesh_count];
    const struct dea_variant *mesh = c->meshes[i % c->mesh_count];
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(r->column),
                               DEA_TEXT_CELL(r->shown->display_unit), DEA_CELL(r->voltage_V),
                               DEA_CELL(mesh->refinement), DEA_CELL((double)mesh->size.unknowns),
                               DEA_CELL(r->values[i % c->mesh_count]),
                               DEA_CELL(r->errors[i % c->mesh_count]), DEA_CELL(r->order),
                               DEA_CELL(r->extrapolated), DEA_TEXT_CELL(dea_order_text(r->kind))));
  }
  return DEA_OK;
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  static const struct {
    const struct dea_result_table_type *type;
    dea_status (*put)(struct dea_context *ctx, const struct dea_convergence *c,
                      struct dea_result_table *table);
  } parts[] = {{&fact_table, add_facts},
               {&mesh_table, add_meshes},
               {&quantity_table, add_quantities},
               {&enough_table, add_enough},
               {&error_table, add_error_rows}};
  struct dea_convergence *c;
  DEA_TRY(ctx, dea_convergence_create(ctx, result, model, &c));
  dea_status status = DEA_OK;
  for (size_t i = 0; c != NULL && i < DEA_COUNT(parts) && status == DEA_OK; i++) {
    struct dea_result_table *table;
    status = dea_result_add_table(ctx, result, parts[i].type, model, c->mesh_count, &table);
    status = status == DEA_OK ? parts[i].put(ctx, c, table) : status;
  }
  dea_convergence_destroy(ctx, c);
  return status;
}

// Figures ----------------------------------------------------------------------------------------

enum { COLOURS = 5 };
static const enum dea_colour colours[COLOURS] = {DEA_VERMILLION, DEA_BLUE, DEA_GREEN, DEA_PURPLE,
                                                 DEA_ORANGE};

/* Adds errors of the meshes [%] against unknowns in thousands. An error of 0 has no place on the
 * axis. */
static dea_status add_errors(struct dea_context *ctx, struct dea_panel *panel,
                             const struct dea_convergence *c, const double *errors,
                             const char *title)
{
  struct dea_series *series;
  size_t n = c->mesh_count;
  DEA_TRY(ctx, dea_panel_add(ctx, panel, n, DEA_LINE_MARKED,
                             colours[(panel->series_count - 1) % COLOURS], title, &series));
  series->marker = (int)panel->series_count - 1;
  for (size_t m = 0; m < n; m++) {
    series->values[m] = 1e-3 * (double)c->meshes[m]->size.unknowns;
    series->values[n + m] = errors[m] > 0 ? 100 * errors[m] : NAN;
  }
  return DEA_OK;
}

static bool is_probe_at(const struct dea_convergence *c, size_t i, double voltage_V)
{
  return c->rows[i].voltage_V == voltage_V && c->rows[i].judged;
}

/* Voltage of the upper panel: the last at which every displacement has an order, else the last. */
static double choose_voltage(const struct dea_convergence *c)
{
  double chosen = NAN, last = NAN;
  for (size_t i = 0; i < c->row_count; i++) {
    double voltage_V = c->rows[i].voltage_V;
    bool good = true, any = false;
    for (size_t k = 0; k < c->row_count; k++) {
      if (is_probe_at(c, k, voltage_V)) {
        any = true;
        good = good && c->rows[k].kind == DEA_ORDER_OBSERVED;
      }
    }
    chosen = good && any ? voltage_V : chosen;
    last = any ? voltage_V : last;
  }
  return isnan(chosen) ? last : chosen;
}

static dea_status fill_upper(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_panel *panel)
{
  double voltage_V = choose_voltage(c);
  for (size_t i = 0; i < c->row_count; i++) {
    const struct dea_convergence_row *row = &c->rows[i];
    if (is_probe_at(c, i, voltage_V)) {
      char title[DEA_LABEL_SIZE], header[DEA_LABEL_SIZE / 2];
      dea_label_escape(row->shown->header, header, sizeof header);
      if (row->kind == DEA_ORDER_OBSERVED) {
        snprintf(title, sizeof title, "%s, order %.1f", header, row->order);
      } else {
        snprintf(title, sizeof title, "%s, no order", header);
      }
      DEA_TRY(ctx, add_errors(ctx, panel, c, row->errors, title));
    }
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Error at %.4g kV (%%)", 1e-3 * voltage_V);
  return DEA_OK;
}

/* A line a voltage: the largest error of a displacement. */
static dea_status fill_lower(struct dea_context *ctx, const struct dea_convergence *c,
                             struct dea_panel *panel)
{
  double last = NAN;
  for (size_t i = 0; i < c->row_count; i++) {
    double voltage_V = c->rows[i].voltage_V, worst[DEA_CONVERGENCE_MESHES_MAX] = {0};
    if (voltage_V == last || !c->rows[i].judged) {
      continue;
    }
    for (size_t k = i; k < c->row_count; k++) {
      for (size_t m = 0; m < c->mesh_count && is_probe_at(c, k, voltage_V); m++) {
        worst[m] = fmax(worst[m], c->rows[k].errors[m]);
      }
    }
    char title[DEA_LABEL_SIZE];
    snprintf(title, sizeof title, "%.4g kV", 1e-3 * voltage_V);
    DEA_TRY(ctx, add_errors(ctx, panel, c, worst, title));
    last = voltage_V;
  }
  snprintf(panel->y_label, sizeof panel->y_label, "Largest error (%%)");
  return DEA_OK;
}

/* Limits around the points, the tolerance among them, with room for the key above. */
static void set_limits(struct dea_panel *panel, double tolerance_percent)
{
  double x[2] = {INFINITY, 0}, y[2] = {tolerance_percent, tolerance_percent};
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    for (size_t i = 0; i < series->count; i++) {
      x[0] = fmin(x[0], series->values[i]);
      x[1] = fmax(x[1], series->values[i]);
      y[0] = fmin(y[0], series->values[series->count + i]); // NAN counts as nothing
      y[1] = fmax(y[1], series->values[series->count + i]);
    }
  }
  double key = 1 + 0.14 * (double)panel->series_count; // of the range without it
  panel->x_min = x[0] / 1.3;
  panel->x_max = x[1] * 1.3;
  panel->y_min = y[0] / 1.4;
  panel->y_max = panel->y_min * pow(1.4 * y[1] / panel->y_min, key);
}

static dea_status fill_plot(struct dea_context *ctx, const struct dea_convergence *c,
                            struct dea_plot *plot)
{
  plot->panel_count = 2;
  DEA_TRY(ctx, fill_upper(ctx, c, &plot->panels[0]));
  DEA_TRY(ctx, fill_lower(ctx, c, &plot->panels[1]));
  for (int p = 0; p < 2; p++) {
    struct dea_panel *panel = &plot->panels[p];
    char text[32];
    snprintf(text, sizeof text, "%.3g %%", 100 * c->tolerance);
    dea_panel_mark(panel, 100 * c->tolerance, text);
    snprintf(panel->x_label, sizeof panel->x_label, "Unknowns (thousands)");
    panel->logarithmic = true;
    set_limits(panel, 100 * c->tolerance);
    panel->key = "top right";
  }
  return DEA_OK;
}

static dea_status build(struct dea_context *ctx, const struct dea_result *result,
                        struct dea_plot *plot)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    struct dea_convergence *convergence;
    DEA_TRY(ctx, dea_convergence_create(ctx, result, models[m], &convergence));
    if (convergence != NULL) { // one model has a mesh at present
      dea_status status = fill_plot(ctx, convergence, plot);
      dea_convergence_destroy(ctx, convergence);
      return status;
    }
  }
  return DEA_OK;
}

static const struct dea_figure figures[] = {
    DEA_STUDY_FIGURE("convergence", study_name, build,
                     "estimated error of displacements on ever finer meshes"),
};

// The study --------------------------------------------------------------------------------------

const struct dea_study dea_study_convergence = {
    .name = study_name,
    .keys = &section,
    .own_models = true,
    .ability = "mesh refinement",
    .able_by = offsetof(struct dea_model_type, size),
    .run = run,
    .tables = tables,
    .figures = figures,
    .figure_count = DEA_COUNT(figures),
};
