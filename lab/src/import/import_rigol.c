/* Rigol oscilloscopes: the first line has names, and where the samples begin and how far apart they
 * are, at its end (MSO5000) or in the line below it (DS1000Z).
 *
 *   Time(s),CH1V,CH2V,t0 =-0.2, tInc = 0.001,      X,CH1,CH2,Start,Increment,
 *   -2.000000e-01,2.0000,0.0100,                   Sequence,VOLT,VOLT,-2.0e-01,1.0e-03
 *                                                  0,2.00e+00,1.00e-02, */
#include "import/import.h"

#include "table/text_file.h"
#include "table/text_rows.h"

#include <math.h>

enum { NAMES_MAX = 16 };

struct head {
  struct dea_slice titles[NAMES_MAX], units[NAMES_MAX]; // [count]
  size_t count;
  size_t lines;               // of the file that it takes
  double start_s, interval_s; // NAN: not said
};

/* "tInc = 0.001": the number; false when it is another word. */
static bool value_of(struct dea_slice field, const char *key, double *value)
{
  size_t equals = dea_slice_find(field, "=");
  if (equals == field.length ||
      !dea_slice_is(dea_slice_trim((struct dea_slice){field.text, equals}), key)) {
    return false;
  }
  struct dea_slice number =
      dea_slice_trim((struct dea_slice){field.text + equals + 1, field.length - equals - 1});
  if (number.length > 0 && number.text[number.length - 1] == 's') {
    number = dea_slice_trim((struct dea_slice){number.text, number.length - 1});
  }
  return dea_slice_number(number, '.', value);
}

/* The field at an index of a line. */
static bool field_at(struct dea_slice line, size_t index, struct dea_slice *out)
{
  bool found = true;
  for (size_t i = 0; i <= index && found; i++) {
    found = dea_slice_field(&line, ',', out);
  }
  return found;
}

/* "CH1V": the channel and its unit. */
static void split_unit(struct dea_slice *title, struct dea_slice *unit)
{
  const size_t last = title->length - 1;
  const char letter = title->text[last];
  if (title->length > 3 && dea_slice_starts(*title, "CH") &&
      (letter == 'V' || letter == 'A' || letter == 'W')) {
    *unit = (struct dea_slice){title->text + last, 1};
    title->length = last;
  }
}

/* Whether a text begins with such lines. */
static bool read_head(struct dea_slice text, struct head *out)
{
  struct dea_lines lines = {text.text, text.text + text.length, 0};
  struct dea_slice first, second = {"", 0}, rest, field;
  *out = (struct head){.lines = 1, .start_s = NAN, .interval_s = NAN};
  if (!dea_lines_next(&lines, &first)) {
    return false;
  }
  bool below = dea_lines_next(&lines, &second), named = true;
  rest = first;
  for (size_t i = 0; dea_slice_field(&rest, ',', &field); i++) {
    struct dea_slice value = {"", 0};
    bool start = dea_slice_is(field, "Start"), step = dea_slice_is(field, "Increment");
    if (start || step) {
      out->lines = 2;
      if (!below || !field_at(second, i, &value) ||
          !dea_slice_number(value, '.', start ? &out->start_s : &out->interval_s)) {
        return false;
      }
    } else if (!value_of(field, "t0", &out->start_s) &&
               !value_of(field, "tInc", &out->interval_s)) {
      if (field.length == 0) {
        continue;
      }
      if (!named || out->count == NAMES_MAX) {
        return false;
      }
      out->units[out->count] = (struct dea_slice){"", 0};
      out->titles[out->count++] = field;
      continue;
    }
    named = false; // names stand before these
  }
  for (size_t i = 0; i < out->count; i++) {
    if (out->lines == 2) {
      field_at(second, i, &out->units[i]);
    } else {
      split_unit(&out->titles[i], &out->units[i]);
    }
  }
  bool ours = out->count > 0 && (out->lines == 1 || (dea_slice_is(out->titles[0], "X") &&
                                                     dea_slice_is(out->units[0], "Sequence")));
  return ours && out->start_s == out->start_s && out->interval_s > 0;
}

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  struct head read;
  (void)file;
  return dea_text_file_is(head, length) &&
         read_head((struct dea_slice){(const char *)head, length}, &read);
}

/* Times are written with seven digits, which are fewer than samples have: those that the header
 * tells take their place, where all are the same to these digits. */
static void sharpen(struct dea_table_column *times, const struct head *head)
{
  bool same = true;
  for (size_t i = 0; i < times->count && same; i++) {
    const double exact = head->start_s + (double)i * head->interval_s;
    same = fabs(times->values[i] - exact) <= 1e-6 * fabs(exact) + 0.01 * head->interval_s;
  }
  for (size_t i = 0; i < times->count && same; i++) {
    times->values[i] = head->start_s + (double)i * head->interval_s;
  }
}

static dea_status read_text(struct dea_context *ctx, struct dea_slice text, struct dea_table *out)
{
  struct head head;
  bool texts[NAMES_MAX] = {false};
  if (!read_head(text, &head)) {
    return dea_fail(ctx, DEA_E_IO,
                    "'%s' does not begin with the names of a Rigol oscilloscope, and with where "
                    "its samples begin and how far apart they are",
                    out->file);
  }
  struct dea_lines lines = {text.text, text.text + text.length, 0};
  struct dea_slice line;
  while (lines.line < head.lines && dea_lines_next(&lines, &line)) {
  }
  DEA_TRY(ctx, dea_table_note(ctx, out, text.text, (size_t)(lines.next - text.text)));
  const bool counted = dea_slice_is(head.titles[0], "X"), // by samples from `start` on
      timed = dea_slice_starts(head.titles[0], "Time");
  if (counted) {
    head.titles[0] = (struct dea_slice){"Time", 4};
    head.units[0] = (struct dea_slice){"s", 1};
  }
  const struct dea_csv_dialect dialect = {.separator = ',',
                                          .decimal = '.',
                                          .count = head.count,
                                          .data = lines.next,
                                          .line = lines.line,
                                          .text = texts};
  DEA_TRY(ctx, dea_text_rows_read(ctx, text, &dialect, head.titles, head.units, out));
  for (size_t i = 0; counted && i < out->columns[0].count; i++) {
    out->columns[0].values[i] = head.start_s + out->columns[0].values[i] * head.interval_s;
  }
  if (timed) {
    sharpen(&out->columns[0], &head);
  }
  for (size_t i = 0; i < out->column_count && !counted && !timed; i++) {
    out->columns[i].start = head.start_s;
    out->columns[i].interval = head.interval_s;
  }
  return DEA_OK;
}

const struct dea_importer dea_import_rigol = {
    .name = "rigol",
    .formats = "CSV of Rigol oscilloscopes",
    .recognise = recognise,
    .read_text = read_text,
};
