/* The process sheet: what is needed, what is done, what is checked, with the design's numbers. */
#pragma once

#include "fabricate/document.h"
#include "fabricate/workshop.h"

/* Amounts for one actuator; NAN where the design does not say enough. */
struct dea_amounts {
  double film_area_m2;          // as cut, unstretched
  double ink_area_m2;           // both electrodes with leads, pads and marks, unstretched
  double ink_volume_m3;         // as it is once cured
  double transfer_glue_area_m2; // below the bottom electrode, without its pad, unstretched
  double bond_area_m2;          // below the fibres and their anchors
  double bond_volume_m3;
  double fibre_sheet_area_m2;   // disc that the holder is cut from
  double stencil_sheet_area_m2; // both
  double ring_area_m2;          // disc that the frame is cut from
};

void dea_amounts_find(const struct dea_workshop *workshop, struct dea_amounts *out);

/* The same of a device that is no disc: what is printed of one, unstretched and without marks, and
 * the mass of its plies, NAN when a material has no density. */
double dea_ink_area_m2(const struct dea_workshop *workshop);
double dea_plies_mass_kg(const struct dea_layout *layout);

/* Computes the sensitivities, of a device of plies where they are asked for, and writes it all.
 * document: zero but for its context; to be freed also after a failure. */
dea_status dea_process_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                             bool sensitivity, struct dea_document *document);
