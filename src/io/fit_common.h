/* What the files of a fit of a material and of a device have in common. */
#pragma once

#include "io/fit_files.h"

enum { DEA_FIT_JSON_SCHEMA = 1 };

/* A new fit.json with program, command (NULL: none) and fit file. */
json_t *dea_fit_json_begin(const struct dea_fit_head *head, const char *command);
/* Adds value, uncertainty, interval and what is said of them. */
void dea_fit_json_value(json_t *object, const struct dea_fit_value *value);
/* A parameter of Weibull's law as an object. */
json_t *dea_fit_json_weibull(const struct dea_weibull_fit *fit, size_t param, const char *name);
/* Adds "correlations", chi-square, rows, condition. scatter_key: of the scatter, where no
 * uncertainty was given (known). */
void dea_fit_json_statistics(json_t *root, bool known, const char *scatter_key, double scatter,
                             const struct dea_lsq_fit *least_squares,
                             const struct dea_lsq_statistics *statistics);
/* Adds file, hash and number of rows of measurements, and how many of them count. */
void dea_fit_json_rows(json_t *object, const char *file, const char *sha256, size_t rows,
                       size_t slack_rows, double lag, double effective);
/* Adds "weak", and the next measurements as `next_key`, each called `word`. */
void dea_fit_json_advice(json_t *object, const char weak[][DEA_FIT_WEAK_SIZE], size_t weak_count,
                         const char *next_key, const char *word, const struct dea_fit_next *next,
                         size_t next_count);

/* Makes the folder, takes fit.json, fit.csv, NAME.yaml and the figures of an earlier fit out of it,
 * and writes NAME.yaml (yaml NULL: none), fit.csv and fit.json; root: taken. */
dea_status dea_fit_folder_write(struct dea_context *ctx, const struct dea_fit_folder *to,
                                const char *name, const char *const figures[], size_t figure_count,
                                const struct dea_text *yaml, const struct dea_text *csv,
                                json_t *root);
