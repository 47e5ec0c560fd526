/* Files made of bytes in a test's folder, and the tables that are read from them. */
#pragma once

#include "failing_allocator.h"
#include "import/import.h"
#include "own_folder.h"
#include "testing.h"

#include <string.h>

static inline void write_bytes(const char *name, const void *bytes, size_t length)
{
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(bytes, 1, length, file), length);
  fclose(file);
}

static struct dea_table *table, *joined; // that was read last, and joined to it
static struct dea_recording *recording;  // that was made last

static inline int import_tear_down(void **state)
{
  dea_table_destroy(ctx, table);
  dea_table_destroy(ctx, joined);
  dea_recording_destroy(ctx, recording);
  return tear_down(state);
}

static inline dea_status read_table(const char *file)
{
  dea_table_destroy(ctx, table);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return dea_table_read(ctx, file, NULL, &table);
}

/* Reads a file with these bytes; the test fails when it cannot be read. */
static inline void read_bytes(const char *name, const void *bytes, size_t length)
{
  write_bytes(name, bytes, length);
  if (read_table(in_folder(name)) != DEA_OK) {
    size_t count;
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    fail_msg("%s: %s; %s", name, dea_context_message(ctx), count > 0 ? findings[0].text : "");
  }
}

static inline void read_text(const char *name, const char *text)
{
  read_bytes(name, text, strlen(text));
}

/* Joins another text to the table. */
static inline dea_status join_text(const char *name, const char *text)
{
  struct dea_table *first = table;
  table = NULL;
  read_text(name, text);
  dea_table_destroy(ctx, joined);
  joined = table;
  table = first;
  return dea_table_join(ctx, table, joined);
}

static inline struct dea_mapping *map_text(const char *text)
{
  struct dea_mapping *mapping;
  dea_finding_clear(ctx);
  if (dea_mapping_read_memory(ctx, "map.yaml", text, strlen(text), &mapping) != DEA_OK) {
    size_t count;
    fail_msg("%s", dea_finding_get(ctx, &count)[0].text);
  }
  return mapping;
}

/* Records the table; mapping: NULL guesses. */
static inline dea_status record_table(const struct dea_mapping *mapping)
{
  dea_recording_destroy(ctx, recording);
  return dea_table_record(ctx, table, mapping, &recording);
}

/* Records a text file; map: of a mapping, NULL guesses. */
static inline void record_file(const char *name, const char *text, const char *map)
{
  read_text(name, text);
  struct dea_mapping *mapping = map != NULL ? map_text(map) : NULL;
  if (record_table(mapping) != DEA_OK) {
    size_t count;
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    fail_msg("%s; %s", dea_context_message(ctx), count > 0 ? findings[count - 1].text : "");
  }
  dea_mapping_destroy(ctx, mapping);
}

static inline const struct dea_table_column *column_of(const char *name)
{
  for (size_t i = 0; i < table->column_count; i++) {
    if (strcmp(table->columns[i].name, name) == 0) {
      return &table->columns[i];
    }
  }
  fail_msg("no column '%s'; the first of %zu is '%s'", name, table->column_count,
           table->column_count > 0 ? table->columns[0].name : "");
  return NULL;
}

/* A column with this name and unit and exactly these values. */
static inline void assert_column(const char *name, const char *unit, const double *values,
                                 size_t count)
{
  const struct dea_table_column *column = column_of(name);
  assert_string_equal(column->unit, unit);
  assert_int_equal(column->count, count);
  for (size_t i = 0; i < count; i++) {
    if (!(column->values[i] == values[i] || (isnan(values[i]) && isnan(column->values[i])))) {
      fail_msg("%s[%zu] = %.17g, wanted %.17g", name, i, column->values[i], values[i]);
    }
  }
}

/* Bytes that must be refused: a finding or the message holds `part`, at line `line` unless 0. */
static inline void assert_refused(const char *name, const void *bytes, size_t length, size_t line,
                                  const char *part)
{
  size_t count;
  write_bytes(name, bytes, length);
  assert_int_equal(read_table(in_folder(name)), DEA_E_IO);
  assert_null(table);
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (strstr(findings[i].text, part) != NULL &&
        (line == 0 || findings[i].location.line == line)) {
      return;
    }
  }
  if (line > 0 || strstr(dea_context_message(ctx), part) == NULL) {
    fail_msg("'%s' (line %zu) is not said: %s; %s", part, line, dea_context_message(ctx),
             count > 0 ? findings[0].text : "");
  }
}

struct refused {
  const char *text;
  size_t line; // 0: of no line
  const char *part;
};

static inline void assert_all_refused(const char *name, const struct refused *cases, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    assert_refused(name, cases[i].text, strlen(cases[i].text), cases[i].line, cases[i].part);
  }
}

/* For failing_each: reads a file that is there. */
static inline void read_again(struct dea_context *own, const char *name)
{
  struct dea_table *again;
  failing_check(own, dea_table_read(own, in_folder(name), NULL, &again));
  dea_table_destroy(own, again);
}

/* Whether a finding of at least that severity holds a text. */
static inline bool is_said(enum dea_severity severity, const char *part)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (findings[i].severity == severity && strstr(findings[i].text, part) != NULL) {
      return true;
    }
  }
  return false;
}
