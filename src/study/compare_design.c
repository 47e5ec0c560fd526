/* Study "compare-design": the design, and others that it names, through the voltages of each. */
#include "base/file.h"
#include "device/device.h"
#include "study/study.h"
#include "study/variant.h"

#include <math.h>
#include <stdio.h>

static const char study_name[] = "compare-design";

/* The name of the design itself: of the entry that changes nothing, or else of its file. */
static void name_base(const struct dea_design *design, char out[DEA_NAME_SIZE])
{
  for (size_t i = 0; i < design->compute.compare_count; i++) {
    const struct dea_design_variant *variant = &design->compute.compare[i];
    if (variant->design == NULL) {
      snprintf(out, DEA_NAME_SIZE, "%s", variant->name.text);
      return;
    }
  }
  size_t length;
  const char *stem = dea_path_stem(design->file, &length);
  snprintf(out, DEA_NAME_SIZE, "%.*s", length < DEA_NAME_SIZE ? (int)length : DEA_NAME_SIZE - 1,
           stem);
}

/* The design itself: its sweep where that has been made, with the last profile. */
static dea_status add_base(struct dea_context *ctx, const struct dea_model_type *type,
                           struct dea_model *model, struct dea_result *result)
{
  const struct dea_design *design = result->design;
  char name[DEA_NAME_SIZE];
  name_base(design, name);
  if (dea_result_find(result, type->name, "sweep") != NULL) {
    return dea_variant_of_sweep(ctx, type, model, study_name, name, result);
  }
  const struct dea_variant_run base = {study_name,
                                       name,
                                       result->device,
                                       dea_model_settings_of(design),
                                       design->compute.voltages_V,
                                       design->compute.voltage_count};
  return dea_variant_run(ctx, type, &base, result);
}

static dea_status add_other(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_design_variant *variant, struct dea_result *result)
{
  struct dea_device *device;
  DEA_TRY(ctx, dea_device_build(ctx, variant->design, &device));
  const struct dea_variant_run other = {study_name,
                                        variant->name.text,
                                        device,
                                        dea_model_settings_of(variant->design),
                                        variant->design->compute.voltages_V,
                                        variant->design->compute.voltage_count};
  dea_status status = dea_variant_run(ctx, type, &other, result);
  dea_device_destroy(ctx, device);
  return status;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  const struct dea_design *design = result->design;
  size_t total = design->compute.compare_count;
  char what[DEA_NAME_SIZE + 20];
  snprintf(what, sizeof what, "%s %s", type->name, study_name);
  dea_status first = add_base(ctx, type, model, result);
  for (size_t i = 0; i < total && first != DEA_E_INTERRUPTED && first != DEA_E_MEMORY; i++) {
    if (design->compute.compare[i].design != NULL) {
      dea_status status = add_other(ctx, type, &design->compute.compare[i], result);
      bool ends = status == DEA_E_INTERRUPTED || status == DEA_E_MEMORY;
      first = first == DEA_OK || ends ? status : first;
    }
    dea_progress(ctx, what, i + 1, total);
  }
  return first;
}

// Tables -----------------------------------------------------------------------------------------

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const struct dea_result_column design_columns[] = {
    {.key = "name", .kind = DEA_CELL_TEXT, .title = "design", .meaning = "name of the design"},
    {.key = "refinement", .hidden = DEA_IN_SCREEN, .title = "refinement", .meaning = "of its mesh"},
    {.key = "elements",
     .kind = DEA_CELL_COUNT,
     .hidden = DEA_IN_SCREEN,
     .title = "elements",
     .meaning = "of its mesh"},
    {.key = "nodes",
     .kind = DEA_CELL_COUNT,
     .hidden = DEA_IN_SCREEN,
     .title = "nodes",
     .meaning = "of its mesh"},
    {.key = "unknowns",
     .kind = DEA_CELL_COUNT,
     .hidden = DEA_IN_SCREEN,
     .title = "unknowns",
     .meaning = "of its mesh"},
    {.key = "wall_s",
     .hidden = DEA_IN_SCREEN,
     .si_unit = "s",
     .display_unit = "s",
     .title = "time",
     .meaning = "that it took"},
    {.key = "complete",
     .kind = DEA_CELL_FLAG,
     .hidden = DEA_IN_SCREEN,
     .title = "complete",
     .meaning = "to the last point"},
    {.key = "points", .kind = DEA_CELL_POINTS, .title = "points", .meaning = "variant of the run"},
    {.key = "last_voltage_V",
     .hidden = DEA_IN_JSON,
     .si_unit = "V",
     .display_unit = "kV",
     .factor = 1e-3,
     .title = "V",
     .meaning = "last voltage"},
    {.key = "last_strain",
     .hidden = DEA_IN_JSON,
     .display_unit = "%",
     .factor = 100,
     .title = "strain",
     .meaning = "of the electrode's radius at the last voltage"},
    {.key = "last_centre_z_m",
     .hidden = DEA_IN_JSON,
     .si_unit = "m",
     .display_unit = "um",
     .factor = 1e6,
     .title = "z centre",
     .meaning = "at the last voltage"},
    {.key = "last_fibre_tip_z_m",
     .hidden = DEA_IN_JSON,
     .si_unit = "m",
     .display_unit = "um",
     .factor = 1e6,
     .title = "z tip",
     .meaning = "at the last voltage"},
    {.key = "last_true_field_V_per_m",
     .hidden = DEA_IN_JSON,
     .si_unit = "V/m",
     .display_unit = "V/um",
     .factor = 1e-6,
     .title = "field",
     .meaning = "at the last voltage"},
    {.key = "stopped", .kind = DEA_CELL_TEXT, .title = "stopped", .meaning = "why it stopped"},
};
static const struct dea_result_table_type design_table = {.study = study_name,
                                                          .name = "designs",
                                                          .key = "designs",
                                                          .title = "designs at their last voltage",
                                                          .where = DEA_IN_JSON | DEA_IN_SCREEN,
                                                          .columns = design_columns,
                                                          .column_count = COUNT(design_columns)};

/* What is only noise is 0. */
static double shown_z(double z_m)
{
  return fabs(z_m) < 1e-12 ? 0 : z_m;
}

static dea_status put_design(struct dea_context *ctx, const struct dea_variant *v, size_t index,
                             struct dea_result_table *table)
{
  const struct dea_load_point none = dea_load_point_empty();
  const struct dea_load_point *p =
      v->curve.count > 0 ? &v->curve.points[v->curve.count - 1] : &none;
  bool sized = v->size.nodes > 0;
  const struct dea_result_table_value row[] = {
      {.text = v->name},
      {.number = v->refinement},
      {.number = sized ? (double)v->size.elements : NAN},
      {.number = sized ? (double)v->size.nodes : NAN},
      {.number = sized ? (double)v->size.unknowns : NAN},
      {.number = v->wall_s},
      {.number = v->curve.complete},
      {.number = (double)index},
      {.number = p->voltage_V},
      {.number = p->electrode_stretch - 1},
      {.number = shown_z(p->centre_z_m)},
      {.number = shown_z(p->fibre_tip_z_m)},
      {.number = p->true_field_V_per_m},
      {.text = v->curve.stopped},
  };
  return dea_result_table_add_row(ctx, table, row);
}

static dea_status tables(struct dea_context *ctx, const char *model, struct dea_result *result)
{
  struct dea_result_table *table = NULL;
  for (size_t i = 0; i < result->variant_count; i++) {
    if (dea_variant_is(&result->variants[i], model, study_name)) {
      if (table == NULL) {
        DEA_TRY(ctx, dea_result_add_table(ctx, result, &design_table, model, 0, &table));
      }
      DEA_TRY(ctx, put_design(ctx, &result->variants[i], i, table));
    }
  }
  return DEA_OK;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.compare_count > 0;
}

const struct dea_study dea_study_compare_design = {
    .name = study_name,
    .asked = asked,
    .needs = "compute.compare, or more design files on the command line,",
    .run = run,
    .tables = tables,
};
