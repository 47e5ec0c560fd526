/* Generators: what makes a device of a design, a file generator_<name>.c each. */
#pragma once

#include "device/device.h"
#include "device/layout.h"

/* Fill a zeroed device of a design of plies, and of one of the short form; what is wrong becomes
 * findings, and the status is DEA_OK also then. What they made is freed with the device. */
dea_status dea_generator_parts(struct dea_context *ctx, const struct dea_design *design,
                               struct dea_device *device);
dea_status dea_generator_disc(struct dea_context *ctx, const struct dea_design *design,
                              struct dea_device *device);

/* ---- for generators ---- */

/* Parts that others name. */
enum dea_named {
  DEA_NAMED_SHAPE,
  DEA_NAMED_PLY,
  DEA_NAMED_BODY,
  DEA_NAMED_PRESSURE,
  DEA_NAMED_CONTACT
};

/* Number of the part with a name; DEA_LAYOUT_NONE after a finding at `location` that says which is
 * nearest, or which there are. */
dea_status dea_part_find(struct dea_context *ctx, const struct dea_parts *parts,
                         enum dea_named kind, const char *name, struct dea_location location,
                         size_t *out);

/* Makes a region of each shape, in their order; the list is the layout's, and its length is set.
 * What is wrong is a finding at its place; a shape that could not be made, or is made of such a
 * one, leaves an empty region. */
dea_status dea_shape_regions_build(struct dea_context *ctx, const struct dea_design *design,
                                   struct dea_layout *layout);

/* Resolves the name of a material: the design's own first, then the catalogue. An unknown name or
 * set, or an error in the material's file, is a finding and DEA_E_DESIGN. */
dea_status dea_generator_material(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_label *name,
                                  const struct dea_material_choice *choice,
                                  struct dea_material *out);

/* A sheet between electrodes, for the next two. */
struct dea_generator_film {
  const struct dea_material *material;
  const char *what;                         // it is, for messages: "the film"
  const struct dea_label *name;             // of the material
  const struct dea_material_choice *choice; // of its sets
  const double *pre_stretch;                // [2]
  struct dea_location pre_stretch_place;
};
/* Adds findings where a material cannot be that of a dielectric, and on what is not known of it. */
dea_status dea_generator_check_film(struct dea_context *ctx, const struct dea_generator_film *film);
/* Adds an error where the material's law ends before the stretches in the plane [2] in which the
 * part `what` ("the film") lies. */
dea_status dea_generator_check_reach(struct dea_context *ctx, const struct dea_material *material,
                                     const char *what, const double *pre_stretch,
                                     struct dea_location place);
/* The same on what matters when it is driven. */
dea_status dea_generator_check_film_in_time(struct dea_context *ctx,
                                            const struct dea_design *design,
                                            const struct dea_generator_film *film);
