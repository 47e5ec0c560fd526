/* A dataset that grows by rows while a program measures, and its reader that trusts nothing. */
#pragma once

#include "base/h5.h"

#include <stdint.h>

/* Rows wait in memory until there is a chunk of them or a flush; then they go straight to their
 * place in the file, never through a cache of HDF5, so that a flush writes only what is new. */
struct dea_recorded_series {
  hid_t set;
  size_t width;    // numbers in a row
  size_t capacity; // rows of a chunk, and of the buffer
  size_t used;     // rows waiting
  hsize_t stored;  // rows in the file
  double *rows;    // [room][width], owned
};

/* Makes an empty dataset of rows of `width` numbers: one-dimensional for 1. */
void dea_series_create(struct h5 *h, hid_t group, const char *name, size_t width, size_t capacity,
                       const char *unit, const char *meaning);
/* Opens it for writing. series: to be closed by the caller, also after a failure. */
void dea_series_open(struct h5 *h, hid_t group, const char *name, size_t width, size_t capacity,
                     struct dea_recorded_series *series);
void dea_series_close(struct dea_context *ctx, struct dea_recorded_series *series);
/* Appends rows: [count][width]. */
void dea_series_add(struct h5 *h, struct dea_recorded_series *series, const double *rows,
                    size_t count);
/* Everything appended is in the file after it, and found by a reader. */
void dea_series_flush(struct h5 *h, struct dea_recorded_series *series);

/* Reads all rows whose bytes the file really has, of numbers of any kind. *rows: [*count][width],
 * owned by the caller, NULL for none. *cut: whether rows are missing that the dataset counts. A
 * dataset of another shape, or one that claims more than its file holds, is a failure. */
void dea_series_read(struct h5 *h, hid_t group, const char *name, size_t width, double **rows,
                     size_t *count, bool *cut);
/* Length of the second dimension of a dataset; 1 for a one-dimensional one, 0 for others. */
size_t dea_series_width(struct h5 *h, hid_t group, const char *name);
