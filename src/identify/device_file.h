/* A fit file of a device: a design, the keys of it that are fitted, and measured curves. */
#pragma once

#include "identify/fit_file.h"

enum {
  DEA_DEVICE_PARAMS_MAX = 12,
  DEA_DEVICE_TIES_MAX = 8, // other keys that a variable of dea sweep sets too
  DEA_DEVICE_FILES_MAX = 16,
  DEA_DEVICE_QUANTITIES_MAX = 8,
};

/* What a name of a number that may change can be. */
#define DEA_DEVICE_PARAM_DOC                                                                       \
  "number of the design or of a material by its name in dea run --sensitivity, but the voltage "   \
  "(film.thickness, plies.NAME.thickness, film.law.NAME, film.permittivity.at_rest, "              \
  "fibres.young_modulus, ...)"

enum dea_device_kind { DEA_DEVICE_SWEEP, DEA_DEVICE_FORCE, DEA_DEVICE_TRANSIENT };

/* Curves of one file as written. */
struct dea_device_curve_text {
  struct dea_label name, file, absolute;
  struct dea_label quantities[DEA_DEVICE_QUANTITIES_MAX];
  size_t quantity_count;
  struct dea_choice kind, use; // enum dea_device_kind, dea_fit_use
  struct dea_quantity relative;
};

struct dea_device_file {
  struct dea_fit_head head;
  struct dea_label design, model;
  struct dea_fit_parameter_text parameters[DEA_DEVICE_PARAMS_MAX];
  size_t parameter_count;
  struct dea_device_curve_text curves[DEA_DEVICE_FILES_MAX];
  size_t curve_count;
};

extern const struct dea_fit_form dea_device_form;
