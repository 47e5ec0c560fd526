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
  const struct dea_case_key *case_key;
  const struct dea_plan *plan;
  const struct dea_store *store;
  const struct dea_plot_format *format;
  const char *folder;
  struct dea_context *ctx;
  size_t params, values;
};

static const struct dea_case *case_of(const struct work *w, size_t i)
{
  return dea_store_find(w->store, w->plan->p + i * w->params);
}

static const char *unit_of(const struct work *w, size_t value)
{
  const size_t i = value % w->case_key->quantity_count;
  return w->case_key->quantities[i].shown.si_unit;
}

// The cases ---------------------------------------------------------------------------------------

static dea_status write_cases(const struct work *w)
{
  struct dea_text out = {.ctx = w->ctx};
  char name[64];
  dea_text_add(&out, "case,id");
  for (size_t j = 0; j < w->params; j++) {
    const struct dea_device_param *param = &w->case_key->params[j];
    dea_text_add(&out, ",%s (%s)", param->param.name, param->param.unit);
  }
  for (size_t i = 0; i < w->values; i++) {
    dea_case_key_value_name(w->case_key, i, name, sizeof name);
    dea_text_add(&out, ",%s (%s)", name, unit_of(w, i));
  }
  dea_text_add(&out, ",time (s)");
  for (size_t k = 0; k < w->case_key->voltage_count; k++) {
    dea_case_key_flags_name(w->case_key, k, name, sizeof name);
    dea_text_add(&out, ",%s", name);
  }
  dea_text_add(&out, ",reason\n");
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = case_of(w, c);
    if (done == NULL) {
      continue;
    }
    dea_text_add(&out, "%zu,%s", c, done->id);
    for (size_t j = 0; j < w->params; j++) {
      DEA_CSV_ADD(&out, 12, done->p[j]);
    }
    for (size_t i = 0; i < w->values; i++) {
      DEA_CSV_ADD(&out, 12, done->q[i]);
    }
    dea_text_add(&out, ",%.4g", done->wall_s);
    for (size_t k = 0; k < w->case_key->voltage_count; k++) {
      char words[DEA_FLAGS_SIZE];
      dea_text_add(&out, ",%s", dea_flags_text(done->marks[k], words));
    }
    dea_text_add(&out, ",%s\n", done->why);
  }
  dea_status status = dea_text_write(w->ctx, &out, w->folder, "cases.csv");
  dea_text_free(&out);
  return status;
}

/* A column of numbers: a variable, or with `values` a value. to: room for all rows. */
static void write_numbers(struct h5 *h, const struct work *w, hid_t group, double *to, bool values,
                          size_t i)
{
  const struct dea_device_param *param = &w->case_key->params[values ? 0 : i];
  const struct dea_column *of = &w->case_key->quantities[i % w->case_key->quantity_count].shown;
  char name[64];
  size_t rows = 0;
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = case_of(w, c);
    if (done != NULL) {
      to[rows++] = values ? done->q[i] : done->p[i];
    }
  }
  dea_case_key_value_name(w->case_key, i, name, sizeof name);
  dea_h5_write_array(h, group, values ? name : param->param.name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE,
                     rows, to, values ? of->si_unit : param->param.unit,
                     values ? of->meaning : "value in the design");
}

enum { ID, REASON, FLAGS }; // FLAGS + k: at voltage k

/* A column of words. */
static void write_texts(struct h5 *h, const struct work *w, hid_t group, size_t rows, size_t what)
{
  static const struct {
    size_t size;
    const char *name, *meaning;
  } kinds[] = {{DEA_CASE_ID_SIZE, "id", "hash of the resolved design"},
               {DEA_CASE_WHY_SIZE, "reason", "why a value is missing"},
               {DEA_FLAGS_SIZE, NULL, "what a reader has to know of the numbers"}};
  const size_t kind = what < FLAGS ? what : FLAGS, size = kinds[kind].size;
  char name[64], words[DEA_FLAGS_SIZE], *texts = dea_alloc(w->ctx, rows, size);
  size_t row = 0;
  if (texts == NULL) {
    h->status = DEA_E_MEMORY;
    return;
  }
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = case_of(w, c);
    if (done != NULL) {
      snprintf(texts + size * row++, size, "%s",
               kind == FLAGS ? dea_flags_text(done->marks[what - FLAGS], words)
               : what == ID  ? done->id
                             : done->why);
    }
  }
  if (kind == FLAGS) {
    dea_case_key_flags_name(w->case_key, what - FLAGS, name, sizeof name);
  }
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, size);
  dea_h5_write_array(h, group, kind == FLAGS ? name : kinds[kind].name, type, type, rows, texts,
                     "1", kinds[kind].meaning);
  dea_h5_close(type);
  dea_free(w->ctx, texts);
}

static dea_status write_h5(const struct work *w)
{
  struct h5 h;
  size_t rows = 0;
  char *path = dea_path_join(w->ctx, w->folder, "cases.h5");
  for (size_t c = 0; c < w->plan->count; c++) {
    rows += case_of(w, c) != NULL ? 1U : 0U;
  }
  double *column = dea_alloc(w->ctx, rows, sizeof *column);
  if (path == NULL || column == NULL) {
    dea_free(w->ctx, column);
    dea_free(w->ctx, path);
    return DEA_E_MEMORY;
  }
  dea_h5_begin(&h, w->ctx, path);
  hid_t file = dea_h5_file_create(&h);
  dea_h5_write_text(&h, file, "question", w->case_key->hash);
  dea_h5_write_text(&h, file, "model", w->case_key->model.type->name);
  hid_t group = dea_h5_group_create(&h, file, "cases");
  if (rows > 0) {
    write_texts(&h, w, group, rows, ID);
    for (size_t j = 0; j < w->params; j++) {
      write_numbers(&h, w, group, column, false, j);
    }
    for (size_t i = 0; i < w->values; i++) {
      write_numbers(&h, w, group, column, true, i);
    }
    for (size_t k = 0; k < w->case_key->voltage_count; k++) {
      write_texts(&h, w, group, rows, FLAGS + k);
    }
    write_texts(&h, w, group, rows, REASON);
  }
  dea_h5_close(group);
  dea_h5_file_write(&h, file);
  dea_h5_end(&h);
  dea_free(w->ctx, column);
  dea_free(w->ctx, path);
  return h.status;
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

/* Values i of the cases from first on, [count]; NAN where a case is not done. */
static void get_values(const struct work *w, size_t i, size_t first, size_t count, double *out)
{
  for (size_t c = 0; c < count; c++) {
    const struct dea_case *done = case_of(w, first + c);
    out[c] = done != NULL ? done->q[i] : NAN;
  }
}

/* Number of samples that are independent: of indices A and B. */
static size_t independent(const struct work *w)
{
  return w->case_key->file->plan.value == DEA_PLAN_INDICES ? 2 * w->plan->samples : w->plan->count;
}

/* Independent samples whose numbers at voltage k are not to be trusted. */
static size_t doubted_at(const struct work *w, size_t k)
{
  size_t count = 0;
  for (size_t c = 0; c < independent(w); c++) {
    const struct dea_case *done = case_of(w, c);
    count += done != NULL && dea_flags_have(done->marks[k], DEA_FLAG_DOUBT) ? 1U : 0U;
  }
  return count;
}

static dea_status write_statistics(const struct work *w, const size_t *doubted, double *values,
                                   struct dea_spread *spreads)
{
  struct dea_text out = {.ctx = w->ctx};
  dea_status status = DEA_OK;
  char name[64];
  dea_text_add(&out, "quantity,unit,V (kV),samples,mean,std");
  for (size_t k = 0; k < DEA_SHARES; k++) {
    dea_text_add(&out, ",%g %%", 100 * dea_shares[k]);
  }
  dea_text_add(&out, ",doubted\n");
  for (size_t i = 0; i < w->values && status == DEA_OK; i++) {
    get_values(w, i, 0, independent(w), values);
    status = dea_spread_find(w->ctx, values, independent(w), &spreads[i]);
    dea_case_key_value_name(w->case_key, i, name, sizeof name);
    name[strcspn(name, "@")] = '\0';
    dea_text_add(&out, "%s,%s,%.6g,%zu", name, unit_of(w, i),
                 1e-3 * w->case_key->voltages_V[i / w->case_key->quantity_count], spreads[i].count);
    DEA_CSV_ADD(&out, 12, spreads[i].mean, spreads[i].std);
    for (size_t k = 0; k < DEA_SHARES; k++) {
      DEA_CSV_ADD(&out, 12, spreads[i].quantile[k]);
    }
    dea_text_add(&out, ",%zu\n", doubted[i / w->case_key->quantity_count]);
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
  dea_text_add(&out, "quantity,above,below,samples,crossed,probability,standard error\n");
  for (size_t l = 0; l < w->case_key->limit_count; l++) {
    const struct dea_limit *limit = &w->case_key->limits[l];
    size_t n = 0, crossed = 0;
    for (size_t c = 0; c < independent(w); c++) {
      const struct dea_case *done = case_of(w, c);
      n += done != NULL ? 1U : 0U;
      crossed += done != NULL && !(dea_limit_margin(w->case_key, limit, done->q) >= 0) ? 1U : 0U;
    }
    const double share = (double)crossed / (double)n;
    dea_text_add(&out, "%s", w->case_key->quantities[limit->column].key);
    DEA_CSV_ADD(&out, 12, limit->above, limit->below);
    dea_text_add(&out, ",%zu,%zu", n, crossed);
    DEA_CSV_ADD(&out, 12, share, sqrt(share * (1 - share) / (double)n));
    dea_text_add(&out, "\n");
  }
  dea_status status =
      w->case_key->limit_count > 0 ? dea_text_write(w->ctx, &out, w->folder, "limits.csv") : DEA_OK;
  dea_text_free(&out);
  return status;
}

static dea_status write_indices(const struct work *w, double *values)
{
  struct dea_text out = {.ctx = w->ctx};
  const size_t n = w->plan->samples;
  char name[64];
  dea_text_add(&out, "quantity,variable,first,total\n");
  for (size_t i = 0; i < w->values; i++) {
    get_values(w, i, 0, w->plan->count, values);
    dea_case_key_value_name(w->case_key, i, name, sizeof name);
    for (size_t j = 0; j < w->params; j++) {
      double first, total;
      dea_sobol_index(values, values + n, values + (2 + j) * n, n, &first, &total);
      dea_text_add(&out, "%s,%s", name, w->case_key->params[j].param.name);
      DEA_CSV_ADD(&out, 12, first, total);
      dea_text_add(&out, "\n");
    }
  }
  dea_status status = dea_text_write(w->ctx, &out, w->folder, "indices.csv");
  dea_text_free(&out);
  return status;
}

// Bands of quantities at several voltages ---------------------------------------------------------

/* Spreads of a quantity at all voltages and how it is shown. */
struct shown {
  const struct dea_case_key *case_key;
  const struct dea_spread *spreads; // of the quantity: [voltages * quantities] from it on
  const struct dea_column *column;
  size_t samples;
  const size_t *doubted; // [voltages]
};

/* Puts quantiles `low` and its opposite at voltage v. */
static void add_point(const struct shown *shown, size_t v, size_t low, struct dea_series *out)
{
  const size_t n = shown->case_key->voltage_count;
  const double *quantile = shown->spreads[v * shown->case_key->quantity_count].quantile;
  out->values[v] = 1e-3 * shown->case_key->voltages_V[v];
  out->values[n + v] = shown->column->factor * quantile[low];
  out->values[2 * n + v] = shown->column->factor * quantile[DEA_SHARES - 1 - low];
}

static dea_status add_bands(const struct shown *shown, struct dea_panel *panel)
{
  static const char *const titles[] = {"95 %", "68 %"};
  static const enum dea_colour colours[] = {DEA_GREY, DEA_VERMILLION};
  const size_t n = shown->case_key->voltage_count;
  for (size_t k = 0; k < 2; k++) { // from the outer pair inwards
    struct dea_series *band;
    DEA_TRY(shown->case_key->ctx,
            dea_panel_add(shown->case_key->ctx, panel, n, DEA_BAND, colours[k], titles[k], &band));
    for (size_t v = 0; v < n; v++) {
      add_point(shown, v, k, band);
    }
  }
  return DEA_OK;
}

/* Whether a voltage has samples that are not to be trusted; none lies beyond the last one. */
static bool is_doubted(const struct shown *shown, size_t v)
{
  return v < shown->case_key->voltage_count && shown->doubted[v] > 0;
}

/* The median where all samples are to be trusted, or dashed where some are not, up to the points
 * beside these. */
static dea_status add_line(const struct shown *shown, struct dea_panel *panel, bool dashed,
                           const char *title)
{
  const size_t n = shown->case_key->voltage_count;
  struct dea_series *line;
  DEA_TRY(shown->case_key->ctx,
          dea_panel_add(shown->case_key->ctx, panel, n, dashed ? DEA_DASHED : DEA_LINE_MARKED,
                        DEA_BLUE, title, &line));
  for (size_t v = 0; v < n; v++) {
    const bool beside = (v > 0 && is_doubted(shown, v - 1)) || is_doubted(shown, v + 1);
    if (dashed ? is_doubted(shown, v) || beside : !is_doubted(shown, v)) {
      add_point(shown, v, DEA_SHARES / 2, line);
    }
  }
  return DEA_OK;
}

/* Samples without a value are in neither median nor bands, and those that are not to be trusted
 * are: the key says both. */
static dea_status add_median(const struct shown *shown, struct dea_panel *panel)
{
  size_t most = 0, least = shown->samples, good = 0;
  char median[64] = "median", doubts[62], both[DEA_LABEL_SIZE];
  for (size_t v = 0; v < shown->case_key->voltage_count; v++) {
    const size_t count = shown->spreads[v * shown->case_key->quantity_count].count;
    most = shown->doubted[v] > most ? shown->doubted[v] : most;
    least = count < least ? count : least;
    good += is_doubted(shown, v) ? 0U : 1U;
  }
  if (least < shown->samples) {
    snprintf(median, sizeof median, "median of %zu or more of %zu", least, shown->samples);
  }
  snprintf(doubts, sizeof doubts, "up to %zu of %zu not to be trusted", most, shown->samples);
  if (good == 0) {
    snprintf(both, sizeof both, "%s, %s", median, doubts);
    return add_line(shown, panel, true, both);
  }
  DEA_TRY(shown->case_key->ctx, add_line(shown, panel, false, median));
  return most > 0 ? add_line(shown, panel, true, doubts) : DEA_OK;
}

static dea_status fill_panel(const struct shown *shown, struct dea_panel *panel)
{
  DEA_TRY(shown->case_key->ctx, add_bands(shown, panel));
  DEA_TRY(shown->case_key->ctx, add_median(shown, panel));
  dea_figure_label(shown->column, panel->y_label, sizeof panel->y_label);
  dea_panel_voltage_axis(panel);
  dea_panel_place_key(panel);
  return DEA_OK;
}

/* Figures band_KEY of spreads [voltages][quantities] of so many samples, into a folder. doubted:
 * [voltages], samples whose numbers are not to be trusted there. */
static dea_status draw(const struct dea_case_key *case_key, const struct dea_spread *spreads,
                       size_t samples, const size_t *doubted, const struct dea_plot_format *format,
                       const char *folder)
{
  struct dea_plot_folder list = {.ctx = case_key->ctx, .format = format, .path = folder};
  dea_status status = DEA_OK;
  for (size_t i = 0; i < case_key->quantity_count && status == DEA_OK; i++) {
    struct dea_plot *plot;
    char name[64];
    const struct shown shown = {case_key, spreads + i, &case_key->quantities[i].shown, samples,
                                doubted};
    snprintf(name, sizeof name, "band_%.50s", case_key->quantities[i].key);
    status = dea_plot_create(case_key->ctx, name,
                             "median of the samples, and where 68 and 95 % of them lie", &plot);
    if (status == DEA_OK) {
      status = dea_plot_folder_add(&list, plot, fill_panel(&shown, &plot->panels[0]));
    }
  }
  return dea_plot_folder_draw(&list, status);
}

// All of it ---------------------------------------------------------------------------------------

static dea_status write_all(const struct work *w)
{
  DEA_TRY(w->ctx, write_cases(w));
  DEA_TRY(w->ctx, write_h5(w));
  if (w->case_key->file->plan.value <= DEA_PLAN_SPARSE || w->case_key->file->objective_count > 0) {
    return DEA_OK;
  }
  size_t doubted[DEA_EXPLORE_VOLTAGES_MAX] = {0};
  for (size_t k = 0; k < w->case_key->voltage_count; k++) {
    doubted[k] = doubted_at(w, k);
  }
  double *values = dea_alloc(w->ctx, w->plan->count, sizeof *values);
  struct dea_spread *spreads = dea_alloc(w->ctx, w->values, sizeof *spreads);
  dea_status status = values != NULL && spreads != NULL
                          ? write_statistics(w, doubted, values, spreads)
                          : DEA_E_MEMORY;
  status = status == DEA_OK ? write_limits(w) : status;
  if (status == DEA_OK && w->case_key->file->plan.value == DEA_PLAN_INDICES) {
    status = write_indices(w, values);
  }
  if (status == DEA_OK && w->case_key->voltage_count > 1) {
    status = draw(w->case_key, spreads, independent(w), doubted, w->format, w->folder);
  }
  dea_free(w->ctx, spreads);
  dea_free(w->ctx, values);
  return status;
}

dea_status dea_sweep_write(const struct dea_case_key *case_key, const struct dea_plan *plan,
                           const struct dea_store *store, const struct dea_plot_format *format,
                           const char *folder)
{
  const struct work w = {case_key,
                         plan,
                         store,
                         format,
                         folder,
                         case_key->ctx,
                         case_key->variable_count,
                         case_key->evaluator.value_count};
  void *before = dea_c_locale_enter();
  dea_status status = write_all(&w);
  dea_c_locale_leave(before);
  return status;
}
