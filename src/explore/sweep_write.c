/* The tables and figures of a sweep: one row a case, and what samples say. */
#include "base/csv_line.h"
#include "base/h5.h"
#include "base/sort.h"
#include "base/write_file.h"
#include "explore/explore_sweep.h"
#include "result/columns.h"
#include "result/figure.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct work {
  struct dea_context *ctx;
  const struct dea_design_space *space;
  const struct dea_plan *plan;
  const struct dea_plot_format *format;
  const char *folder;
  struct dea_arena memory;
  size_t params, values;
  /* Of samples: */
  struct dea_spread *spreads;               // [values]
  size_t doubted[DEA_EXPLORE_VOLTAGES_MAX]; // that are not to be trusted
};

// The cases ---------------------------------------------------------------------------------------

/* A column of cases.csv and cases.h5. */
struct column {
  enum { ID, VARIABLE, VALUE, TIME, FLAGS, REASON } kind;
  size_t i; // of its kind
  char name[DEA_FIT_PARAM_NAME > 64 ? DEA_FIT_PARAM_NAME : 64];
  const char *unit, *meaning; // unit: NULL for words
};

/* A word at voltage k: "centre_z_m", of several voltages "centre_z_m@6000". */
static void name_at(const struct dea_design_space *space, const char *word, size_t k, char *out,
                    size_t size)
{
  if (space->voltage_count == 1) {
    snprintf(out, size, "%s", word);
  } else {
    snprintf(out, size, "%s@%.6g", word, space->voltages_V[k]);
  }
}

static size_t list_columns(const struct work *w, struct column *out)
{
  const struct dea_design_space *space = w->space;
  struct column *next = out;
  *next++ = (struct column){ID, 0, "id", NULL, "hash of the resolved design"};
  for (size_t j = 0; j < w->params; j++) {
    const struct dea_fit_param *param = &space->params[j].param;
    *next = (struct column){VARIABLE, j, "", param->unit, "value in the design"};
    snprintf(next->name, sizeof next->name, "%s", param->name);
    next++;
  }
  for (size_t i = 0; i < w->values; i++) {
    const struct dea_explored *of = &space->quantities[i % space->quantity_count];
    *next = (struct column){VALUE, i, "", of->shown.si_unit, of->shown.meaning};
    name_at(space, of->key, i / space->quantity_count, next->name, sizeof next->name);
    next++;
  }
  *next++ = (struct column){TIME, 0, "time", "s", "of the evaluation"};
  for (size_t k = 0; k < space->voltage_count; k++) {
    *next = (struct column){FLAGS, k, "", NULL, "what a reader has to know of the numbers"};
    name_at(space, "flags", k, next->name, sizeof next->name);
    next++;
  }
  *next++ = (struct column){REASON, 0, "reason", NULL, "why a value is missing"};
  return (size_t)(next - out);
}

static double number_of(const struct column *column, const struct dea_case *done)
{
  return column->kind == VARIABLE ? done->p[column->i]
         : column->kind == VALUE  ? done->q[column->i]
                                  : done->wall_s;
}

static const char *words_of(const struct column *column, const struct dea_case *done,
                            char words[DEA_FLAGS_SIZE])
{
  return column->kind == ID       ? done->id
         : column->kind == REASON ? done->why
                                  : dea_flags_text(done->marks[column->i], words);
}

static dea_status write_csv(const struct work *w, const struct column *columns, size_t count)
{
  struct dea_text out = {.ctx = w->ctx};
  char words[DEA_FLAGS_SIZE];
  dea_text_add(&out, "case");
  for (size_t k = 0; k < count; k++) {
    const char *unit = columns[k].unit;
    dea_text_add(&out, unit != NULL ? ",%s (%s)" : ",%s", columns[k].name, unit);
  }
  dea_text_add(&out, "\n");
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = w->plan->cases[c];
    if (done == NULL) {
      continue;
    }
    dea_text_add(&out, "%zu", c);
    for (size_t k = 0; k < count; k++) {
      if (columns[k].unit == NULL) {
        dea_text_add(&out, ",%s", words_of(&columns[k], done, words));
      } else {
        DEA_CSV_ADD(&out, columns[k].kind == TIME ? 4 : 12, number_of(&columns[k], done));
      }
    }
    dea_text_add(&out, "\n");
  }
  return dea_text_write(w->ctx, &out, w->folder, "cases.csv");
}

static void write_column(struct h5 *h, const struct work *w, hid_t group,
                         const struct column *column, size_t rows)
{
  const bool is_number = column->unit != NULL;
  const size_t size = is_number                ? sizeof(double)
                      : column->kind == ID     ? DEA_CASE_ID_SIZE
                      : column->kind == REASON ? DEA_CASE_WHY_SIZE
                                               : DEA_FLAGS_SIZE;
  char words[DEA_FLAGS_SIZE], *cells = dea_alloc(w->ctx, rows, size), *next = cells;
  if (cells == NULL) {
    h->status = DEA_E_MEMORY;
    return;
  }
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = w->plan->cases[c];
    if (done != NULL && is_number) {
      const double number = number_of(column, done);
      memcpy(next, &number, size);
    } else if (done != NULL) {
      snprintf(next, size, "%s", words_of(column, done, words));
    }
    next += done != NULL ? size : 0;
  }
  hid_t type = H5Tcopy(is_number ? H5T_NATIVE_DOUBLE : H5T_C_S1);
  H5Tset_size(type, size);
  dea_h5_write_array(h, group, column->name, type, is_number ? H5T_IEEE_F64LE : type, rows, cells,
                     is_number ? column->unit : "1", column->meaning);
  dea_h5_close(type);
  dea_free(w->ctx, cells);
}

static dea_status write_h5(const struct work *w, const struct column *columns, size_t count)
{
  struct h5 h;
  size_t rows = 0;
  char path[DEA_PATH_SIZE];
  DEA_TRY(w->ctx, dea_path_build(w->ctx, w->folder, "cases.h5", path));
  for (size_t c = 0; c < w->plan->count; c++) {
    rows += w->plan->cases[c] != NULL ? 1U : 0U;
  }
  dea_h5_begin(&h, w->ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "question", w->space->hash);
  dea_h5_write_text(&h, file, "model", w->space->model.type->name);
  hid_t group = dea_h5_group_create(&h, file, "cases");
  for (size_t k = 0; k < count && rows > 0; k++) {
    if (columns[k].kind != TIME) { // the same cases give the same bytes
      write_column(&h, w, group, &columns[k], rows);
    }
  }
  dea_h5_close(group);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  return h.status;
}

static dea_status write_cases(struct work *w)
{
  struct column *columns = dea_arena_alloc(
      &w->memory, 3 + w->params + w->values + w->space->voltage_count, sizeof *columns);
  DEA_TRY_MEMORY(columns != NULL);
  const size_t count = list_columns(w, columns);
  DEA_TRY(w->ctx, write_csv(w, columns, count));
  return write_h5(w, columns, count);
}

// What samples say --------------------------------------------------------------------------------

const double dea_shares[DEA_SHARES] = {0.025, 0.16, 0.5, 0.84, 0.975};

dea_status dea_spread_find(struct dea_context *ctx, const double *values, size_t count,
                           struct dea_spread *out)
{
  double *sorted = dea_alloc(ctx, count, sizeof *sorted);
  DEA_TRY_MEMORY(sorted != NULL);
  *out = (struct dea_spread){0, 0, 0, {NAN, NAN, NAN, NAN, NAN}};
  for (size_t i = 0; i < count; i++) {
    if (!isnan(values[i])) {
      sorted[out->count++] = values[i];
      out->mean += values[i];
    }
  }
  out->mean /= (double)out->count; // NAN without any
  for (size_t i = 0; i < out->count; i++) {
    out->std += (sorted[i] - out->mean) * (sorted[i] - out->mean);
  }
  out->std = out->count > 1 ? sqrt(out->std / (double)(out->count - 1)) : NAN;
  qsort(sorted, out->count, sizeof *sorted, dea_rising);
  for (size_t k = 0; k < DEA_SHARES && out->count > 0; k++) {
    const double at = dea_shares[k] * (double)(out->count - 1);
    const size_t i = (size_t)at;
    const double next = sorted[i + 1 < out->count ? i + 1 : i];
    out->quantile[k] = sorted[i] + (at - (double)i) * (next - sorted[i]);
  }
  dea_free(ctx, sorted);
  return DEA_OK;
}

void dea_sobol_index(const double *a, const double *b, const double *ab, size_t samples,
                     double *first, double *total)
{
  double n = 0, sum = 0, squares = 0, of_first = 0, of_total = 0;
  for (size_t i = 0; i < samples; i++) {
    if (!isnan(a[i]) && !isnan(b[i]) && !isnan(ab[i])) {
      n += 1;
      sum += a[i] + b[i];
    }
  }
  const double mean = sum / (2 * n);
  for (size_t i = 0; i < samples; i++) {
    if (!isnan(a[i]) && !isnan(b[i]) && !isnan(ab[i])) {
      squares += (a[i] - mean) * (a[i] - mean) + (b[i] - mean) * (b[i] - mean);
      of_first += (b[i] - ab[i]) * (b[i] - ab[i]);
      of_total += (a[i] - ab[i]) * (a[i] - ab[i]);
    }
  }
  const double variance = squares / (2 * n);
  *first = 1 - of_first / (2 * n * variance);
  *total = of_total / (2 * n * variance);
}

/* Values i of all cases; NAN where one is not done. */
static void get_values(const struct work *w, size_t i, double *out)
{
  for (size_t c = 0; c < w->plan->count; c++) {
    out[c] = w->plan->cases[c] != NULL ? w->plan->cases[c]->q[i] : NAN;
  }
}

/* Number of samples that are independent: of indices A and B. */
static size_t independent(const struct work *w)
{
  return w->space->file->plan.value == DEA_PLAN_INDICES ? 2 * w->plan->samples : w->plan->count;
}

static dea_status write_statistics(struct work *w, double *values)
{
  const struct dea_design_space *space = w->space;
  struct dea_text out = {.ctx = w->ctx};
  dea_status status = DEA_OK;
  dea_text_add(&out, "quantity,unit,V (kV),samples,mean,std");
  for (size_t k = 0; k < DEA_SHARES; k++) {
    dea_text_add(&out, ",%g %%", 100 * dea_shares[k]);
  }
  dea_text_add(&out, ",doubted\n");
  for (size_t i = 0; i < w->values && status == DEA_OK; i++) {
    const struct dea_explored *of = &space->quantities[i % space->quantity_count];
    const size_t voltage = i / space->quantity_count;
    get_values(w, i, values);
    status = dea_spread_find(w->ctx, values, independent(w), &w->spreads[i]);
    dea_text_add(&out, "%s,%s,%.6g,%zu", of->key, of->shown.si_unit,
                 1e-3 * space->voltages_V[voltage], w->spreads[i].count);
    DEA_CSV_ADD(&out, 12, w->spreads[i].mean, w->spreads[i].std);
    dea_csv_add_numbers(&out, 12, w->spreads[i].quantile, DEA_SHARES);
    dea_text_add(&out, ",%zu\n", w->doubted[voltage]);
  }
  status = status == DEA_OK ? dea_text_write(w->ctx, &out, w->folder, "statistics.csv") : status;
  dea_text_free(&out);
  return status;
}

/* How many samples cross each limit at the last voltage, a failed one among them, with the standard
 * error of that share. */
static dea_status write_limits(const struct work *w)
{
  struct dea_text out = {.ctx = w->ctx};
  if (w->space->limit_count == 0) {
    return DEA_OK;
  }
  dea_text_add(&out, "quantity,above,below,samples,crossed,probability,standard error\n");
  for (size_t l = 0; l < w->space->limit_count; l++) {
    const struct dea_limit *limit = &w->space->limits[l];
    size_t n = 0, crossed = 0;
    for (size_t c = 0; c < independent(w); c++) {
      const struct dea_case *done = w->plan->cases[c];
      n += done != NULL ? 1U : 0U;
      crossed += done != NULL && !(dea_limit_margin(w->space, limit, done->q) >= 0) ? 1U : 0U;
    }
    const double share = (double)crossed / (double)n;
    dea_text_add(&out, "%s", w->space->quantities[limit->column].key);
    DEA_CSV_ADD(&out, 12, limit->above, limit->below);
    dea_text_add(&out, ",%zu,%zu", n, crossed);
    DEA_CSV_ADD(&out, 12, share, sqrt(share * (1 - share) / (double)n));
    dea_text_add(&out, "\n");
  }
  return dea_text_write(w->ctx, &out, w->folder, "limits.csv");
}

static dea_status write_indices(const struct work *w, double *values)
{
  struct dea_text out = {.ctx = w->ctx};
  const struct dea_design_space *space = w->space;
  const size_t n = w->plan->samples;
  char name[64];
  dea_text_add(&out, "quantity,variable,first,total\n");
  for (size_t i = 0; i < w->values; i++) {
    get_values(w, i, values);
    name_at(space, space->quantities[i % space->quantity_count].key, i / space->quantity_count,
            name, sizeof name);
    for (size_t j = 0; j < w->params; j++) {
      double first, total;
      dea_sobol_index(values, values + n, values + (2 + j) * n, n, &first, &total);
      dea_text_add(&out, "%s,%s", name, space->params[j].param.name);
      DEA_CSV_ADD(&out, 12, first, total);
      dea_text_add(&out, "\n");
    }
  }
  return dea_text_write(w->ctx, &out, w->folder, "indices.csv");
}

// Bands of a quantity at several voltages ---------------------------------------------------------

/* Puts quantiles `low` and its opposite of quantity i at voltage v. */
static void add_point(const struct work *w, size_t i, size_t v, size_t low, struct dea_series *out)
{
  const struct dea_design_space *space = w->space;
  const size_t n = space->voltage_count;
  const double *quantile = w->spreads[v * space->quantity_count + i].quantile;
  out->values[v] = 1e-3 * space->voltages_V[v];
  out->values[n + v] = space->quantities[i].shown.factor * quantile[low];
  out->values[2 * n + v] = space->quantities[i].shown.factor * quantile[DEA_SHARES - 1 - low];
}

static dea_status add_bands(const struct work *w, size_t i, struct dea_panel *panel)
{
  static const char *const titles[] = {"95 %", "68 %"};
  static const enum dea_colour colours[] = {DEA_GREY, DEA_VERMILLION};
  const size_t n = w->space->voltage_count;
  for (size_t k = 0; k < 2; k++) { // from the outer pair inwards
    struct dea_series *band;
    DEA_TRY(w->ctx, dea_panel_add(w->ctx, panel, n, DEA_BAND, colours[k], titles[k], &band));
    for (size_t v = 0; v < n; v++) {
      add_point(w, i, v, k, band);
    }
  }
  return DEA_OK;
}

/* The median where all samples are to be trusted, or dashed where some are not, up to the points
 * beside these. */
static dea_status add_line(const struct work *w, size_t i, struct dea_panel *panel, bool dashed,
                           const char *title)
{
  const size_t n = w->space->voltage_count;
  struct dea_series *line;
  DEA_TRY(w->ctx, dea_panel_add(w->ctx, panel, n, dashed ? DEA_DASHED : DEA_LINE_MARKED, DEA_BLUE,
                                title, &line));
  for (size_t v = 0; v < n; v++) {
    const bool beside = (v > 0 && w->doubted[v - 1] > 0) || (v + 1 < n && w->doubted[v + 1] > 0);
    if (dashed ? w->doubted[v] > 0 || beside : w->doubted[v] == 0) {
      add_point(w, i, v, DEA_SHARES / 2, line);
    }
  }
  return DEA_OK;
}

/* Samples without a value are in neither median nor bands, and those that are not to be trusted
 * are: the key says both. */
static dea_status add_median(const struct work *w, size_t i, struct dea_panel *panel)
{
  const size_t samples = independent(w);
  size_t most = 0, least = samples, good = 0;
  char median[64] = "median", doubts[62], both[DEA_LABEL_SIZE];
  for (size_t v = 0; v < w->space->voltage_count; v++) {
    const size_t count = w->spreads[v * w->space->quantity_count + i].count;
    most = w->doubted[v] > most ? w->doubted[v] : most;
    least = count < least ? count : least;
    good += w->doubted[v] > 0 ? 0U : 1U;
  }
  if (least < samples) {
    snprintf(median, sizeof median, "median of %zu or more of %zu", least, samples);
  }
  snprintf(doubts, sizeof doubts, "up to %zu of %zu not to be trusted", most, samples);
  if (good == 0) {
    snprintf(both, sizeof both, "%s, %s", median, doubts);
    return add_line(w, i, panel, true, both);
  }
  DEA_TRY(w->ctx, add_line(w, i, panel, false, median));
  return most > 0 ? add_line(w, i, panel, true, doubts) : DEA_OK;
}

static dea_status fill_panel(const struct work *w, size_t i, struct dea_panel *panel)
{
  DEA_TRY(w->ctx, add_bands(w, i, panel));
  DEA_TRY(w->ctx, add_median(w, i, panel));
  dea_figure_label(&w->space->quantities[i].shown, panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

/* Figures band_KEY. */
static dea_status draw(const struct work *w)
{
  struct dea_plot_folder list = {.ctx = w->ctx, .format = w->format, .path = w->folder};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < w->space->quantity_count && status == DEA_OK; i++) {
    struct dea_plot *plot;
    char name[64];
    snprintf(name, sizeof name, "band_%.50s", w->space->quantities[i].key);
    status = dea_plot_create(w->ctx, name,
                             "median of the samples, and where 68 and 95 % of them lie", &plot);
    if (status == DEA_OK) {
      status = dea_plot_folder_add(&list, plot, fill_panel(w, i, &plot->panels[0]));
    }
  }
  return dea_plot_folder_draw(&list, status);
}

// All of it ---------------------------------------------------------------------------------------

/* What samples say. */
static dea_status write_samples(struct work *w)
{
  double *values = dea_arena_alloc(&w->memory, w->plan->count, sizeof *values);
  w->spreads = dea_arena_alloc(&w->memory, w->values, sizeof *w->spreads);
  DEA_TRY(w->ctx, dea_arena_status(&w->memory));
  for (size_t c = 0; c < independent(w); c++) {
    const struct dea_case *done = w->plan->cases[c];
    for (size_t k = 0; k < w->space->voltage_count && done != NULL; k++) {
      w->doubted[k] += dea_flags_have(done->marks[k], DEA_FLAG_DOUBT) ? 1U : 0U;
    }
  }
  DEA_TRY(w->ctx, write_statistics(w, values));
  DEA_TRY(w->ctx, write_limits(w));
  if (w->space->file->plan.value == DEA_PLAN_INDICES) {
    DEA_TRY(w->ctx, write_indices(w, values));
  }
  return w->space->voltage_count > 1 ? draw(w) : DEA_OK;
}

dea_status dea_sweep_write(const struct dea_design_space *space, const struct dea_plan *plan,
                           const struct dea_plot_format *format, const char *folder)
{
  struct work w = {.ctx = space->ctx,
                   .space = space,
                   .plan = plan,
                   .format = format,
                   .folder = folder,
                   .memory = {.ctx = space->ctx},
                   .params = space->variable_count,
                   .values = space->evaluator.value_count};
  const bool samples =
      space->file->plan.value > DEA_PLAN_SPARSE && space->file->objective_count == 0;
  void *before = dea_c_locale_enter();
  dea_status status = write_cases(&w);
  status = status == DEA_OK && samples ? write_samples(&w) : status;
  dea_c_locale_leave(before);
  dea_arena_free(&w.memory);
  return status;
}
