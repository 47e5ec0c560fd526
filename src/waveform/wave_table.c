/* Waveform "table": times and voltages from a CSV file, straight in between. */
#include "base/csv_line.h"
#include "base/file.h"
#include "base/units.h"
#include "waveform/wave_make.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FILE_MAX = 50000000, FINDINGS_MAX = 20, TIME = 0, VOLTAGE = 1 };
static const double voltage_max_V = 1e6; // as of the other kinds

struct raw {
  struct dea_label kind, file;
  struct dea_quantity repeat;
};

static const struct dea_field fields[] = {
    DEA_WAVE_KIND(struct raw),
    {.key = "file",
     .kind = DEA_FIELD_LABEL,
     .offset = offsetof(struct raw, file),
     .required = true,
     .doc = "CSV file with a header such as 'time (s),voltage (kV)', times rising from 0; two rows "
            "of one time are a jump; its path counts from the folder of the design file",
     .example = "drive.csv"},
    DEA_WAVE_CYCLES(struct raw, repeat, "repeat", "how often the table is played", "1"),
};

const struct dea_record dea_wave_table_record = {"table", "times and voltages from a CSV file",
                                                 fields, DEA_WAVE_COUNT(fields)};

/* Names of a column, ended by NULL, its unit and how a header is written. */
static const struct {
  const char *names[4], *unit, *example, *one;
} columns[2] = {{{"time", "t", NULL}, "s", "time (s)", "1 s"},
                {{"voltage", "v", "u", NULL}, "V", "voltage (kV)", "1 kV"}};

struct table {
  const struct dea_reader *reader;
  const char *file; // interned
  size_t line, errors, room;
  char separator;
  int of_field[2]; // number of the field of each column, -1: none
  size_t field_count;
  double factor[2];
  struct dea_waveform *out;
};

/* Where the next error may be reported; false when there were too many. */
static bool at_column(struct table *t, size_t column, struct dea_location *location)
{
  *location = (struct dea_location){t->file, t->line, column};
  return ++t->errors <= FINDINGS_MAX;
}

static dea_status read_unit(struct table *t, int c, const char *title, const char *unit,
                            size_t column)
{
  struct dea_context *ctx = t->reader->ctx;
  struct dea_location location;
  char one[DEA_CSV_FIELD_MAX + 2], why[DEA_WHY_SIZE] = "";
  if (unit[0] == '\0') {
    at_column(t, column, &location);
    return dea_finding_add(ctx, DEA_ERROR, location,
                           "'%s' needs a unit in parentheses, for example '%s'", title,
                           columns[c].example);
  }
  snprintf(one, sizeof one, "1 %s", unit);
  const struct dea_measure due = {columns[c].unit, columns[c].one};
  if (dea_units_read(ctx, one, due, &t->factor[c], why)) {
    return DEA_OK;
  }
  if (why[0] == '\0') {
    return dea_context_status(ctx);
  }
  at_column(t, column, &location);
  return dea_finding_add(ctx, DEA_ERROR, location, "the unit in '%s' does not fit: %s", title, why);
}

/* Column of that folded name, -1 when it is none of the two. */
static int find_column(const char *name)
{
  for (int c = 0; c < 2; c++) {
    for (size_t i = 0; columns[c].names[i] != NULL; i++) {
      if (strcmp(columns[c].names[i], name) == 0) {
        return c;
      }
    }
  }
  return -1;
}

static dea_status read_header(struct table *t, const char *line)
{
  struct dea_context *ctx = t->reader->ctx;
  const char *cursor = line;
  char title[DEA_CSV_FIELD_MAX], name[DEA_CSV_FIELD_MAX], unit[DEA_CSV_FIELD_MAX];
  size_t column;
  struct dea_location location;
  t->separator = dea_csv_separator(line);
  while (dea_csv_field(line, &cursor, t->separator, title, &column)) {
    dea_csv_split_title(title, name, unit);
    int c = find_column(name);
    if (c >= 0 && t->of_field[c] >= 0) {
      at_column(t, column, &location);
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "'%s' is there twice", title));
    } else if (c >= 0) {
      t->of_field[c] = (int)t->field_count;
      DEA_TRY(ctx, read_unit(t, c, title, unit, column));
    }
    t->field_count++; // other columns are of no matter here
  }
  for (int c = 0; c < 2; c++) {
    if (t->of_field[c] < 0) {
      at_column(t, 1, &location);
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "no column such as '%s'",
                                   columns[c].example));
    }
  }
  return DEA_OK;
}

/* Adds a row that was read; `column` of its time. */
static dea_status add_row(struct table *t, const double value[2], size_t column)
{
  struct dea_context *ctx = t->reader->ctx;
  struct dea_waveform *w = t->out;
  struct dea_location location;
  double last = w->knot_count > 0 ? w->knots[w->knot_count - 1].offset_s : 0;
  if (w->knot_count == 0 ? value[TIME] != 0 : value[TIME] < last) {
    return at_column(t, column, &location)
               ? dea_finding_add(ctx, DEA_ERROR, location,
                                 w->knot_count == 0 ? "times start at 0, not at %g s"
                                                    : "times rise; %g s comes too late",
                                 value[TIME])
               : DEA_OK;
  }
  if (w->knot_count == t->room) {
    struct dea_wave_knot *moved = dea_resize(ctx, w->knots, 2 * t->room, sizeof *moved);
    if (moved == NULL) {
      return DEA_E_MEMORY;
    }
    w->knots = moved;
    t->room *= 2;
  }
  dea_wave_add(w, 0, value[TIME], value[VOLTAGE]);
  return DEA_OK;
}

static dea_status read_row(struct table *t, const char *line)
{
  struct dea_context *ctx = t->reader->ctx;
  const char *cursor = line;
  char text[DEA_CSV_FIELD_MAX], shown[DEA_CSV_FIELD_MAX];
  size_t column = 1, number = 0, at[2] = {1, 1}, before = t->errors;
  double value[2] = {NAN, NAN};
  struct dea_location location;
  for (; dea_csv_field(line, &cursor, t->separator, text, &column); number++) {
    for (int c = 0; c < 2; c++) {
      memcpy(shown, text, sizeof shown);
      if ((int)number != t->of_field[c]) {
        continue;
      }
      at[c] = column;
      if (!dea_csv_number(t->separator, text, &value[c]) && at_column(t, column, &location)) {
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "'%s' is not a number", shown));
      }
      value[c] *= t->factor[c];
    }
  }
  if (t->errors == before && (isnan(value[0]) || isnan(value[1]))) {
    return at_column(t, at[isnan(value[0]) ? 0 : 1], &location)
               ? dea_finding_add(ctx, DEA_ERROR, location, "a row without a %s",
                                 isnan(value[0]) ? "time" : "voltage")
               : DEA_OK;
  }
  if (t->errors == before && !(fabs(value[1]) <= voltage_max_V)) {
    return at_column(t, at[1], &location)
               ? dea_finding_add(ctx, DEA_ERROR, location, "a voltage is at most 1 MV")
               : DEA_OK;
  }
  return t->errors == before ? add_row(t, value, at[TIME]) : DEA_OK;
}

static dea_status read_text(struct table *t, char *text)
{
  struct dea_context *ctx = t->reader->ctx;
  struct dea_location location;
  const char *header = dea_csv_line(&text, &t->line);
  if (header != NULL) {
    DEA_TRY(ctx, read_header(t, header));
  }
  if (t->errors > 0) {
    return DEA_OK; // without a header the rows say nothing
  }
  for (const char *line; (line = dea_csv_line(&text, &t->line)) != NULL;) {
    DEA_TRY(ctx, read_row(t, line));
  }
  const struct dea_waveform *w = t->out;
  if (t->errors == 0 && !(w->knot_count > 0 && w->knots[w->knot_count - 1].offset_s > 0)) {
    at_column(t, 1, &location);
    return dea_finding_add(ctx, DEA_ERROR, location, "a table needs two times at least");
  }
  return DEA_OK;
}

static dea_status make(const struct dea_reader *reader, const void *data, const char *beside,
                       struct dea_waveform *out)
{
  const struct raw *raw = data;
  struct dea_context *ctx = reader->ctx;
  struct table t = {.reader = reader, .room = 64, .of_field = {-1, -1}, .out = out};
  char *text = NULL, *path = dea_path_beside(ctx, beside, raw->file.text);
  size_t length;
  t.file = path != NULL ? dea_intern(ctx, path) : NULL;
  dea_status status =
      t.file != NULL ? dea_file_read(ctx, path, FILE_MAX, &text, &length) : DEA_E_MEMORY;
  dea_free(ctx, path);
  if (status == DEA_E_IO) {
    return dea_finding_add(ctx, DEA_ERROR, raw->file.location, "file: %s",
                           dea_context_message(ctx));
  }
  if (status == DEA_E_DESIGN) { // too large, which is a finding
    return DEA_OK;
  }
  DEA_TRY(ctx, status);
  status = dea_wave_room(ctx, out, t.room, 1);
  if (status == DEA_OK) {
    dea_wave_open(out, 0, 1, 1);
    status = read_text(&t, text);
  }
  dea_free(ctx, text);
  if (status == DEA_OK && t.errors == 0) {
    double length_s = out->knots[out->knot_count - 1].offset_s;
    out->blocks[0].frequency_Hz = 1 / length_s;
    out->blocks[0].cycles = (size_t)raw->repeat.si;
    out->end_s = raw->repeat.si * length_s;
  }
  return status;
}

const struct dea_wave_type dea_wave_table = {
    .name = "table",
    .record = &dea_wave_table_record,
    .raw_size = sizeof(struct raw),
    .make = make,
};
