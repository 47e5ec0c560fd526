/* Files of other programs: read into a table of columns, which a mapping makes a recording of.
 *
 * A format is one file import_<name>.c and an entry in the list of importers.c. */
#pragma once

#include "base/schema.h"
#include "recording/recording.h"
#include "table/imported_table.h"

struct dea_importer {
  const char *name;    // "csv"
  const char *formats; // "CSV with any separator", for help
  /* Whether a file looks like this format: its name, and its first bytes, without UTF-8's mark. */
  bool (*recognise)(const char *file, const unsigned char *head, size_t length);
  /* One of these reads: the file's text (text_file.h), its bytes, or the file itself. Errors are
   * findings with line and column, or byte offset; DEA_E_IO then. */
  dea_status (*read_text)(struct dea_context *ctx, struct dea_slice text, struct dea_table *out);
  dea_status (*read_bytes)(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                           size_t length, struct dea_table *out);
  dea_status (*read_file)(struct dea_context *ctx, const char *file, struct dea_table *out);
};

const struct dea_importer *const *dea_importer_all(size_t *count);
/* Reads with one of them; bytes: of the file, not looked at by one that reads the file itself. out:
 * empty, filled also after a failure. */
dea_status dea_importer_read(struct dea_context *ctx, const struct dea_importer *importer,
                             const char *file, const unsigned char *bytes, size_t length,
                             struct dea_table *out);
/* Reads a file with the format that recognises it, or the one of that name (NULL: any). out: owned
 * by the caller, NULL on failure. */
dea_status dea_table_read(struct dea_context *ctx, const char *file, const char *format,
                          struct dea_table **out);

/* What a column may be by its name, whose words are in table/words.c: enum dea_channel_kind or
 * one of these, the last of which is of another column, "z std". */
enum { DEA_GUESS_TIME = -1, DEA_GUESS_NOTHING = -2, DEA_GUESS_UNCERTAINTY = -3 };
int dea_guess_by_name(const char *name);

/* What columns mean; read from YAML, or guessed from names and units. */
struct dea_mapping;
dea_status dea_mapping_read(struct dea_context *ctx, const char *file, struct dea_mapping **out);
/* The same from text; file: for messages. */
dea_status dea_mapping_read_memory(struct dea_context *ctx, const char *file, const char *bytes,
                                   size_t length, struct dea_mapping **out);
void dea_mapping_destroy(struct dea_context *ctx, struct dea_mapping *mapping);
extern const struct dea_record dea_mapping_record;

/* What is made of a column. */
enum dea_column_use {
  DEA_USE_LEFT,     // nothing
  DEA_USE_TIME,     // times of others
  DEA_USE_CLOCK,    // one number that is the rate or the interval of others
  DEA_USE_CHANNEL,  // a channel
  DEA_USE_PROFILE,  // a point of all frames of a profile sensor
  DEA_USE_POSITION, // where these points are
};
struct dea_column_role {
  enum dea_column_use use;
  enum dea_channel_kind kind; // of a channel
  double factor, offset;      // SI value = value * factor + offset
  size_t clock;               // 1 + the column with its times; 0: none
  double start_s, interval_s; // interval NAN: by its times
  const char *why;            // one clause for people, or why it is left; static or lent by mapping
};
/* What each column of a table is for; roles: [column_count]. mapping: NULL guesses. Errors are
 * findings in the mapping; DEA_E_DESIGN then. */
dea_status dea_table_roles(struct dea_context *ctx, const struct dea_table *table,
                           const struct dea_mapping *mapping, struct dea_column_role *roles);
/* Name of what a role takes a column for: "voltage", "time", "left". */
const char *dea_role_name(const struct dea_column_role *role);

/* Moves the columns of another table to the end of this one, which must have the same clock.
 * DEA_E_IO otherwise. */
dea_status dea_table_join(struct dea_context *ctx, struct dea_table *table,
                          struct dea_table *other);

/* Makes a recording of a table. mapping: NULL guesses. What a column was taken for, and which ones
 * were left, become notes. out: owned by the caller, NULL on failure. */
dea_status dea_table_record(struct dea_context *ctx, const struct dea_table *table,
                            const struct dea_mapping *mapping, struct dea_recording **out);
