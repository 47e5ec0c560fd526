/* Generators: what makes a device of a design. A new one is a file generator_<name>.c and a line
 * here. */
#pragma once

#include "device/device.h"

struct dea_generator {
  const char *name;
  /* Whether it is the one for a design. */
  bool (*takes)(const struct dea_design *design);
  /* Fills a zeroed device; what is wrong becomes findings, and the status is DEA_OK also then. What
   * it made is freed with the device. */
  dea_status (*fill)(struct dea_context *ctx, const struct dea_design *design,
                     struct dea_device *device);
};

// X(name): `const struct dea_generator dea_generator_<name>`; the first that takes a design makes
// it
#define DEA_GENERATOR_LIST(X)                                                                      \
  X(parts)                                                                                         \
  X(disc)

#define DEA_GENERATOR_DECLARE(name) extern const struct dea_generator dea_generator_##name;
DEA_GENERATOR_LIST(DEA_GENERATOR_DECLARE)
#undef DEA_GENERATOR_DECLARE

/* ---- for generators ---- */

/* Resolves the name of a material: the design's own first, then the catalogue. An unknown name or
 * set, or an error in the material's file, is a finding and DEA_E_DESIGN. */
dea_status dea_generator_material(struct dea_context *ctx, const struct dea_design *design,
                                  const struct dea_label *name,
                                  const struct dea_material_choice *choice,
                                  struct dea_material *out);

/* A sheet between electrodes, for the next two. */
struct dea_generator_film {
  const struct dea_material *material;
  const char *what;                              // it is, for messages: "the film"
  const struct dea_label *name;                  // of the material
  const struct dea_label *breakdown, *viscosity; // chosen sets
  const double *pre_stretch;                     // [2]
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
