#include "cli/cli.h"

#include "base/file.h"
#include "base/write_file.h"
#include "compare/compare_set.h"
#include "figures/run_figures.h"
#include "io/results_h5.h"

#include <math.h>
#include <string.h>

enum { SIDES_MAX = 17 };

/* Models asked for: of the runs, of the reference. */
struct models {
  size_t count;
  char at[DEA_DESIGN_MODELS_MAX][2][DEA_NAME_SIZE];
};

struct request {
  struct cli_words names; // runs, and last what they are compared with
  struct models models;
  struct cli_words quantities;
  double tolerance;   // NAN for none
  const char *output; // folder; NULL for none
  struct dea_plot_format format;
  bool json;
};

/* What a name stands for: one of the two. */
struct side {
  struct dea_run *run;
  struct dea_measured *measured;
};

// Command line -----------------------------------------------------------------------------------

/* "5%" or "0.05". */
static dea_status parse_tolerance(struct dea_cli *cli, const struct cli_option *option,
                                  const char *text, void *target)
{
  double *tolerance = target;
  (void)option;
  return cli_read_share(text, tolerance) && *tolerance >= 0.0
             ? DEA_OK
             : cli_usage_error(cli, "'%s' is not a tolerance such as 5%%", text);
}

/* "lumped" or "lumped:axisymmetric". */
static dea_status parse_models(struct dea_cli *cli, const struct cli_option *option,
                               const char *text, void *target)
{
  struct models *models = target;
  size_t n = strcspn(text, ":");
  const char *second = text[n] == ':' ? text + n + 1 : text;
  size_t m = strcspn(second, ":");
  (void)option;
  if (models->count == DEA_DESIGN_MODELS_MAX || n == 0 || m == 0 || n >= DEA_NAME_SIZE ||
      m >= DEA_NAME_SIZE || second[m] != '\0') {
    return cli_usage_error(cli, "'%s' names no model", text);
  }
  memcpy(models->at[models->count][0], text, n);
  memcpy(models->at[models->count++][1], second, m);
  return DEA_OK;
}

/* Says of which quantities there are, or which of them is near. */
static dea_status no_quantity(struct dea_context *ctx, const char *text)
{
  char hint[DEA_HINT_SIZE];
  DEA_TRY(ctx, dea_column_hint(ctx, text, "; there are ", hint));
  return dea_fail(ctx, DEA_E_ARGUMENT, "'%.80s' is not a quantity%s", text, hint);
}

/* Columns of the quantities asked for [quantities.count]; which there are the runs say. */
static dea_status find_columns(struct dea_context *ctx, const struct request *request, int *out)
{
  for (size_t i = 0; i < request->quantities.count; i++) {
    out[i] = dea_column_find(ctx, request->quantities.at[i]);
    DEA_TRY(ctx, out[i] >= 0 ? DEA_OK : no_quantity(ctx, request->quantities.at[i]));
  }
  return DEA_OK;
}

// What is compared --------------------------------------------------------------------------------

/* True for a run: a folder, a store by its name or its first bytes. */
static bool is_run(const char *path)
{
  size_t n = strlen(path), length;
  char head[8];
  if ((n > 3 && strcmp(path + n - 3, ".h5") == 0) || dea_path_is_folder(path)) {
    return true;
  }
  return dea_file_head(path, head, sizeof head, &length) && dea_head_is_h5(head, length);
}

/* Two of which none is a reduced measurement, and at most one --model. */
static bool is_pair(const struct request *request)
{
  const char *const *names = request->names.at;
  return request->names.count == 2 && request->models.count < 2 &&
         !dea_measured_is_folder(names[0]) && !dea_measured_is_folder(names[1]);
}

static dea_status read_sides(struct dea_context *ctx, const struct request *request,
                             struct side *sides)
{
  bool run = false; // whose voltages are not below 0
  for (size_t i = 0; i < request->names.count; i++) {
    const char *name = request->names.at[i];
    if (dea_measured_is_folder(name) && i + 1 < request->names.count) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "%s is a measurement: name it last, and runs before it",
                      name);
    }
    if ((is_run(name) && !dea_measured_is_folder(name)) ||
        (i + 1 < request->names.count && !is_pair(request))) {
      DEA_TRY(ctx, dea_run_read(ctx, name, &sides[i].run));
      run = true;
    }
  }
  for (size_t i = 0; i < request->names.count; i++) { // whose columns are those of the runs
    DEA_TRY(ctx, sides[i].run != NULL
                     ? DEA_OK
                     : dea_measured_read(ctx, request->names.at[i], &sides[i].measured));
  }
  for (size_t i = 0; i < request->names.count && run; i++) {
    DEA_TRY(ctx, sides[i].measured == NULL ? DEA_OK : dea_measured_fold(ctx, sides[i].measured));
  }
  return DEA_OK;
}

/* Last part of a path, or all of it where another side ends the same. Into out[DEA_LABEL_SIZE]. */
static void side_name(const struct request *request, size_t side, char *out)
{
  const char *path = request->names.at[side], *own = dea_path_name(path);
  bool alone = own[0] != '\0';
  for (size_t i = 0; i < request->names.count; i++) {
    alone = alone && (i == side || strcmp(dea_path_name(request->names.at[i]), own) != 0);
  }
  snprintf(out, DEA_LABEL_SIZE, "%.60s", alone ? own : path);
}

/* Model of the reference that this model is to be compared with, "" where none is asked for; NULL:
 * others are. */
static const char *reference_model(const struct request *request, const char *model)
{
  for (size_t k = 0; k < request->models.count; k++) {
    if (strcmp(model, request->models.at[k][0]) == 0) {
      return request->models.at[k][1];
    }
  }
  return request->models.count > 0 ? NULL : "";
}

/* Models of a run that are to be compared; names lent. */
static size_t models_of(const struct request *request, const struct dea_run *run,
                        const char *models[DEA_DESIGN_MODELS_MAX])
{
  // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a side is a run or a table
  size_t count = dea_result_models(run->result, models, DEA_DESIGN_MODELS_MAX), kept = 0;
  for (size_t m = 0; m < count; m++) {
    if (reference_model(request, models[m]) != NULL) {
      models[kept++] = models[m];
    }
  }
  return kept;
}

/* Adds the models of one run; they are called by what tells them apart. */
static dea_status add_run(struct dea_context *ctx, const struct request *request,
                          const struct side *sides, size_t side, bool one_model,
                          struct dea_compare_set *set)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = models_of(request, sides[side].run, models);
  char run[DEA_LABEL_SIZE];
  side_name(request, side, run);
  if (count == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "%s has no model %s", request->names.at[side],
                    request->models.count > 0 ? "of those asked for" : "with points");
  }
  for (size_t m = 0; m < count; m++) {
    struct dea_set_curve curve = {.result = sides[side].run->result, .model = models[m]};
    if (request->names.count == 2) {
      snprintf(curve.name, sizeof curve.name, "%s", models[m]);
    } else {
      snprintf(curve.name, sizeof curve.name, "%.60s%s%.60s", run, one_model ? "" : ", ",
               one_model ? "" : models[m]);
    }
    DEA_TRY(ctx, dea_compare_set_add(ctx, set, &curve, reference_model(request, models[m])));
  }
  return DEA_OK;
}

/* A model of the first of two, or its table, beside the other. */
static dea_status add_pair(struct dea_context *ctx, const struct request *request,
                           const struct side *a, const char *model, const char *reference_model,
                           struct dea_compare_set *set)
{
  struct dea_set_curve curve = {.model = ""};
  char name[DEA_LABEL_SIZE];
  side_name(request, 0, name);
  if (a->measured != NULL) {
    curve.curve = &a->measured->points->curve;
    memcpy(curve.name, name, sizeof name);
  } else {
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): a side is a run or a table
    curve.result = a->run->result;
    curve.model = model;
    snprintf(curve.name, sizeof curve.name, "%.60s, %.60s", name, model);
  }
  return dea_compare_set_add(ctx, set, &curve, reference_model);
}

/* The models that both runs have; the one asked for with --model; else the first ones. */
static dea_status fill_pairs(struct dea_context *ctx, const struct request *request,
                             const struct side *sides, struct dea_compare_set *set)
{
  const struct side *a = &sides[0], *b = &sides[1];
  const char *models[DEA_DESIGN_MODELS_MAX];
  bool asked = request->models.count > 0;
  const char *model = asked ? request->models.at[0][0] : "";
  const char *beside = asked ? request->models.at[0][1] : "";
  size_t count =
      a->run == NULL ? 0 : dea_result_models(a->run->result, models, DEA_DESIGN_MODELS_MAX);
  for (size_t m = 0; !asked && b->run != NULL && m < count; m++) {
    if (dea_figure_curve(a->run->result, models[m], false) != NULL &&
        dea_figure_curve(b->run->result, models[m], false) != NULL) {
      DEA_TRY(ctx, add_pair(ctx, request, a, models[m], models[m], set));
    }
  }
  if (set->curve_count > 0) {
    return DEA_OK;
  }
  const char *first = asked || count == 0 ? model : models[0];
  if (a->run != NULL && dea_figure_curve(a->run->result, first, false) == NULL) {
    return dea_compare_no_model(ctx, request->names.at[0], a->run->result, model);
  }
  return add_pair(ctx, request, a, first, beside, set);
}

static dea_status fill_set(struct dea_context *ctx, const struct request *request,
                           const struct side *sides, struct dea_compare_set *set)
{
  size_t runs = request->names.count - 1;
  bool one_model = true;
  for (size_t i = 0; i < runs; i++) {
    const char *models[DEA_DESIGN_MODELS_MAX];
    one_model = one_model && models_of(request, sides[i].run, models) == 1;
  }
  for (size_t i = 0; i < runs; i++) {
    DEA_TRY(ctx, add_run(ctx, request, sides, i, one_model, set));
  }
  return DEA_OK;
}

// What is printed ---------------------------------------------------------------------------------

/* What a table of misfits is of: a pair, a quantity, a profile, or a column of a history. */
static size_t group_of(const struct dea_compare_set *set, const struct dea_set_misfit *m)
{
  return m->kind != DEA_SET_VOLTAGE ? m->measured
         : set->pairs               ? m->curve
                                    : (size_t)m->misfit.column;
}

static void print_group_head(const struct dea_compare_set *set, const struct dea_set_misfit *m,
                             bool std)
{
  static const char *const places[] = {"at kV", "at mm", "at s"};
  char title[DEA_COLUMN_TITLE_SIZE], text[DEA_COLUMN_TITLE_SIZE + 16], beside[DEA_LABEL_SIZE];
  dea_column_title(m->misfit.quantity, title, sizeof title);
  snprintf(text, sizeof text, "%s%s", title, m->kind == DEA_SET_HISTORY ? " in time" : "");
  if (m->kind == DEA_SET_PROFILE) {
    snprintf(text, sizeof text, "z over film at %.4g kV (um)",
             1e-3 * set->measured->profiles[m->measured].voltage_V);
  } else if (m->kind == DEA_SET_VOLTAGE && set->pairs) {
    dea_compare_set_beside(set, m->curve, beside);
    printf("a: %s\nb: %s", set->curves[m->curve].name, beside);
    snprintf(text, sizeof text, "a - b");
  }
  printf("\n%-28s %6s %11s %11s %8s %11s %10s %13s", text, "points", "RMS", "largest",
         places[m->kind], "bias", "RMS/range", "largest/range");
  printf(std ? " %11s %8s %8s\n" : "\n", "chi2/point", "in 1 std", "in 2 std");
}

static void print_group_row(const struct dea_compare_set *set, const struct dea_set_misfit *of,
                            double tolerance)
{
  static const double factors[] = {1e-3, 1e3, 1}; // of the place
  const struct dea_misfit *m = &of->misfit;
  const double factor = m->quantity->factor;
  char name[DEA_COLUMN_TITLE_SIZE + DEA_LABEL_SIZE];
  if (of->kind == DEA_SET_VOLTAGE && set->pairs) {
    dea_column_title(m->quantity, name, sizeof name);
  } else {
    snprintf(name, sizeof name, "%s%s%s", set->curves[of->curve].name,
             of->line.directed ? ", " : "", of->line.directed ? dea_half_names[of->half] : "");
  }
  printf("  %-26s %6zu %11.5g %11.5g %8.4g %11.5g %8.3g %% %11.3g %%", name, m->count,
         factor * m->rms, factor * m->largest, factors[of->kind] * m->largest_at, factor * m->bias,
         100.0 * m->relative_rms, 100.0 * m->relative_largest);
  if (m->std_count > 0) {
    printf(" %11.4g %6.0f %% %6.0f %%", m->chi_square, 100.0 * m->within_1_std,
           100.0 * m->within_2_std);
  }
  printf("%s\n",
         !isnan(tolerance) && !(m->relative_largest <= tolerance) ? "  out of tolerance" : "");
}

/* The tables of a kind; true when some misfit has uncertainties. */
static bool print_kind(const struct dea_compare_set *set, enum dea_set_kind kind, double tolerance)
{
  size_t groups = 0;
  bool any = false;
  for (size_t i = 0; i < set->misfit_count; i++) {
    const size_t group = group_of(set, &set->misfits[i]);
    groups = set->misfits[i].kind == kind && group >= groups ? group + 1 : groups;
  }
  for (size_t group = 0; group < groups; group++) {
    const struct dea_set_misfit *first = NULL;
    bool std = false;
    for (int pass = 0; pass < 2; pass++) { // the first one says what the table is of
      for (size_t i = 0; i < set->misfit_count; i++) {
        const struct dea_set_misfit *m = &set->misfits[i];
        if (m->kind != kind || group_of(set, m) != group) {
          continue;
        }
        first = first != NULL ? first : m;
        std = std || m->misfit.std_count > 0;
        if (pass == 1) {
          print_group_row(set, m, tolerance);
        }
      }
      if (pass == 0 && first != NULL) {
        print_group_head(set, first, std);
      }
    }
    any = any || std;
  }
  return any;
}

/* Whether some model has a band of its own. */
static bool has_model_std(const struct dea_compare_set *set)
{
  for (size_t i = 0; i < set->misfit_count; i++) {
    if (!isnan(dea_misfit_a_std_rms(&set->misfits[i].misfit))) {
      return true;
    }
  }
  return false;
}

static void print_tables(const struct dea_compare_set *set, double tolerance)
{
  if (!set->pairs) {
    printf("Each curve minus %s%s\n", set->reference,
           set->measured != NULL ? ", as measured" : " (a run)");
  }
  bool std = print_kind(set, DEA_SET_VOLTAGE, tolerance);
  std = print_kind(set, DEA_SET_PROFILE, NAN) || std;
  print_kind(set, DEA_SET_HISTORY, NAN);
  if (std) {
    printf(
        "\nchi2/point is the mean of (difference/std)^2: 1 where differences are of the size of "
        "the scatter.\nOf a normal scatter 68 %% lie within 1 std and 95 %% within 2. The std is "
        "what the measurement\nsays of its scatter; errors of its calibration and of the model "
        "are not in it.\n");
    printf("%s", has_model_std(set)
                     ? "Where the model has a band, by the uncertainties of its design and "
                       "material, the std is that of both\n(the root of the sum of squares). The "
                       "band moves all points of a curve together.\n"
                     : "");
  }
}

static dea_status judge(struct dea_context *ctx, const struct dea_compare_set *set,
                        double tolerance)
{
  const struct dea_set_misfit *worst = dea_compare_set_worst(set);
  if (isnan(tolerance) || (worst != NULL && worst->misfit.relative_largest <= tolerance)) {
    return DEA_OK;
  }
  return worst == NULL
             ? dea_fail(ctx, DEA_E_DIFFERS,
                        "no quantity against the voltage is in common, so none is within the "
                        "tolerance")
             : dea_fail(ctx, DEA_E_DIFFERS,
                        "%s of %s differs by %.3g %% of its range, more than %.3g %%",
                        worst->misfit.quantity->key, set->curves[worst->curve].name,
                        100.0 * worst->misfit.relative_largest, 100.0 * tolerance);
}

static dea_status compare(struct dea_context *ctx, const struct request *request,
                          const struct side *sides, struct dea_compare_set *set)
{
  DEA_TRY(ctx,
          set->pairs ? fill_pairs(ctx, request, sides, set) : fill_set(ctx, request, sides, set));
  int columns[CLI_WORDS_MAX];
  DEA_TRY(ctx, find_columns(ctx, request, columns));
  DEA_TRY(ctx, dea_compare_set_compute(ctx, set, columns, request->quantities.count));
  if (request->json) {
    char *text;
    DEA_TRY(ctx, dea_json_text(ctx, dea_compare_set_json(set, request->tolerance), &text));
    fputs(text, stdout);
    dea_free(ctx, text);
  } else {
    print_tables(set, request->tolerance);
  }
  if (request->output != NULL) {
    DEA_TRY(ctx, dea_compare_set_draw(ctx, set, &request->format, request->output));
  }
  return judge(ctx, set, request->tolerance);
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_context *ctx = cli->ctx;
  struct side sides[SIDES_MAX] = {{0}};
  struct dea_compare_set set = {.pairs = is_pair(request), .memory = {.ctx = ctx}};
  size_t last = request->names.count - 1;
  side_name(request, last, set.reference);
  dea_status status = read_sides(ctx, request, sides);
  if (status == DEA_OK) {
    set.measured = sides[last].measured;
    set.reference_result = sides[last].run != NULL ? sides[last].run->result : NULL;
    status = compare(ctx, request, sides, &set);
  }
  dea_arena_free(&set.memory);
  for (size_t i = 0; i <= last; i++) {
    dea_run_destroy(ctx, sides[i].run);
    dea_measured_destroy(ctx, sides[i].measured);
  }
  return status;
}

static const struct request defaults = {.tolerance = NAN,
                                        .format = {.svg = true, .width_m = 0.085}};

static const struct cli_option options[] = {
    {NULL, 0, CLI_FOLDER, "A... B",
     "A: folders of runs. B: folder of a run or of dea reduce, or a CSV table", CLI_AT(names),
     .least = 2, .most = SIDES_MAX,
     .too_few = "give two or more: runs, and a run or what was measured",
     .too_many = "at most 16 runs can be compared at a time"},
    {"tolerance", 0, CLI_TEXT, "SHARE", "largest difference allowed, such as 5%", CLI_AT(tolerance),
     parse_tolerance},
    {"quantity", 0, CLI_QUANTITY, "KEY",
     "only this quantity, such as fibre_tip_z_m, or hub_z_m of a monitor; can be repeated",
     CLI_AT(quantities), .most = CLI_WORDS_MAX, .too_many = "too many quantities"},
    {"model", 0, CLI_MODEL, "MODEL",
     "only this model; can be repeated. lumped:axisymmetric takes one of A, the other of B. There "
     "are",
     CLI_AT(models), parse_models, .most = DEA_DESIGN_MODELS_MAX},
    CLI_OUTPUT_ROW(CLI_FOLDER, "DIR", "draw the figures into this folder"),
    CLI_FORMAT_ROW("formats with commas between, svg if not given"),
    CLI_WIDTH_ROW("width, 85 for one column or 170 for two"),
    CLI_JSON_ROW("print the comparison as JSON"),
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
    .defaults = &defaults,
    CLI_RUN};
