#include "cli/compare_many.h"

#include "base/file.h"
#include "base/write_file.h"
#include "output/compare_set.h"
#include "output/results_h5.h"

#include <math.h>
#include <string.h>

bool cli_compare_is_run(const char *path)
{
  size_t n = strlen(path);
  char head[8] = {0};
  if ((n > 3 && strcmp(path + n - 3, ".h5") == 0) || dea_path_is_folder(path)) {
    return true;
  }
  FILE *file = fopen(path, "rb");
  bool good = file != NULL && fread(head, 1, sizeof head, file) == sizeof head &&
              memcmp(head, "\x89HDF\r\n\x1a\n", sizeof head) == 0;
  if (file != NULL) {
    fclose(file);
  }
  return good;
}

dea_status cli_compare_judge(struct dea_context *ctx, const struct dea_misfit *worst,
                             const char *curve, double tolerance)
{
  if (isnan(tolerance) || worst == NULL || worst->relative_largest <= tolerance) {
    return DEA_OK;
  }
  return dea_fail(ctx, DEA_E_DIFFERS, "%s%s%s differs by %.3g %% of its range, more than %.3g %%",
                  dea_point_columns[worst->column].key, curve[0] != '\0' ? " of " : "", curve,
                  100.0 * worst->relative_largest, 100.0 * tolerance);
}

const char *cli_compare_mark(const struct dea_misfit *misfit, double tolerance)
{
  return !isnan(tolerance) && !(misfit->relative_largest <= tolerance) ? "  out of tolerance" : "";
}

// What is compared --------------------------------------------------------------------------------

/* All that was read. */
struct sides {
  struct dea_run *runs[COMPARE_NAMES_MAX];
  struct dea_measured *measured; // NULL: the reference is the last run
};

static dea_status read_sides(struct dea_context *ctx, const struct compare_request *request,
                             struct sides *sides)
{
  size_t last = request->names.count - 1;
  for (size_t i = 0; i < last; i++) {
    if (dea_measured_is_folder(request->names.at[i])) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "%s is a measurement: name it last, and runs before it",
                      request->names.at[i]);
    }
    DEA_TRY(ctx, dea_run_read(ctx, request->names.at[i], &sides->runs[i]));
  }
  const char *reference = request->names.at[last];
  return dea_measured_is_folder(reference) || !cli_compare_is_run(reference)
             ? dea_measured_read(ctx, reference, &sides->measured)
             : dea_run_read(ctx, reference, &sides->runs[last]);
}

static void free_sides(struct dea_context *ctx, struct sides *sides)
{
  for (size_t i = 0; i < COMPARE_NAMES_MAX; i++) {
    dea_run_destroy(ctx, sides->runs[i]);
  }
  dea_measured_destroy(ctx, sides->measured);
}

/* Last part of a path, or all of it where another side ends the same. Into out[DEA_LABEL_SIZE]. */
static void side_name(const struct compare_request *request, size_t side, char *out)
{
  const char *path = request->names.at[side], *own = dea_path_name(path);
  bool alone = own[0] != '\0';
  for (size_t i = 0; i < request->names.count; i++) {
    alone = alone && (i == side || strcmp(dea_path_name(request->names.at[i]), own) != 0);
  }
  snprintf(out, DEA_LABEL_SIZE, "%.60s", alone ? own : path);
}

/* Models of a run that are to be compared; names lent. */
static size_t models_of(const struct compare_request *request, const struct dea_run *run,
                        const char *models[DEA_DESIGN_MODELS_MAX])
{
  size_t count = dea_result_models(run->result, models, DEA_DESIGN_MODELS_MAX), kept = 0;
  for (size_t m = 0; m < count && request->models.count > 0; m++) {
    for (size_t k = 0; k < request->models.count; k++) {
      if (strcmp(models[m], request->models.at[k][0]) == 0) {
        models[kept++] = models[m];
        break;
      }
    }
  }
  return request->models.count > 0 ? kept : count;
}

/* Model of the reference that was asked for beside this one, "" for none. */
static const char *reference_model(const struct compare_request *request, const char *model)
{
  for (size_t k = 0; k < request->models.count; k++) {
    if (strcmp(model, request->models.at[k][0]) == 0) {
      return request->models.at[k][1];
    }
  }
  return "";
}

/* Adds the models of one run; they are called by what tells them apart. */
static dea_status add_run(struct dea_context *ctx, const struct compare_request *request,
                          const struct sides *sides, size_t side, bool one_model,
                          struct dea_compare_set *set)
{
  const char *models[DEA_DESIGN_MODELS_MAX];
  size_t count = models_of(request, sides->runs[side], models);
  char run[DEA_LABEL_SIZE], name[DEA_LABEL_SIZE];
  side_name(request, side, run);
  if (count == 0) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "%s has no model %s", request->names.at[side],
                    request->models.count > 0 ? "of those asked for" : "with points");
  }
  for (size_t m = 0; m < count; m++) {
    if (request->names.count == 2) {
      snprintf(name, sizeof name, "%s", models[m]);
    } else {
      snprintf(name, sizeof name, "%.60s%s%.60s", run, one_model ? "" : ", ",
               one_model ? "" : models[m]);
    }
    DEA_TRY(ctx, dea_compare_set_add(ctx, set, name, sides->runs[side]->result, models[m],
                                     reference_model(request, models[m])));
  }
  return DEA_OK;
}

static dea_status fill_set(struct dea_context *ctx, const struct compare_request *request,
                           const struct sides *sides, struct dea_compare_set *set)
{
  size_t runs = request->names.count - 1;
  bool one_model = true;
  for (size_t i = 0; i < runs; i++) {
    const char *models[DEA_DESIGN_MODELS_MAX];
    one_model = one_model && models_of(request, sides->runs[i], models) == 1;
  }
  for (size_t i = 0; i < runs; i++) {
    DEA_TRY(ctx, add_run(ctx, request, sides, i, one_model, set));
  }
  return DEA_OK;
}

// What is printed ---------------------------------------------------------------------------------

/* Title of a table and of the place of the largest difference. */
static void print_head(const char *title, const char *at, bool std)
{
  printf("\n%-28s %6s %11s %11s %8s %11s %10s %13s", title, "points", "RMS", "largest", at, "bias",
         "RMS/range", "largest/range");
  printf(std ? " %11s %8s %8s\n" : "\n", "chi2/point", "in 1 std", "in 2 std");
}

static void print_row(const char *name, const struct dea_misfit *m, double at_factor,
                      double tolerance)
{
  double factor = dea_point_columns[m->column].factor;
  printf("  %-26s %6zu %11.5g %11.5g %8.4g %11.5g %8.3g %% %11.3g %%", name, m->count,
         factor * m->rms, factor * m->largest, at_factor * m->largest_at, factor * m->bias,
         100.0 * m->relative_rms, 100.0 * m->relative_largest);
  if (m->std_count > 0) {
    printf(" %11.4g %6.0f %% %6.0f %%", m->chi_square, 100.0 * m->within_1_std,
           100.0 * m->within_2_std);
  }
  printf("%s\n", cli_compare_mark(m, tolerance));
}

/* Prints the misfits of a quantity; true when some has uncertainties. */
static bool print_quantity(const struct dea_compare_set *set, int column, double tolerance)
{
  const struct dea_misfit *rows[DEA_SET_CURVES_MAX] = {NULL};
  bool any = false, std = false;
  for (size_t i = 0; i < set->curve_count; i++) {
    const struct dea_comparison *c = set->curves[i].comparison;
    for (size_t k = 0; c != NULL && k < c->misfit_count; k++) {
      if (c->misfits[k].column == column) {
        rows[i] = &c->misfits[k];
        any = true;
        std = std || rows[i]->std_count > 0;
      }
    }
  }
  if (any) {
    char title[96];
    dea_column_title(&dea_point_columns[column], title, sizeof title);
    print_head(title, "at kV", std);
  }
  for (size_t i = 0; i < set->curve_count; i++) {
    if (rows[i] != NULL) {
      print_row(set->curves[i].name, rows[i], 1e-3, tolerance);
    }
  }
  return std;
}

static bool print_profiles(const struct dea_compare_set *set)
{
  bool std = false;
  for (size_t i = 0; i < set->profile_count; i++) {
    std = std || set->profiles[i].misfit.std_count > 0;
  }
  for (size_t i = 0; i < set->profile_count; i++) {
    const struct dea_set_profile *p = &set->profiles[i];
    char text[2 * DEA_LABEL_SIZE];
    if (i == 0 || p->measured != set->profiles[i - 1].measured) {
      snprintf(text, sizeof text, "z over film at %.4g kV (um)",
               1e-3 * set->measured->profiles[p->measured].voltage_V);
      print_head(text, "at mm", std);
    }
    snprintf(text, sizeof text, "%s%s%s", set->curves[p->curve].name, p->line.directed ? ", " : "",
             p->line.directed ? dea_half_names[p->half] : "");
    print_row(text, &p->misfit, 1e3, NAN);
  }
  return std;
}

static void print_histories(const struct dea_compare_set *set)
{
  for (int k = 0; k < DEA_MEASURED_COLUMNS; k++) {
    bool first = true;
    for (size_t i = 0; i < set->history_count; i++) {
      const struct dea_set_history *h = &set->histories[i];
      if ((int)h->column != k) {
        continue;
      }
      if (first) {
        char title[96], text[112];
        dea_column_title(&dea_point_columns[h->misfit.column], title, sizeof title);
        snprintf(text, sizeof text, "%s in time", title);
        print_head(text, "at s", false);
        first = false;
      }
      print_row(set->curves[h->curve].name, &h->misfit, 1.0, NAN);
    }
  }
}

static void print_tables(const struct dea_compare_set *set, double tolerance)
{
  bool std = false;
  printf("Each curve minus %s%s\n", set->reference,
         set->measured != NULL ? ", as measured" : " (a run)");
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    std = print_quantity(set, c, tolerance) || std;
  }
  std = print_profiles(set) || std;
  print_histories(set);
  if (std) {
    printf(
        "\nchi2/point is the mean of (difference/std)^2: 1 where differences are of the size of "
        "the scatter.\nOf a normal scatter 68 %% lie within 1 std and 95 %% within 2. The std is "
        "what the measurement\nsays of its scatter; errors of its calibration and of the model "
        "are not in it.\n");
  }
}

static dea_status print_json(struct dea_context *ctx, const struct dea_compare_set *set,
                             double tolerance)
{
  char *text;
  DEA_TRY(ctx, dea_json_text(ctx, dea_compare_set_json(set, tolerance), &text));
  fputs(text, stdout);
  dea_free(ctx, text);
  return DEA_OK;
}

static dea_status compare(struct dea_context *ctx, const struct compare_request *request,
                          const struct sides *sides, struct dea_compare_set *set)
{
  size_t worst_curve = 0;
  DEA_TRY(ctx, fill_set(ctx, request, sides, set));
  DEA_TRY(ctx, dea_compare_set_compute(ctx, set, request->columns.at, request->columns.count));
  if (request->json) {
    DEA_TRY(ctx, print_json(ctx, set, request->tolerance));
  } else {
    print_tables(set, request->tolerance);
  }
  if (request->output != NULL) {
    DEA_TRY(ctx, dea_compare_set_draw(ctx, set, &request->format, request->output));
  }
  const struct dea_misfit *worst = dea_compare_set_worst(set, &worst_curve);
  if (worst == NULL && !isnan(request->tolerance)) {
    return dea_fail(
        ctx, DEA_E_DIFFERS,
        "no quantity against the voltage is in common, so none is within the tolerance");
  }
  return cli_compare_judge(ctx, worst, set->curves[worst_curve].name, request->tolerance);
}

dea_status cli_compare_many(struct dea_cli *cli, const struct compare_request *request)
{
  struct sides sides = {0};
  struct dea_compare_set *set = NULL;
  struct dea_context *ctx = cli->ctx;
  char reference[DEA_LABEL_SIZE];
  size_t last = request->names.count - 1;
  side_name(request, last, reference);
  dea_status status = read_sides(ctx, request, &sides);
  if (status == DEA_OK) {
    status =
        dea_compare_set_create(ctx, reference, sides.measured,
                               sides.runs[last] != NULL ? sides.runs[last]->result : NULL, &set);
  }
  if (status == DEA_OK) {
    status = compare(ctx, request, &sides, set);
  }
  dea_compare_set_destroy(ctx, set);
  free_sides(ctx, &sides);
  return status;
}
