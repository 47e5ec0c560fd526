/* MATLAB's .mat files, through libmatio: a module that is loaded on demand (base/module.h).
 *
 * libmatio and the HDF5 below it keep state of their own: one thread at a time. */
#pragma once

#include "import/import.h"

enum dea_mat_version {
  DEA_MAT_5,  // what every MATLAB and Octave reads; at most 2 GB a variable
  DEA_MAT_73, // HDF5; any size
};

/* A variable to write: a column vector of doubles, or a text. */
struct dea_mat_variable {
  const char *name;     // letter first, then letters, digits, '_'; at most 63
  const char *text;     // UTF-8; NULL: numbers
  const double *values; // [count]; NULL with a text
  size_t count;         // 1: what MATLAB takes as a scalar
};

/* Writes a file with these variables, uncompressed; the same input gives the same bytes (version
 * 5). The file is complete or is not there; an old one of that name is replaced. DEA_E_ARGUMENT for
 * a name that MATLAB does not take or a variable too large for the version, DEA_E_UNSUPPORTED when
 * the module is not there, DEA_E_IO when the file cannot be written. */
dea_status dea_mat_write(struct dea_context *ctx, const char *file,
                         const struct dea_mat_variable *variables, size_t count,
                         enum dea_mat_version version);

/* Reads the variables of a file of version 4, 5 or 7.3 into the columns of a table: real numbers of
 * any class; a vector is a column, a matrix a column each, "z(1)", "z(2)", ..., at most
 * DEA_MAT_COLUMNS_MAX of them; fields of a struct "data.time". Texts go to the table's note. What
 * cannot be read (tables and other objects, cells, complex numbers) is said as a note. */
enum { DEA_MAT_COLUMNS_MAX = 4096 };
dea_status dea_mat_read(struct dea_context *ctx, const char *file, struct dea_table *out);

/* Path of the module into out[size]; false when it is not here. */
bool dea_mat_find(char *out, size_t size);

/* What the module exports as `dea_matio_module`. */
struct dea_mat_type {
  dea_status (*write)(struct dea_context *ctx, const char *file,
                      const struct dea_mat_variable *variables, size_t count,
                      enum dea_mat_version version);
  dea_status (*read)(struct dea_context *ctx, const char *file, struct dea_table *out);
};
