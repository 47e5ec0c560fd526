/* dea run: design -> models -> studies -> run folder, or JSON on stdout. */
#include "base/file.h"
#include "base/text.h"
#include "base/write_file.h"
#include "base/yaml.h"
#include "base/yaml_write.h"
#include "cli/cli.h"
#include "io/csv.h"
#include "io/summary.h"
#include "job/job.h"
#include "job/run_folder.h"
#include "material/plane.h"
#include "result/figure.h"
#include "result/observation.h"
#include "result/provenance.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { STUDIES_MAX = 8, TABLE_ROWS = 9, MONITORS_SHOWN = 4, SHOWN_MAX = 4 + MONITORS_SHOWN };
static const char sensitivity_name[] = "sensitivity";

struct request {
  struct cli_words designs; // the first, and those that it is compared with
  const char *output;       // NULL: not given
  struct cli_words models, studies;
  struct cli_overrides overrides;
  bool json, force, keep, resume, no_figures, sensitivity;
};

/* Everything of one run that has to be given back. */
struct run {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  struct dea_job job;
};

static dea_status parse_model(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target)
{
  struct cli_words *models = target;
  if (models->count == DEA_DESIGN_MODELS_MAX) {
    return cli_usage_error(cli, "too many models");
  }
  for (size_t i = 0; i < models->count; i++) {
    if (strcmp(models->at[i], text) == 0) {
      return cli_usage_error(cli, "--%s %s is given twice", option->name, text);
    }
  }
  models->at[models->count++] = text;
  return DEA_OK;
}

/* The models to run: --model, or those of the design. DEA_E_USAGE or DEA_E_DESIGN for unknown
 * ones. */
static dea_status choose_models(struct dea_cli *cli, const struct request *request,
                                const struct dea_design *design, struct dea_job *job)
{
  bool given = request->models.count > 0, bad = false;
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a design without errors is there
  job->model_count = given ? request->models.count : design->compute.model_count;
  for (size_t i = 0; i < job->model_count; i++) {
    const struct dea_label *label = &design->compute.models[i];
    const struct dea_location option = {.file = "--model"};
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): as many were given as are counted
    dea_model_seek(cli->ctx, given ? request->models.at[i] : label->text,
                   given ? option : label->location, &job->models[i]);
    bad = bad || job->models[i] == NULL;
  }
  if (bad) {
    return dea_fail(cli->ctx, given ? DEA_E_USAGE : DEA_E_DESIGN, "a model is not known");
  }
  return DEA_OK;
}

/* Text in YAML's double quotes. */
static void add_quoted(struct dea_text *out, const char *text, size_t length)
{
  dea_text_add(out, "\"");
  dea_yaml_add_quoted(out, text, length);
  dea_text_add(out, "\"");
}

/* Value of `compute.compare` that names design files after their names without folder and ending:
 * paths count from here. */
static void add_designs(const char *const files[], size_t count, struct dea_text *out)
{
  char here[4096];
  if (getcwd(here, sizeof here) == NULL) {
    here[0] = '\0';
  }
  for (size_t i = 0; i < count; i++) {
    size_t length;
    const char *name = dea_path_stem(files[i], &length);
    struct dea_text path = {.ctx = out->ctx};
    dea_text_add(&path, "%s%s%s", files[i][0] == '/' ? "" : here, files[i][0] == '/' ? "" : "/",
                 files[i]);
    dea_text_add(out, "%s{name: ", i == 0 ? "[" : ", ");
    add_quoted(out, name, length);
    dea_text_add(out, ", file: ");
    add_quoted(out, dea_text_get(&path), strlen(dea_text_get(&path)));
    dea_text_add(out, "}%s", i + 1 == count ? "]" : "");
    dea_text_free_in(&path, out);
  }
}

static dea_status build(struct dea_cli *cli, const struct request *request, const char *bytes,
                        size_t length, struct run *run)
{
  struct dea_context *ctx = cli->ctx;
  struct dea_override overrides[CLI_OVERRIDES_MAX + 2];
  size_t count = request->overrides.count;
  memcpy(overrides, request->overrides.at, sizeof request->overrides.at);
  if (request->designs.count > 1) {
    struct dea_text others = {.ctx = ctx};
    add_designs(request->designs.at + 1, request->designs.count - 1, &others);
    overrides[count].key = "compute.compare";
    DEA_TRY(ctx, cli_keep_text(&others, &overrides[count++].value));
  }
  DEA_TRY(ctx, dea_design_read_memory(ctx, request->designs.at[0], bytes, length, overrides, count,
                                      &run->design));
  if (request->sensitivity && request->studies.count == 0 &&
      !dea_study_asked(run->design, sensitivity_name)) {
    overrides[count++] = (struct dea_override){"compute.sensitivity", "{}"};
    dea_design_destroy(ctx, run->design);
    run->design = NULL;
    DEA_TRY(ctx, dea_design_read_memory(ctx, request->designs.at[0], bytes, length, overrides,
                                        count, &run->design));
  }
  DEA_TRY(ctx, dea_device_build(ctx, run->design, &run->device));
  DEA_TRY(ctx, dea_result_create(ctx, run->design, run->device, &run->result));
  return DEA_CHAIN(ctx, dea_provenance_fill(ctx, bytes, length, overrides, count, cli->command_line,
                                            &run->result->provenance));
}

static dea_status prepare(struct dea_cli *cli, const struct request *request, struct run *run)
{
  struct dea_context *ctx = cli->ctx;
  char *bytes;
  size_t length;
  DEA_TRY(ctx, dea_file_read(ctx, request->designs.at[0], DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = build(cli, request, bytes, length, run); // the very bytes that are kept
  dea_free(ctx, bytes);
  return DEA_CHAIN(ctx, status);
}

static void release(struct dea_cli *cli, struct run *run)
{
  dea_job_end(cli->ctx, &run->job);
  dea_result_destroy(cli->ctx, run->result);
  dea_device_destroy(cli->ctx, run->device);
  dea_design_destroy(cli->ctx, run->design);
}

/* The field at which the film breaks down, with the band of its sources and the chance there. */
static void print_breakdown(const struct dea_load_point *p, const struct dea_breakdown *film)
{
  double field = 1e-6 * p->true_field_V_per_m;
  printf("the field reaches the film's breakdown field, %.4g V/um (margin 0", field);
  if (film->law.high > film->law.low) {
    printf("; by source %.4g to %.4g V/um", film->law.low * field, film->law.high * field);
  }
  if (!isnan(p->breakdown_probability)) {
    double band[2];
    dea_breakdown_probability_band(film, p->breakdown_margin, band);
    printf("; breaks down by here with at most %.0f %%", 100 * p->breakdown_probability);
    if (!isnan(band[0])) {
      printf(", by source %.0f to %.0f %%", 100 * band[0], 100 * band[1]);
    }
  }
  puts(")");
}

/* slack: of a film without tension. */
static void print_event(const struct dea_event *event, const struct dea_breakdown *film, bool slack)
{
  static const char *const names[] = {[DEA_EVENT_PULL_IN] = "pull-in",
                                      [DEA_EVENT_SNAP_BACK] = "snap-back",
                                      [DEA_EVENT_SLACK] = "the film goes slack",
                                      [DEA_EVENT_BUCKLING] = "the film buckles"};
  const struct dea_load_point *p = &event->point;
  printf("  at %.4g kV", 1e-3 * p->voltage_V);
  if (!isnan(p->electrode_stretch)) { // of a disc
    printf(", electrode stretch %.5g", p->electrode_stretch);
  }
  fputs(": ", stdout);
  if (event->kind == DEA_EVENT_BREAKDOWN) {
    print_breakdown(p, film);
  } else {
    printf("%s%s\n", names[event->kind],
           slack && event->kind == DEA_EVENT_PULL_IN ? " of a slack film: not predictive" : "");
  }
}

/* A column of the table of a sweep. */
struct shown {
  int column; // of load points
  const char *title, *unit;
  double factor;
  int width, digits;
};

/* What is shown of a device of any layout: what its monitors show, or without any how far the film
 * goes. */
static size_t add_any(const struct dea_context *ctx, const struct dea_curve *sweep,
                      struct shown out[MONITORS_SHOWN])
{
  int columns[MONITORS_SHOWN];
  size_t count = dea_curve_headlines(ctx, sweep, columns, MONITORS_SHOWN);
  if (count == 0) {
    columns[count++] = dea_point_column_find("lowest_z_m");
    columns[count++] = dea_point_column_find("highest_z_m");
  }
  for (size_t i = 0; i < count; i++) {
    const struct dea_column *c = dea_column_at(ctx, columns[i]);
    const bool bare = strcmp(c->display_unit, "1") == 0;
    out[i] = (struct shown){columns[i], c->header, bare ? "" : c->display_unit,
                            c->factor,  16,        strcmp(c->si_unit, "m") == 0 ? 1 : 4};
  }
  return count;
}

static size_t find_shown(const struct dea_context *ctx, const struct dea_curve *sweep,
                         bool any_layout, struct shown out[SHOWN_MAX])
{
  int (*const find)(const char *key) = dea_point_column_find;
  size_t n = 0;
  out[n++] = (struct shown){find("voltage_V"), "V", "kV", 1e-3, 9, 3};
  if (any_layout) {
    n += add_any(ctx, sweep, out + n);
  } else { // a disc
    out[n++] = (struct shown){find("electrode_stretch"), "stretch", "", 1, 10, 5};
    out[n++] = (struct shown){find("electrode_edge_u_m"), "u edge", "um", 1e6, 12, 2};
    out[n++] = (struct shown){find("fibre_tip_z_m"), "z tip", "um", 1e6, 12, 1};
  }
  out[n++] = (struct shown){find("true_field_V_per_m"), "field", "V/um", 1e-6, 12, 2};
  out[n++] = (struct shown){find("breakdown_margin"), "margin", "%", 100, 10, 1};
  out[n++] = (struct shown){find("min_tension_N_per_m"), "tension", "N/m", 1, 10, 3};
  return n;
}

/* "<" before an upper bound; "-" where there is no value, or left_out: another model predicts it.
 */
static void print_cell(const struct dea_load_point *p, const struct shown *c, bool left_out)
{
  char text[400] = "-";
  const double value = left_out ? NAN : c->factor * dea_point_get(p, c->column);
  if (!isnan(value)) { // without the sign of what is 0 to all digits shown
    snprintf(text, sizeof text, "%s%.*f", dea_point_is_bound(p, c->column) ? "<" : "", c->digits,
             fabs(value) < 0.5 * pow(10, -c->digits) ? 0.0 : value);
  }
  printf("%*s", c->width, text);
}

static void print_row(const struct dea_result *result, const struct dea_curve *sweep,
                      const struct dea_load_point *p, const struct shown *shown, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    print_cell(p, &shown[i], dea_figure_leaves_out(result, sweep, shown[i].column));
  }
  char words[DEA_FLAGS_SIZE];
  dea_flags_text(dea_load_point_flags(p) & ~(1u << DEA_FLAG_BOUND | 1u << DEA_FLAG_PLAIN), words);
  printf("%s%s%s\n", words[0] != '\0' ? "  " : "",
         dea_load_point_valid(p) ? "" : "not trusted: ", words);
}

/* Points from row to row of a table of at most TABLE_ROWS rows: 1, 2 or 5 times a power of ten, so
 * that round voltages stay round. */
static size_t row_step(size_t count)
{
  static const size_t factors[] = {1, 2, 5};
  for (size_t power = 1;; power *= 10) {
    for (size_t i = 0; i < sizeof factors / sizeof factors[0]; i++) {
      if ((count - 1 + factors[i] * power - 1) / (factors[i] * power) < TABLE_ROWS) {
        return factors[i] * power;
      }
    }
  }
}

/* A few rows of the sweep, the last one among them. */
static void print_sweep(const struct dea_context *ctx, const struct dea_result *result,
                        const struct dea_curve *sweep, bool any_layout)
{
  struct shown shown[SHOWN_MAX];
  const size_t count = find_shown(ctx, sweep, any_layout, shown);
  for (size_t i = 0; i < count; i++) {
    printf(" %*.*s", shown[i].width - 1, shown[i].width - 1, shown[i].title);
  }
  putchar('\n');
  for (size_t i = 0; i < count; i++) {
    printf("%*s", shown[i].width, shown[i].unit);
  }
  putchar('\n');
  const size_t step = row_step(sweep->count);
  for (size_t i = 0; i + 1 < sweep->count; i += step) {
    print_row(result, sweep, &sweep->points[i], shown, count);
  }
  print_row(result, sweep, &sweep->points[sweep->count - 1], shown, count);
}

/* The sweep, or how long the path is where that was asked for alone, and the path's events. */
static void print_model(const struct dea_context *ctx, const struct dea_result *result,
                        const char *model)
{
  const struct dea_curve *sweep = dea_result_find(result, model, "sweep");
  const struct dea_curve *path = dea_result_find(result, model, "path");
  if (sweep == NULL && path == NULL) {
    return;
  }
  const bool any_layout =
      dea_device_is_observed(result->device) && dea_model_find(model)->any_layout;
  const struct dea_layout_ply *film = dea_layout_film(result->device->layout);
  printf("\n%s\n", model);
  if (sweep != NULL && sweep->count > 0) {
    print_sweep(ctx, result, sweep, any_layout);
  } else if (sweep == NULL && path->count > 0) {
    double highest_V = 0;
    for (size_t i = 0; i < path->count; i++) {
      highest_V = fmax(highest_V, path->points[i].voltage_V);
    }
    printf("  path of %zu points, up to %.4g kV\n", path->count, 1e-3 * highest_V);
  }
  const struct dea_curve *limits = path != NULL ? path : sweep;
  for (size_t i = 0; i < limits->event_count; i++) {
    print_event(&limits->events[i],
                film != NULL ? &film->material.breakdown : &result->device->film.breakdown,
                dea_curve_is_slack(limits));
  }
  if (sweep != NULL && dea_verdict_of(sweep->status)[0] != '\0') {
    printf("  stopped, %s: %s\n", dea_verdict_of(sweep->status), sweep->stopped);
  }
}

// Tables of studies -------------------------------------------------------------------------------

enum { ROWS_SHOWN = 40, WIDTH_MAX = 36, DIGITS = 5, ERROR_DIGITS = 2 };

/* Whether some row has something in a column; without rows all have. */
static bool has_any(const struct dea_result_table *table, size_t column)
{
  size_t values = dea_result_table_values(table, column);
  for (size_t i = 0; i < table->row_count; i++) {
    const struct dea_cell *cell = dea_result_table_cell(table, i, column);
    for (size_t k = 0; k < values; k++) {
      if (!isnan(cell[k].number) || (cell[k].text != NULL && cell[k].text[0] != '\0')) {
        return true;
      }
    }
  }
  return table->row_count == 0;
}

/* Whether a cell holds what rounding left of 0: display units are chosen so that numbers are
 * near 1. */
static bool is_noise(const struct dea_result_column *column, const char *text)
{
  const double least = 1e-9;
  const char *unit = column->display_unit;
  return column->kind == DEA_CELL_NUMBER && unit != NULL && strcmp(unit, "1") != 0 &&
         fabs(strtod(text, NULL)) < least;
}

/* Rows that are shown of a table are `every` rows apart. */
static size_t table_step(const struct dea_result_table *table)
{
  return table->type.every > 0 ? table->type.every : 1;
}

/* A cell as text, with the unit of its quantity where the title cannot say it. line: 0 for the
 * title, then rows that are shown. */
static void add_cell(const struct dea_result_table *table, size_t line, size_t column, size_t value,
                     struct dea_text *out)
{
  const struct dea_result_column *c = &table->type.columns[column];
  if (line == 0) {
    if (value == 0) {
      dea_result_table_column_title(c, out);
    }
    return;
  }
  const size_t row = (line - 1) * table_step(table);
  const struct dea_column *quantity = dea_result_table_quantity(table, row);
  bool percent = c->display_unit != NULL && strcmp(c->display_unit, "%") == 0 && c->list;
  dea_result_table_cell_text(table, row, column, value, percent ? ERROR_DIGITS : DIGITS, out);
  if (out->length > 0 && is_noise(c, dea_text_get(out))) {
    out->length = 0;
    dea_text_add(out, "0");
  }
  if (out->length > 0 && c->kind == DEA_CELL_VALUE && strcmp(quantity->display_unit, "1") != 0) {
    dea_text_add(out, " %s", quantity->display_unit);
  } else if (out->length == 0 && c->kind != DEA_CELL_TEXT) {
    dea_text_add(out, "-");
  }
}

static int column_width(struct dea_context *ctx, const struct dea_result_table *table,
                        size_t column, size_t value, size_t rows)
{
  size_t width = 0;
  for (size_t i = 0; i <= rows; i++) {
    struct dea_text text = {.ctx = ctx};
    add_cell(table, i, column, value, &text);
    width = text.length > width ? text.length : width;
    dea_text_free(&text);
  }
  return width < WIDTH_MAX ? (int)width : WIDTH_MAX;
}

static dea_status print_rows(struct dea_context *ctx, const struct dea_result_table *table)
{
  const size_t step = table_step(table), all = (table->row_count + step - 1) / step;
  const size_t rows = all < ROWS_SHOWN ? all : ROWS_SHOWN;
  size_t values[DEA_RESULT_TABLE_COLUMNS_MAX];
  int widths[DEA_RESULT_TABLE_COLUMNS_MAX][DEA_RESULT_TABLE_WIDTH_MAX];
  bool failed = false;
  for (size_t c = 0; c < table->type.column_count; c++) {
    values[c] = has_any(table, c) ? dea_result_table_shown(table, c, DEA_IN_SCREEN) : 0;
    for (size_t k = 0; k < values[c]; k++) {
      widths[c][k] = column_width(ctx, table, c, k, rows);
    }
  }
  for (size_t i = 0; i <= rows; i++) {
    for (size_t c = 0; c < table->type.column_count; c++) {
      const bool words = table->type.columns[c].kind == DEA_CELL_TEXT ||
                         table->type.columns[c].kind == DEA_CELL_QUANTITY;
      for (size_t k = 0; k < values[c]; k++) {
        struct dea_text cell = {.ctx = ctx};
        add_cell(table, i, c, k, &cell);
        printf("  %*s", words ? -widths[c][k] : widths[c][k], dea_text_get(&cell));
        failed = failed || cell.failed;
        dea_text_free(&cell);
      }
    }
    putchar('\n');
  }
  if (table->row_count > rows) {
    printf("  and %zu more (summary.json)\n", table->row_count - rows);
  }
  return failed ? DEA_E_MEMORY : DEA_OK;
}

/* "title 5 um, title 3 %": a table of one row. */
static dea_status print_line(struct dea_context *ctx, const struct dea_result_table *table)
{
  struct dea_text line = {.ctx = ctx};
  for (size_t c = 0; c < table->type.column_count; c++) {
    const struct dea_result_column *column = &table->type.columns[c];
    const char *unit = column->display_unit != NULL ? column->display_unit : "1";
    struct dea_text cell = {.ctx = ctx};
    dea_result_table_cell_text(table, 0, c, 0, DIGITS, &cell);
    if (dea_result_table_shown(table, c, DEA_IN_SCREEN) > 0 && cell.length > 0) {
      bool long_text = column->kind == DEA_CELL_TEXT && strchr(dea_text_get(&cell), '\n') != NULL;
      dea_text_add(&line, "%s%s %s%s%s",
                   line.length == 0 ? "  "
                   : long_text      ? "\n  "
                                    : ", ",
                   column->title, dea_text_get(&cell), strcmp(unit, "1") != 0 ? " " : "",
                   strcmp(unit, "1") != 0 ? unit : "");
    }
    dea_text_free_in(&cell, &line);
  }
  puts(dea_text_get(&line));
  return dea_text_free(&line);
}

static dea_status print_tables(struct dea_context *ctx, const struct dea_result *result,
                               const char *model)
{
  for (size_t i = 0; i < result->table_count; i++) {
    const struct dea_result_table *table = &result->tables[i];
    bool wanted = strcmp(table->model, model) == 0 && table->row_count > 0 &&
                  (table->type.where & (DEA_IN_SCREEN | DEA_IN_TERMINAL)) != 0;
    if (wanted) {
      printf("\n%s: %s\n", model, table->type.title);
      DEA_TRY(ctx, table->type.one_row ? print_line(ctx, table) : print_rows(ctx, table));
    }
  }
  return DEA_OK;
}

/* Names what the folder has got. */
static void print_folder(const struct run *run)
{
  const char *folder = dea_job_folder(&run->job, run->result);
  if (folder == NULL) {
    return;
  }
  bool drawn = !run->job.no_figures && dea_folder_has(folder, DEA_FIGURE_FOLDER "/");
  printf("\nresults: %s (summary.json, results.h5%s%s)\n", folder,
         dea_csv_has(run->result) ? ", CSV" : "", drawn ? ", " DEA_FIGURE_FOLDER "/" : "");
  if (strcmp(folder, run->job.folder) != 0) {
    printf("%s still has the results of before; --resume goes on\n", run->job.folder);
  }
}

/* What the solver of model 3d has done, if anything. */
static void print_solver(const struct dea_solver_counters *solver)
{
  const char *join = "solver:";
#define PRINT(member, label)                                                                       \
  printf("%s %lu " label, join, solver->member);                                                   \
  join = ",";
  if (solver->newton_iterations > 0) {
    DEA_SOLVER_COUNTERS(PRINT)
    puts("");
  }
#undef PRINT
}

/* Writes what there is, whatever happened before: partial results are results. */
static dea_status deliver(struct dea_cli *cli, const struct request *request, struct run *run)
{
  struct dea_context *ctx = cli->ctx;
  if (request->json) {
    char *text;
    DEA_TRY(ctx, dea_summary_text(ctx, run->result, &text));
    fputs(text, stdout);
    dea_free(ctx, text);
  }
  dea_status status = dea_job_write(ctx, &run->job, run->result);
  if (!request->json) {
    puts(run->design->title.text);
    for (size_t i = 0; i < run->job.model_count; i++) {
      print_model(ctx, run->result, run->job.models[i]->name);
      DEA_TRY(ctx, print_tables(ctx, run->result, run->job.models[i]->name));
    }
    if (!cli->quiet &&
        (status == DEA_OK || status == DEA_E_TOOL)) { // without gnuplot the data are there
      print_folder(run);
    }
    if (cli->verbose) {
      print_solver(&run->result->provenance.solver);
    }
  }
  return status;
}

/* The folder of a run; with --keep "out-2", "out-3", ... where "out" exists. */
static dea_status name_folder(struct dea_cli *cli, const struct request *request,
                              const char **folder)
{
  const char *name = request->output;
  DEA_TRY(cli->ctx, cli_output_name(cli, request->designs.at[0], "run", &name));
  *folder = name;
  for (size_t n = 2; request->keep && dea_path_exists(*folder); n++) {
    struct dea_text text = {.ctx = cli->ctx};
    dea_text_add(&text, "%.*s-%zu", (int)dea_path_length(name), name, n);
    DEA_TRY(cli->ctx, cli_keep_text(&text, folder));
  }
  return DEA_OK;
}

static dea_status run_all(struct dea_cli *cli, const struct request *request, struct run *run)
{
  struct dea_context *ctx = cli->ctx;
  bool began, given = request->studies.count > 0; // else those that the design asks for
  char message[1024];
  DEA_TRY(ctx, prepare(cli, request, run));
  const char *folder = NULL; // the summary goes to stdout alone
  if (request->output != NULL || !request->json) {
    DEA_TRY(ctx, name_folder(cli, request, &folder));
  }
  const bool renewed = folder != NULL && !request->resume && !request->keep &&
                       dea_run_folder_is_of(ctx, folder, run->design);
  run->job = (struct dea_job){.studies = given ? request->studies.at : NULL,
                              .study_count = request->studies.count,
                              .folder = folder,
                              .force = request->force || renewed,
                              .resume = request->resume,
                              .no_figures = request->no_figures};
  DEA_TRY(ctx, choose_models(cli, request, run->design, &run->job));
  dea_status status = dea_job_run(ctx, &run->job, run->result, &began);
  snprintf(message, sizeof message, "%s", dea_context_message(ctx));
  if (!began) {
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  DEA_TRY(ctx, !run->job.keep.refused ? deliver(cli, request, run) : DEA_OK);
  return status == DEA_OK ? DEA_OK : dea_fail(ctx, status, "%s", message);
}

static dea_status run(struct dea_cli *cli, void *user)
{
  struct request *request = user;
  struct run run = {0};
  if (request->resume && request->json && request->output == NULL) {
    return cli_usage_error(cli, "--resume with --json needs the folder (-o)");
  }
  if (request->resume && request->force) {
    return cli_usage_error(cli, "--resume goes on, --force starts anew: choose one");
  }
  if (request->keep && (request->resume || request->force)) {
    return cli_usage_error(cli, "--keep takes a new folder, --resume and --force do not");
  }
  if (cli->follower) { // no folder; its standard output leads nowhere
    request->json = true;
    request->output = NULL;
  }
  if (request->sensitivity && request->studies.count > 0 && request->studies.count < STUDIES_MAX) {
    request->studies.at[request->studies.count++] = sensitivity_name;
  }
  const dea_status status = run_all(cli, request, &run);
  release(cli, &run);
  return status;
}

static const struct cli_option options[] = {
    CLI_MANY(CLI_DESIGN, "DESIGN...",
             "design file; more of them are set beside the first in its figures and tables (study "
             "compare-design)",
             designs, DEA_DESIGN_VARIANTS_MAX + 1, "a design file is needed",
             "too many design files"),
    {"model", 'm', CLI_MODEL, "NAME", "model instead of the design's list; can be repeated",
     CLI_AT(models), parse_model, .most = DEA_DESIGN_MODELS_MAX},
    {"study", 0, CLI_STUDY, "NAME", "only this study; can be repeated", CLI_AT(studies),
     .most = STUDIES_MAX, .too_many = "too many studies"},
    {"sensitivity", 0, CLI_FLAG, NULL,
     "also what matters: the change of displacement, field, tension, ... by each number of the "
     "design (study sensitivity)",
     CLI_AT(sensitivity)},
    CLI_SET_ROW('s', CLI_KEY, "film.thickness=200um"),
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "run folder (default: DESIGN.run here)"),
    CLI_FORCE_ROW('f', "replace whatever results are in the folder; without it those of another "
                       "design file stay"),
    {"keep", 'k', CLI_FLAG, NULL, "keep earlier results: take DIR-2, DIR-3, ... where DIR exists",
     CLI_AT(keep)},
    {"resume", 0, CLI_FLAG, NULL, "go on where the run in the folder stopped (model 3d)",
     CLI_AT(resume)},
    {"no-figures", 0, CLI_FLAG, NULL, "no figures", CLI_AT(no_figures)},
    CLI_JSON_ROW("summary as JSON on stdout; a folder only with -o"),
    {0}};

const struct dea_command cmd_run = {
    .name = "run",
    .summary = "Solve a design: stretch, field, displacement and margins against voltage",
    .on_ranks = true,
    CLI_RUN};
