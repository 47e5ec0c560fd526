/* Study "modal": frequencies and shapes of small vibrations about voltages. */
#include "base/schema.h"
#include "study/study.h"

#include <stddef.h>
#include <stdio.h>

// Keys -------------------------------------------------------------------------------------------

/* Settings of compute.modal. */
struct settings {
  struct dea_quantity count;                            // modes
  struct dea_quantity voltages_V[DEA_DESIGN_STOPS_MAX]; // none: 0 and quarters of the highest
  size_t voltage_count;
};

#define AT(member) offsetof(struct settings, member)

static const struct dea_field fields[] = {
    {.key = "count",
     .kind = DEA_FIELD_INTEGER,
     .offset = AT(count),
     .unit = "1",
     .min = 1,
     .max = DEA_DESIGN_MODES_MAX,
     .default_text = "6",
     .doc = "how many modes, from the lowest on",
     .example = "6"},
    {.key = "voltage",
     .kind = DEA_FIELD_NUMBER,
     .offset = AT(voltages_V),
     .unit = "V",
     .max = 1e6,
     .list_min = 1,
     .list_max = DEA_DESIGN_STOPS_MAX,
     .element_size = sizeof(struct dea_quantity),
     .count_offset = AT(voltage_count),
     .absent_text = "0 V and the quarters of the highest",
     .doc = "voltages that the actuator vibrates about, in the order to be computed",
     .example = "[0 kV, 4 kV, 8 kV]"},
};

static const struct dea_record record = {
    "modal",
    "study of vibrations, made when this section is there ({}) or with --study: frequencies and "
    "shapes about voltages (3d)",
    fields, sizeof fields / sizeof fields[0]};

static const struct dea_design_section section = {
    .key = "modal", .record = &record, .size = sizeof(struct settings)};

// Study ------------------------------------------------------------------------------------------

/* The modes at one voltage. */
static dea_status take(struct dea_context *ctx, const struct dea_model_type *type,
                       struct dea_model *model, const struct dea_load_point *at, size_t stop,
                       struct dea_result *result, struct dea_curve *curve)
{
  const struct settings *settings = dea_design_settings(result->design, &section)->values;
  size_t count = (size_t)settings->count.si;
  struct dea_load_point points[DEA_DESIGN_MODES_MAX];
  struct dea_field_mesh *shapes;
  char name[DEA_NAME_SIZE];
  DEA_TRY(ctx, dea_model_modes(ctx, type, model, at, count, points, &shapes));
  snprintf(name, sizeof name, "%.50s" DEA_SHAPES_SUFFIX, type->name);
  DEA_TRY(ctx, dea_result_add_surface(ctx, result, name, stop, at->voltage_V, shapes));
  for (size_t k = 0; k < count; k++) {
    DEA_TRY(ctx, dea_curve_add_point(ctx, curve, &points[k]));
  }
  return DEA_OK;
}

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none
  const struct dea_design *design = result->design;
  const struct settings *settings = dea_design_settings(design, &section)->values;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  size_t count =
      dea_study_stops(design, settings->voltages_V, settings->voltage_count, true, voltages_V);
  DEA_TRY(ctx, dea_study_stop_by_stop(ctx, type, result, "modal", type->modes != NULL, voltages_V,
                                      count, take));
  return DEA_OK;
}

const struct dea_study dea_study_modal = {
    .name = "modal", .keys = &section, .own_models = true, .run = run};
