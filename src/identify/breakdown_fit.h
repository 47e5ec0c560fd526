/* A fit of breakdown tests: the films as they are read, and Weibull's law of them. */
#pragma once

#include "base/arena.h"
#include "identify/fit_head.h"
#include "identify/weibull.h"

/* A table of films that broke or survived. */
struct dea_breakdown_file {
  struct dea_fit_head head;
  struct dea_label material;
  struct dea_label tests;                            // their table
  struct dea_quantity thickness_m, stretch, area_m2; // of all films; absent: columns
  struct dea_quantity exponent, thickness_exponent;  // known before; absent: found
  struct dea_quantity thickness0_m, area0_m2;        // references; absent: geometric means
};

extern const struct dea_fit_form dea_breakdown_form;

struct dea_breakdown_fit {
  struct dea_arena memory;
  const struct dea_breakdown_file *file; // lent
  const char *tests_file;                // interned
  char sha256[65];                       // of its bytes
  size_t rows;
  size_t *line;                                            // [rows] of the table
  double *field_V_per_m, *stretch, *thickness_m, *area_m2; // [rows]; thickness as stretched
  bool *survived;                                          // [rows]
  struct dea_weibull_data data;                            // of the above
  struct dea_weibull_fit fit;
};

/* Reads the films and fits. What is wrong with them becomes findings with file and line, DEA_E_IO
 * then; else as dea_weibull_solve. fit: freed by the caller, also after a failure. */
dea_status dea_breakdown_fit_run(struct dea_context *ctx, const struct dea_breakdown_file *file,
                                 struct dea_breakdown_fit *fit);
void dea_breakdown_fit_free(struct dea_breakdown_fit *fit);

/* Stretch to which the field found belongs: 1, or that of all films where no power of it is known.
 */
double dea_breakdown_fit_stretch(const struct dea_breakdown_fit *fit);
/* Field of a film over what the law gives it in place of the reference: on the reference. */
double dea_breakdown_fit_reference_field(const struct dea_breakdown_fit *fit, size_t i);
