/* MATLAB's .mat files, through libmatio: a module that is loaded on demand (base/module.h).
 *
 * libmatio and the HDF5 below it keep state of their own: one thread at a time. */
#pragma once

#include "import/import.h"

/* Path of the module into out[size]; false when it is not here. */
bool dea_mat_find(char *out, size_t size);

/* What the module exports as `dea_matio_module`. */
struct dea_mat_type {
  /* Reads the variables of a file of version 5 or 7.3 into the columns of a table: real numbers of
   * any class; a vector is a column, a matrix a column each, "z(1)", "z(2)", ..., at most
   * DEA_MAT_COLUMNS_MAX of them; fields of a struct "data.time". Texts go to the table's note. What
   * cannot be read (tables and other objects, cells, complex numbers) is said as a note. */
  dea_status (*read)(struct dea_context *ctx, const char *file, struct dea_table *out);
};
enum { DEA_MAT_COLUMNS_MAX = 4096 };
