/* Tables as CSV: comma, decimal point, display units in the header. */
#pragma once

#include "base/csv_line.h"
#include "result/result.h"
#include "table/csv_columns.h"

/* "V (kV)": the header of a column, without unit when that is 1. */
enum { DEA_COLUMN_TITLE_SIZE = 224 };
void dea_column_title(const struct dea_column *column, char *out, size_t size);

/* Writes directory/MODEL_KIND.csv. Columns without any number are left out, a missing number is an
 * empty field. Digits: 12 significant. Columns "... std" come last, where they are known. */
dea_status dea_csv_write_curve(struct dea_context *ctx, const struct dea_curve *curve,
                               const char *directory);
/* Writes all tables of a result: curves, their events (MODEL_KIND_events.csv), profiles
 * (MODEL_profiles.csv), variants of studies (MODEL_STUDY.csv) with their profiles, and the tables
 * of studies that are for CSV. */
dea_status dea_csv_write(struct dea_context *ctx, const struct dea_result *result,
                         const char *directory);
/* Whether a result has anything that is written as CSV. */
bool dea_csv_has(const struct dea_result *result);
/* The name of the file of a table of a study. */
enum { DEA_RESULT_TABLE_FILE_SIZE = 3 * DEA_NAME_SIZE + 8 };
void dea_csv_table_name(const struct dea_result_table *table, char out[DEA_RESULT_TABLE_FILE_SIZE]);

/* Measurements: a curve, and the standard uncertainty of each value where given. */
struct dea_measurement {
  struct dea_curve curve;     // model "measurement", kind "sweep"
  struct dea_load_point *std; // [curve.count] uncertainty (1 sigma) of each, NAN: not given
  size_t *line;               // [curve.count] where each row stands
  const char *file;           // interned
};

/* Reads a table of measurements as the reader of text tables finds it (table/csv_text.h): its
 * titles are headers or keys of DEA_LOAD_POINT_LIST (or a common name of it, "voltage", "stretch")
 * with their units; a key with unit ("centre_z_m") needs none. " std" after the name marks the
 * standard uncertainty. An empty field is a missing value. A voltage column is needed. All errors
 * become findings with file:line:column; DEA_E_IO then. out: owned by the caller. */
dea_status dea_measurement_read(struct dea_context *ctx, const char *file,
                                struct dea_measurement **out);
void dea_measurement_destroy(struct dea_context *ctx, struct dea_measurement *measurement);

/* A quantity as a column of a file, named by its header or key, with an uncertainty; its texts are
 * of the arena. */
dea_status dea_csv_want_column(struct dea_arena *memory, const struct dea_column *column,
                               struct dea_csv_wanted *out);
