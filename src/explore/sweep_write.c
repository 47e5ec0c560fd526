/* The tables of a sweep: one row a case, and what samples say. */
#include "base/csv_line.h"
#include "base/h5.h"
#include "base/write_file.h"
#include "explore/explore_sweep.h"
#include "explore/sample_statistics.h"
#include "result/columns.h"

#include <math.h>
#include <stdio.h>
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

/* One column: a variable, or with value >= 0 a value. */
static void write_column(struct h5 *h, const struct work *w, hid_t group, size_t rows,
                         double *column, size_t param, int value)
{
  char name[64];
  size_t row = 0;
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = case_of(w, c);
    if (done != NULL) {
      column[row++] = value >= 0 ? done->q[value] : done->p[param];
    }
  }
  if (value >= 0) {
    const struct dea_column *of =
        &w->case_key->quantities[(size_t)value % w->case_key->quantity_count].shown;
    dea_case_key_value_name(w->case_key, (size_t)value, name, sizeof name);
    dea_h5_write_array(h, group, name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, rows, column, of->si_unit,
                       of->meaning);
  } else {
    const struct dea_device_param *of = &w->case_key->params[param];
    dea_h5_write_array(h, group, of->param.name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, rows, column,
                       of->param.unit, "value in the design");
  }
}

enum { ID, REASON, FLAGS }; // FLAGS + k: at voltage k

/* A column of words. */
static void write_texts(struct h5 *h, const struct work *w, hid_t group, size_t rows, size_t what)
{
  static const size_t sizes[] = {DEA_CASE_ID_SIZE, DEA_CASE_WHY_SIZE, DEA_FLAGS_SIZE};
  static const char *const meanings[] = {"hash of the resolved design", "why a value is missing",
                                         "what a reader has to know of the numbers"};
  const size_t kind = what < FLAGS ? what : FLAGS, size = sizes[kind];
  char name[64];
  snprintf(name, sizeof name, "%s", what == ID ? "id" : "reason");
  if (kind == FLAGS) {
    dea_case_key_flags_name(w->case_key, what - FLAGS, name, sizeof name);
  }
  char *texts = dea_alloc(w->ctx, rows, size);
  size_t row = 0;
  if (texts == NULL) {
    h->status = DEA_E_MEMORY;
    return;
  }
  for (size_t c = 0; c < w->plan->count; c++) {
    const struct dea_case *done = case_of(w, c);
    if (done != NULL) {
      char *to = texts + size * row++, words[DEA_FLAGS_SIZE];
      snprintf(to, size, "%s",
               kind == FLAGS ? dea_flags_text(done->marks[what - FLAGS], words)
               : what == ID  ? done->id
                             : done->why);
    }
  }
  hid_t type = H5Tcopy(H5T_C_S1);
  H5Tset_size(type, size);
  dea_h5_write_array(h, group, name, type, type, rows, texts, "1", meanings[kind]);
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
      write_column(&h, w, group, rows, column, j, -1);
    }
    for (size_t i = 0; i < w->values; i++) {
      write_column(&h, w, group, rows, column, 0, (int)i);
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
    status = dea_sweep_draw(w->case_key, spreads, independent(w), doubted, w->format, w->folder);
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
