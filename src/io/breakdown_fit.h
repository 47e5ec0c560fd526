/* A fit of breakdown tests: the films as they are read, Weibull's law of them, and its files. */
#pragma once

#include "base/arena.h"
#include "base/json.h"
#include "identify/breakdown_file.h"
#include "identify/weibull.h"
#include "plot/plot.h"

struct dea_breakdown_fit {
  struct dea_arena memory;               // the first member
  const struct dea_breakdown_file *file; // lent
  const char *tests_file;                // interned
  char sha256[65];                       // of its bytes
  size_t rows;
  size_t *line;                                            // [rows] of the table
  double *field_V_per_m, *stretch, *thickness_m, *area_m2; // [rows]; thickness as stretched
  bool *survived;                                          // [rows]
  struct dea_weibull_data data;                            // of the above
  struct dea_weibull_fit fit;
};

/* Reads the films and fits. What is wrong with them becomes findings with file and line, DEA_E_IO
 * then; else as dea_weibull_solve. out: owned by the caller, NULL on failure. */
dea_status dea_breakdown_fit_run(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                 struct dea_breakdown_fit **out);
void dea_breakdown_fit_destroy(struct dea_context *ctx, struct dea_breakdown_fit *fit);

/* Field at which that share of films breaks that are as the reference, and its standard
 * uncertainty, which counts on its logarithm. */
double dea_breakdown_fit_quantile(const struct dea_breakdown_fit *fit, double share,
                                  double *log_std);
/* Stretch to which the field found belongs: 1, or that of all films where no power of it is known.
 */
double dea_breakdown_fit_stretch(const struct dea_breakdown_fit *fit);
/* Field of a film over what the law gives it in place of the reference: on the reference. */
double dea_breakdown_fit_reference_field(const struct dea_breakdown_fit *fit, size_t i);

json_t *dea_breakdown_fit_json(const struct dea_breakdown_fit *fit, const char *command);
/* As dea_fit_folder. */
dea_status dea_breakdown_fit_folder(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                    const char *directory, bool force);
/* Writes NAME.yaml, the catalogue's material with this law of breakdown, fit.csv, fit.json and
 * figure fit: the share of broken films over the field, by Kaplan and Meier and by the law with its
 * band of two standard uncertainties. */
dea_status dea_breakdown_fit_write(struct dea_context *ctx, const struct dea_breakdown_fit *fit,
                                   const char *command, const struct dea_plot_format *format,
                                   const char *directory);
