#include "io/checkpoint.h"

#include "base/write_file.h"
#include "figures/surface_lattice.h"
#include "io/results_h5.h"
#include "io/state_file.h"
#include "io/vtu.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Names ------------------------------------------------------------------------------------------

enum { NAME_SIZE = DEA_NAME_SIZE + 48 };

static void field_name(const char *model, size_t point, char out[NAME_SIZE])
{
  snprintf(out, NAME_SIZE, DEA_FIELD_FOLDER "/%.63s_%04zu.vtu", model, point);
}

static void pvd_name(const char *model, char out[NAME_SIZE])
{
  snprintf(out, NAME_SIZE, "%.63s_sweep.pvd", model);
}

static void state_name(const char *model, char out[NAME_SIZE])
{
  snprintf(out, NAME_SIZE, "%.63s_state.h5", model);
}

void dea_checkpoint_forget(struct dea_context *ctx, const char *directory, const char *model,
                           size_t count)
{
  char name[NAME_SIZE], folder[DEA_PATH_SIZE];
  bool fields =
      dea_path_build(ctx, directory, DEA_FIELD_FOLDER, folder) == DEA_OK && dea_path_exists(folder);
  for (size_t i = 0; i < count && fields; i++) {
    field_name(model, i, name);
    dea_path_forget(ctx, directory, name);
  }
  pvd_name(model, name);
  dea_path_forget(ctx, directory, name);
  state_name(model, name);
  dea_path_forget(ctx, directory, name);
  if (fields) {
    rmdir(folder); // when nothing else is in it
  }
}

// Fields -----------------------------------------------------------------------------------------

/* Lines up the files that are there. */
static dea_status write_pvd(struct dea_context *ctx, const char *directory, const char *model,
                            const struct dea_curve *curve)
{
  char name[NAME_SIZE], path[DEA_PATH_SIZE];
  size_t count = 0;
  struct dea_pvd_entry *entries = dea_alloc(ctx, curve->count, sizeof *entries);
  DEA_TRY_MEMORY(entries != NULL);
  for (size_t i = 0; i < curve->count; i++) {
    field_name(model, i, name);
    if (dea_folder_has(directory, name)) {
      entries[count].voltage_V = curve->points[i].voltage_V;
      snprintf(entries[count++].file, sizeof entries[0].file, "%.79s", name);
    }
  }
  pvd_name(model, name);
  dea_status status = dea_path_build(ctx, directory, name, path);
  status = status == DEA_OK ? dea_pvd_write(ctx, entries, count, path) : status;
  dea_free(ctx, entries);
  return status;
}

static dea_status write_vtu(struct dea_context *ctx, const char *directory, const char *name,
                            const struct dea_field_mesh *mesh, double voltage_V, bool whole)
{
  char folder[DEA_PATH_SIZE], path[DEA_PATH_SIZE];
  DEA_TRY(ctx, dea_path_build(ctx, directory, DEA_FIELD_FOLDER, folder));
  DEA_TRY(ctx, dea_path_build(ctx, directory, name, path));
  DEA_TRY(ctx, dea_folder_create(ctx, folder));
  return DEA_CHAIN(ctx, dea_vtu_write(ctx, mesh, voltage_V, whole, path));
}

/* Fields of the last point of a curve. Those of the point before go when only the last is wanted:
 * at any time there are some. */
static dea_status keep_fields(struct dea_context *ctx, const struct dea_keep *keep,
                              const struct dea_design *design, const struct dea_curve *curve,
                              const struct dea_field_mesh *mesh)
{
  size_t last = curve->count - 1;
  char name[NAME_SIZE];
  field_name(curve->model, last, name);
  DEA_TRY(ctx, write_vtu(ctx, keep->directory, name, mesh, curve->points[last].voltage_V,
                         design->report.fields_of.value == DEA_FIELDS_WHOLE));
  if (design->report.fields.value == DEA_FIELDS_LAST && last > 0) {
    field_name(curve->model, last - 1, name);
    dea_path_forget(ctx, keep->directory, name);
  }
  return DEA_CHAIN(ctx, write_pvd(ctx, keep->directory, curve->model, curve));
}

dea_status dea_checkpoint_shapes(struct dea_context *ctx, const struct dea_result *result,
                                 const char *directory)
{
  bool whole = result->design == NULL || result->design->report.fields_of.value == DEA_FIELDS_WHOLE;
  for (size_t i = 0; i < result->surface_count; i++) {
    const struct dea_surface_record *record = &result->surfaces[i];
    if (dea_surface_has_shapes(record) ||
        dea_field_mesh_find(record->mesh, DEA_VOLTAGE_FIELD) != NULL) {
      char name[NAME_SIZE];
      field_name(record->model, record->point, name);
      DEA_TRY(ctx, write_vtu(ctx, directory, name, record->mesh, record->voltage_V, whole));
    }
  }
  return DEA_OK;
}

// Keeper -----------------------------------------------------------------------------------------

static dea_status state_path(struct dea_context *ctx, const char *directory, const char *model,
                             char out[DEA_PATH_SIZE])
{
  char name[NAME_SIZE];
  state_name(model, name);
  return dea_path_build(ctx, directory, name, out);
}

static dea_status restore(struct dea_context *ctx, void *user, const char *model,
                          const struct dea_state *wanted, struct dea_state *out)
{
  const struct dea_keep *keep = user;
  char path[DEA_PATH_SIZE];
  DEA_TRY(ctx, state_path(ctx, keep->directory, model, path));
  return DEA_CHAIN(ctx, dea_state_file_read(ctx, model, wanted, path, out));
}

/* The results before the state: it is the state that says how far a run came. */
static dea_status keep_point(struct dea_context *ctx, void *user, const struct dea_result *result,
                             const struct dea_curve *curve, const struct dea_field_mesh *fields,
                             const struct dea_state *state)
{
  const struct dea_keep *keep = user;
  DEA_TRY(ctx, fields != NULL ? keep_fields(ctx, keep, result->design, curve, fields) : DEA_OK);
  if (state == NULL) {
    return DEA_OK;
  }
  char path[DEA_PATH_SIZE];
  const struct dea_state_reach reach = {curve->count, curve->event_count};
  DEA_TRY(ctx, dea_path_build(ctx, keep->directory, "results.h5", path));
  DEA_TRY(ctx, dea_results_h5_write(ctx, result, path));
  DEA_TRY(ctx, state_path(ctx, keep->directory, curve->model, path));
  return DEA_CHAIN(ctx, dea_state_file_write(ctx, curve->model, state, reach, path));
}

void dea_checkpoint_begin(struct dea_keep *keep, const char *directory)
{
  *keep = (struct dea_keep){
      .directory = directory,
      .sink = {.user = keep, .restore = restore, .refused = &keep->refused, .point = keep_point}};
}

// Going on ---------------------------------------------------------------------------------------

static dea_status check_voltages(struct dea_context *ctx, const struct dea_design *design,
                                 const struct dea_curve *curve, size_t count, const char *directory)
{
  for (size_t i = 0; i < count; i++) {
    double there = curve->points[i].voltage_V;
    if (i >= design->compute.voltage_count ||
        fabs(design->compute.voltages_V[i] - there) > 1e-9 * (1 + fabs(there))) {
      DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, design->compute.voltages_place,
                                   "the run in %.200s has %g V as voltage number %zu, this design "
                                   "has not",
                                   directory, there, i + 1));
      return dea_fail(ctx, DEA_E_DESIGN,
                      "cannot resume: the first voltages are not those of the run in %.200s; more "
                      "may be added at the end",
                      directory);
    }
  }
  return DEA_OK;
}

/* Moves the surfaces of a model at its first `count` points to another result. */
static dea_status read_surfaces(struct dea_context *ctx, struct dea_result *from, const char *model,
                                size_t count, struct dea_result *to)
{
  for (size_t i = 0; i < from->surface_count; i++) {
    struct dea_surface_record *record = &from->surfaces[i];
    if (strcmp(record->model, model) == 0 && record->point < count) {
      struct dea_field_mesh *mesh = record->mesh;
      record->mesh = NULL;
      DEA_TRY(ctx, dea_result_add_surface(ctx, to, model, record->point, record->voltage_V, mesh));
    }
  }
  return DEA_OK;
}

/* Copies the profiles of a model at its first `count` points: each has at most one, in their order.
 */
static dea_status read_profiles(struct dea_context *ctx, const struct dea_result *from,
                                const char *model, size_t count, struct dea_result *to)
{
  for (size_t i = 0; i < from->profile_count && count > 0; i++) {
    const struct dea_profile_record *record = &from->profiles[i];
    if (strcmp(record->model, model) == 0) {
      const struct dea_profile profile = dea_profile_of_record(record);
      DEA_TRY(ctx, dea_result_add_profile(ctx, to, model, record->voltage_V, &profile));
      count--;
    }
  }
  return DEA_OK;
}

/* Moves the tables that the sweep of a model makes as it goes, with the rows of its first `count`
 * points: each has as many. */
static dea_status read_tables(struct dea_context *ctx, struct dea_result *from,
                              const struct dea_curve *sweep, size_t count, struct dea_result *to)
{
  for (size_t i = 0; i < from->table_count; i++) {
    struct dea_result_table *table = &from->tables[i];
    if (strcmp(table->model, sweep->model) == 0 && strcmp(table->type.study, sweep->kind) == 0) {
      dea_result_table_cut(ctx, table, count * (table->row_count / sweep->count));
      DEA_TRY(ctx, dea_result_adopt_table(ctx, to, table));
    }
  }
  return DEA_OK;
}

static dea_status read_sweep(struct dea_context *ctx, const char *directory, const char *state,
                             struct dea_result *old, const struct dea_curve *sweep,
                             struct dea_result *result)
{
  struct dea_state_reach reach;
  struct dea_curve *curve;
  DEA_TRY(ctx, dea_state_file_reach(ctx, state, &reach));
  const size_t count = reach.points;
  if (count > sweep->count || reach.events > sweep->event_count) {
    return dea_fail(ctx, DEA_E_IO, "%s is damaged: it stands after point %zu of %zu", state, count,
                    sweep->count);
  }
  DEA_TRY(ctx, check_voltages(ctx, result->design, sweep, count, directory));
  DEA_TRY(ctx, dea_result_add_curve(ctx, result, sweep->model, "sweep", &curve));
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &sweep->points[i]));
  }
  for (size_t i = 0; i < reach.events; i++) { // not where it stopped, after the last point
    DEA_TRY(ctx, dea_curve_add_event(ctx, curve, &sweep->events[i]));
  }
  DEA_TRY(ctx, read_surfaces(ctx, old, sweep->model, count, result));
  DEA_TRY(ctx, read_profiles(ctx, old, sweep->model, count, result));
  return DEA_CHAIN(ctx, read_tables(ctx, old, sweep, count, result));
}

dea_status dea_checkpoint_restore(struct dea_context *ctx, const char *directory,
                                  struct dea_result *result)
{
  struct dea_run *old;
  bool any = false;
  DEA_TRY(ctx, dea_run_read(ctx, directory, &old));
  dea_status status = DEA_OK;
  for (size_t i = 0; i < old->result->curve_count && status == DEA_OK; i++) {
    const struct dea_curve *curve = &old->result->curves[i];
    char path[DEA_PATH_SIZE];
    status = state_path(ctx, directory, curve->model, path);
    if (status == DEA_OK && strcmp(curve->kind, "sweep") == 0 && dea_path_exists(path)) {
      any = true;
      status = read_sweep(ctx, directory, path, old->result, curve, result);
    }
  }
  dea_run_destroy(ctx, old);
  if (status == DEA_OK && !any) {
    status = dea_fail(ctx, DEA_E_IO,
                      "no model left a state in %s from which it could go on; run from the start "
                      "with --force",
                      directory);
  }
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}
