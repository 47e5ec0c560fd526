#include "io/breakdown_fit.h"

#include "base/file.h"
#include "base/version.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "figures/weibull_picture.h"
#include "io/fit_common.h"
#include "material/catalogue.h"
#include "result/provenance.h"
#include "table/csv_columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_MAX = 100000000 };

/* ---- the films ---- */

enum column { VOLTAGE, FIELD, THICKNESS, STRETCH, AREA, SURVIVED, COLUMNS };

static const struct dea_csv_wanted wanted[COLUMNS] = {
    [VOLTAGE] = DEA_CSV_COLUMN("voltage", "V", "1 kV", .title = "voltage (kV)", .filled = true),
    [FIELD] = DEA_CSV_COLUMN("field", "V/m", "80 V/um", .title = "field (V/um)", .filled = true),
    [THICKNESS] =
        DEA_CSV_COLUMN("thickness", "m", "100 um", .title = "thickness (um)", .filled = true),
    [STRETCH] = DEA_CSV_COLUMN("stretch", "1", "1.5", .title = "stretch", .filled = true),
    [AREA] = DEA_CSV_COLUMN("area", "m^2", "20 mm^2", .title = "area (mm^2)", .filled = true),
    [SURVIVED] =
        DEA_CSV_COLUMN("survived", "1", "1", .title = "survived", .needed = true, .filled = true),
};

/* What the file says for all films, or the table for each; both or neither are errors. */
static dea_status check_source(struct dea_context *ctx, const struct dea_breakdown_file *file,
                               const struct dea_csv_columns *table, enum column column,
                               const struct dea_quantity *all, const char *key)
{
  const bool given = all->origin != DEA_ABSENT, there = table->values[column] != NULL;
  if (given != there) {
    return DEA_OK;
  }
  return dea_finding_add(ctx, DEA_ERROR, file->tests.location,
                         given ? "'%.80s' has a column %s, which the fit file gives too: which "
                                 "one counts?"
                               : "'%.80s' has no column '%s', and the fit file does not give one "
                                 "for all films",
                         file->tests.text, given ? key : wanted[column].title);
}

static dea_status check_table(struct dea_context *ctx, const struct dea_breakdown_file *file,
                              const struct dea_csv_columns *table)
{
  DEA_TRY(ctx, check_source(ctx, file, table, THICKNESS, &file->thickness_m, "thickness"));
  DEA_TRY(ctx, check_source(ctx, file, table, STRETCH, &file->stretch, "stretch"));
  DEA_TRY(ctx, check_source(ctx, file, table, AREA, &file->area_m2, "area"));
  if ((table->values[VOLTAGE] == NULL) == (table->values[FIELD] == NULL)) {
    DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, file->tests.location,
                                 "'%.80s' needs one of the columns '%s' and '%s'", file->tests.text,
                                 wanted[VOLTAGE].title, wanted[FIELD].title));
  }
  for (size_t i = 0; i < table->rows; i++) {
    const struct dea_location here = {table->file, table->line[i], 1};
    for (int c = 0; c < COLUMNS; c++) {
      const double value = table->values[c] != NULL ? table->values[c][i] : 1;
      if (c == SURVIVED ? value != 0 && value != 1 : !(value > 0)) {
        DEA_TRY(ctx, dea_finding_add(
                         ctx, DEA_ERROR, here, "%s: %g, but it has to be %s", wanted[c].name, value,
                         c == SURVIVED ? "1, or 0 of a film that broke" : "more than 0"));
      }
    }
  }
  return DEA_OK;
}

static double of_row(const struct dea_csv_columns *table, enum column column,
                     const struct dea_quantity *all, size_t i)
{
  return table->values[column] != NULL ? table->values[column][i] : all->si;
}

static dea_status take_rows(struct dea_breakdown_fit *fit, const struct dea_csv_columns *table)
{
  const struct dea_breakdown_file *file = fit->file;
  struct dea_arena *memory = &fit->memory;
  const size_t n = fit->rows = table->rows;
  fit->tests_file = table->file;
  fit->line = dea_arena_alloc(memory, n, sizeof *fit->line);
  fit->field_V_per_m = dea_arena_alloc(memory, n, sizeof *fit->field_V_per_m);
  fit->stretch = dea_arena_alloc(memory, n, sizeof *fit->stretch);
  fit->thickness_m = dea_arena_alloc(memory, n, sizeof *fit->thickness_m);
  fit->area_m2 = dea_arena_alloc(memory, n, sizeof *fit->area_m2);
  fit->survived = dea_arena_alloc(memory, n, sizeof *fit->survived);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t i = 0; i < n; i++) {
    const double s = of_row(table, STRETCH, &file->stretch, i);
    const double h = of_row(table, THICKNESS, &file->thickness_m, i) / (s * s);
    fit->line[i] = table->line[i];
    fit->stretch[i] = s;
    fit->thickness_m[i] = h;
    fit->area_m2[i] = of_row(table, AREA, &file->area_m2, i);
    fit->field_V_per_m[i] =
        table->values[FIELD] != NULL ? table->values[FIELD][i] : table->values[VOLTAGE][i] / h;
    fit->survived[i] = table->values[SURVIVED][i] == 1;
  }
  return DEA_OK;
}

static dea_status read_films(struct dea_breakdown_fit *fit, const char *path)
{
  struct dea_context *ctx = fit->memory.ctx;
  struct dea_csv_columns table;
  char *bytes;
  size_t length;
  DEA_TRY(ctx, dea_file_read(ctx, path, FILE_MAX, &bytes, &length));
  dea_sha256_hex(bytes, length, fit->sha256);
  dea_free(ctx, bytes);
  DEA_TRY(ctx, dea_csv_columns_read(ctx, path, wanted, COLUMNS, &table));
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status = check_table(ctx, fit->file, &table);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) > errors) {
    status = dea_fail(ctx, DEA_E_IO, "'%.80s' has errors", path);
  }
  status = status == DEA_OK ? take_rows(fit, &table) : status;
  dea_csv_columns_free(ctx, &table);
  return status;
}

/* ---- the law ---- */

/* Geometric mean and how far values spread, as a ratio. */
static double mean_of(const double *values, size_t count, double *spread)
{
  double sum = 0, low = INFINITY, high = 0;
  for (size_t i = 0; i < count; i++) {
    sum += log(values[i]);
    low = fmin(low, values[i]);
    high = fmax(high, values[i]);
  }
  *spread = high / low;
  return exp(sum / (double)count);
}

/* Powers that the films can tell are found; those of the fit file and those that they cannot are
 * kept. */
static dea_status make_data(struct dea_breakdown_fit *fit)
{
  static const double differs = 1.03;
  const struct dea_breakdown_file *file = fit->file;
  double stretches, thicknesses, areas;
  double *unstretched = dea_arena_alloc(&fit->memory, fit->rows, sizeof *unstretched);
  DEA_TRY(fit->memory.ctx, dea_arena_status(&fit->memory));
  for (size_t i = 0; i < fit->rows; i++) {
    unstretched[i] = fit->thickness_m[i] * fit->stretch[i] * fit->stretch[i];
  }
  mean_of(fit->stretch, fit->rows, &stretches);
  mean_of(unstretched, fit->rows, &thicknesses);
  const double area = mean_of(fit->area_m2, fit->rows, &areas);
  double unused;
  const double thickness = mean_of(fit->thickness_m, fit->rows, &unused);
  const bool n_given = file->exponent.origin != DEA_ABSENT;
  const bool p_given = file->thickness_exponent.origin != DEA_ABSENT;
  fit->data = (struct dea_weibull_data){
      .rows = fit->rows,
      .field_V_per_m = fit->field_V_per_m,
      .stretch = fit->stretch,
      .thickness_m = fit->thickness_m,
      .area_m2 = fit->area_m2,
      .survived = fit->survived,
      .thickness0_m = file->thickness0_m.origin != DEA_ABSENT ? file->thickness0_m.si : thickness,
      .area0_m2 = file->area0_m2.origin != DEA_ABSENT ? file->area0_m2.si : area,
  };
  fit->data.held[DEA_WEIBULL_STRETCH] = n_given || stretches < differs;
  fit->data.held[DEA_WEIBULL_THICKNESS] = p_given || thicknesses < differs;
  fit->data.given[DEA_WEIBULL_STRETCH] = n_given ? file->exponent.si : 0;
  fit->data.given[DEA_WEIBULL_THICKNESS] = p_given ? file->thickness_exponent.si : 0;
  return DEA_OK;
}

/* Films that are meant to be alike differ by a few percent, which tells no power. */
static dea_status check_powers(const struct dea_breakdown_fit *fit)
{
  static const struct {
    enum dea_weibull_param param;
    const char *key, *what;
  } powers[] = {{DEA_WEIBULL_STRETCH, "exponent", "stretches"},
                {DEA_WEIBULL_THICKNESS, "thickness_exponent", "thicknesses"}};
  static const double large = 0.5; // of powers that are below 1 in all that is published
  static const double open = 10;   // the likelihood rises without end: all that differ survived
  for (size_t k = 0; k < 2; k++) {
    const double std = fit->fit.std[powers[k].param];
    if (std > open) {
      return dea_fail(fit->memory.ctx, DEA_E_ARGUMENT,
                      "the films do not limit the power of their %s: give %s in the fit file, 0 "
                      "where it is not known",
                      powers[k].what, powers[k].key);
    }
    if (std > large) {
      DEA_TRY(fit->memory.ctx,
              dea_finding_add(fit->memory.ctx, DEA_WARNING, fit->file->tests.location,
                              "the films' %s tell little of their power (%.2g +- %.2g), and other "
                              "films get a field by it: give %s in the fit file, 0 where it is not "
                              "known",
                              powers[k].what, fit->fit.value[powers[k].param], std, powers[k].key));
    }
  }
  return DEA_OK;
}

static dea_status run(void *made, const void *file)
{
  struct dea_breakdown_fit *fit = made;
  struct dea_context *ctx = fit->memory.ctx;
  fit->file = file;
  char *path = dea_path_beside(ctx, fit->file->head.file, fit->file->tests.text);
  dea_status status = path != NULL ? read_films(fit, path) : DEA_E_MEMORY;
  dea_free(ctx, path);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, make_data(fit));
  status = dea_weibull_solve(ctx, &fit->data, &fit->fit);
  status = status == DEA_OK ? check_powers(fit) : status;
  return dea_refuse_argument(ctx, fit->file->tests.location, status);
}

dea_status dea_breakdown_fit_run(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                 struct dea_breakdown_fit **out)
{
  dea_status status;
  *out = dea_fit_frame_make(ctx, sizeof **out, file, run, &status);
  return status;
}

void dea_breakdown_fit_destroy(struct dea_context *ctx, struct dea_breakdown_fit *fit)
{
  dea_fit_frame_destroy(ctx, fit);
}

double dea_breakdown_fit_quantile(const struct dea_breakdown_fit *fit, double share,
                                  double *log_std)
{
  return dea_weibull_quantile(&fit->fit, share, log_std);
}

double dea_breakdown_fit_stretch(const struct dea_breakdown_fit *fit)
{
  double unused;
  const bool known =
      !fit->data.held[DEA_WEIBULL_STRETCH] || fit->file->exponent.origin != DEA_ABSENT;
  return known ? 1 : mean_of(fit->stretch, fit->rows, &unused);
}

double dea_breakdown_fit_reference_field(const struct dea_breakdown_fit *fit, size_t i)
{
  const double *value = fit->fit.value;
  return fit->field_V_per_m[i] * pow(fit->stretch[i], -value[DEA_WEIBULL_STRETCH]) *
         pow(fit->thickness_m[i] / fit->data.thickness0_m, -value[DEA_WEIBULL_THICKNESS]) *
         pow(fit->area_m2[i] / fit->data.area0_m2, 1 / value[DEA_WEIBULL_SHAPE]);
}

/* ---- the material ---- */

static void add_power(struct dea_text *out, const struct dea_breakdown_fit *fit,
                      enum dea_weibull_param k, const struct dea_quantity *given, const char *key)
{
  if (!fit->data.held[k] || given->origin != DEA_ABSENT) {
    dea_text_add(out, ", %s: %.6g", key, fit->fit.value[k]);
    if (k == DEA_WEIBULL_THICKNESS) {
      dea_text_add(out, ", reference_thickness: %.6g m", fit->data.thickness0_m);
    }
  }
}

/* Text inside of quotation marks. */
static void add_words(struct dea_text *out, const char *text)
{
  for (const char *c = text; *c != '\0'; c++) {
    dea_text_add(out, *c == '"' || *c == '\\' ? "\\%c" : *c == '\n' ? " " : "%c", *c);
  }
}

/* The item of `breakdown`, in one line. */
static void add_law(struct dea_text *out, const struct dea_breakdown_fit *fit)
{
  const struct dea_breakdown_file *file = fit->file;
  const struct dea_weibull_fit *w = &fit->fit;
  dea_text_add(out, "[{id: fit, at_rest: %.6g V/m, value_range: [%.6g V/m, %.6g V/m]",
               w->value[DEA_WEIBULL_FIELD], w->low_95, w->high_95);
  add_power(out, fit, DEA_WEIBULL_STRETCH, &file->exponent, "exponent");
  add_power(out, fit, DEA_WEIBULL_THICKNESS, &file->thickness_exponent, "thickness_exponent");
  dea_text_add(out, ", weibull_shape: %.6g, reference_area: %.6g m^2, uncertainty: \"",
               w->value[DEA_WEIBULL_SHAPE], fit->data.area0_m2);
  dea_text_add(out,
               "value_range is the 95 %% interval of at_rest; standard uncertainties: at_rest "
               "%.3g V/um, weibull_shape %.2g",
               1e-6 * w->std[DEA_WEIBULL_FIELD], w->std[DEA_WEIBULL_SHAPE]);
  if (!fit->data.held[DEA_WEIBULL_STRETCH]) {
    dea_text_add(out, ", exponent %.2g", w->std[DEA_WEIBULL_STRETCH]);
  }
  if (!fit->data.held[DEA_WEIBULL_THICKNESS]) {
    dea_text_add(out, ", thickness_exponent %.2g", w->std[DEA_WEIBULL_THICKNESS]);
  }
  dea_text_add(out, "\", source: \"");
  if (file->head.source.text[0] != '\0') {
    add_words(out, file->head.source.text);
    dea_text_add(out, "; ");
  }
  dea_text_add(out, "dea %s fit of %s (SHA-256 %s) to %s (%s)\"", DEA_VERSION,
               dea_path_name(file->head.file), file->head.sha256, dea_path_name(fit->tests_file),
               fit->sha256);
  const double stretch = dea_breakdown_fit_stretch(fit);
  dea_text_add(out, ", note: \"%zu films, of which %zu broke; the others count as survivors",
               fit->rows, w->broken);
  if (fabs(stretch - 1) > 1e-9) {
    dea_text_add(out, "; at_rest is that of films at the stretch %.4g, all that were tested",
                 stretch);
  }
  dea_text_add(out, "\"}]");
}

/* The catalogue's material with another name and this law. */
static dea_status add_material(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                               struct dea_text *out)
{
  const struct dea_breakdown_file *file = fit->file;
  struct dea_catalogue_entry *entry;
  struct dea_text law = {.ctx = ctx};
  DEA_TRY(ctx, dea_catalogue_read(ctx, file->material.text, file->material.location, &entry));
  void *before = dea_c_locale_enter();
  add_law(&law, fit);
  dea_status status = law.failed ? DEA_E_MEMORY : DEA_OK;
  status =
      status == DEA_OK ? dea_yaml_override(ctx, entry->yaml, "name", file->head.name.text) : status;
  status = status == DEA_OK ? dea_yaml_override(ctx, entry->yaml, "breakdown", dea_text_get(&law))
                            : status;
  if (status == DEA_OK) {
    dea_text_add(out, "# Written by dea %s fit: %s with the breakdown law of %s.\n", DEA_VERSION,
                 file->material.text, dea_path_name(fit->tests_file));
    dea_yaml_write(dea_yaml_root(entry->yaml), out);
    status = out->failed ? DEA_E_MEMORY : DEA_OK;
  }
  dea_c_locale_leave(before);
  dea_text_free(&law);
  dea_catalogue_destroy(ctx, entry);
  return status;
}

/* ---- CSV and JSON ---- */

static void add_rows(struct dea_text *csv, const struct dea_breakdown_fit *fit)
{
  dea_text_add(csv, "line,field (V/um),survived,stretch,thickness (um),area (mm^2),"
                    "field on the reference (V/um),chance by the law\n");
  for (size_t i = 0; i < fit->rows; i++) {
    const double reference = dea_breakdown_fit_reference_field(fit, i);
    double std;
    const double z = dea_weibull_z(&fit->fit, reference, &std);
    dea_text_add(csv, "%zu,%.8g,%d,%.8g,%.8g,%.8g,%.8g,%.6g\n", fit->line[i],
                 1e-6 * fit->field_V_per_m[i], fit->survived[i], fit->stretch[i],
                 1e6 * fit->thickness_m[i], 1e6 * fit->area_m2[i], 1e-6 * reference,
                 -expm1(-exp(z)));
  }
}

json_t *dea_breakdown_fit_json(const struct dea_breakdown_fit *fit, const char *command)
{
  static const char *const keys[DEA_WEIBULL_PARAMS] = {"at_rest_V_per_m", "weibull_shape",
                                                       "exponent", "thickness_exponent"};
  json_t *root = dea_fit_json_begin(&fit->file->head, command), *list = json_array();
  dea_json_put_text(root, "tests", fit->tests_file);
  dea_json_put_text(root, "tests_sha256", fit->sha256);
  dea_json_put_count(root, "films", fit->rows);
  dea_json_put_count(root, "broken", fit->fit.broken);
  dea_json_put(root, "log_likelihood", fit->fit.log_likelihood);
  dea_json_put(root, "reference_thickness_m", fit->data.thickness0_m);
  dea_json_put(root, "reference_area_m2", fit->data.area0_m2);
  for (size_t k = 0; k < DEA_WEIBULL_PARAMS; k++) {
    json_t *object = json_object();
    dea_json_put_text(object, "name", keys[k]);
    dea_json_put(object, "value", fit->fit.value[k]);
    dea_json_put(object, "standard_uncertainty", fit->fit.std[k]);
    dea_json_put(object, "interval_low", fit->fit.low[k]);
    dea_json_put(object, "interval_high", fit->fit.high[k]);
    json_object_set_new(object, "fixed", json_boolean(fit->data.held[k]));
    json_array_append_new(list, object);
  }
  json_object_set_new(root, "parameters", list);
  dea_json_put(root, "at_rest_low_95_V_per_m", fit->fit.low_95);
  dea_json_put(root, "at_rest_high_95_V_per_m", fit->fit.high_95);
  return root;
}

/* ---- the figure ---- */

static dea_status draw(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                       const struct dea_plot_format *format, const char *directory)
{
  double *field = dea_alloc(ctx, fit->rows, sizeof *field);
  if (field == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < fit->rows; i++) {
    field[i] = dea_breakdown_fit_reference_field(fit, i);
  }
  const struct dea_weibull_picture picture = {
      .caption = "share of films that have broken over the true field on the reference film, and "
                 "Weibull's law of it",
      .x_label = "Field on the reference film (V/\302\265m)",
      .y_label = "Films broken (%)",
      .points = "films",
      .factor = 1e-6,
      .rows = fit->rows,
      .values = field,
      .survived = fit->survived,
      .fit = &fit->fit,
  };
  dea_status status = dea_weibull_draw(ctx, &picture, format, directory);
  dea_free(ctx, field);
  return status;
}

dea_status dea_breakdown_fit_folder(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                    const char *directory, bool force)
{
  static const char *const figures[] = {"fit"};
  return dea_fit_folder_make(ctx, directory, file->head.name.text, figures, 1, force);
}

dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const char *command, const struct dea_plot_format *format,
                                   const char *directory)
{
  struct dea_text csv = {.ctx = ctx}, material = {.ctx = ctx};
  void *before = dea_c_locale_enter();
  add_rows(&csv, fit);
  dea_c_locale_leave(before);
  dea_status status = add_material(ctx, fit, &material);
  if (status == DEA_OK) {
    status = dea_fit_folder_write(ctx, directory, fit->file->head.name.text, &material, &csv,
                                  dea_breakdown_fit_json(fit, command));
  }
  dea_text_free(&csv);
  dea_text_free(&material);
  DEA_TRY(ctx, status);
  return draw(ctx, fit, format, directory);
}
