/* The layout of a disc in a round frame. */
#pragma once

#include "device/device.h"

/* The layout of a disc of these numbers: regions "film", "electrode", "fibres"; plies of film,
 * electrodes with stiffness, glue, and fibres; the frame as a support. Under fibres that lie on
 * electrodes of a thickness, "filler" continues these. membrane: as a film is that is a surface,
 * with both electrodes in one and bonds under the fibres (docs/theory/membrane.md). Symmetry is not
 * looked for. The disc's own monitors are there. out: owned by the caller (dea_layout_destroy),
 * NULL on failure. */
dea_status dea_disc_layout_create(struct dea_context *ctx, const struct dea_device *device,
                                  bool membrane, struct dea_layout **out);

/* The monitors that a disc brings, where its numbers say, behind those of its layout in place of
 * what was there: "centre", "fibre tip", "electrode edge", and "electrode" for its stretch. film:
 * the ply. DEA_E_MEMORY. */
dea_status dea_disc_layout_own_monitors(struct dea_context *ctx, const struct dea_device *device,
                                        size_t film, struct dea_layout *layout);

/* Adds the monitors of a disc's own layout, which may have other names and plies, to that one;
 * false in *fit where one is of a region that is none of the disc's. Elements through plies that
 * are said there are taken too. */
dea_status dea_disc_layout_add_monitors(struct dea_context *ctx, const struct dea_device *device,
                                        struct dea_layout *to, bool *fit);
