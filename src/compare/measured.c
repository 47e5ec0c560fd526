#include "compare/measured.h"

#include "base/write_file.h"
#include "result/observation.h"

#include <math.h>

enum { PROFILE_V, PROFILE_X, PROFILE_Z, PROFILE_COLUMNS };

static const struct dea_csv_wanted profile_columns[PROFILE_COLUMNS] = {
    [PROFILE_V] =
        DEA_CSV_COLUMN("v", "V", "1 kV", .title = "V (kV)", .needed = true, .filled = true),
    [PROFILE_X] =
        DEA_CSV_COLUMN("x", "m", "1 mm", .title = "x (mm)", .needed = true, .filled = true),
    [PROFILE_Z] =
        DEA_CSV_COLUMN("z", "m", "1 um", .title = "z (um)", .needed = true, .uncertain = true),
};

/* What a history may have of any device. */
static const char *const history_keys[] = {"time_s", "voltage_V", "centre_z_m", "fibre_tip_z_m",
                                           "force_N"};

bool dea_measured_is_folder(const char *path)
{
  return dea_path_is_folder(path) && dea_folder_has(path, "measurement.csv") &&
         !dea_folder_has(path, "results.h5");
}

/* Rows are out of order: a finding at the one that is, and DEA_E_IO. */
static dea_status out_of_order(struct dea_context *ctx, const struct dea_csv_columns *rows,
                               size_t row, const char *what)
{
  DEA_TRY(ctx,
          dea_finding_add(ctx, DEA_ERROR, (struct dea_location){rows->file, rows->line[row], 1},
                          "%s from the row before to this one", what));
  return dea_fail(ctx, DEA_E_IO, "%s cannot be used: its rows are out of order", rows->file);
}

/* Whether a row begins a profile, whose first row so far is `start`: another voltage, or x from its
 * beginning on. */
static bool begins(const struct dea_csv_columns *rows, size_t start, size_t row)
{
  return row == 0 || rows->values[PROFILE_V][row] != rows->values[PROFILE_V][start] ||
         rows->values[PROFILE_X][row] <= rows->values[PROFILE_X][start];
}

/* Parts the rows into profiles, in each of which x rises. */
static dea_status part_profiles(struct dea_context *ctx, struct dea_measured *m)
{
  const struct dea_csv_columns *rows = &m->profile_rows;
  size_t capacity = 0, start = 0;
  for (size_t i = 0; i < rows->rows; i++) {
    double *x = rows->values[PROFILE_X] + i;
    if (begins(rows, start, i)) {
      double *std = rows->std[PROFILE_Z];
      start = i;
      DEA_TRY(ctx,
              dea_array_grow(ctx, &m->profiles, m->profile_count, &capacity, sizeof *m->profiles));
      m->profiles[m->profile_count++] = (struct dea_measured_profile){
          rows->values[PROFILE_V][i],
          {0, x, rows->values[PROFILE_Z] + i, std != NULL ? std + i : std}};
    } else if (!(x[0] > x[-1])) {
      return out_of_order(ctx, rows, i, "x does not rise");
    }
    m->profiles[m->profile_count - 1].z.count++;
  }
  return DEA_OK;
}

static dea_status check_history(struct dea_context *ctx, const struct dea_csv_columns *history)
{
  for (size_t i = 1; i < history->rows; i++) {
    const double *time = history->values[DEA_MEASURED_TIME];
    if (!(time[i] >= time[i - 1])) {
      return out_of_order(ctx, history, i, "the time falls");
    }
  }
  return DEA_OK;
}

/* Reads folder/name where it is there. */
static dea_status read_rows(struct dea_context *ctx, const char *folder, const char *name,
                            const struct dea_csv_wanted *wanted, size_t count,
                            struct dea_csv_columns *out)
{
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, folder, name, path));
  return dea_path_exists(path) ? dea_csv_columns_read(ctx, path, wanted, count, NULL, out) : DEA_OK;
}

static dea_status read_history(struct dea_context *ctx, const char *path, struct dea_measured *m)
{
  const size_t keys = sizeof history_keys / sizeof history_keys[0];
  const size_t capacity = keys + (size_t)dea_column_count(ctx);
  struct dea_arena memory = {.ctx = ctx};
  struct dea_csv_wanted *wanted = dea_arena_alloc(&memory, capacity, sizeof *wanted);
  m->history_column = dea_alloc(ctx, capacity, sizeof *m->history_column);
  dea_status status = wanted != NULL && m->history_column != NULL ? DEA_OK : DEA_E_MEMORY;
  for (size_t i = 0; i < capacity && status == DEA_OK; i++) {
    const int column = i < keys ? dea_point_column_find(history_keys[i]) : (int)(i - keys);
    if (i < keys ||
        (column >= DEA_LOAD_POINT_COLUMNS && dea_observed_is(dea_column_at(ctx, column), NULL))) {
      struct dea_csv_wanted *one = &wanted[m->history_count];
      status = dea_csv_want_column(&memory, dea_column_at(ctx, column), one);
      one->needed = one->filled = m->history_count == DEA_MEASURED_TIME;
      one->uncertain = false;
      m->history_column[m->history_count++] = column;
    }
  }
  if (status == DEA_OK) {
    status = read_rows(ctx, path, "history.csv", wanted, m->history_count, &m->history);
  }
  dea_arena_free(&memory);
  DEA_TRY(ctx, status);
  return check_history(ctx, &m->history);
}

static dea_status read_folder(struct dea_context *ctx, const char *path, struct dea_measured *m)
{
  char points[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, path, "measurement.csv", points));
  DEA_TRY(ctx, dea_measurement_read(ctx, points, &m->points));
  DEA_TRY(ctx,
          read_rows(ctx, path, "profiles.csv", profile_columns, PROFILE_COLUMNS, &m->profile_rows));
  DEA_TRY(ctx, part_profiles(ctx, m));
  return read_history(ctx, path, m);
}

dea_status dea_measured_read(struct dea_context *ctx, const char *path, struct dea_measured **out)
{
  struct dea_measured *m = dea_alloc(ctx, 1, sizeof *m);
  *out = NULL;
  DEA_TRY_MEMORY(m != NULL);
  dea_status status = dea_path_is_folder(path) ? read_folder(ctx, path, m)
                                               : dea_measurement_read(ctx, path, &m->points);
  DEA_TRY_ELSE(ctx, status, dea_measured_destroy(ctx, m));
  *out = m;
  return DEA_OK;
}

static void turn_point(struct dea_load_point *p)
{
  if (p->voltage_V < 0) {
    p->voltage_V = -p->voltage_V;
    p->source_voltage_V = -p->source_voltage_V;
    p->charge_C = -p->charge_C;
    p->current_A = -p->current_A;
  }
}

/* Whether voltages are below 0 by more than the noise of a monitor. */
static bool is_negative(const struct dea_curve *points)
{
  static const double noise = 0.01; // of the largest size
  double lowest_V = 0, largest_V = 0;
  for (size_t i = 0; i < points->count; i++) {
    lowest_V = fmin(lowest_V, points->points[i].voltage_V);
    largest_V = fmax(largest_V, fabs(points->points[i].voltage_V));
  }
  return lowest_V < -noise * largest_V;
}

dea_status dea_measurement_fold(struct dea_context *ctx, struct dea_measurement *points)
{
  if (!is_negative(&points->curve)) {
    return DEA_OK;
  }
  for (size_t i = 0; i < points->curve.count; i++) {
    turn_point(&points->curve.points[i]);
  }
  return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){points->file, 0, 0},
                         "voltages below 0 stand at their size: the response of a film does not "
                         "know the sign");
}

dea_status dea_measured_fold(struct dea_context *ctx, struct dea_measured *measured)
{
  const bool negative = is_negative(&measured->points->curve);
  for (size_t i = 0; i < measured->profile_count && negative; i++) {
    measured->profiles[i].voltage_V = fabs(measured->profiles[i].voltage_V);
  }
  return dea_measurement_fold(ctx, measured->points);
}

void dea_measured_destroy(struct dea_context *ctx, struct dea_measured *measured)
{
  if (measured != NULL) {
    dea_measurement_destroy(ctx, measured->points);
    dea_csv_columns_free(ctx, &measured->profile_rows);
    dea_csv_columns_free(ctx, &measured->history);
    dea_free(ctx, measured->profiles);
    dea_free(ctx, measured->history_column);
    dea_free(ctx, measured);
  }
}
