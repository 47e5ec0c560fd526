/* Study "load-line": the force that holds the fibre tips at a height, against that height, up to
 * where no force is left, at quarters of the highest voltage. */
#include "study/study.h"

#include <math.h>

enum { LINES = 4, LINE_POINTS = 201 };

static const struct dea_result_column columns[] = {
    DEA_NUMBER_COLUMN("voltage_V", "V", "kV", 1e-3, "V", "voltage of the line"),
    DEA_NUMBER_COLUMN("height_m", "m", "um", 1e6, "height", "of the fibre tips"),
    DEA_NUMBER_COLUMN("force_N", "N", "mN", 1e3, "force",
                      "that holds them there: an upper bound, of rigid rods"),
};
static const char study_name[] = "load-line";
static const struct dea_result_table_type force_table =
    DEA_RESULT_TABLE(study_name, "forces", columns, .title = "load lines", .where = DEA_IN_CSV);

static bool is_fatal(dea_status status)
{
  return status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED;
}

/* Forces from the flat film to the height at which none is left; NAN where the model has none. */
static dea_status add_forces(struct dea_context *ctx, const struct dea_model_type *type,
                             struct dea_model *model, double voltage_V, double free_m,
                             struct dea_result_table *table)
{
  for (int i = 0; i < LINE_POINTS; i++) {
    double height_m = free_m * i / (LINE_POINTS - 1), force_N = 0;
    dea_status status =
        i > 0 ? dea_model_hold(ctx, type, model, voltage_V, height_m, &force_N) : DEA_OK;
    if (is_fatal(status)) {
      return status;
    }
    DEA_TRY(ctx, DEA_TABLE_ADD(ctx, table, DEA_CELL(voltage_V), DEA_CELL(height_m),
                               DEA_CELL(status == DEA_OK ? force_N : NAN)));
  }
  return DEA_OK;
}

/* The line at a voltage, from rest; none where there is no equilibrium or it does not lift. */
static dea_status add_line(struct dea_context *ctx, const struct dea_model_type *type,
                           const struct dea_result *result, double voltage_V,
                           struct dea_result_table *table)
{
  struct dea_model *model;
  struct dea_load_point point;
  DEA_TRY(ctx, dea_model_create(ctx, type, result->design, result->device, &model));
  dea_status status = type->solve(ctx, model, voltage_V, &point);
  if (status == DEA_OK && point.fibre_tip_z_m > 0) {
    status = add_forces(ctx, type, model, voltage_V, point.fibre_tip_z_m, table);
  }
  type->destroy(ctx, model);
  if (is_fatal(status)) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none: each line starts from rest
  double highest_V = dea_study_highest_V(result);
  struct dea_result_table *table;
  DEA_TRY(ctx, dea_result_add_table(ctx, result, &force_table, type->name, 0, &table));
  for (int n = 1; n <= LINES && highest_V > 0; n++) {
    DEA_TRY(ctx, add_line(ctx, type, result, highest_V * n / LINES, table));
  }
  return DEA_OK;
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
