/* The process sheet: what is needed, what is done, what is checked, with the design's numbers. */
#pragma once

#include "base/text.h"
#include "fabricate/workshop.h"

/* Amounts for one device; NAN where the design does not say enough, 0 where there is none. */
struct dea_amounts {
  double film_area_m2;          // films as cut
  double ink_area_m2;           // electrodes with leads, pads and marks, as printed
  double ink_volume_m3;         // as it is once cured
  double transfer_glue_area_m2; // below bottom electrodes of films printed on both faces, but pads
  double bond_area_m2;          // below pieces on tabs, and what of them lies on the frame
  double bond_volume_m3;
  double stencil_sheet_area_m2; // all
  double frame_sheet_area_m2;   // that the frame is cut from
  double mass_kg;               // of the plies; NAN when a material has no density
};

void dea_amounts_find(const struct dea_workshop *workshop, struct dea_amounts *out);

/* Writes it all as one HTML file. drawing: of the actuator, SVG text; NULL: none. */
dea_status dea_process_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                             const char *drawing, struct dea_text *out);
