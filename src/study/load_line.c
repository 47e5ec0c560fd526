/* Study "load-line": the force that the fibre tips push with where they are held at a height,
 * against that height, up to where no force is left, at quarters of the highest voltage. */
#include "study/study.h"

#include <math.h>

enum { LINES = 4, LINE_POINTS = 201 };

static const struct dea_result_column columns[] = {
    DEA_KV("voltage_V", "V", "voltage of the line"),
    DEA_UM("height_m", "height", "of the fibre tips"),
    DEA_MN("force_N", "force",
           "that they push with there: of model lumped an upper bound, of rigid rods"),
};
static const char study_name[] = "load-line";
static const struct dea_result_table_type force_table =
    DEA_RESULT_TABLE(study_name, "forces", columns, .title = "load lines", .where = DEA_IN_CSV);

/* Forces from the flat film to the height at which none is left; NAN where the model has none. */
static dea_status add_forces(struct dea_context *ctx, const struct dea_study_job *job,
                             double voltage_V, double free_m, struct dea_result_table *table)
{
  for (int i = 0; i < LINE_POINTS; i++) {
    double height_m = free_m * i / (LINE_POINTS - 1) + 0.0, force_N = 0;
    const dea_status status = job->type->hold(ctx, job->model, voltage_V, height_m, &force_N);
    if (dea_status_ends(status)) {
      return status;
    }
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(voltage_V), DEA_CELL(height_m),
                               DEA_CELL(status == DEA_OK ? force_N : NAN)));
  }
  return DEA_OK;
}

/* The line at a voltage; none where there is no equilibrium or nothing moves. */
static dea_status add_line(struct dea_context *ctx, const struct dea_study_job *job,
                           double voltage_V, struct dea_result_table *table)
{
  struct dea_load_point point;
  dea_status status = job->type->solve(ctx, job->model, voltage_V, &point);
  if (status == DEA_OK && point.fibre_tip_z_m != 0) {
    status = add_forces(ctx, job, voltage_V, point.fibre_tip_z_m, table);
  }
  return dea_forgive(ctx, status);
}

static dea_status run(struct dea_context *ctx, const struct dea_study_job *job)
{
  struct dea_result *result = job->result;
  struct dea_study_job own = *job; // from rest
  double highest_V = dea_study_highest_V(result);
  struct dea_result_table *table;
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &force_table, job->type->name, 0, &table));
  DEA_TRY(ctx, dea_model_create(ctx, job->type, result->design, result->device, &own.model));
  dea_status status = DEA_OK;
  for (int n = 1; n <= LINES && highest_V > 0 && status == DEA_OK; n++) {
    status = add_line(ctx, &own, highest_V * n / LINES, table);
  }
  job->type->destroy(ctx, own.model);
  return DEA_CHAIN(ctx, status);
}

static bool able(const struct dea_model_type *type, const struct dea_result *result)
{
  return type->hold != NULL && result->device->fibre_count > 0;
}

const struct dea_study dea_study_load_line = {.name = study_name,
                                              .by_name_only = true,
                                              .own_models = true,
                                              .ability = "a load line of this actuator",
                                              .able = able,
                                              .run = run};
