/* Measurements as a fit takes them: stretch, nominal stress, uncertainty, in time where they are.
 */
#pragma once

#include "identify/fit_file.h"

/* Columns of a file as whoever read it lends them, in SI. */
struct dea_fit_raw {
  const char *file; // interned
  char sha256[65];  // of its bytes
  size_t rows;
  const size_t *line;                    // [rows] where each stands in the file
  const double *values[DEA_FIT_COLUMNS]; // [rows], NULL: not there
};

struct dea_fit_series {
  const struct dea_fit_test *test; // lent
  const char *file;
  char sha256[65];
  size_t rows;
  size_t *line;             // [rows]
  double *stretch;          // [rows]
  double *time_s;           // [rows], NULL: slow
  double *stress_Pa;        // [rows], NAN of a prediction
  double *std_Pa;           // [rows] standard uncertainty, NAN where none is given
  struct dea_coupon coupon; // the way through the rows
  size_t slack, repeated;   // rows that were left out
};

/* Memory of the arena. What is wrong becomes a finding with file and line, DEA_E_IO then; what is
 * only odd (slack rows, repeated rows, a stretch that is never reached) a warning. */
dea_status dea_fit_series_build(struct dea_arena *arena, const struct dea_fit_test *test,
                                const struct dea_fit_raw *raw, struct dea_fit_series *out);
