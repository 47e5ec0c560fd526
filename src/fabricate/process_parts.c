#include "fabricate/process_parts.h"

#include <math.h>

void dea_process_begin_materials(struct dea_document *document, int copies)
{
  static const double widths[] = {0.19, 0.19, 0.12, 0.12, 0.38};
  dea_document_add(document, DEA_BLOCK_HEADING, "Bill of materials");
  dea_document_add(document, DEA_BLOCK_HEAD, "for");
  dea_document_cell(document, "material");
  dea_document_cell(document, "one");
  dea_document_cell(document, "all %d", copies);
  dea_document_cell(document, "remarks");
  dea_document_widths(document, widths);
}

void dea_process_add_material(struct dea_document *document, int copies, const char *item,
                              const char *material, double area_m2, double volume_m3,
                              const char *note)
{
  dea_document_add(document, DEA_BLOCK_ROW, "%s", item);
  dea_document_cell(document, "%s", material);
  dea_document_cell(document,
                    "%.4g\xc2\xa0"
                    "cm\xc2\xb2",
                    1e4 * area_m2);
  dea_document_cell(document,
                    "%.4g\xc2\xa0"
                    "cm\xc2\xb2",
                    1e4 * area_m2 * copies);
  if (isnan(volume_m3)) {
    dea_document_cell(document, "%s", note);
  } else {
    dea_document_cell(document, "%.4g\xc2\xa0mm\xc2\xb3 each, %.4g\xc2\xa0mm\xc2\xb3 in all. %s",
                      1e9 * volume_m3, 1e9 * volume_m3 * copies, note);
  }
}

void dea_process_add_effect(struct dea_document *document, double effect, double value, bool length)
{
  if (isnan(effect)) {
    dea_document_cell(document, "unknown");
  } else {
    dea_document_cell(document, length ? "%+.3g \xc2\xb5m (%+.2g %%)" : "%+.3g (%+.2g %%)",
                      length ? 1e6 * effect : effect, 100 * effect / value);
  }
}

void dea_process_add_voltage(struct dea_document *document, double voltage_V, double highest_V)
{
  if (voltage_V < highest_V) {
    dea_document_add(document, DEA_BLOCK_TEXT,
                     "The design goes to %.4g kV. The next quarter of that is not shown: by the "
                     "trend of its tension the film goes slack there, or the model has no state to "
                     "be trusted.",
                     1e-3 * highest_V);
  }
}
