/* Reader of measurements (see dea_measurement_read in csv.h). */
#include "output/csv.h"

#include "base/csv_line.h"
#include "base/file.h"
#include "base/write_file.h"
#include "output/csv_columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIELD_MAX = DEA_CSV_FIELD_MAX, FIELDS_MAX = 64, FILE_MAX = 100000000, FINDINGS_MAX = 20 };

enum role { ROLE_VALUE, ROLE_STD, ROLE_STABLE, ROLE_MODES, ROLE_TRUSTED, ROLE_FLAGS };

struct field_meaning {
  enum role role;
  int column;    // of dea_point_columns
  double factor; // number in the file -> SI
};

struct reader {
  struct dea_context *ctx;
  const char *file;
  char separator;
  size_t line;
  struct field_meaning fields[FIELDS_MAX];
  size_t field_count;
  size_t errors;
};

/* Names that people use beside the headers and keys of the list; folded (see dea_csv_fold). */
static const struct {
  const char *name, *key;
} other_names[] = {
    {"voltage", "voltage_V"},         {"stretch", "electrode_stretch"},
    {"z center", "centre_z_m"},       {"centre z", "centre_z_m"},
    {"center z", "centre_z_m"},       {"fibre tip z", "fibre_tip_z_m"},
    {"z tip", "fibre_tip_z_m"},       {"z fiber tip", "fibre_tip_z_m"},
    {"field", "true_field_V_per_m"},  {"electrode edge u", "electrode_edge_u_m"},
    {"u edge", "electrode_edge_u_m"}, {"tension", "min_tension_N_per_m"},
    {"displacement", "centre_z_m"},   {"z", "centre_z_m"},
};
enum { OTHER_NAMES = sizeof other_names / sizeof other_names[0] };

static struct dea_location place_of(const struct reader *r, size_t column)
{
  return (struct dea_location){r->file, r->line, column};
}

/* Counts an error; false when its finding should no longer be added (too many, or no memory). */
static bool one_more_error(struct reader *r)
{
  return ++r->errors <= FINDINGS_MAX;
}

/* Column of a folded name, or -1; by_key: it is the key, whose name carries the SI unit. */
static int find_column(const char *name, bool *by_key)
{
  char folded[FIELD_MAX];
  *by_key = false;
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    dea_csv_fold(dea_point_columns[c].header, folded);
    if (strcmp(folded, name) == 0) {
      return c;
    }
    dea_csv_fold(dea_point_columns[c].key, folded);
    if (strcmp(folded, name) == 0) {
      *by_key = true;
      return c;
    }
  }
  for (int i = 0; i < OTHER_NAMES; i++) {
    if (strcmp(other_names[i].name, name) == 0) {
      return dea_point_column_find(other_names[i].key);
    }
  }
  return -1;
}

static void unknown_title(struct reader *r, const char *title, const char *name, size_t column)
{
  char store[2 * DEA_LOAD_POINT_COLUMNS][FIELD_MAX];
  const char *candidates[2 * DEA_LOAD_POINT_COLUMNS + OTHER_NAMES];
  int count = 0;
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++, count += 2) {
    dea_csv_fold(dea_point_columns[c].header, store[count]);
    dea_csv_fold(dea_point_columns[c].key, store[count + 1]);
    candidates[count] = store[count];
    candidates[count + 1] = store[count + 1];
  }
  for (int i = 0; i < OTHER_NAMES; i++) {
    candidates[count++] = other_names[i].name;
  }
  const char *nearest = dea_nearest_name(name, candidates, (size_t)count);
  if (!one_more_error(r)) {
    return;
  }
  if (nearest == NULL) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                    "'%s' is not a known quantity; known are, for example, 'V (kV)', 'z centre "
                    "(um)', 'electrode stretch', 'force (mN)'",
                    title);
    return;
  }
  bool by_key;
  char proper[96];
  dea_column_title(&dea_point_columns[find_column(nearest, &by_key)], proper, sizeof proper);
  dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                  "'%s' is not a known quantity; did you mean '%s'?", title, proper);
}

/* Sets field->factor from the unit in a title. */
static void read_unit(struct reader *r, const char *title, const char *unit, bool by_key,
                      size_t column, struct field_meaning *field)
{
  const struct dea_column *c = &dea_point_columns[field->column];
  char proper[96];
  dea_column_title(c, proper, sizeof proper);
  field->factor = 1.0;
  if (unit[0] == '\0') {
    if (!by_key && strcmp(c->si_unit, "1") != 0 && one_more_error(r)) {
      dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                      "'%s' needs a unit in parentheses, for example '%s'", title, proper);
    }
    return;
  }
  if (strcmp(unit, "%") == 0 && strcmp(c->si_unit, "1") == 0) {
    field->factor = 0.01;
    return;
  }
  char why[DEA_WHY_SIZE], example[32];
  snprintf(example, sizeof example, "1 %s", c->display_unit);
  const struct dea_measure due = {.unit = c->si_unit, .example = example};
  if (!dea_csv_unit(r->ctx, unit, due, &field->factor, why) && why[0] != '\0' &&
      one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column), "the unit in '%s' does not fit: %s",
                    title, why);
  }
}

/* Columns that are no quantities. */
static bool find_state(const char *name, enum role *role)
{
  static const struct {
    const char *name;
    enum role role;
  } states[] = {{"stable", ROLE_STABLE},
                {"unstable modes", ROLE_MODES},
                {"trusted", ROLE_TRUSTED},
                {"flags", ROLE_FLAGS}};
  for (size_t i = 0; i < sizeof states / sizeof states[0]; i++) {
    if (strcmp(states[i].name, name) == 0) {
      *role = states[i].role;
      return true;
    }
  }
  return false;
}

/* Cuts the word for an uncertainty from the end of a name; whether there was one. */
static bool take_std(char *name)
{
  static const char *const words[] = {"std", "err", "error", "uncertainty"};
  size_t length = strlen(name);
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    size_t n = strlen(words[i]);
    bool alone = strcmp(name, words[i]) == 0;
    if (alone ||
        (length > n && name[length - n - 1] == ' ' && strcmp(name + length - n, words[i]) == 0)) {
      name[alone ? 0 : length - n - 1] = '\0';
      return true;
    }
  }
  return false;
}

/* The quantity that a name means: of an uncertainty without one, that of the column before it. */
static int column_of(struct reader *r, const char *title, const char *name, size_t place,
                     bool *by_key)
{
  *by_key = false;
  if (name[0] == '\0' && r->field_count > 0) {
    return r->fields[r->field_count - 1].column;
  }
  if (strcmp(name, "displacement") == 0) {
    dea_finding_add(r->ctx, DEA_NOTE, place_of(r, place),
                    "'%s' is taken for that of the centre; 'z fibre tip' is that of the tip",
                    title);
  }
  return find_column(name, by_key);
}

static void read_title(struct reader *r, const char *title, size_t column,
                       struct field_meaning *field)
{
  char name[FIELD_MAX], unit[FIELD_MAX];
  bool by_key;
  dea_csv_split_title(title, name, unit);
  bool is_std = take_std(name);
  *field = (struct field_meaning){.role = is_std ? ROLE_STD : ROLE_VALUE, .factor = 1.0};
  if (find_state(name, &field->role)) {
    field->column = -1;
  } else {
    field->column = column_of(r, title, name, column, &by_key);
    if (field->column < 0) {
      unknown_title(r, title, name, column);
      return;
    }
    if (is_std && name[0] == '\0' && unit[0] == '\0') { // of the column before it in all
      field->factor = r->fields[r->field_count - 1].factor;
    } else {
      read_unit(r, title, unit, by_key, column, field);
    }
  }
  for (size_t i = 0; i < r->field_count; i++) {
    if (r->fields[i].role == field->role && r->fields[i].column == field->column &&
        one_more_error(r)) {
      dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column), "'%s' is there twice", title);
    }
  }
}

static void read_header(struct reader *r, const char *line)
{
  const char *cursor = line;
  char title[FIELD_MAX];
  size_t column;
  bool has_voltage = false;
  r->separator = dea_csv_separator(line);
  while (dea_csv_field(line, &cursor, r->separator, title, &column)) {
    if (r->field_count == FIELDS_MAX) {
      if (one_more_error(r)) {
        dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column), "more than %d columns", FIELDS_MAX);
      }
      return;
    }
    struct field_meaning field;
    read_title(r, title, column, &field);
    r->fields[r->field_count++] = field;
    has_voltage = has_voltage || (field.role == ROLE_VALUE && field.column == 0);
  }
  if (!has_voltage && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, 1), "no column of voltages such as 'V (kV)'");
  }
}

static void set_field(const struct field_meaning *field, double value, struct dea_load_point *point,
                      struct dea_load_point *std)
{
  switch (field->role) {
  case ROLE_VALUE:
    dea_point_set(point, field->column, value * field->factor);
    break;
  case ROLE_STD:
    dea_point_set(std, field->column, value * field->factor);
    break;
  case ROLE_STABLE:
    point->stable = value != 0.0;
    break;
  case ROLE_MODES:
    point->unstable_modes = value > 0.0 && value < 1e9 ? (int)value : 0;
    break;
  case ROLE_TRUSTED: // follows from the flags
  case ROLE_FLAGS:
    break;
  }
}

/* Reads a line of numbers; false when it has errors (then counted). */
static bool read_row(struct reader *r, const char *line, struct dea_load_point *point,
                     struct dea_load_point *std)
{
  const char *cursor = line;
  char text[FIELD_MAX];
  size_t column = 1, i = 0, before = r->errors;
  bool more = false;
  *point = *std = dea_load_point_empty();
  for (; dea_csv_field(line, &cursor, r->separator, text, &column); i++) {
    double value;
    if (i == r->field_count) {
      more = true;
      break;
    }
    char shown[FIELD_MAX];
    memcpy(shown, text, sizeof shown);
    if (r->fields[i].role == ROLE_FLAGS) {
      point->told = dea_flags_of_text(text);
    } else if (!dea_csv_number(r->separator, text, &value)) {
      if (one_more_error(r)) {
        dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column), "'%s' is not a number", shown);
      }
    } else {
      set_field(&r->fields[i], value, point, std);
    }
  }
  if ((more || i < r->field_count) && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                    "%s fields than the header, which has %zu", more ? "more" : "fewer",
                    r->field_count);
  } else if (r->errors == before && isnan(point->voltage_V) && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, 1), "a row without a voltage");
  }
  return r->errors == before;
}

static dea_status add_row(struct reader *r, struct dea_measurement *m, size_t *room_now,
                          const struct dea_load_point *point, const struct dea_load_point *std)
{
  if (m->curve.count == *room_now) {
    size_t room = *room_now > 0 ? 2 * *room_now : 64;
    void *moved = dea_resize(r->ctx, m->std, room, sizeof *m->std);
    m->std = moved != NULL ? moved : m->std;
    void *lines = moved != NULL ? dea_resize(r->ctx, m->line, room, sizeof *m->line) : NULL;
    if (lines == NULL) {
      return DEA_E_MEMORY;
    }
    m->line = lines;
    *room_now = room;
  }
  m->std[m->curve.count] = *std;
  m->line[m->curve.count] = r->line;
  return dea_curve_add_point(r->ctx, &m->curve, point);
}

/* Takes the lines of text one by one (they are cut in place). */
static dea_status read_lines(struct reader *r, char *text, struct dea_measurement *m)
{
  size_t room = 0;
  bool has_header = false;
  for (char *line; (line = dea_csv_line(&text, &r->line)) != NULL;) {
    if (!has_header) {
      has_header = true;
      read_header(r, line);
      if (r->errors > 0) {
        break; // without a header the rows say nothing
      }
      continue;
    }
    struct dea_load_point point, std;
    if (read_row(r, line, &point, &std)) {
      DEA_TRY(r->ctx, add_row(r, m, &room, &point, &std));
    }
  }
  if (m->curve.count == 0 && r->errors == 0 && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, 1), "no rows of numbers");
  }
  return DEA_OK;
}

static dea_status read_text(struct dea_context *ctx, const char *file, char *text, size_t length,
                            struct dea_measurement *m)
{
  struct reader r = {.ctx = ctx, .file = file};
  if (memchr(text, '\0', length) != NULL) {
    return dea_fail(ctx, DEA_E_IO, "%s is not a text file", file);
  }
  dea_context_clear(ctx); // so that the status below can only be of a finding
  dea_status status = read_lines(&r, text, m);
  if (status == DEA_OK && dea_context_status(ctx) != DEA_OK) {
    return dea_context_status(ctx); // a finding could not be kept, or there are no units
  }
  if (status == DEA_OK && r.errors > 0) {
    status = dea_fail(ctx, DEA_E_IO, "%s cannot be used: %zu error%s", file, r.errors,
                      r.errors == 1 ? "" : "s");
  }
  return status;
}

dea_status dea_measurement_read(struct dea_context *ctx, const char *file,
                                struct dea_measurement **out)
{
  *out = NULL;
  const char *name = dea_intern(ctx, file);
  if (name == NULL) {
    return DEA_E_MEMORY;
  }
  char *text;
  size_t length;
  dea_status read = dea_file_read(ctx, file, FILE_MAX, &text, &length);
  DEA_TRY(ctx, read == DEA_E_DESIGN ? dea_fail(ctx, DEA_E_IO, "'%s' is too large", file) : read);
  struct dea_measurement *m = dea_alloc(ctx, 1, sizeof *m);
  dea_status status = DEA_E_MEMORY;
  if (m != NULL) {
    m->file = name;
    m->curve = (struct dea_curve){.model = "measurement", .kind = "sweep", .complete = true};
    status = read_text(ctx, name, text, length, m);
  }
  dea_free(ctx, text);
  if (status != DEA_OK) {
    dea_measurement_destroy(ctx, m);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  *out = m;
  return DEA_OK;
}

void dea_measurement_destroy(struct dea_context *ctx, struct dea_measurement *measurement)
{
  if (measurement != NULL) {
    dea_free(ctx, measurement->curve.points);
    dea_free(ctx, measurement->std);
    dea_free(ctx, measurement->line);
    dea_free(ctx, measurement);
  }
}
