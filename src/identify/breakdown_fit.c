#include "identify/breakdown_fit.h"

#include "base/file.h"
#include "result/provenance.h"
#include "table/csv_columns.h"

#include <math.h>

/* ---- the fit file ---- */

#define AT(member) offsetof(struct dea_breakdown_file, member)

static const struct dea_field fields[] = {
    DEA_FIT_HEAD_FIELDS("name of the material that is written", "my-silicone", "none",
                        "what the material is", "silicone film, batch 7"),
    DEA_LABEL_ROW("material", AT(material), "elastosil-2030",
                  "material of the catalogue whose law, permittivity and density are kept",
                  .required = true),
    DEA_LABEL_ROW(
        "breakdown", AT(tests), "breakdown.csv",
        "CSV table of films, counted from the folder of this file: 'voltage (kV)' or 'field "
        "(V/um)' at breakdown or the largest that was survived, 'survived' (1, or 0: it broke), "
        "and what differs of 'thickness (um)' unstretched, 'stretch', 'area (mm^2)'",
        .required = true),
    DEA_NUMBER_ROW("thickness", AT(thickness_m), "m", "100 um",
                   "thickness of all films, unstretched", .above_min = true, .max = 0.1,
                   .absent_text = "a column"),
    DEA_NUMBER_ROW("stretch", AT(stretch), "1", "1.5",
                   "stretch of all films, the mean one of the plane", .above_min = true, .max = 100,
                   .absent_text = "a column"),
    DEA_NUMBER_ROW("area", AT(area_m2), "m^2", "20 mm^2",
                   "area under the electrodes of all films, unstretched", .above_min = true,
                   .max = 10, .absent_text = "a column"),
    DEA_NUMBER_ROW("exponent", AT(exponent), "1", "0.63", "power of the stretch, where it is known",
                   .min = -10, .max = 10,
                   .absent_text = "found where stretches differ, else unknown"),
    DEA_NUMBER_ROW("thickness_exponent", AT(thickness_exponent), "1", "-0.25",
                   "power of the thickness, where it is known", .min = -10, .max = 10,
                   .absent_text = "found where unstretched thicknesses differ, else unknown"),
    DEA_NUMBER_ROW("reference_thickness", AT(thickness0_m), "m", "50 um",
                   "thickness, as stretched, that the field found belongs to", .above_min = true,
                   .max = 0.1, .absent_text = "the films' mean"),
    DEA_NUMBER_ROW("reference_area", AT(area0_m2), "m^2", "100 mm^2",
                   "unstretched area that the field found belongs to", .above_min = true, .max = 10,
                   .absent_text = "the films' mean"),
};
const struct dea_fit_form dea_breakdown_form = {
    {"fit file", "breakdown tests of a film, for Weibull's law of them", fields,
     sizeof fields / sizeof fields[0]},
    sizeof(struct dea_breakdown_file),
    NULL};

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

static dea_status read_rows(struct dea_breakdown_fit *fit, const struct dea_csv_columns *table)
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
  dea_sha256_file(path, fit->sha256);
  DEA_TRY(ctx, dea_csv_columns_read(ctx, path, wanted, COLUMNS, NULL, &table));
  const size_t errors = dea_finding_count(ctx, DEA_ERROR);
  dea_status status = check_table(ctx, fit->file, &table);
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) > errors) {
    status = dea_fail(ctx, DEA_E_IO, "'%.80s' has errors", path);
  }
  status = status == DEA_OK ? read_rows(fit, &table) : status;
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
static dea_status build_data(struct dea_breakdown_fit *fit)
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

dea_status dea_breakdown_fit_run(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                 struct dea_breakdown_fit *fit)
{
  *fit = (struct dea_breakdown_fit){.file = file, .memory = {.ctx = ctx}};
  char *path = dea_path_beside(ctx, fit->file->head.file, fit->file->tests.text);
  dea_status status = path != NULL ? read_films(fit, path) : DEA_E_MEMORY;
  dea_free(ctx, path);
  DEA_TRY(ctx, status);
  DEA_TRY(ctx, build_data(fit));
  status = dea_weibull_solve(ctx, &fit->data, &fit->fit);
  status = status == DEA_OK ? check_powers(fit) : status;
  return dea_refuse_argument(ctx, fit->file->tests.location, status);
}

void dea_breakdown_fit_free(struct dea_breakdown_fit *fit)
{
  dea_arena_free(&fit->memory);
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
