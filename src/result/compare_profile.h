/* Profiles across the film beside measured ones. */
#pragma once

#include "result/compare.h"

/* Which half of a model's line from the centre to the frame: model 3d has one along a fibre and one
 * halfway between two fibres; a model without a direction has the former only. */
enum dea_half { DEA_HALF_FIBRE, DEA_HALF_BETWEEN, DEA_HALVES };

/* The film as a sensor above it sees it: displacement out of the plane at the places as they moved,
 * on both sides of the centre, each the same. */
struct dea_film_line {
  struct dea_samples samples; // count 0: the model has none, or none that leaves the plane
  bool directed;              // the model tells the two halves apart
  bool between_records;       // formed of two voltages that were computed
};

/* Line of a model of the result at a voltage: of the profile within 0.5 % of it, or linear in the
 * voltage between the first two neighbours that have it between them. */
dea_status dea_film_line_build(struct dea_arena *memory, const struct dea_result *result,
                               const char *model, double voltage_V, enum dea_half half,
                               struct dea_film_line *out);

/* line minus measured at the measured places, on both sides of the centre; those beyond the film
 * are left out. */
dea_status dea_film_line_compare(struct dea_arena *memory, const struct dea_film_line *line,
                                 const struct dea_samples *measured, struct dea_misfit *out);
