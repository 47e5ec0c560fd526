/* The grid of a plate, its plies numbered whatever of them it has. */
#pragma once

#include "model/solid/actuator/disc_mesh.h"

#include <string.h>

/* From bottom to top; DISC_TOP: the upper electrode, or the bond that stands for it under fibres,
 * and beside it the filler. */
enum { DISC_BOTTOM, DISC_FILM, DISC_BOND, DISC_TOP, DISC_GLUE, DISC_FIBRES };

static int disc_ply(const char *name)
{
  static const struct {
    const char *name;
    int ply;
  } plies[] = {{"lower electrode", DISC_BOTTOM},
               {"electrodes", DISC_BOTTOM},
               {"film", DISC_FILM},
               {"bond of the film", DISC_BOND},
               {"upper electrode", DISC_TOP},
               {"bond of electrodes", DISC_TOP},
               {"filler", DISC_TOP},
               {"bond", DISC_GLUE},
               {"fibres", DISC_FIBRES}};
  for (size_t i = 0; i < sizeof plies / sizeof plies[0]; i++) {
    if (strcmp(plies[i].name, name) == 0) {
      return plies[i].ply;
    }
  }
  return -1;
}

/* like: with the elements of that plate. Freed by dea_layout_mesh_free, also after a failure. */
static dea_status disc_mesh(struct dea_context *in, const struct dea_fibre_disc *p,
                            const struct dea_fibre_disc *like, struct dea_layout_mesh *out)
{
  const struct dea_device device = {.disc = true,
                                    .film_thickness_m = p->film_thickness,
                                    .film_thickness_unstretched_m = p->film_thickness,
                                    .pre_stretch = 1,
                                    .electrode_thickness_m = p->electrode_thickness,
                                    .frame_radius_m = p->frame_radius,
                                    .electrode_radius_m = p->electrode_radius,
                                    .fibre_count = p->fibres,
                                    .fibre_width_m = p->outer_width,
                                    .fibre_tip_width_m = p->tip_width,
                                    .fibre_tip_radius_m = p->tip_radius,
                                    .fibre_outer_gap_m = p->frame_radius - p->outer_radius,
                                    .fibre_thickness_m = p->fibre_thickness,
                                    .bond_thickness_m = p->glue_thickness};
  const struct dea_model_settings settings = {.order_z = p->order_z, .elements_z = p->through};
  const struct dea_layout_mesh other = {.cuts = like != NULL ? *like : *p};
  bool fit;
  dea_status status =
      dea_disc_mesh_create(in, &device, &settings, p, like != NULL ? &other : NULL, out, &fit);
  for (size_t e = 0; status == DEA_OK && e < out->grid->element_count; e++) {
    out->grid->ply[e] = disc_ply(out->layout->plies[out->grid->ply[e]].name);
  }
  return status;
}
