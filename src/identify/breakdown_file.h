/* A fit file of breakdown tests: a table of films that broke or survived. */
#pragma once

#include "identify/fit_head.h"

struct dea_breakdown_file {
  struct dea_fit_head head;
  struct dea_label material;
  struct dea_label tests;                            // their table
  struct dea_quantity thickness_m, stretch, area_m2; // of all films; absent: columns
  struct dea_quantity exponent, thickness_exponent;  // known before; absent: found
  struct dea_quantity thickness0_m, area0_m2;        // references; absent: geometric means
};

extern const struct dea_record dea_breakdown_file_record;

/* Errors are findings with their places; DEA_E_DESIGN then. out: owned by the caller, NULL on
 * failure. */
dea_status dea_breakdown_file_read(struct dea_context *ctx, const char *file,
                                   struct dea_breakdown_file **out);
void dea_breakdown_file_destroy(struct dea_context *ctx, struct dea_breakdown_file *fit);
