/* Tektronix TDS oscilloscopes: what the file says of itself stands beside the first samples.
 *
 *   Record Length,2.500000e+03,,-0.500000000000,   2.00000,
 *   Sample Interval,4.000000e-04,,-0.499600000000,   2.01005,
 *
 * A file has one channel; those of one shot are joined. Files of later models (MSO, DPO, MDO) have
 * their lines above the numbers, as format csv reads them. */
#include "import/import.h"

#include "base/text.h"
#include "table/text_file.h"
#include "table/text_rows.h"

enum { KEY, VALUE, BESIDE, TIME, SAMPLE, FIELDS, HEADER_LINES = 40 };

/* The fields of a line that has all of them. */
static bool part(struct dea_slice line, struct dea_slice out[FIELDS])
{
  size_t count = 0;
  while (count < FIELDS && dea_slice_field(&line, ',', &out[count])) {
    count++;
  }
  return count == FIELDS;
}

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  struct dea_lines lines = {(const char *)head, (const char *)head + length, 0};
  struct dea_slice line, fields[FIELDS];
  double time, sample;
  (void)file;
  return dea_text_file_is(head, length) && dea_lines_next(&lines, &line) && part(line, fields) &&
         dea_slice_is(fields[KEY], "Record Length") && dea_slice_number(fields[TIME], '.', &time) &&
         time == time && dea_slice_number(fields[SAMPLE], '.', &sample);
}

/* Names and units of the two columns, and what the file says of itself. */
static dea_status read_header(struct dea_context *ctx, struct dea_slice text,
                              struct dea_slice titles[FIELDS], struct dea_slice units[FIELDS],
                              struct dea_table *out)
{
  struct dea_lines lines = {text.text, text.text + text.length, 0};
  struct dea_slice line, fields[FIELDS];
  struct dea_text note = {.ctx = ctx};
  while (lines.line < HEADER_LINES && dea_lines_next(&lines, &line)) {
    if (!part(line, fields) || fields[KEY].length == 0) {
      continue;
    }
    dea_text_add(&note, "%s%.*s: %.*s", note.length > 0 ? "; " : "", (int)fields[KEY].length,
                 fields[KEY].text, (int)fields[VALUE].length, fields[VALUE].text);
    if (dea_slice_is(fields[KEY], "Source")) {
      titles[SAMPLE] = fields[VALUE];
    } else if (dea_slice_is(fields[KEY], "Vertical Units")) {
      units[SAMPLE] = fields[VALUE];
    } else if (dea_slice_is(fields[KEY], "Horizontal Units")) {
      units[TIME] = fields[VALUE];
    }
  }
  dea_status status =
      note.failed ? DEA_E_MEMORY : dea_table_note(ctx, out, dea_text_get(&note), note.length);
  dea_text_free(&note);
  return status;
}

static dea_status read_text(struct dea_context *ctx, struct dea_slice text, struct dea_table *out)
{
  static const struct dea_slice none = {"", 0};
  struct dea_slice titles[FIELDS] = {none, none, none, {"Time", 4}, {"sample", 6}};
  struct dea_slice units[FIELDS] = {none, none, none, {"s", 1}, none};
  bool texts[FIELDS] = {false};
  const struct dea_csv_dialect dialect = {.separator = ',',
                                          .decimal = '.',
                                          .count = FIELDS,
                                          .skipped = TIME,
                                          .data = text.text,
                                          .text = texts};
  DEA_TRY(ctx, read_header(ctx, text, titles, units, out));
  return dea_text_rows_read(ctx, text, &dialect, titles, units, out);
}

const struct dea_importer dea_import_tektronix = {
    .name = "tektronix",
    .formats = "CSV of Tektronix TDS oscilloscopes",
    .recognise = recognise,
    .read_text = read_text,
};
