/* The operating map: at which voltages the actuator works, against a parameter of the design, as
 * study operating-map found it. */
#include "report/section.h"

#include <string.h>

static const char study[] = "operating-map";

dea_status dea_section_map(struct dea_report *report, const struct dea_report_run *run)
{
  const struct dea_result *result = run->run->result;
  const struct dea_result_table *scale = NULL;
  for (size_t i = 0; i < result->table_count && scale == NULL; i++) {
    scale = strcmp(result->tables[i].type.study, study) == 0 ? &result->tables[i] : NULL;
  }
  if (run->device == NULL || scale == NULL) {
    return DEA_OK;
  }
  dea_section_begin(report, "map", run->number, "Operating map");
  dea_text_add(&report->text, "<p>Other values of the design are as they are. %s%s</p>",
               run->device->fibre_count > 0
                   ? "Displacements of model lumped are those of rigid rods, so upper bounds. "
                   : "",
               run->device->film.breakdown.known ? ""
                                                 : "The breakdown field of this film is unknown.");
  DEA_TRY(report->ctx, dea_section_figures(report, run, study));
  dea_section_end(report);
  return DEA_OK;
}
