/* Reader of measurements (see dea_measurement_read in csv.h). */
#include "io/csv.h"

#include <stdio.h>
#include <string.h>

/* What of a point is no quantity, behind the columns. */
enum state { STABLE, MODES, TRUSTED, FLAGS, STATES };

struct reader {
  struct dea_context *ctx;
  struct dea_csv_wanted *wanted; // [columns + STATES]
  size_t columns;                // of the context
  struct dea_csv_columns table;
  struct dea_arena memory;
};

dea_status dea_csv_want_column(struct dea_arena *memory, const struct dea_column *column,
                               struct dea_csv_wanted *out)
{
  enum { EXAMPLE = 32 };
  char *title = dea_arena_alloc(memory, DEA_COLUMN_TITLE_SIZE + 2 * DEA_CSV_FIELD_MAX + EXAMPLE, 1);
  DEA_TRY_MEMORY(title != NULL);
  char *name = title + DEA_COLUMN_TITLE_SIZE, *key = name + DEA_CSV_FIELD_MAX;
  char *example = key + DEA_CSV_FIELD_MAX;
  dea_column_title(column, title, DEA_COLUMN_TITLE_SIZE);
  dea_csv_fold(column->header, name);
  dea_csv_fold(column->key, key);
  snprintf(example, EXAMPLE, "1 %.20s", column->display_unit);
  *out = (struct dea_csv_wanted){.name = name,
                                 .title = title,
                                 .measure = {column->si_unit, example},
                                 .key = key,
                                 .uncertain = true};
  return DEA_OK;
}

static double parse_flags(const char *words)
{
  return dea_flags_of_text(words);
}

/* Names that people use beside the headers and keys of the list; folded (see dea_csv_fold). */
static const struct {
  const char *key, *other[5];
} other_names[] = {
    {"voltage_V", {"voltage"}},
    {"electrode_stretch", {"stretch"}},
    {"centre_z_m", {"z center", "centre z", "center z", "displacement", "z"}},
    {"fibre_tip_z_m", {"fibre tip z", "z tip", "z fiber tip"}},
    {"true_field_V_per_m", {"field"}},
    {"electrode_edge_u_m", {"electrode edge u", "u edge"}},
    {"min_tension_N_per_m", {"tension"}},
};

static dea_status want_all(struct reader *r)
{
  static const char *const states[] = {
      [STABLE] = "stable", [MODES] = "unstable modes", [TRUSTED] = "trusted", [FLAGS] = "flags"};
  r->columns = (size_t)dea_column_count(r->ctx);
  r->wanted = dea_arena_alloc(&r->memory, r->columns + STATES, sizeof *r->wanted);
  DEA_TRY(r->ctx, dea_arena_status(&r->memory));
  for (size_t c = 0; c < r->columns; c++) {
    DEA_TRY(r->ctx, dea_csv_want_column(&r->memory, dea_column_at(r->ctx, (int)c), &r->wanted[c]));
  }
  for (size_t i = 0; i < sizeof other_names / sizeof other_names[0]; i++) {
    struct dea_csv_wanted *wanted = &r->wanted[dea_point_column_find(other_names[i].key)];
    memcpy(wanted->other, other_names[i].other, sizeof wanted->other);
  }
  struct dea_csv_wanted *voltage = &r->wanted[dea_point_column_find("voltage_V")];
  voltage->needed = voltage->filled = true;
  struct dea_csv_wanted *centre = &r->wanted[dea_point_column_find("centre_z_m")];
  centre->guess = "displacement";
  centre->note = "is taken for that of the centre; 'z fibre tip' is that of the tip";
  for (size_t k = 0; k < STATES; k++) { // trusted: follows from the flags
    r->wanted[r->columns + k] =
        (struct dea_csv_wanted){.name = states[k], .title = states[k], .measure = {"1", "1"}};
  }
  r->wanted[r->columns + FLAGS].parse = parse_flags;
  return DEA_OK;
}

/* Sets a row's numbers of a table [columns] in a point that has a place for its monitors. */
static void set_values(const struct reader *r, double *const *values, size_t row,
                       struct dea_load_point *point)
{
  for (size_t c = 0; c < r->columns; c++) {
    if (values[c] != NULL) {
      dea_point_set(point, (int)c, values[c][row]);
    }
  }
}

static double state_of(const struct reader *r, enum state state, size_t row, double otherwise)
{
  const double *values = r->table.values[r->columns + state];
  return values != NULL ? values[row] : otherwise;
}

static dea_status read_rows(struct reader *r, struct dea_measurement *m)
{
  struct dea_arena *memory = &m->curve.memory;
  int *monitors = dea_arena_alloc(&r->memory, r->columns, sizeof *monitors);
  size_t monitor_count = 0;
  memory->ctx = r->ctx;
  m->std = dea_alloc(r->ctx, r->table.rows, sizeof *m->std);
  DEA_TRY_MEMORY(m->std != NULL && monitors != NULL);
  for (size_t c = DEA_LOAD_POINT_COLUMNS; c < r->columns; c++) {
    if (r->table.values[c] != NULL) {
      monitors[monitor_count++] = (int)c;
    }
  }
  struct dea_monitor_values *own = dea_monitor_values_create(&r->memory, monitors, monitor_count);
  DEA_TRY(r->ctx, dea_arena_status(&r->memory));
  for (size_t row = 0; row < r->table.rows; row++) {
    struct dea_load_point point = dea_load_point_empty(), std = point;
    std.monitors = dea_monitor_values_create(memory, monitors, monitor_count);
    DEA_TRY(r->ctx, dea_arena_status(memory));
    point.monitors = own;
    set_values(r, r->table.values, row, &point);
    set_values(r, r->table.std, row, &std);
    const double modes = state_of(r, MODES, row, 0);
    point.stable = state_of(r, STABLE, row, point.stable) != 0;
    point.unstable_modes = modes > 0 && modes < 1e9 ? (int)modes : 0;
    point.own_flags = (unsigned)state_of(r, FLAGS, row, 0);
    m->std[row] = std;
    DEA_TRY(r->ctx, dea_curve_add_point(r->ctx, &m->curve, &point));
  }
  m->file = r->table.file;
  m->line = r->table.line;
  r->table.line = NULL;
  return DEA_OK;
}

static dea_status read_table(struct reader *r, const char *file, struct dea_measurement *m)
{
  DEA_TRY(r->ctx, want_all(r));
  DEA_TRY(r->ctx, dea_csv_columns_read(
                      r->ctx, file, r->wanted, r->columns + STATES,
                      "'V (kV)', 'z centre (um)', 'electrode stretch', 'force (mN)'", &r->table));
  const dea_status status = read_rows(r, m);
  dea_csv_columns_free(r->ctx, &r->table);
  return status;
}

dea_status dea_measurement_read(struct dea_context *ctx, const char *file,
                                struct dea_measurement **out)
{
  struct reader r = {.ctx = ctx, .memory = {.ctx = ctx}};
  struct dea_measurement *m = dea_alloc(ctx, 1, sizeof *m);
  *out = NULL;
  DEA_TRY_MEMORY(m != NULL);
  m->curve = (struct dea_curve){.model = "measurement", .kind = "sweep", .complete = true};
  const dea_status status = read_table(&r, file, m);
  dea_arena_free(&r.memory);
  DEA_TRY_ELSE(ctx, status, dea_measurement_destroy(ctx, m));
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
