#include "cli/cli.h"

#include "cli/compare_many.h"
#include "output/compare_output.h"
#include "output/csv.h"
#include "output/figure.h"
#include "output/measured.h"
#include "output/results_h5.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PAIRS_MAX = DEA_DESIGN_MODELS_MAX };

/* One of the two sides: a run or measurements. */
struct side {
  const char *name;
  struct dea_run *run;
  struct dea_measurement *measurement;
};

struct request {
  struct side side[2];
  const char *model[2]; // asked for with --model, "" for any
  const struct compare_request *line;
};

/* A pair of curves and what came out. */
struct pair {
  const struct dea_curve *a, *b;
  const struct dea_load_point *b_std;
  struct dea_comparison *comparison;
  struct dea_compared compared;
};

// Command line -----------------------------------------------------------------------------------

static int take_quantity(struct dea_cli *cli, const struct dea_command *command,
                         const struct cli_option *option, const char *text, void *target)
{
  struct compare_columns *columns = target;
  int column = dea_point_column_find(text);
  (void)option;
  if (column >= 0 && columns->count < COMPARE_QUANTITIES_MAX) {
    columns->at[columns->count++] = column;
    return 0;
  }
  const char *keys[DEA_LOAD_POINT_COLUMNS];
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    keys[c] = dea_point_columns[c].key;
  }
  const char *nearest = dea_nearest_name(text, keys, DEA_LOAD_POINT_COLUMNS);
  return cli_usage_error(cli, command, "'%s' is not a quantity; %s%s%s", text,
                         nearest != NULL ? "did you mean '" : "see 'dea compare --help'",
                         nearest != NULL ? nearest : "", nearest != NULL ? "'?" : "");
}

/* "5%" or "0.05". */
static int take_tolerance(struct dea_cli *cli, const struct dea_command *command,
                          const struct cli_option *option, const char *text, void *target)
{
  double *tolerance = target;
  (void)option;
  return cli_read_share(text, tolerance) && *tolerance >= 0.0
             ? 0
             : cli_usage_error(cli, command, "'%s' is not a tolerance such as 5%%", text);
}

/* "lumped" or "lumped:axisymmetric". */
static int take_models(struct dea_cli *cli, const struct dea_command *command,
                       const struct cli_option *option, const char *text, void *target)
{
  struct compare_models *models = target;
  size_t n = strcspn(text, ":");
  const char *second = text[n] == ':' ? text + n + 1 : text;
  size_t m = strcspn(second, ":");
  (void)option;
  if (models->count == DEA_DESIGN_MODELS_MAX || n == 0 || m == 0 || n >= DEA_NAME_SIZE ||
      m >= DEA_NAME_SIZE || second[m] != '\0') {
    return cli_usage_error(cli, command, "'%s' names no model", text);
  }
  memcpy(models->at[models->count][0], text, n);
  memcpy(models->at[models->count++][1], second, m);
  return 0;
}

// Sides ------------------------------------------------------------------------------------------

static dea_status side_read(struct dea_context *ctx, struct side *side)
{
  if (cli_compare_is_run(side->name)) {
    return dea_run_read(ctx, side->name, &side->run);
  }
  return dea_measurement_read(ctx, side->name, &side->measurement);
}

static void side_free(struct dea_context *ctx, struct side *side)
{
  dea_run_destroy(ctx, side->run);
  dea_measurement_destroy(ctx, side->measurement);
}

/* Curve of a model, or of the only one there is when model is ""; NULL if there is none. */
static const struct dea_curve *side_curve(const struct side *side, const char *model)
{
  if (side->measurement != NULL) {
    return &side->measurement->curve;
  }
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(side->run->result, models, DEA_DESIGN_MODELS_MAX);
  const char *wanted = model[0] != '\0' ? model : count > 0 ? models[0] : "";
  return dea_figure_curve(side->run->result, wanted, false);
}

static void pair_set(const struct request *request, const struct dea_curve *a,
                     const struct dea_curve *b, struct pair *pair)
{
  const struct side *sides = request->side;
  *pair = (struct pair){.a = a, .b = b};
  pair->b_std = sides[1].measurement != NULL ? sides[1].measurement->std : NULL;
  const struct dea_curve *const curves[2] = {a, b};
  char *const names[2] = {pair->compared.a, pair->compared.b};
  for (int k = 0; k < 2; k++) {
    const char *slash = strrchr(sides[k].name, '/');
    const char *name = slash != NULL && slash[1] != '\0' ? slash + 1 : sides[k].name;
    bool measured = sides[k].measurement != NULL;
    snprintf(names[k], DEA_LABEL_SIZE, "%.60s%s%.60s", name, measured ? "" : ", ",
             measured ? "" : curves[k]->model);
  }
}

static dea_status no_curve(struct dea_context *ctx, const struct side *side, const char *model)
{
  struct dea_text all = {.ctx = ctx};
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = dea_result_models(side->run->result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; m < count; m++) {
    dea_text_add(&all, "%s%s", m > 0 ? ", " : "", models[m]);
  }
  dea_status status = model[0] != '\0'
                          ? dea_fail(ctx, DEA_E_ARGUMENT, "%s has no model '%s' (it has: %s)",
                                     side->name, model, count > 0 ? dea_text_get(&all) : "none")
                          : dea_fail(ctx, DEA_E_ARGUMENT, "%s has no points", side->name);
  dea_text_free(&all);
  return status;
}

/* The curves to be compared: those of the same model; a chosen pair with --model; the only ones. */
static dea_status find_pairs(struct dea_context *ctx, const struct request *request,
                             struct pair *pairs, size_t *count)
{
  const struct side *a = &request->side[0], *b = &request->side[1];
  *count = 0;
  if (request->model[0][0] == '\0' && a->run != NULL && b->run != NULL) {
    const char *models[DEA_DESIGN_MODELS_MAX];
    size_t n = dea_result_models(a->run->result, models, DEA_DESIGN_MODELS_MAX);
    for (size_t m = 0; m < n; m++) {
      const struct dea_curve *x = side_curve(a, models[m]), *y = side_curve(b, models[m]);
      if (x != NULL && y != NULL) {
        pair_set(request, x, y, &pairs[(*count)++]);
      }
    }
    if (*count > 0) {
      return DEA_OK;
    }
  }
  const struct dea_curve *x = side_curve(a, request->model[0]);
  const struct dea_curve *y = side_curve(b, request->model[1]);
  if (x == NULL || y == NULL) {
    return no_curve(ctx, x == NULL ? a : b, request->model[x == NULL ? 0 : 1]);
  }
  pair_set(request, x, y, &pairs[(*count)++]);
  return DEA_OK;
}

// Comparison and output --------------------------------------------------------------------------

/* Says of which measured points the run has no counterpart: a good misfit of a few says little. */
static dea_status note_left_out(struct dea_context *ctx, const struct pair *pair)
{
  for (size_t i = 0; i < pair->comparison->misfit_count && pair->b_std != NULL; i++) {
    const struct dea_misfit *m = &pair->comparison->misfits[i];
    size_t measured = 0;
    for (size_t k = 0; k < pair->b->count; k++) {
      measured += isnan(dea_point_get(&pair->b->points[k], m->column)) ? 0U : 1U;
    }
    if (m->count < measured) {
      DEA_TRY(ctx,
              dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                              "%zu of %zu measured points of '%s' lie outside the voltages of "
                              "the run and are left out",
                              measured - m->count, measured, dea_point_columns[m->column].header));
    }
  }
  return DEA_OK;
}

/* Takes the misfits out that were not asked for; a quantity that is missing is an error. */
static dea_status compare_pair(struct dea_context *ctx, const struct request *request,
                               struct pair *pair)
{
  const int *only = request->line->columns.count == 1 ? &request->line->columns.at[0] : NULL;
  DEA_TRY(ctx, dea_compare_curves(ctx, pair->a, pair->b, pair->b_std, only != NULL ? *only : -1,
                                  &pair->comparison));
  pair->compared.comparison = pair->comparison;
  DEA_TRY(ctx, note_left_out(ctx, pair));
  if (request->line->columns.count < 2) {
    return DEA_OK;
  }
  size_t found = dea_comparison_keep(pair->comparison, request->line->columns.at,
                                     request->line->columns.count);
  return found < request->line->columns.count
             ? dea_fail(ctx, DEA_E_ARGUMENT, "the two have not all quantities asked for in common")
             : DEA_OK;
}

static void print_table(const struct pair *pair, double tolerance)
{
  printf("a: %s\nb: %s\n%-28s %6s %12s %12s %8s %12s %10s %10s\n", pair->compared.a,
         pair->compared.b, "a - b", "points", "RMS", "largest", "at kV", "bias", "RMS/range",
         "largest/range");
  for (size_t i = 0; i < pair->comparison->misfit_count; i++) {
    const struct dea_misfit *m = &pair->comparison->misfits[i];
    const struct dea_column *c = &dea_point_columns[m->column];
    char title[96];
    dea_column_title(c, title, sizeof title);
    printf("%-28s %6zu %12.5g %12.5g %8.4g %12.5g %8.3g %% %8.3g %%%s\n", title, m->count,
           c->factor * m->rms, c->factor * m->largest, 1e-3 * m->largest_at, c->factor * m->bias,
           100.0 * m->relative_rms, 100.0 * m->relative_largest, cli_compare_mark(m, tolerance));
  }
}

static dea_status print_json(struct dea_context *ctx, const struct pair *pairs, size_t count,
                             double tolerance)
{
  json_t *root = json_object(), *list = json_array();
  json_object_set_new(root, "schema", json_integer(1));
  if (!isnan(tolerance)) {
    dea_json_put(root, "tolerance", tolerance);
  }
  for (size_t i = 0; i < count; i++) {
    json_array_append_new(list, dea_compared_json(&pairs[i].compared, tolerance));
  }
  json_object_set_new(root, "comparisons", list);
  char *text;
  DEA_TRY(ctx, dea_json_text(ctx, root, &text));
  fputs(text, stdout);
  dea_free(ctx, text);
  return DEA_OK;
}

static dea_status draw(struct dea_context *ctx, const struct request *request,
                       const struct pair *pairs, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_compared_draw(ctx, &pairs[i].compared, count > 1 ? pairs[i].a->model : "",
                                   &request->line->format, request->line->output));
  }
  return DEA_OK;
}

static dea_status judge(struct dea_context *ctx, const struct pair *pairs, size_t count,
                        double tolerance)
{
  const struct dea_misfit *worst = NULL;
  for (size_t i = 0; i < count; i++) {
    for (size_t k = 0; k < pairs[i].comparison->misfit_count; k++) {
      const struct dea_misfit *m = &pairs[i].comparison->misfits[k];
      worst = worst == NULL || m->relative_largest > worst->relative_largest ? m : worst;
    }
  }
  return cli_compare_judge(ctx, worst, "", tolerance);
}

static dea_status compare(struct dea_cli *cli, struct request *request, struct pair *pairs,
                          size_t *count)
{
  struct dea_context *ctx = cli->ctx;
  DEA_TRY(ctx, side_read(ctx, &request->side[0]));
  DEA_TRY(ctx, side_read(ctx, &request->side[1]));
  DEA_TRY(ctx, find_pairs(ctx, request, pairs, count));
  for (size_t i = 0; i < *count; i++) {
    DEA_TRY(ctx, compare_pair(ctx, request, &pairs[i]));
    if (pairs[i].comparison->part_only) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_NOTE, (struct dea_location){"", 0, 0},
                                   "the voltages of %s and %s differ and go up and down: only the "
                                   "first part of one was compared",
                                   pairs[i].compared.a, pairs[i].compared.b));
    }
    if (!request->line->json) {
      print_table(&pairs[i], request->line->tolerance);
    }
  }
  if (request->line->json) {
    DEA_TRY(ctx, print_json(ctx, pairs, *count, request->line->tolerance));
  }
  if (request->line->output != NULL) {
    DEA_TRY(ctx, draw(ctx, request, pairs, *count));
  }
  return judge(ctx, pairs, *count, request->line->tolerance);
}

/* The two-sided comparison: pairs of curves, each with its difference. */
static int compare_two(struct dea_cli *cli, const struct compare_request *line)
{
  struct request request = {.side = {{.name = line->names.at[0]}, {.name = line->names.at[1]}},
                            .model = {"", ""},
                            .line = line};
  struct pair pairs[PAIRS_MAX];
  memset(pairs, 0, sizeof pairs);
  size_t count = 0;
  if (line->models.count > 0) {
    request.model[0] = line->models.at[0][0];
    request.model[1] = line->models.at[0][1];
  }
  int code = cli_report(cli, compare(cli, &request, pairs, &count));
  for (size_t i = 0; i < count; i++) {
    dea_comparison_destroy(cli->ctx, pairs[i].comparison);
  }
  side_free(cli->ctx, &request.side[0]);
  side_free(cli->ctx, &request.side[1]);
  return code;
}

static int run(struct dea_cli *cli, void *user)
{
  const struct compare_request *request = user;
  const char *const *names = request->names.at;
  bool two = request->names.count == 2 && request->models.count < 2 &&
             !dea_measured_is_folder(names[0]) && !dea_measured_is_folder(names[1]);
  return two ? compare_two(cli, request) : cli_report(cli, cli_compare_many(cli, request));
}

static const struct compare_request defaults = {.tolerance = NAN,
                                                .format = {.svg = true, .width_m = 0.085}};

#define AT(member) .target = offsetof(struct compare_request, member)

static const struct cli_option options[] = {
    {NULL, 0, CLI_FOLDER, "A... B",
     "A: folders of runs. B: folder of a run or of dea reduce, or a CSV table", AT(names),
     .least = 2, .most = COMPARE_NAMES_MAX,
     .too_few = "give two or more: runs, and a run or what was measured",
     .too_many = "at most 16 runs can be compared at a time"},
    {"tolerance", 0, CLI_TEXT, "SHARE", "largest difference allowed, such as 5%", AT(tolerance),
     take_tolerance},
    {"quantity", 0, CLI_QUANTITY, "KEY",
     "only this quantity, such as fibre_tip_z_m; can be repeated", AT(columns), take_quantity,
     .most = COMPARE_QUANTITIES_MAX},
    {"model", 0, CLI_MODEL, "MODEL",
     "only this model; can be repeated. lumped:axisymmetric takes one of A, the other of B. There "
     "are",
     AT(models), take_models, .most = DEA_DESIGN_MODELS_MAX},
    {"output", 'o', CLI_FOLDER, "DIR", "draw the figures into this folder", AT(output)},
    {"format", 0, CLI_FORMAT, "LIST", "formats with commas between, svg if not given", AT(format),
     cli_take_formats},
    {"width", 0, CLI_TEXT, "MM", "width, 85 for one column or 170 for two", AT(format),
     cli_take_width},
    {"json", 0, CLI_FLAG, NULL, "print the comparison as JSON", AT(json)},
    {0}};

const struct dea_command cmd_compare = {
    .name = "compare",
    .summary = "Compare runs with a run or with what was measured",
    .about =
        "A are folders of runs. B, with which they are compared, is a folder of a run, a CSV table "
        "with headers such as 'V (kV)', 'z centre (um)', 'z centre std (um)', or a folder written "
        "by dea reduce (measurement.csv, profiles.csv, history.csv). Two runs: curves of the same "
        "model are compared, each pair in a figure with its difference. More of them, several "
        "--model, or a reduced measurement: all curves in one figure a quantity, with a band of "
        "one standard deviation, then profiles across the film and histories in time. "
        "Differences are a - b, relative ones over the range of b. The exit code is 1 when a "
        "tolerance is given and the largest difference of a quantity against the voltage exceeds "
        "it.",
    .options = options,
    .request_size = sizeof(struct compare_request),
    .defaults = &defaults,
    .run = run,
};
