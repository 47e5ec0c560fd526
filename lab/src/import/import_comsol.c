/* COMSOL's text exports: lines that begin with % and a name of their own above numbers.
 *
 * Spreadsheet: "% X  Y  w (um) @ t=0.1", then rows. Sectionwise: "% Coordinates", "% Elements
 * (...)" and "% Data (w (um))", each above its own rows. */
#include "import/import.h"

#include "table/text_file.h"
#include "table/text_rows.h"
#include "table/titles.h"

#include <string.h>

enum { HEAD_LINES = 200, NOTE_SIZE = 4000 };

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  struct dea_slice text = {(const char *)head, length};
  struct dea_lines lines = {text.text, text.text + length, 0};
  struct dea_slice line;
  (void)file;
  while (dea_text_file_is(head, length) && lines.line < 12 && dea_lines_next(&lines, &line) &&
         dea_slice_starts(line, "%")) {
    if (dea_slice_find(line, "COMSOL") < line.length || dea_slice_starts(line, "% Model:")) {
      return true;
    }
  }
  return false;
}

/* What stands above the numbers. */
struct header {
  struct dea_slice length_unit; // of coordinates; empty
  struct dea_slice titles;      // the last line before the numbers
  struct dea_slice last;        // line with % before the place that is looked at
  bool sections;
};

/* The text of a line with %, without that. */
static struct dea_slice bare(struct dea_slice line)
{
  line = dea_slice_trim(line);
  return dea_slice_trim((struct dea_slice){line.text + 1, line.length - 1});
}

static bool is_marked(struct dea_slice line)
{
  line = dea_slice_trim(line);
  return line.length > 0 && line.text[0] == '%';
}

/* "Length unit: m" and the like: the value, or false. */
static bool key_value(struct dea_slice line, const char *key, struct dea_slice *value)
{
  if (!dea_slice_starts(line, key)) {
    return false;
  }
  size_t n = strlen(key);
  *value = dea_slice_trim((struct dea_slice){line.text + n, line.length - n});
  return true;
}

static struct header read_header(struct dea_lines *lines)
{
  struct header header = {.length_unit = {"", 0}, .titles = {"", 0}};
  struct dea_lines ahead = *lines;
  struct dea_slice line;
  while (dea_lines_next(&ahead, &line) && (is_marked(line) || dea_csv_is_blank(line))) {
    *lines = ahead;
    if (!is_marked(line)) {
      continue;
    }
    line = bare(line);
    key_value(line, "Length unit:", &header.length_unit);
    header.titles = line;
    header.sections = header.sections || dea_slice_is(line, "Coordinates");
    if (dea_slice_is(line, "Coordinates")) {
      break;
    }
  }
  // "m, m" in tables of several
  size_t comma = dea_slice_find(header.length_unit, ",");
  header.length_unit.length = comma;
  return header;
}

/* Commas between numbers, or blanks. */
static char find_separator(struct dea_slice line)
{
  return memchr(line.text, ',', line.length) != NULL ? ',' : ' ';
}

/* Whether a title is a coordinate without a unit of its own. */
static bool is_place(struct dea_slice title)
{
  static const char *const names[] = {"x",     "y",     "z",          "r",
                                      "cpt1x", "cln1x", "arc length", "reversed arc length"};
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    if (dea_slice_is(title, names[i])) {
      return true;
    }
  }
  return false;
}

/* Unit of a title such as "w (um) @ t=0.1", which stays whole as a name. */
static void split_title(struct dea_context *ctx, struct dea_slice title, struct dea_slice *name,
                        struct dea_slice *unit)
{
  dea_title_split(ctx, title, name, unit);
  size_t at = dea_slice_find(title, "@");
  if (unit->length == 0 && at < title.length) {
    struct dea_slice before = dea_slice_trim((struct dea_slice){title.text, at}), ignored;
    dea_title_split(ctx, before, &ignored, unit);
    *name = title;
  }
}

/* Parts the titles and puts them, and their units, into names[count] and names[count ...]. */
static dea_status find_titles(struct dea_context *ctx, const struct dea_table *out,
                              const struct header *header, size_t count, char separator,
                              struct dea_slice *names)
{
  struct dea_slice *units = names + count;
  bool good = dea_titles_part(header->titles, separator, count, names);
  for (size_t i = 0; i < count; i++) {
    struct dea_slice title = good ? names[i] : (struct dea_slice){"", 0};
    split_title(ctx, title, &names[i], &units[i]);
    if (units[i].length == 0 && is_place(title)) {
      units[i] = header->length_unit;
    }
  }
  if (!good) {
    const struct dea_location location = {.file = out->file};
    return dea_finding_add(ctx, DEA_WARNING, location,
                           "the line '%% %.*s' does not name the %zu columns below: they are "
                           "called 'column 1' and so on",
                           (int)(header->titles.length < 60 ? header->titles.length : 60),
                           header->titles.text, count);
  }
  return DEA_OK;
}

/* Rows of numbers from the next line on, up to one with % or the end. */
static dea_status read_rows(struct dea_context *ctx, const struct dea_lines *lines,
                            struct dea_slice rest, const struct header *header,
                            struct dea_table *out)
{
  struct dea_lines ahead = {rest.text, rest.text + rest.length, lines->line};
  struct dea_slice first;
  if (!dea_lines_next(&ahead, &first)) {
    return dea_fail(ctx, DEA_E_IO, "'%s' has no numbers below line %zu", out->file, lines->line);
  }
  struct dea_csv_dialect dialect = {.decimal = '.', .data = rest.text, .line = lines->line};
  dialect.separator = find_separator(first);
  dialect.count = dea_slice_count(first, dialect.separator);
  if (dialect.count == 0 || dialect.count > DEA_TABLE_COLUMNS_MAX) {
    return dea_fail(ctx, DEA_E_IO, "'%s' has %zu columns, not 1 to %d", out->file, dialect.count,
                    (int)DEA_TABLE_COLUMNS_MAX);
  }
  struct dea_slice *names = dea_alloc(ctx, 2 * dialect.count, sizeof *names);
  dialect.text = names != NULL ? dea_alloc(ctx, dialect.count, sizeof *dialect.text) : NULL;
  dea_status status = DEA_E_MEMORY;
  if (dialect.text != NULL) {
    status = find_titles(ctx, out, header, dialect.count, dialect.separator, names);
  }
  if (status == DEA_OK) {
    status = dea_text_rows_read(ctx, rest, &dialect, names, names + dialect.count, out);
  }
  dea_free(ctx, dialect.text);
  dea_free(ctx, names);
  return status;
}

// Sectionwise ------------------------------------------------------------------------------------

/* Title of a section's columns: the positions of "Coordinates", or what "Data (w (um))" holds. */
static struct dea_slice section_titles(struct dea_slice line, size_t count)
{
  static const char *const positions[] = {"x", "x  y", "x  y  z"};
  if (dea_slice_is(line, "Coordinates") && count >= 1 && count <= 3) {
    return (struct dea_slice){positions[count - 1], strlen(positions[count - 1])};
  }
  size_t open = dea_slice_find(line, "(");
  if (open < line.length && line.text[line.length - 1] == ')') {
    return dea_slice_trim((struct dea_slice){line.text + open + 1, line.length - open - 2});
  }
  return line;
}

static dea_status read_section(struct dea_context *ctx, struct dea_slice title,
                               struct dea_slice length_unit, const struct dea_lines *lines,
                               struct dea_slice rows, struct dea_table *out)
{
  struct dea_lines ahead = {rows.text, rows.text + rows.length, 0};
  struct dea_slice first;
  if (dea_slice_starts(title, "Elements") || !dea_lines_next(&ahead, &first)) {
    return DEA_OK;
  }
  size_t count = dea_slice_count(first, find_separator(first));
  const struct header header = {.length_unit = length_unit, .titles = section_titles(title, count)};
  return read_rows(ctx, lines, rows, &header, out);
}

/* lines: behind "% Coordinates". */
static dea_status read_sections(struct dea_context *ctx, struct dea_lines lines,
                                struct dea_slice length_unit, struct dea_table *out)
{
  struct dea_slice title = {"Coordinates", 11}, line;
  struct dea_lines start = lines;
  while (true) {
    const char *end = lines.next;
    bool more = dea_lines_next(&lines, &line);
    if (more && !is_marked(line)) {
      continue;
    }
    struct dea_slice rows = {start.next, (size_t)(end - start.next)};
    DEA_TRY(ctx, read_section(ctx, title, length_unit, &start, rows, out));
    if (!more) {
      return DEA_OK;
    }
    title = bare(line);
    start = lines;
  }
}

static dea_status read_text(struct dea_context *ctx, struct dea_slice text, struct dea_table *out)
{
  const char *end = text.text + text.length;
  struct dea_lines lines = {text.text, end, 0};
  struct header header = read_header(&lines);
  size_t above = (size_t)(lines.next - text.text);
  DEA_TRY(ctx, dea_table_note(ctx, out, text.text, above < NOTE_SIZE ? above : NOTE_SIZE));
  if (header.sections) {
    return read_sections(ctx, lines, header.length_unit, out);
  }
  struct dea_slice rest = {lines.next, (size_t)(end - lines.next)};
  return read_rows(ctx, &lines, rest, &header, out);
}

const struct dea_importer dea_import_comsol = {
    .name = "comsol",
    .formats = "COMSOL's text export",
    .recognise = recognise,
    .read_text = read_text,
};
