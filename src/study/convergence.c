/* Study "convergence": the same device on ever finer meshes, at a few voltages. What the sequence
 * of answers says of each mesh is found in result/convergence.h. */
#include "study/study.h"
#include "study/variant.h"

#include <math.h>
#include <stdio.h>

static dea_status run(struct dea_context *ctx, const struct dea_model_type *type,
                      struct dea_model *model, struct dea_result *result)
{
  (void)model; // none: each mesh has its own
  const struct dea_design *design = result->design;
  size_t total = design->compute.convergence.refinement_count;
  double voltages_V[DEA_DESIGN_STOPS_MAX];
  char what[DEA_NAME_SIZE + 16], name[DEA_NAME_SIZE];
  dea_status first = DEA_OK;
  if (type->size == NULL) {
    DEA_TRY(ctx,
            dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                            "model %s has no mesh to refine: no study of convergence", type->name));
    return DEA_OK;
  }
  result->convergence_tolerance = design->compute.convergence.tolerance.si;
  snprintf(what, sizeof what, "%s convergence", type->name);
  struct dea_device device = *result->device; // what it lends stays the original's
  struct dea_variant_run one = {.study = "convergence",
                                .name = name,
                                .device = &device,
                                .voltages_V = voltages_V,
                                .voltage_count = dea_study_stops(
                                    design, design->compute.convergence.voltages_V,
                                    design->compute.convergence.voltage_count, false, voltages_V)};
  for (size_t i = 0; i < total; i++) {
    device.solid_refinement = design->compute.convergence.refinements[i].si;
    snprintf(name, sizeof name, "refinement %.4g", device.solid_refinement);
    dea_status status = dea_variant_run(ctx, type, &one, result);
    first = first == DEA_OK ? status : first;
    if (status == DEA_E_INTERRUPTED || status == DEA_E_MEMORY) {
      break;
    }
    dea_progress(ctx, what, i + 1, total);
  }
  return first;
}

static bool asked(const struct dea_design *design)
{
  return design->compute.convergence.asked;
}

const struct dea_study dea_study_convergence = {
    .name = "convergence",
    .asked = asked,
    .own_models = true,
    .run = run,
};
