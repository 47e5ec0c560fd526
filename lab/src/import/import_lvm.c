/* LabVIEW's text measurements (.lvm).
 *
 * A header of keys, "***End_of_Header***", then segments: each with a header of its own (one value
 * a channel), a line of column titles, rows. With "Multi_Headings No" only the first segment has a
 * header. Blocks between "***Start_Special***" and "***End_Special***" are not of the measurement.
 * Source: NI, "Specification for the LabVIEW Measurement File (.lvm)". */
#include "import/lvm.h"

#include "table/text_file.h"

#include <ctype.h>
#include <math.h>
#include <string.h>

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
static dea_status read_header(struct dea_lvm *lvm)
{
  struct dea_slice line;
  bool special = false;
  lvm->separator = '\t';
  lvm->decimal = '.';
  lvm->x = DEA_LVM_X_ONE;
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
      lvm->x = dea_slice_starts(value, "No")      ? DEA_LVM_X_NONE
               : dea_slice_starts(value, "Multi") ? DEA_LVM_X_MULTI
                                                  : DEA_LVM_X_ONE;
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
static bool find_field(const struct dea_lvm *lvm, size_t n, size_t *i)
{
  if (lvm->x == DEA_LVM_X_MULTI) {
    *i = n / 2;
    return n % 2 == 0;
  }
  size_t shift = lvm->x == DEA_LVM_X_NONE && !lvm->first_empty ? 0 : 1;
  *i = n < shift ? 0 : n - shift;
  return n < shift;
}

/* Fields of a line that a key begins: "Samples\t10\t10". false for another line. */
static bool read_key(const struct dea_lvm *lvm, struct dea_slice line, const char *key,
                     struct dea_slice *values)
{
  struct dea_slice rest = line, field;
  if (!dea_slice_field(&rest, lvm->separator, &field) || !dea_slice_is(field, key)) {
    return false;
  }
  *values = rest;
  return true;
}

static double number_of(const struct dea_lvm *lvm, struct dea_slice field)
{
  double value;
  return dea_slice_number(field, lvm->decimal, &value) ? value : NAN;
}

/* What a line of a segment's header says of one channel. */
static void read_channel(const struct dea_lvm *lvm, struct dea_slice key, struct dea_slice field,
                         struct dea_lvm_channel *channel)
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
    channel->day = dea_lvm_day(field);
  } else if (dea_slice_is(key, "Time")) {
    channel->clock_s = dea_lvm_time_of_day(field, lvm->decimal);
  }
}

/* Values of one line of a segment's header: a field a channel. With X_Columns Multi each column has
 * one, those of the times an empty one; where the second one of the samples is not empty, the file
 * is of a program that writes one a channel there too. */
static void read_channels(struct dea_lvm *lvm, struct dea_slice line)
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

static dea_status begin_channels(struct dea_lvm *lvm, struct dea_slice values)
{
  struct dea_slice field;
  double count = dea_slice_field(&values, lvm->separator, &field) ? number_of(lvm, field) : NAN;
  if (!(count >= 1 && count <= DEA_LVM_CHANNELS_MAX)) {
    return dea_fail(lvm->ctx, DEA_E_IO,
                    "'%s', line %zu: the number of channels is none from 1 to %d", lvm->file,
                    lvm->lines.line, (int)DEA_LVM_CHANNELS_MAX);
  }
  if (lvm->segments > 0 && (size_t)count != lvm->count) {
    return dea_fail(lvm->ctx, DEA_E_IO,
                    "'%s', line %zu: a segment has %.0f channels and the first one %zu; write them "
                    "to files of their own",
                    lvm->file, lvm->lines.line, count, lvm->count);
  }
  lvm->count = (size_t)count;
  lvm->stride = lvm->x == DEA_LVM_X_MULTI ? 2 : 1;
  for (size_t i = 0; i < lvm->count; i++) {
    lvm->channels[i].delta = NAN;
    lvm->channels[i].x0 = 0;
    lvm->channels[i].clock_s = lvm->channels[i].day = NAN;
    lvm->channels[i].samples = 0;
  }
  return DEA_OK;
}

/* The header of a segment from `line` on, up to and with its end. */
static dea_status read_segment_header(struct dea_lvm *lvm, struct dea_slice line)
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
static dea_status check_titles(const struct dea_lvm *lvm, struct dea_slice rest)
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
static dea_status read_titles(struct dea_lvm *lvm)
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
static dea_status read_field(struct dea_lvm *lvm, struct dea_slice line, size_t n,
                             struct dea_slice field, bool *any)
{
  size_t i;
  double value;
  bool time = find_field(lvm, n, &i);
  if (i >= lvm->count || (time && lvm->x == DEA_LVM_X_NONE)) {
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
  for (size_t k = i; time && k < (lvm->x == DEA_LVM_X_ONE ? lvm->count : i + 1); k++) {
    lvm->channels[k].x_now = value;
  }
  return DEA_OK;
}

/* One row; only counted before the columns are made. */
static dea_status read_row(struct dea_lvm *lvm, struct dea_slice line)
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
    dea_lvm_keep_row(lvm, lvm->row++);
  }
  return DEA_OK;
}

/* Rows up to the next segment's header, or the end. *line, *more: what follows. */
static dea_status read_rows(struct dea_lvm *lvm, struct dea_slice *line, bool *more)
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
static dea_status read_segments(struct dea_lvm *lvm, struct dea_lines start)
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
    dea_lvm_begin_segment(lvm);
    DEA_TRY(lvm->ctx, read_rows(lvm, &line, &more));
    lvm->segments++;
  }
  return lvm->segments > 0 ? DEA_OK
                           : dea_fail(lvm->ctx, DEA_E_IO, "'%s' holds no segment", lvm->file);
}

static dea_status read_measurement(struct dea_lvm *lvm, struct dea_slice text)
{
  lvm->lines = (struct dea_lines){text.text, text.text + text.length, 0};
  DEA_TRY(lvm->ctx, read_header(lvm));
  struct dea_lines start = lvm->lines;
  DEA_TRY(lvm->ctx, read_segments(lvm, start));
  DEA_TRY(lvm->ctx, dea_lvm_add_columns(lvm));
  return read_segments(lvm, start);
}

static dea_status read_text(struct dea_context *ctx, struct dea_slice text, struct dea_table *out)
{
  struct dea_lvm *lvm = dea_alloc(ctx, 1, sizeof *lvm);
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
