/* Columns of numbers of a CSV file, found by their titles. */
#pragma once

#include "base/units.h"

enum { DEA_CSV_COLUMNS_MAX = 64 };

/* A column that a file may have. */
struct dea_csv_wanted {
  const char *name;           // as dea_csv_fold writes it, "z std"
  const char *title;          // how it is written, for messages: "z std (um)"
  struct dea_measure measure; // what its unit becomes, {"m", "1 um"}
  bool needed;                // without it the file is of no use
  bool filled;                // every row has it
  const char *other[2];       // names that people use beside it, NULL: none
  bool strain;                // a column that is called a strain counts too: it is 1 less
};

#define DEA_CSV_COLUMN(its_name, its_unit, its_example, ...)                                       \
  {                                                                                                \
    .name = its_name, .measure = {its_unit, its_example}, __VA_ARGS__                              \
  }

struct dea_csv_columns {
  const char *file; // interned
  size_t rows;
  size_t *line;                        // [rows] where each stands; owned
  double *values[DEA_CSV_COLUMNS_MAX]; // [rows] in SI, NAN: empty field; owned, NULL: not there
};

/* Reads the columns wanted, count <= DEA_CSV_COLUMNS_MAX; others become notes and are left out.
 * Encoding, separators, preamble, titles and units as the reader of text tables finds them
 * (table/fields.h). All errors become findings with
 * file:line:column; DEA_E_IO then. out: freed by the caller after success, empty on failure. */
dea_status dea_csv_columns_read(struct dea_context *ctx, const char *file,
                                const struct dea_csv_wanted *wanted, size_t count,
                                struct dea_csv_columns *out);
/* Leaves it empty. */
void dea_csv_columns_free(struct dea_context *ctx, struct dea_csv_columns *columns);

/* Factor from the unit of a title ("um") to that of a measure. false: why says what does not fit,
 * or as dea_units_read. */
bool dea_csv_unit(struct dea_context *ctx, const char *unit, struct dea_measure due, double *factor,
                  char why[DEA_WHY_SIZE]);
