/* Reader of measurements (see dea_measurement_read in csv.h). */
#include "io/csv.h"

#include "base/csv_line.h"
#include "table/csv_columns.h"
#include "table/fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIELD_MAX = DEA_CSV_FIELD_MAX, FIELDS_MAX = 512, FINDINGS_MAX = 20 };

enum role { ROLE_VALUE, ROLE_STD, ROLE_STABLE, ROLE_MODES, ROLE_TRUSTED, ROLE_FLAGS };

struct field_meaning {
  enum role role;
  int column;    // of the context
  double factor; // number in the file -> SI
};

struct reader {
  struct dea_context *ctx;
  struct dea_fields table;
  struct field_meaning fields[FIELDS_MAX];
  struct dea_text_marks marks[FIELDS_MAX];
  size_t field_count;
  size_t errors;
  struct dea_arena memory;                  // of the two below
  struct dea_monitor_values *row, *row_std; // of the columns of monitors that the file has
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

/* Where the title of a column stands. */
static struct dea_location place_of(const struct reader *r, size_t column)
{
  return dea_fields_place(&r->table, r->table.titles[column]);
}

/* Counts an error; false when its finding should no longer be added (too many, or no memory). */
static bool one_more_error(struct reader *r)
{
  return ++r->errors <= FINDINGS_MAX;
}

/* Column of a folded name, or -1; by_key: it is the key, whose name carries the SI unit. */
static int find_column(const struct dea_context *ctx, const char *name, bool *by_key)
{
  char folded[FIELD_MAX];
  *by_key = false;
  for (int c = 0; c < dea_column_count(ctx); c++) {
    dea_csv_fold(dea_column_at(ctx, c)->header, folded);
    if (strcmp(folded, name) == 0) {
      return c;
    }
    dea_csv_fold(dea_column_at(ctx, c)->key, folded);
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

/* The name nearest to one that is none; empty where none is near. Titles and keys of the columns,
 * and the other names. */
static dea_status find_nearest(struct reader *r, const char *name, char nearest[FIELD_MAX])
{
  const size_t count = (size_t)dea_column_count(r->ctx), all = 2 * count + OTHER_NAMES;
  struct dea_arena memory = {.ctx = r->ctx};
  char(*store)[FIELD_MAX] = dea_arena_alloc(&memory, 2 * count, sizeof *store);
  const char **candidates = dea_arena_alloc(&memory, all, sizeof *candidates);
  nearest[0] = '\0';
  for (size_t c = 0; candidates != NULL && c < all; c++) {
    if (c < 2 * count) {
      const struct dea_column *column = dea_column_at(r->ctx, (int)(c / 2));
      dea_csv_fold(c % 2 == 0 ? column->header : column->key, store[c]);
    }
    candidates[c] = c < 2 * count ? store[c] : other_names[c - 2 * count].name;
  }
  const char *found = candidates != NULL ? dea_nearest_name(name, candidates, all) : NULL;
  snprintf(nearest, FIELD_MAX, "%s", found != NULL ? found : "");
  const dea_status status = dea_arena_status(&memory);
  dea_arena_free(&memory);
  return status;
}

static void unknown_title(struct reader *r, const char *title, const char *name, size_t column)
{
  char nearest[FIELD_MAX];
  if (!one_more_error(r) || find_nearest(r, name, nearest) != DEA_OK) {
    return;
  }
  if (nearest[0] == '\0') {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                    "'%s' is not a known quantity; known are, for example, 'V (kV)', 'z centre "
                    "(um)', 'electrode stretch', 'force (mN)'",
                    title);
    return;
  }
  bool by_key;
  char proper[DEA_COLUMN_TITLE_SIZE];
  dea_column_title(dea_column_at(r->ctx, find_column(r->ctx, nearest, &by_key)), proper,
                   sizeof proper);
  dea_finding_add(r->ctx, DEA_ERROR, place_of(r, column),
                  "'%s' is not a known quantity; did you mean '%s'?", title, proper);
}

/* Sets field->factor from the unit in a title. */
static void read_unit(struct reader *r, const char *title, const char *unit, bool by_key,
                      size_t column, struct field_meaning *field)
{
  const struct dea_column *c = dea_column_at(r->ctx, field->column);
  char proper[DEA_COLUMN_TITLE_SIZE];
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
  return find_column(r->ctx, name, by_key);
}

static void read_title(struct reader *r, const char *title, size_t column,
                       struct field_meaning *field)
{
  char name[FIELD_MAX], unit[FIELD_MAX];
  bool by_key;
  dea_fields_title(r->ctx, &r->table, column, name, unit);
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

static void read_header(struct reader *r)
{
  bool has_voltage = false;
  if (r->table.count > FIELDS_MAX && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, 0), "more than %d columns", FIELDS_MAX);
    return;
  }
  for (size_t i = 0; i < r->table.count; i++) {
    char title[FIELD_MAX];
    struct field_meaning field;
    const struct dea_slice slice = r->table.titles[i];
    snprintf(title, sizeof title, "%.*s", (int)(slice.length < FIELD_MAX ? slice.length : 0),
             slice.text);
    read_title(r, title, i, &field);
    r->fields[r->field_count++] = field;
    has_voltage = has_voltage || (field.role == ROLE_VALUE && field.column == 0);
  }
  if (!has_voltage && one_more_error(r)) {
    dea_finding_add(r->ctx, DEA_ERROR, place_of(r, 0), "no column of voltages such as 'V (kV)'");
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

/* Reads a row of numbers; false when it has errors (then counted). */
static bool read_row(struct reader *r, size_t row, struct dea_load_point *point,
                     struct dea_load_point *std)
{
  struct dea_slice rest = r->table.lines[row], field;
  const size_t before = r->errors;
  *point = *std = dea_load_point_empty();
  point->monitors = r->row;
  std->monitors = r->row_std;
  for (size_t i = 0; i < r->row->count; i++) {
    r->row->at[i].value = r->row_std->at[i].value = NAN;
  }
  for (size_t i = 0; i < r->field_count && dea_slice_field(&rest, r->table.separator, &field);
       i++) {
    double value;
    if (r->fields[i].role == ROLE_FLAGS) {
      char text[FIELD_MAX];
      snprintf(text, sizeof text, "%.*s", (int)(field.length < FIELD_MAX ? field.length : 0),
               field.text);
      point->told = dea_flags_of_text(text);
    } else if (dea_fields_number(r->ctx, &r->table, row, field, &r->marks[i], &value)) {
      set_field(&r->fields[i], value, point, std);
    } else {
      r->errors++;
    }
  }
  if (r->errors == before && isnan(point->voltage_V) && one_more_error(r)) {
    const struct dea_location here = {r->table.file, r->table.numbers[row], 1};
    dea_finding_add(r->ctx, DEA_ERROR, here, "a row without a voltage");
  }
  return r->errors == before;
}

static dea_status add_row(struct reader *r, struct dea_measurement *m, size_t *room_now,
                          size_t line, const struct dea_load_point *point,
                          const struct dea_load_point *std)
{
  if (m->curve.count == *room_now) {
    size_t capacity = *room_now > 0 ? 2 * *room_now : 64;
    void *moved = dea_resize(r->ctx, m->std, capacity, sizeof *m->std);
    m->std = moved != NULL ? moved : m->std;
    void *lines = moved != NULL ? dea_resize(r->ctx, m->line, capacity, sizeof *m->line) : NULL;
    if (lines == NULL) {
      return DEA_E_MEMORY;
    }
    m->line = lines;
    *room_now = capacity;
  }
  m->curve.memory.ctx = r->ctx;
  m->std[m->curve.count] = *std;
  m->std[m->curve.count].monitors = dea_monitor_values_copy(&m->curve.memory, std->monitors);
  m->line[m->curve.count] = line;
  return dea_curve_add_point(r->ctx, &m->curve, point);
}

/* Room for a row's columns of monitors. */
static dea_status make_rows(struct reader *r)
{
  int columns[FIELDS_MAX];
  size_t count = 0;
  for (size_t i = 0; i < r->field_count; i++) {
    if (r->fields[i].column >= DEA_LOAD_POINT_COLUMNS && r->fields[i].role == ROLE_VALUE) {
      columns[count++] = r->fields[i].column;
    }
  }
  r->memory.ctx = r->ctx;
  r->row = dea_monitor_values_create(&r->memory, columns, count);
  r->row_std = dea_monitor_values_create(&r->memory, columns, count);
  return dea_arena_status(&r->memory);
}

static dea_status read_rows(struct reader *r, struct dea_measurement *m)
{
  size_t capacity = 0;
  dea_context_clear(r->ctx); // so that the status below can only be of a finding
  read_header(r);
  DEA_TRY(r->ctx, make_rows(r));
  const size_t rows = r->errors == 0 ? r->table.rows : 0; // without a header they say nothing
  for (size_t row = 0; row < rows && r->errors < FINDINGS_MAX; row++) {
    struct dea_load_point point, std;
    if (read_row(r, row, &point, &std)) {
      DEA_TRY(r->ctx, add_row(r, m, &capacity, r->table.numbers[row], &point, &std));
    }
  }
  for (size_t i = 0; i < r->field_count && r->errors == 0; i++) {
    r->errors += dea_text_marks_refuse(r->ctx, &r->marks[i], r->table.separator, r->table.decimal,
                                       r->table.file, "a column");
  }
  if (dea_context_status(r->ctx) != DEA_OK) {
    return dea_context_status(r->ctx); // a finding could not be kept, or there are no units
  }
  return r->errors == 0 ? DEA_OK
                        : dea_fail(r->ctx, DEA_E_IO, "%s cannot be used: %zu error%s",
                                   r->table.file, r->errors, r->errors == 1 ? "" : "s");
}

dea_status dea_measurement_read(struct dea_context *ctx, const char *file,
                                struct dea_measurement **out)
{
  struct reader r = {.ctx = ctx};
  *out = NULL;
  DEA_TRY(ctx, dea_fields_read(ctx, file, &r.table));
  struct dea_measurement *m = dea_alloc(ctx, 1, sizeof *m);
  dea_status status = DEA_E_MEMORY;
  if (m != NULL) {
    m->file = r.table.file;
    m->curve = (struct dea_curve){.model = "measurement", .kind = "sweep", .complete = true};
    status = read_rows(&r, m);
  }
  dea_fields_free(ctx, &r.table);
  dea_arena_free(&r.memory);
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
    dea_arena_free(&measurement->curve.memory);
    dea_free(ctx, measurement->std);
    dea_free(ctx, measurement->line);
    dea_free(ctx, measurement);
  }
}
