/* Profiles across the film beside measured ones. */
#pragma once

#include "result/compare.h"

/* Which half of a model's line from the centre to the frame: model 3d has one along a fibre and one
 * halfway between two fibres; a model without a direction has the former only. */
enum dea_half { DEA_HALF_FIBRE, DEA_HALF_BETWEEN, DEA_HALVES };

/* The film as a sensor above it sees it: distance from the centre as it moved, strictly rising, and
 * displacement out of the plane. Arrays [count], owned. */
struct dea_film_line {
  size_t count; // 0: the model has none, or none that leaves the plane
  double *x_m, *z_m;
  bool directed;        // the model tells the two halves apart
  bool between_records; // formed of two voltages that were computed
};

/* Line of a model of the result at a voltage: of the profile within 0.5 % of it, or linear in the
 * voltage between the first two neighbours that have it between them. out: freed by the caller
 * after success. */
dea_status dea_film_line_make(struct dea_context *ctx, const struct dea_result *result,
                              const char *model, double voltage_V, enum dea_half half,
                              struct dea_film_line *out);
void dea_film_line_free(struct dea_context *ctx, struct dea_film_line *line);

/* line minus measured at the measured places x_m [count], on both sides of the centre; those beyond
 * the film are left out. z_std_m: NULL or NAN for unknown. out: freed by the caller, also after a
 * failure; count 0: no place in common. */
dea_status dea_film_line_compare(struct dea_context *ctx, const struct dea_film_line *line,
                                 const double *x_m, const double *z_m, const double *z_std_m,
                                 size_t count, struct dea_misfit *out);
