/* Files of other programs: read into a table of columns, which a mapping makes a recording of.
 *
 * A format is one file import_<name>.c and one line in import_list.h. */
#ifndef DEA_LAB_IMPORT_IMPORT_H
#define DEA_LAB_IMPORT_IMPORT_H

#include "base/schema.h"
#include "lab/recording/recording.h"

/* A column as the file has it. */
struct dea_table_column {
  char *name;             // "Dev1/ai0"; owned
  char *unit;             // as written, "": none; owned
  double start, interval; // of its samples when the file says so [s]; interval NAN: it does not
  double *values;         // [count], owned; NAN: missing
  size_t count;
};

struct dea_table {
  const char *file; // interned
  struct dea_table_column *columns;
  size_t column_count, column_room;
  char *note; // what the file says of itself; NULL; owned
};

struct dea_importer {
  const char *name;    // "csv"
  const char *formats; // "CSV with any separator", for help
  /* Whether a file looks like this format: its name, and its first bytes. */
  bool (*recognise)(const char *file, const unsigned char *head, size_t length);
  /* Reads the file's bytes (NULL with `whole` false, then from the file). Errors are findings with
   * line and column, or byte offset; DEA_E_IO then. */
  bool whole;
  dea_status (*read)(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                     size_t length, struct dea_table *out);
};

const struct dea_importer *const *dea_importer_all(size_t *count);
/* Adds an empty column with room for `room` values; NULL on failure. */
struct dea_table_column *dea_table_add(struct dea_context *ctx, struct dea_table *table,
                                       const char *name, size_t name_length, const char *unit,
                                       size_t unit_length, size_t room);

/* Reads a file with the format that recognises it, or the one of that name (NULL: any). out: owned
 * by the caller, NULL on failure. */
dea_status dea_table_read(struct dea_context *ctx, const char *file, const char *format,
                          struct dea_table **out);
void dea_table_destroy(struct dea_context *ctx, struct dea_table *table);

/* What columns mean; read from YAML, or guessed from names and units. */
struct dea_mapping;
dea_status dea_mapping_read(struct dea_context *ctx, const char *file, struct dea_mapping **out);
void dea_mapping_destroy(struct dea_context *ctx, struct dea_mapping *mapping);
extern const struct dea_record dea_mapping_record;

/* Makes a recording of a table. mapping: NULL guesses. What a column was taken for, and which ones
 * were left, become notes. out: owned by the caller, NULL on failure. */
dea_status dea_table_record(struct dea_context *ctx, const struct dea_table *table,
                            const struct dea_mapping *mapping, struct dea_recording **out);

#endif
