/* The tests of a fit file as they are read. */
#pragma once

#include "identify/fit.h"

/* The tests of a fit file, in its order. */
struct dea_fit_tests {
  struct dea_fit_series series[DEA_FIT_TESTS_MAX];
  size_t count;
  struct dea_arena memory;
};

/* Reads the CSV files of all tests, named from the fit file's folder. All errors become findings
 * with their places; DEA_E_IO then, or DEA_E_DESIGN. out: freed by the caller after success. */
dea_status dea_fit_tests_read(struct dea_context *ctx, const struct dea_fit_file *file,
                              struct dea_fit_tests *out);
void dea_fit_tests_free(struct dea_fit_tests *tests);
