/* LabVIEW's text measurements (.lvm).
 *
 * A header of keys, "***End_of_Header***", then segments: each with a header of its own (one value
 * a channel), a line of column titles, rows. With "Multi_Headings No" only the first segment has a
 * header. Blocks between "***Start_Special***" and "***End_Special***" are not of the measurement.
 * Source: NI, "Specification for the LabVIEW Measurement File (.lvm)". */
#include "import/import.h"
#include "table/clock_text.h"
#include "table/slices.h"
#include "table/text_file.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum { CHANNELS_MAX = 1024 };

enum x_columns { X_NONE, X_ONE, X_MULTI }; // columns of times

struct channel {
  struct dea_slice name, unit;
  // of the segment
  double x0, delta, clock_s; // start and step [s], time of day; NAN: not given
  double day;                // its date, since 1970; NAN: not given
  size_t samples;            // 0: not given
  double shift_s;            // what is added to its times
  double end_s;              // half a step behind its last sample
  // of a row
  double x_now, y_now;
  bool present;
  // of all
  double start_s, interval_s; // of the first segment
  double last_s;              // latest time
  double first_clock_s, first_day;
  size_t total;
  size_t missing;          // rows without it since the last one with it
  bool gap;                // a segment does not go on where the one before ended
  size_t column, x_column; // of the table; SIZE_MAX: none
};

struct lvm {
  struct dea_context *ctx;
  const char *file;
  struct dea_table *table;
  struct dea_lines lines;
  char separator, decimal;
  enum x_columns x;
  bool headings;         // each segment has a header
  bool first_empty;      // rows begin with the field of times, also when it is empty
  bool not_time;         // X is something else
  bool filling;          // second time: values are kept
  bool shared, own;      // one column of times for all channels, or one for each
  bool differ;           // the clocks of the channels
  size_t stride;         // fields a channel in the header of a segment
  size_t rows, x_column; // of that
  size_t segments, row, count;
  struct channel channels[CHANNELS_MAX]; // [count]
};

// Channels: clocks, samples, columns --------------------------------------------------------------

static const double day_s = 86400;

/* "13:05:07,25" in seconds; NAN for anything else. */
static double time_of_day(struct dea_slice text, char decimal)
{
  double sum = 0, value;
  for (int part = 0; part < 3; part++) {
    size_t n = dea_slice_find(text, ":");
    struct dea_slice number = {text.text, n};
    if ((n == text.length) != (part == 2) || number.length == 0 ||
        !dea_slice_number(number, decimal, &value) || !(value >= 0 && value < 61)) {
      return NAN;
    }
    sum = 60 * sum + value;
    text = (struct dea_slice){text.text + n + 1, part < 2 ? text.length - n - 1 : 0};
  }
  return sum;
}

/* "2026/03/02" in days since 1970; NAN for anything else. */
static double day_of(struct dea_slice text)
{
  char moment[40];
  double days, seconds;
  bool dated;
  snprintf(moment, sizeof moment, "%.*s 00:00:00", (int)(text.length < 20 ? text.length : 20),
           text.text);
  const struct dea_slice whole = {moment, strlen(moment)};
  return dea_clock_text(whole, &days, &seconds, &dated) && dated ? days : NAN;
}

/* Seconds of the segment's clock after that of the first segment; 0 when it is not known. Without
 * dates it is taken to be less than half a day before that, or after midnight. */
static double later(const struct channel *channel)
{
  double days = channel->day - channel->first_day;
  double s = channel->clock_s - channel->first_clock_s + (isnan(days) ? 0 : days * day_s);
  return isnan(s) ? 0 : s < -day_s / 2 ? s + day_s : s;
}

/* Before the rows of a segment, whose header was read. */
static void begin_segment(struct lvm *lvm)
{
  for (size_t i = 0; i < lvm->count; i++) {
    struct channel *channel = &lvm->channels[i];
    if (lvm->segments == 0) {
      channel->first_clock_s = channel->clock_s;
      channel->first_day = channel->day;
      channel->start_s = channel->x0;
      channel->interval_s = channel->delta;
      channel->last_s = -INFINITY;
      channel->missing = 0;
      channel->total = lvm->filling ? channel->total : 0;
    }
    channel->shift_s = later(channel);
    lvm->differ = lvm->differ || channel->x0 != lvm->channels[0].x0 ||
                  channel->delta != lvm->channels[0].delta ||
                  channel->shift_s != lvm->channels[0].shift_s;
    if (lvm->x == X_NONE && lvm->segments > 0) {
      // behind the end of the one before: its start goes on by itself
      channel->shift_s = channel->x0 > channel->end_s ? 0 : channel->shift_s;
      double due = channel->start_s + (double)channel->total * channel->interval_s;
      double start = channel->x0 + channel->shift_s;
      channel->gap = channel->gap || !(fabs(start - due) <= channel->interval_s / 2) ||
                     fabs(channel->delta - channel->interval_s) > 1e-9 * channel->interval_s;
    }
    channel->end_s = channel->x0 + channel->shift_s - 0.5 * channel->delta;
  }
}

/* Time of a row of a channel; rows of a segment that begins at 0 again come after its clock. */
static double row_time(const struct lvm *lvm, struct channel *channel, size_t row)
{
  if (lvm->x == X_NONE) {
    return channel->x0 + (double)row * channel->delta + channel->shift_s;
  }
  if (row == 0 && channel->x_now > channel->last_s) {
    channel->shift_s = 0; // its times go on by themselves
  }
  return channel->x_now + channel->shift_s;
}

static void add(struct lvm *lvm, size_t column, double value, size_t capacity)
{
  if (column != SIZE_MAX && lvm->table->columns[column].count < capacity) {
    lvm->table->columns[column].values[lvm->table->columns[column].count++] = value;
  }
}

/* The times that all channels share. */
static void keep_shared_time(struct lvm *lvm, size_t row)
{
  struct channel *first = &lvm->channels[0];
  double time = row_time(lvm, first, row);
  first->last_s = fmax(first->last_s, time);
  if (lvm->filling) {
    add(lvm, lvm->x_column, time, lvm->rows);
  } else {
    lvm->rows++;
  }
}

/* Counts, or keeps, the row whose numbers are in the channels; row: within the segment. */
static void keep_row(struct lvm *lvm, size_t row)
{
  bool own = lvm->x == X_MULTI || lvm->own;
  if (!own) {
    keep_shared_time(lvm, row);
  }
  for (size_t i = 0; i < lvm->count; i++) {
    struct channel *channel = &lvm->channels[i];
    bool beyond = lvm->headings && channel->samples > 0 && row >= channel->samples;
    bool present = channel->present && !beyond;
    if (beyond && !(lvm->filling && lvm->shared)) {
      continue;
    }
    if (present) {
      channel->end_s = channel->x0 + channel->shift_s + ((double)row + 0.5) * channel->delta;
    }
    if (!lvm->filling) { // what is missing at the end does not count
      channel->total += present ? channel->missing + 1 : 0;
      channel->missing = present ? 0 : channel->missing + 1;
    } else {
      add(lvm, channel->column, present ? channel->y_now : NAN, channel->total);
    }
    if (own) {
      double time = row_time(lvm, channel, row);
      channel->last_s = fmax(channel->last_s, time);
      add(lvm, lvm->filling ? channel->x_column : SIZE_MAX, time, channel->total);
    }
  }
}

/* A column for times; *column its index. */
static dea_status add_times(struct lvm *lvm, const char *name, size_t capacity, size_t *column)
{
  const char *unit = lvm->not_time ? "" : "s";
  *column = lvm->table->column_count;
  return dea_table_add(lvm->ctx, lvm->table, name, strlen(name), unit, strlen(unit), capacity) !=
                 NULL
             ? DEA_OK
             : dea_context_status(lvm->ctx);
}

static dea_status add_column(struct lvm *lvm, size_t i)
{
  struct channel *channel = &lvm->channels[i];
  char number[32], times[32] = "X_Value";
  struct dea_slice name = channel->name;
  channel->total = lvm->shared ? lvm->rows : channel->total;
  if (lvm->own) {
    if (i > 0) {
      snprintf(times, sizeof times, "X_Value %zu", i + 1);
    }
    DEA_TRY(lvm->ctx, add_times(lvm, times, channel->total, &channel->x_column));
  }
  if (name.length == 0) {
    snprintf(number, sizeof number, "channel %zu", i + 1);
    name = (struct dea_slice){number, strlen(number)};
  }
  channel->column = lvm->table->column_count;
  struct dea_table_column *column =
      dea_table_add(lvm->ctx, lvm->table, name.text, name.length, channel->unit.text,
                    channel->unit.length, channel->total);
  if (column == NULL) {
    return dea_context_status(lvm->ctx);
  }
  size_t clock = lvm->shared ? lvm->x_column : channel->x_column;
  if (clock != SIZE_MAX && !lvm->not_time) {
    column->clock = clock + 1;
  } else if (clock == SIZE_MAX) {
    column->start = channel->start_s;
    column->interval = channel->interval_s > 0 ? channel->interval_s : NAN;
  }
  return DEA_OK;
}

/* Between counting and keeping. */
static dea_status add_columns(struct lvm *lvm)
{
  bool gap = false;
  for (size_t i = 0; i < lvm->count; i++) {
    gap = gap || (lvm->channels[i].gap && lvm->channels[i].interval_s > 0);
    lvm->channels[i].x_column = SIZE_MAX;
    lvm->channels[i].column = SIZE_MAX;
  }
  lvm->filling = true;
  bool timed = lvm->x == X_NONE && gap;
  lvm->own = lvm->x == X_MULTI || (timed && lvm->differ);
  lvm->shared = lvm->x == X_ONE || (timed && !lvm->differ);
  lvm->x_column = SIZE_MAX;
  DEA_TRY(lvm->ctx, lvm->shared ? add_times(lvm, "X_Value", lvm->rows, &lvm->x_column) : DEA_OK);
  for (size_t i = 0; i < lvm->count; i++) {
    DEA_TRY(lvm->ctx, lvm->channels[i].total > 0 ? add_column(lvm, i) : DEA_OK);
  }
  if (timed) {
    const struct dea_location location = {.file = lvm->file};
    return dea_finding_add(lvm->ctx, DEA_NOTE, location,
                           "its %zu segments do not follow one another without a gap: every sample "
                           "gets its time",
                           lvm->segments);
  }
  return DEA_OK;
}

// The file ---------------------------------------------------------------------------------------

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  static const char name[] = "LabVIEW Measurement";
  (void)file;
  return length >= sizeof name - 1 && memcmp(head, name, sizeof name - 1) == 0;
}

/* A line inside of a special block, or one that begins or ends it. */
static bool skip_special(struct dea_slice line, bool *inside)
{
  bool starts = dea_slice_starts(line, "***Start_Special***");
  bool ends = dea_slice_starts(line, "***End_Special***");
  bool skipped = *inside || starts || ends;
  *inside = (*inside || starts) && !ends;
  return skipped;
}

/* The header of the file: keys and values parted by a tab, or by what "Separator" says. */
static dea_status read_header(struct lvm *lvm)
{
  struct dea_slice line;
  bool special = false;
  lvm->separator = '\t';
  lvm->decimal = '.';
  lvm->x = X_ONE;
  while (dea_lines_next(&lvm->lines, &line)) {
    struct dea_slice trimmed = dea_slice_trim(line);
    if (dea_slice_starts(trimmed, "***End_of_Header***")) {
      return DEA_OK;
    }
    if (skip_special(trimmed, &special)) {
      continue;
    }
    size_t n = 0;
    while (n < trimmed.length && strchr("\t,", trimmed.text[n]) == NULL) {
      n++;
    }
    struct dea_slice key = {trimmed.text, n}, value = {"", 0};
    if (n < trimmed.length) {
      value = (struct dea_slice){trimmed.text + n + 1, trimmed.length - n - 1};
      // "Separator" and "Decimal_Separator" may be the mark that parts the fields
      while (value.length > 1 && strchr("\t,", value.text[value.length - 1]) != NULL) {
        value.length--;
      }
      value = dea_slice_trim(value);
    }
    if (dea_slice_is(key, "Separator")) {
      lvm->separator = dea_slice_starts(value, "Comma") || dea_slice_is(value, ",") ? ',' : '\t';
    } else if (dea_slice_is(key, "Decimal_Separator")) {
      lvm->decimal = dea_slice_is(value, ",") ? ',' : '.';
    } else if (dea_slice_is(key, "X_Columns")) {
      lvm->x = dea_slice_starts(value, "No")      ? X_NONE
               : dea_slice_starts(value, "Multi") ? X_MULTI
                                                  : X_ONE;
    } else if (dea_slice_is(key, "Multi_Headings")) {
      lvm->headings = dea_slice_starts(value, "Yes");
    } else if (dea_slice_is(key, "Description") || dea_slice_is(key, "Project")) {
      DEA_TRY(lvm->ctx, dea_table_note(lvm->ctx, lvm->table, value.text, value.length));
    }
  }
  return dea_fail(lvm->ctx, DEA_E_IO, "'%s' has no line ***End_of_Header***", lvm->file);
}

// Segments ---------------------------------------------------------------------------------------

/* What field n of a row is: the times (true) or the values of channel *i, count: none. With
 * X_Columns No the first field is there, but empty. */
static bool find_field(const struct lvm *lvm, size_t n, size_t *i)
{
  if (lvm->x == X_MULTI) {
    *i = n / 2;
    return n % 2 == 0;
  }
  size_t shift = lvm->x == X_NONE && !lvm->first_empty ? 0 : 1;
  *i = n < shift ? 0 : n - shift;
  return n < shift;
}

/* Fields of a line that a key begins: "Samples\t10\t10". false for another line. */
static bool read_key(const struct lvm *lvm, struct dea_slice line, const char *key,
                     struct dea_slice *values)
{
  struct dea_slice rest = line, field;
  if (!dea_slice_field(&rest, lvm->separator, &field) || !dea_slice_is(field, key)) {
    return false;
  }
  *values = rest;
  return true;
}

static double number_of(const struct lvm *lvm, struct dea_slice field)
{
  double value;
  return dea_slice_number(field, lvm->decimal, &value) ? value : NAN;
}

/* What a line of a segment's header says of one channel. */
static void read_channel(const struct lvm *lvm, struct dea_slice key, struct dea_slice field,
                         struct channel *channel)
{
  double number = number_of(lvm, field);
  if (dea_slice_is(key, "Samples")) {
    channel->samples = number >= 0 && number < 1e15 ? (size_t)number : 0;
  } else if (dea_slice_is(key, "Delta_X")) {
    channel->delta = number;
  } else if (dea_slice_is(key, "X0")) {
    channel->x0 = isnan(number) ? 0 : number;
  } else if (dea_slice_is(key, "Y_Unit_Label")) {
    channel->unit = field;
  } else if (dea_slice_is(key, "Date")) {
    channel->day = day_of(field);
  } else if (dea_slice_is(key, "Time")) {
    channel->clock_s = time_of_day(field, lvm->decimal);
  }
}

/* Values of one line of a segment's header: a field a channel. With X_Columns Multi each column has
 * one, those of the times an empty one; where the second one of the samples is not empty, the file
 * is of a program that writes one a channel there too. */
static void read_channels(struct lvm *lvm, struct dea_slice line)
{
  struct dea_slice key, field;
  if (!dea_slice_field(&line, lvm->separator, &key)) {
    return;
  }
  for (size_t n = 0; dea_slice_field(&line, lvm->separator, &field); n++) {
    if (n == 0 && dea_slice_is(key, "X_Dimension")) {
      lvm->not_time = field.length > 0 && !dea_slice_is(field, "Time");
    }
    if (n == 1 && dea_slice_is(key, "Samples") && dea_slice_trim(field).length > 0) {
      lvm->stride = 1;
    }
    if (n % lvm->stride == 0 && n / lvm->stride < lvm->count) {
      read_channel(lvm, key, field, &lvm->channels[n / lvm->stride]);
    }
  }
}

static dea_status begin_channels(struct lvm *lvm, struct dea_slice values)
{
  struct dea_slice field;
  double count = dea_slice_field(&values, lvm->separator, &field) ? number_of(lvm, field) : NAN;
  if (!(count >= 1 && count <= CHANNELS_MAX)) {
    return dea_fail(lvm->ctx, DEA_E_IO,
                    "'%s', line %zu: the number of channels is none from 1 to %d", lvm->file,
                    lvm->lines.line, (int)CHANNELS_MAX);
  }
  if (lvm->segments > 0 && (size_t)count != lvm->count) {
    return dea_fail(lvm->ctx, DEA_E_IO,
                    "'%s', line %zu: a segment has %.0f channels and the first one %zu; write them "
                    "to files of their own",
                    lvm->file, lvm->lines.line, count, lvm->count);
  }
  lvm->count = (size_t)count;
  lvm->stride = lvm->x == X_MULTI ? 2 : 1;
  for (size_t i = 0; i < lvm->count; i++) {
    lvm->channels[i].delta = NAN;
    lvm->channels[i].x0 = 0;
    lvm->channels[i].clock_s = lvm->channels[i].day = NAN;
    lvm->channels[i].samples = 0;
  }
  return DEA_OK;
}

/* The header of a segment from `line` on, up to and with its end. */
static dea_status read_segment_header(struct lvm *lvm, struct dea_slice line)
{
  struct dea_slice values;
  bool special = false, known = false;
  do {
    if (dea_slice_starts(line, "***End_of_Header***")) {
      if (!known) {
        break;
      }
      return DEA_OK;
    }
    if (skip_special(line, &special)) {
      continue;
    }
    if (read_key(lvm, line, "Channels", &values)) {
      known = true;
      DEA_TRY(lvm->ctx, begin_channels(lvm, values));
    } else if (known) {
      read_channels(lvm, line);
    }
  } while (dea_lines_next(&lvm->lines, &line));
  return dea_fail(lvm->ctx, DEA_E_IO, "'%s', line %zu: the header of a segment %s", lvm->file,
                  lvm->lines.line,
                  known ? "does not end" : "does not say how many channels it has");
}

/* Channels of a later segment that have other names would be joined to those of the first. */
static dea_status check_titles(const struct lvm *lvm, struct dea_slice rest)
{
  struct dea_slice field;
  for (size_t n = 0; dea_slice_field(&rest, lvm->separator, &field); n++) {
    size_t i;
    if (find_field(lvm, n, &i) || i >= lvm->count) {
      continue;
    }
    const struct dea_slice first = lvm->channels[i].name;
    if (!dea_slice_same(field, first)) {
      return dea_fail(lvm->ctx, DEA_E_IO,
                      "'%s', line %zu: a segment has the channel '%.*s' where the first one has "
                      "'%.*s'; write them to files of their own",
                      lvm->file, lvm->lines.line, (int)(field.length < 40 ? field.length : 40),
                      field.text, (int)(first.length < 40 ? first.length : 40), first.text);
    }
  }
  return DEA_OK;
}

/* The titles of the columns: of the first segment they name the channels. */
static dea_status read_titles(struct lvm *lvm)
{
  struct dea_slice line, field;
  if (!dea_lines_next(&lvm->lines, &line)) {
    return DEA_OK; // a segment without rows
  }
  bool first_empty = true; // "X_Value" stands for the column of times, also when it is empty
  struct dea_slice rest = line;
  if (dea_slice_field(&rest, lvm->separator, &field)) {
    first_empty = field.length == 0 || dea_slice_starts(field, "X_Value");
  }
  lvm->first_empty = first_empty;
  rest = line;
  if (lvm->segments > 0) {
    return check_titles(lvm, line);
  }
  for (size_t n = 0; dea_slice_field(&rest, lvm->separator, &field); n++) {
    size_t i;
    if (!find_field(lvm, n, &i) && i < lvm->count) {
      lvm->channels[i].name = field;
    }
  }
  return DEA_OK;
}

/* Takes field n of a row. */
static dea_status read_field(struct lvm *lvm, struct dea_slice line, size_t n,
                             struct dea_slice field, bool *any)
{
  size_t i;
  double value;
  bool time = find_field(lvm, n, &i);
  if (i >= lvm->count || (time && lvm->x == X_NONE)) {
    return DEA_OK; // a comment, or the empty field of the times
  }
  if (!dea_slice_number(field, lvm->decimal, &value)) {
    const struct dea_location location = {lvm->file, lvm->lines.line,
                                          (size_t)(field.text - line.text) + 1};
    DEA_TRY(lvm->ctx, dea_finding_add(lvm->ctx, DEA_ERROR, location, "'%.*s' is not a number",
                                      (int)(field.length < 40 ? field.length : 40), field.text));
    return dea_fail(lvm->ctx, DEA_E_IO, "'%s' has lines that cannot be read", lvm->file);
  }
  if (!time) {
    lvm->channels[i].y_now = value;
    lvm->channels[i].present = field.length > 0;
    *any = *any || field.length > 0;
  }
  for (size_t k = i; time && k < (lvm->x == X_ONE ? lvm->count : i + 1); k++) {
    lvm->channels[k].x_now = value;
  }
  return DEA_OK;
}

/* One row; only counted before the columns are made. */
static dea_status read_row(struct lvm *lvm, struct dea_slice line)
{
  struct dea_slice rest = line, field;
  bool any = false;
  for (size_t i = 0; i < lvm->count; i++) {
    lvm->channels[i].x_now = NAN;
    lvm->channels[i].present = false;
  }
  for (size_t n = 0; dea_slice_field(&rest, lvm->separator, &field); n++) {
    DEA_TRY(lvm->ctx, read_field(lvm, line, n, field, &any));
  }
  if (any) {
    keep_row(lvm, lvm->row++);
  }
  return DEA_OK;
}

/* Rows up to the next segment's header, or the end. *line, *more: what follows. */
static dea_status read_rows(struct lvm *lvm, struct dea_slice *line, bool *more)
{
  bool special = false;
  lvm->row = 0;
  while ((*more = dea_lines_next(&lvm->lines, line))) {
    struct dea_slice values;
    if (skip_special(*line, &special) || dea_slice_trim(*line).length == 0) {
      continue;
    }
    if (read_key(lvm, *line, "Channels", &values)) {
      return DEA_OK;
    }
    DEA_TRY(lvm->ctx, read_row(lvm, *line));
  }
  return DEA_OK;
}

/* All segments; the first time samples are counted, the second time kept. */
static dea_status read_segments(struct lvm *lvm, struct dea_lines start)
{
  struct dea_slice line;
  bool more = true;
  lvm->segments = 0;
  lvm->lines = start;
  // blank lines and special blocks may stand before the first
  bool special = false;
  do {
    more = dea_lines_next(&lvm->lines, &line);
  } while (more && (dea_slice_trim(line).length == 0 || skip_special(line, &special)));
  while (more) {
    DEA_TRY(lvm->ctx, read_segment_header(lvm, line));
    DEA_TRY(lvm->ctx, read_titles(lvm));
    begin_segment(lvm);
    DEA_TRY(lvm->ctx, read_rows(lvm, &line, &more));
    lvm->segments++;
  }
  return lvm->segments > 0 ? DEA_OK
                           : dea_fail(lvm->ctx, DEA_E_IO, "'%s' holds no segment", lvm->file);
}

static dea_status read_measurement(struct lvm *lvm, struct dea_slice text)
{
  lvm->lines = (struct dea_lines){text.text, text.text + text.length, 0};
  DEA_TRY(lvm->ctx, read_header(lvm));
  struct dea_lines start = lvm->lines;
  DEA_TRY(lvm->ctx, read_segments(lvm, start));
  DEA_TRY(lvm->ctx, add_columns(lvm));
  return read_segments(lvm, start);
}

static dea_status read_text(struct dea_context *ctx, struct dea_slice text, struct dea_table *out)
{
  struct lvm *lvm = dea_alloc(ctx, 1, sizeof *lvm);
  DEA_TRY_MEMORY(lvm != NULL);
  lvm->ctx = ctx;
  lvm->file = out->file;
  lvm->table = out;
  dea_status status = read_measurement(lvm, text);
  dea_free(ctx, lvm);
  return status;
}

const struct dea_importer dea_import_lvm = {
    .name = "lvm",
    .formats = "LabVIEW's text measurements (.lvm)",
    .recognise = recognise,
    .read_text = read_text,
};
