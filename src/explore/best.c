#include "explore/best.h"

#include "base/file.h"
#include "base/version.h"
#include "base/write_file.h"
#include "explore/explore_sweep.h"
#include "explore/plan.h"
#include "result/columns.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct work {
  struct dea_context *ctx;
  const struct dea_design_space *space;
  const struct dea_optimise_options *options;
  struct dea_optimise_report *report;
  struct dea_store *store;
  struct dea_evaluator evaluator;
  struct dea_search search;
  struct dea_limit sides[2 * DEA_EXPLORE_LIMITS_MAX]; // of limits, each with one only
  struct dea_arena memory;
  double *scatter; // [scattered][params]; NULL: none
};

// What is sought ----------------------------------------------------------------------------------

static double sign_of(const struct dea_design_space *space, size_t k)
{
  return space->file->objectives[k].goal.value == DEA_MOST ? -1 : 1;
}

static double objective(const void *user, size_t k, const double *q)
{
  const struct dea_design_space *space = ((const struct work *)user)->space;
  const size_t last = (space->voltage_count - 1) * space->quantity_count;
  return sign_of(space, k) * q[last + (size_t)space->objectives[k]];
}

static double margin(const void *user, size_t side, const double *q)
{
  const struct work *w = user;
  return dea_limit_margin(w->space, &w->sides[side], q);
}

/* Shifts of scattered designs, the first of them none. */
static dea_status build_scatter(struct work *w)
{
  const struct dea_design_space *space = w->space;
  const size_t n = space->variable_count;
  size_t scattering = 0;
  for (size_t j = 0; j < n; j++) {
    scattering += space->variables[j].scatter > 0 ? 1U : 0U;
  }
  w->report->scattered = scattering > 0 ? (size_t)space->file->robust.samples.si : 1;
  if (scattering == 0) {
    return DEA_OK;
  }
  const size_t count = w->report->scattered;
  w->scatter = dea_arena_alloc(&w->memory, count * n, sizeof *w->scatter);
  double *few = dea_arena_alloc(&w->memory, count * scattering, sizeof *few);
  double *u = dea_arena_alloc(&w->memory, count * n, sizeof *u);
  DEA_TRY_MEMORY(!w->memory.failed);
  dea_sample_sobol(scattering, count - 1, (unsigned long long)space->file->seed.si, few);
  for (size_t i = 0, d = 0; i < (count - 1) * n; i++) { // what does not scatter: in its middle
    u[i] = space->variables[i % n].scatter > 0 ? few[d++] : 0.5;
  }
  dea_sample_correlate(space->file, count - 1, u);
  for (size_t i = n; i < count * n; i++) {
    const struct dea_variable *variable = &space->variables[i % n];
    const bool normal = variable->text->distribution.value == DEA_NORMAL;
    const double at = u[i - n];
    w->scatter[i] = variable->scatter * (normal ? dea_normal_quantile(at) : 2 * at - 1);
  }
  return DEA_OK;
}

/* Where a search begins: of what is counted off, at the value nearest to the start. */
static double begin_of(const struct dea_variable *variable)
{
  const double start = variable->param.param.start;
  double out = variable->value_count > 0 ? variable->values[0] : start;
  for (size_t i = 1; i < variable->value_count; i++) {
    out = fabs(variable->values[i] - start) < fabs(out - start) ? variable->values[i] : out;
  }
  return out;
}

static void fill_search(struct work *w)
{
  const struct dea_design_space *space = w->space;
  const struct dea_explore_file *file = space->file;
  const struct dea_explore_robust *robust = &file->robust;
  struct dea_search *search = &w->search;
  *search = (struct dea_search){
      .ctx = w->ctx,
      .evaluator = &w->evaluator,
      .store = w->store,
      .processes = w->options->processes,
      .objective = objective,
      .margin = margin,
      .user = w,
      .objective_count = file->objective_count,
      .method = (enum dea_method)file->method.value,
      .starts = (size_t)file->starts.si,
      .evaluations = (size_t)file->evaluations.si,
      .front = (size_t)file->front.si,
      .tolerance = file->tolerance.si,
      .scatter = w->scatter,
      .scatter_count = w->report->scattered,
      .quantile = robust->quantile.origin != DEA_ABSENT ? robust->quantile.si : NAN,
      .spread = robust->spread.si,
      .replaced = w->report->replaced};
  for (size_t l = 0; l < space->limit_count; l++) {
    const struct dea_limit *limit = &space->limits[l];
    if (!isnan(limit->above)) {
      w->sides[search->limit_count++] = (struct dea_limit){limit->column, limit->above, NAN};
    }
    if (!isnan(limit->below)) {
      w->sides[search->limit_count++] = (struct dea_limit){limit->column, NAN, limit->below};
    }
  }
  for (size_t j = 0; j < space->variable_count; j++) {
    const struct dea_variable *variable = &space->variables[j];
    search->start[j] = begin_of(variable);
    search->low[j] = variable->low;
    search->high[j] = variable->high;
    search->values[j] = variable->values;
    search->value_count[j] = variable->value_count;
  }
}

/* Whether a start that the file says is none of the values that a variable can take. */
static bool is_start_excluded(const struct dea_variable *variable)
{
  const double start = variable->param.param.start;
  return variable->text->text.start.text[0] != '\0' &&
         !(fabs(begin_of(variable) - start) <= 1e-9 * fabs(start));
}

/* Says limits of one quantity that exclude each other; each by itself is checked as it is read. */
static dea_status check_limits(const struct work *w)
{
  const struct dea_design_space *space = w->space;
  for (size_t l = 0; l < space->limit_count; l++) {
    for (size_t k = 0; k < space->limit_count; k++) {
      const struct dea_limit *low = &space->limits[l], *high = &space->limits[k];
      if (k != l && low->column == high->column && low->above >= high->below) {
        const struct dea_explore_limit *text = space->file->limits;
        DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, text[k > l ? k : l].quantity.location,
                                        "%s cannot be above %s and below %s",
                                        space->quantities[low->column].key, text[l].above.text,
                                        text[k].below.text));
      }
    }
  }
  return DEA_OK;
}

static dea_status check(const struct work *w)
{
  const struct dea_design_space *space = w->space;
  const size_t errors = dea_finding_count(w->ctx, DEA_ERROR);
  const struct dea_location file = {space->file->head.file, 1, 1};
  double combinations = 1;
  if (space->file->objective_count == 0) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, file, "objectives: say what is wanted"));
  }
  for (size_t j = 0; j < space->variable_count; j++) {
    const struct dea_variable *variable = &space->variables[j];
    const struct dea_label *name = &variable->text->text.name;
    combinations *= variable->value_count > 0 ? (double)variable->value_count : 1;
    if (variable->text->distribution.value == DEA_LOGNORMAL ||
        (variable->text->distribution.value != DEA_UNIFORM && variable->scatter == 0)) {
      DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, name->location,
                                      "%s: a search needs low and high, or values", name->text));
    } else if (variable->value_count == 0 && !(variable->high > variable->low)) {
      DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, name->location,
                                      "%s: its bounds leave nothing to search", name->text));
    } else if (is_start_excluded(variable)) {
      DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, variable->text->text.start.location,
                                      "%s starts at %s, which is none of its values", name->text,
                                      variable->text->text.start.text));
    }
  }
  DEA_TRY(w->ctx, check_limits(w));
  if (combinations > 10000) {
    DEA_TRY(w->ctx, dea_finding_add(w->ctx, DEA_ERROR, file,
                                    "%.3g combinations of values and whole numbers are too many",
                                    combinations));
  }
  return dea_finding_count(w->ctx, DEA_ERROR) == errors
             ? DEA_OK
             : dea_fail(w->ctx, DEA_E_DESIGN, "'%s' cannot be optimised", space->file->head.file);
}

// Files -------------------------------------------------------------------------------------------

/* All evaluations in their order, as a plan. */
static dea_status write_cases(struct work *w)
{
  const size_t count = dea_store_count(w->store);
  struct dea_plan plan = {.cases = dea_arena_alloc(&w->memory, count, sizeof(struct dea_case *)),
                          .count = count,
                          .samples = count};
  DEA_TRY_MEMORY(plan.cases != NULL);
  for (size_t i = 0; i < count; i++) {
    plan.cases[i] = dea_store_get(w->store, i);
  }
  return dea_sweep_write(w->space, &plan, &w->options->format, w->options->folder);
}

/* A variable this near to a bound, as a share of its range, is at it. */
static const double bound_share = 1e-4;

static const char written_by[] = "# Written by dea ";
static const char front_table[] = "front.csv", front_figure[] = "front";
enum { BEST_SIZE = 40 };

/* number: in the front, 0 where there is one only. */
static void name_best(size_t number, char name[BEST_SIZE])
{
  if (number > 0) {
    snprintf(name, BEST_SIZE, "best-%zu.yaml", number);
  } else {
    snprintf(name, BEST_SIZE, "best.yaml");
  }
}

const char *dea_optimum_bound(const struct dea_design_space *space, const struct dea_optimum *best,
                              size_t variable)
{
  const struct dea_variable *of = &space->variables[variable];
  const double near = bound_share * (of->high - of->low);
  return of->value_count > 0                    ? NULL
         : best->p[variable] <= of->low + near  ? "lower"
         : best->p[variable] >= of->high - near ? "upper"
                                                : NULL;
}

/* The design of an optimum, of that number. */
static dea_status write_design(const struct work *w, const struct dea_optimum *best, size_t number)
{
  const struct dea_design_space *space = w->space;
  struct dea_text text = {.ctx = w->ctx};
  char name[BEST_SIZE], label[DEA_NAME_SIZE];
  name_best(number, name);
  snprintf(label, sizeof label, "%.50s", space->file->head.name.text);
  const struct dea_device_values with = {
      space->params, best->p, space->variable_count, 10, label, space->file->head.title.text, ""};
  dea_text_add(&text, "%s%s optimise: the best of %s for %s.\n", written_by, DEA_VERSION,
               dea_path_name(space->path), dea_path_name(space->file->head.file));
  for (size_t k = 0; k < space->file->objective_count; k++) {
    const struct dea_column *column = &space->quantities[space->objectives[k]].shown;
    dea_text_add(&text, "#   %s = %.8g %s at %.6g V, model %s\n", column->key,
                 sign_of(space, k) * best->f[k], column->si_unit,
                 space->voltages_V[space->voltage_count - 1], space->model.type->name);
  }
  for (size_t j = 0; j < space->variable_count; j++) {
    const char *bound = dea_optimum_bound(space, best, j);
    if (bound != NULL) {
      dea_text_add(&text, "#   %s is at its %s bound\n", space->params[j].param.name, bound);
    }
  }
  for (unsigned f = 0; f < DEA_FLAG_COUNT; f++) {
    char line[DEA_FLAG_LINE_SIZE];
    if ((best->marks >> f & 1U) != 0) {
      dea_text_add(&text, "#   %s\n", dea_flag_line((enum dea_flag)f, line));
    }
  }
  dea_status status =
      dea_device_design_text(w->ctx, &space->model.file, space->device, &with, &text);
  status = status == DEA_OK ? dea_text_write(w->ctx, &text, w->options->folder, name) : status;
  dea_text_free(&text);
  return status;
}

static dea_status write_front(const struct work *w)
{
  const struct dea_design_space *space = w->space;
  struct dea_text out = {.ctx = w->ctx};
  dea_text_add(&out, "design");
  for (size_t j = 0; j < space->variable_count; j++) {
    dea_text_add(&out, ",%s (%s)", space->params[j].param.name, space->params[j].param.unit);
  }
  for (size_t k = 0; k < 2; k++) {
    const struct dea_column *column = &space->quantities[space->objectives[k]].shown;
    dea_text_add(&out, ",%s (%s)", column->key, column->si_unit);
  }
  dea_text_add(&out, ",flags\n");
  for (size_t i = 0; i < w->report->count; i++) {
    const struct dea_optimum *best = &w->report->optima[i];
    dea_text_add(&out, "best-%zu.yaml", i + 1);
    for (size_t j = 0; j < space->variable_count; j++) {
      dea_text_add(&out, ",%.12g", best->p[j]);
    }
    for (size_t k = 0; k < 2; k++) {
      dea_text_add(&out, ",%.12g", sign_of(space, k) * best->f[k]);
    }
    char words[DEA_FLAGS_SIZE];
    dea_text_add(&out, ",%s\n", dea_flags_text(best->marks, words));
  }
  return dea_text_write(w->ctx, &out, w->options->folder, front_table);
}

// Figures -----------------------------------------------------------------------------------------

/* Whether limits hold, of what dea_search_compute says. */
static bool is_within(const struct dea_search *search, const double *looked)
{
  for (size_t l = 0; l < search->limit_count; l++) {
    if (!(looked[search->objective_count + l] <= 1e-6)) {
      return false;
    }
  }
  return true;
}

/* Where designs lie: x and y of each case, in series of those within and beyond the limits. of_x:
 * an objective, or -1: the number of the evaluation, and the best so far as a line. */
static dea_status fill_plot(struct work *w, struct dea_panel *panel, int of_x, int of_y)
{
  const struct dea_design_space *space = w->space;
  const size_t count = dea_store_count(w->store);
  const struct dea_column *y = &space->quantities[space->objectives[of_y]].shown;
  struct dea_series *beyond, *within, *line;
  const size_t points = of_x < 0 ? count : w->report->count;
  double best = INFINITY;
  DEA_TRY(w->ctx,
          dea_panel_add(w->ctx, panel, count, DEA_MARKERS, DEA_GREY, "beyond a limit", &beyond));
  DEA_TRY(w->ctx,
          dea_panel_add(w->ctx, panel, count, DEA_MARKERS, DEA_SKY, "within the limits", &within));
  DEA_TRY(w->ctx, dea_panel_add(w->ctx, panel, points, of_x < 0 ? DEA_LINE : DEA_LINE_MARKED,
                                DEA_VERMILLION, of_x < 0 ? "best so far" : "front", &line));
  dea_figure_label(y, panel->y_label, sizeof panel->y_label);
  snprintf(panel->x_label, sizeof panel->x_label, "Evaluations");
  const struct dea_column *x = of_x < 0 ? NULL : &space->quantities[space->objectives[of_x]].shown;
  if (x != NULL) {
    dea_figure_label(x, panel->x_label, sizeof panel->x_label);
  }
  for (size_t i = 0; i < count; i++) {
    double looked[DEA_SEARCH_VALUES_MAX];
    const bool is_there = dea_search_compute(&w->search, dea_store_get(w->store, i)->p, looked);
    const bool good = is_there && is_within(&w->search, looked);
    struct dea_series *to = good ? within : beyond;
    const double f = is_there ? looked[of_y] : NAN; // a scattered one of another stands for none
    to->values[i] = x == NULL  ? (double)(i + 1)
                    : is_there ? x->factor * sign_of(space, (size_t)of_x) * looked[of_x]
                               : NAN;
    to->values[count + i] = y->factor * sign_of(space, (size_t)of_y) * f;
    best = good && f < best ? f : best;
    if (x == NULL && isfinite(best)) {
      line->values[i] = (double)(i + 1);
      line->values[count + i] = y->factor * sign_of(space, (size_t)of_y) * best;
    }
  }
  for (size_t i = 0; i < points && x != NULL; i++) {
    const struct dea_optimum *at = &w->report->optima[i];
    line->values[i] = x->factor * sign_of(space, (size_t)of_x) * at->f[of_x];
    line->values[points + i] = y->factor * sign_of(space, (size_t)of_y) * at->f[of_y];
  }
  dea_panel_limit(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

static dea_status draw(struct work *w, struct dea_plot_folder *folder, const char *name,
                       const char *caption, int of_x, int of_y)
{
  struct dea_plot *plot;
  DEA_TRY(w->ctx, dea_plot_create(w->ctx, name, caption, &plot));
  return dea_plot_folder_add(folder, plot, fill_plot(w, &plot->panels[0], of_x, of_y));
}

/* Whether any design has all values. */
static bool has_values(const struct work *w)
{
  return w->report->failed < dea_store_count(w->store);
}

static dea_status draw_all(struct work *w)
{
  struct dea_plot_folder folder = {
      .ctx = w->ctx, .format = &w->options->format, .path = w->options->folder};
  if (!has_values(w)) {
    return DEA_OK;
  }
  dea_status status =
      draw(w, &folder, "progress", "designs in the order of their evaluation", -1, 0);
  if (status == DEA_OK && w->space->file->objective_count > 1) {
    status =
        draw(w, &folder, front_figure, "all designs, and the front of the two objectives", 0, 1);
  }
  return dea_plot_folder_draw(&folder, status);
}

// Why there is none -------------------------------------------------------------------------------

static const char digits[] = "0123456789.";

/* Whether two reasons are the same but for their numbers, as far as they were kept. */
static bool is_alike(const char *a, const char *b)
{
  const bool cut = strlen(a) == DEA_CASE_WHY_SIZE - 1 || strlen(b) == DEA_CASE_WHY_SIZE - 1;
  while (*a != '\0' && *b != '\0') {
    const size_t of_a = strspn(a, digits), of_b = strspn(b, digits);
    if ((of_a > 0) != (of_b > 0) || (of_a == 0 && *a != *b)) {
      return false;
    }
    a += of_a > 0 ? of_a : 1;
    b += of_b > 0 ? of_b : 1;
  }
  return *a == *b || cut;
}

/* Reasons of designs without all values by count, in the order in which they came. */
static dea_status add_reasons(const struct work *w)
{
  enum { MOST = 5 };
  const char *why[MOST];
  size_t counts[MOST + 1] = {0}, kinds = 0; // the last one: of others
  for (size_t i = 0; i < dea_store_count(w->store); i++) {
    const char *now = dea_store_get(w->store, i)->why;
    size_t k = 0;
    while (k < kinds && !is_alike(why[k], now)) {
      k++;
    }
    if (k == kinds && kinds < MOST) {
      why[kinds++] = now;
    }
    counts[k]++;
  }
  for (size_t k = 0; k < kinds; k++) {
    DEA_TRY(w->ctx,
            dea_finding_add(w->ctx, DEA_NOTE, (struct dea_location){0}, "%zu of %zu designs: %s",
                            counts[k], dea_store_count(w->store), why[k]));
  }
  return counts[MOST] == 0 ? DEA_OK
                           : dea_finding_add(w->ctx, DEA_NOTE, (struct dea_location){0},
                                             "%zu of %zu designs: other reasons", counts[MOST],
                                             dea_store_count(w->store));
}

static dea_status fail_without(const struct work *w)
{
  if (has_values(w)) {
    return dea_fail(w->ctx, DEA_E_NO_EQUILIBRIUM,
                    "none of the %zu designs that were tried is within all limits",
                    w->report->evaluations);
  }
  DEA_TRY(w->ctx, add_reasons(w));
  return dea_fail(w->ctx, DEA_E_NO_EQUILIBRIUM,
                  "none of the %zu designs that were tried could be computed",
                  w->report->evaluations);
}

// All of it ---------------------------------------------------------------------------------------

/* Takes away a file of that name in the folder if it begins as an earlier search has written it;
 * false: it does not. */
static bool forget(const struct work *w, const char *name, const char *begin)
{
  char path[DEA_PATH_SIZE], head[32] = "";
  size_t length;
  const bool written = dea_path_build(w->ctx, w->options->folder, name, path) == DEA_OK &&
                       dea_file_head(path, head, strlen(begin), &length) &&
                       strncmp(head, begin, strlen(begin)) == 0;
  if (written) {
    dea_path_forget(w->ctx, w->options->folder, name);
  }
  return written;
}

/* Takes away designs of an earlier search in the folder that had more of them, or of the other
 * kind. ended: to its end, so that what is not found is none. */
static dea_status remove_older(const struct work *w, bool ended)
{
  const bool front = w->space->file->objective_count > 1;
  char name[BEST_SIZE];
  for (size_t i = front ? w->report->count + 1 : 1; i <= DEA_EXPLORE_FRONT_MAX + 1; i++) {
    name_best(i, name);
    forget(w, name, written_by);
  }
  if (front || (ended && w->report->count == 0)) {
    name_best(0, name);
    forget(w, name, written_by);
  }
  return front || !forget(w, front_table, "design,")
             ? DEA_OK
             : dea_gnuplot_create_folders(w->ctx, w->options->folder, front_figure, true);
}

/* What a reader has to know of the numbers of the best at the last voltage. */
static void add_flags(struct work *w)
{
  for (size_t i = 0; i < w->report->count; i++) {
    struct dea_optimum *best = &w->report->optima[i];
    best->marks = dea_search_marks(&w->search, best->p, w->space->voltage_count - 1);
  }
}

static dea_status write_all(struct work *w, bool ended)
{
  const bool front = w->space->file->objective_count > 1;
  add_flags(w);
  for (size_t i = 0; i < dea_store_count(w->store); i++) {
    w->report->failed += dea_store_get(w->store, i)->why[0] != '\0' ? 1U : 0U;
  }
  DEA_TRY(w->ctx, write_cases(w));
  DEA_TRY(w->ctx, remove_older(w, ended));
  for (size_t i = 0; i < w->report->count; i++) {
    DEA_TRY(w->ctx, write_design(w, &w->report->optima[i], front ? i + 1 : 0));
  }
  DEA_TRY(w->ctx, front ? write_front(w) : DEA_OK);
  return draw_all(w);
}

static dea_status run(struct work *w)
{
  const struct dea_shard whole = {1, 1};
  DEA_TRY(w->ctx, check(w));
  DEA_TRY(w->ctx, build_scatter(w));
  w->evaluator = dea_design_space_with_slopes(w->space);
  w->report->gradients = w->evaluator.gradients;
  DEA_TRY(w->ctx, w->options->force ? dea_store_remove(w->ctx, w->options->folder) : DEA_OK);
  DEA_TRY(w->ctx, dea_store_open(w->ctx, w->options->folder,
                                 w->evaluator.gradients ? w->space->hash_slopes : w->space->hash,
                                 &w->evaluator, &whole, &w->store));
  w->report->before = dea_store_count(w->store);
  fill_search(w);
  dea_status status = dea_search_run(&w->search, w->report->optima, &w->report->count);
  char message[512];
  snprintf(message, sizeof message, "%.511s", dea_context_message(w->ctx));
  w->report->evaluations = dea_store_count(w->store);
  if (status == DEA_OK || status == DEA_E_INTERRUPTED) {
    DEA_TRY(w->ctx, write_all(w, status == DEA_OK));
  }
  if (status == DEA_OK && w->report->count == 0) {
    return fail_without(w);
  }
  return status == DEA_OK ? DEA_OK : dea_fail(w->ctx, status, "%s", message);
}

dea_status dea_optimise_run(const struct dea_design_space *space,
                            const struct dea_optimise_options *options,
                            struct dea_optimise_report *report)
{
  struct work w = {.ctx = space->ctx,
                   .space = space,
                   .options = options,
                   .report = report,
                   .memory = {.ctx = space->ctx}};
  *report = (struct dea_optimise_report){0};
  dea_status status = run(&w);
  dea_store_close(w.store);
  dea_arena_free(&w.memory);
  return status;
}
