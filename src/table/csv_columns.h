/* Columns of numbers of a CSV file, found by their titles. */
#pragma once

#include "base/arena.h"
#include "base/units.h"

/* A column that a file may have. */
struct dea_csv_wanted {
  const char *name;           // as dea_csv_fold writes it, "z"
  const char *title;          // how it is written, for messages: "z (um)"
  struct dea_measure measure; // what its unit becomes, {"m", "1 um"}
  bool needed;                // without it the file is of no use
  bool filled;                // every row has it
  const char *other[5];       // names that people use beside it, NULL: none
  bool strain;                // a column that is called a strain counts too: it is 1 less
  const char *key;            // name that says the unit, SI, likewise folded; NULL: none
  bool uncertain; // "z std", "z err" are its standard uncertainty; "err" is that of the column
                  // before
  const char *guess, *note;           // what a column of the name `guess` is said to be taken for
  double (*parse)(const char *words); // what is no number, up to DEA_CSV_FIELD_MAX bytes
};

#define DEA_CSV_COLUMN(its_name, its_unit, its_example, ...)                                       \
  {                                                                                                \
    .name = its_name, .measure = {its_unit, its_example}, __VA_ARGS__                              \
  }

struct dea_csv_columns {
  const char *file; // interned
  size_t rows;
  size_t *line;           // [rows] where each stands; owned
  double **values, **std; // [wanted][rows] in SI, NAN: empty field; NULL: not there
  struct dea_arena memory;
};

/* Reads the columns wanted [count]. Others become notes and are left out, or with `known`, which
 * says what there is ("'V (kV)', 'force (mN)'"), errors with the nearest title. Encoding,
 * separators, preamble, titles and units as the reader of text tables finds them
 * (table/csv_text.h). All errors become findings with file:line:column; DEA_E_IO then. out: freed
 * by the caller after success, empty on failure. */
dea_status dea_csv_columns_read(struct dea_context *ctx, const char *file,
                                const struct dea_csv_wanted *wanted, size_t count,
                                const char *known, struct dea_csv_columns *out);
/* Leaves it empty. */
void dea_csv_columns_free(struct dea_context *ctx, struct dea_csv_columns *columns);
