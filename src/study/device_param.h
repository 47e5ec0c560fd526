/* Numbers of a design that may change: keys of the file, or of the film's material; and the device
 * that is built with other values in their place. */
#pragma once

#include "device/device.h"
#include "identify/device_fit.h"

/* A design and its device, where parameters are looked up. */
struct dea_device_param_source {
  const struct dea_design *design;
  const struct dea_device *device; // built from it
  bool whole;                      // whole numbers are parameters too
};

/* Fills kind, index, list, state, unit, limits (infinite for none) and `designed` of a parameter,
 * whose other members are left alone. name: a dotted key that is a number ("film.thickness"), a
 * number of a material ("fibres.young_modulus", "film.branch.1.time"), of a design with plies of
 * parts and shapes (study/numbers.h). *good: false after a finding (an error at its place) that
 * says why there is no such parameter. */
dea_status dea_device_param_find(struct dea_context *ctx,
                                 const struct dea_device_param_source *source,
                                 const struct dea_label *name, struct dea_device_param *out,
                                 bool *good);
/* Takes " stretched" or " unstretched" off the end of a text, and returns it, "" for neither;
 * static storage. */
const char *dea_device_param_split_state(char *text);
/* Its standard uncertainty from a text, "2 um". *good: false after a finding at its place. */
dea_status dea_device_param_std(struct dea_context *ctx, const struct dea_device_param *param,
                                const struct dea_label *text, double *std, bool *good);
/* Value of a parameter as a design file has it, with so many digits: "1.02e-4 m stretched". */
void dea_device_param_text(const struct dea_device_param *param, double value, int digits,
                           char out[80]);
/* The same with six digits and the unit that a person would take: "102 um stretched". */
void dea_device_param_show(const struct dea_device_param *param, double value, char out[80]);

/* The text of a design file; lent. */
struct dea_design_bytes {
  const struct dea_design *design; // as it was read: name and folder of the file, and its sections
  const char *bytes;
  size_t length;
};
/* Design and device with p [count] in place of the design's values. On failure what was made before
 * it is there too: both are the caller's to destroy, NULL where there is none. DEA_E_DESIGN where
 * it cannot be built so. */
dea_status dea_device_params_build(struct dea_context *ctx, const struct dea_design_bytes *file,
                                   const struct dea_device_param *params, size_t count,
                                   const double *p, struct dea_design **design,
                                   struct dea_device **device);

/* The parameter itself for k = 0, then those that take the same value; NULL: there is no more. */
const struct dea_device_param *dea_device_param_tie(const struct dea_device_param *param, size_t k);
/* A value of a parameter into its material (param->material); nothing of a key of the design. */
void dea_device_param_set(const struct dea_device_param *param, double value,
                          struct dea_material *material);
