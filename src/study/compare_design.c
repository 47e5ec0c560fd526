/* Study "compare-design": the design, and others that it names, through the voltages of each. */
#include "base/file.h"
#include "device/device.h"
#include "study/study.h"
#include "study/variant.h"

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
  const struct dea_variant_run base = {study_name, name, result->device, design->compute.voltages_V,
                                       design->compute.voltage_count};
  return dea_variant_run(ctx, type, &base, result);
}

static dea_status add_other(struct dea_context *ctx, const struct dea_model_type *type,
                            const struct dea_design_variant *variant, struct dea_result *result)
{
  struct dea_device *device;
  DEA_TRY(ctx, dea_device_build(ctx, variant->design, &device));
  const struct dea_variant_run other = {study_name, variant->name.text, device,
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

static bool asked(const struct dea_design *design)
{
  return design->compute.compare_count > 0;
}

const struct dea_study dea_study_compare_design = {
    .name = study_name,
    .asked = asked,
    .needs = "compute.compare, or more design files on the command line,",
    .run = run,
};
