/* A fit file of life tests: specimens that were cycled until they failed or the test ended. */
#pragma once

#include "identify/fit_head.h"
#include "identify/life.h"

enum { DEA_LIFE_SPECIMENS_MAX = 200, DEA_LIFE_PARTS_MAX = 16 };

struct dea_life_specimen {
  struct dea_label name;
  struct dea_label reduced[DEA_LIFE_PARTS_MAX]; // folders of its recordings, in time
  size_t reduced_count;
  struct dea_quantity life; // in the clock's unit, where it is known already
  struct dea_choice failed;
};

struct dea_life_file {
  struct dea_fit_head head;
  struct dea_life_specimen specimens[DEA_LIFE_SPECIMENS_MAX];
  size_t specimen_count;
  struct dea_choice clock, breakdown;
  struct dea_quantity stroke_loss, reference_cycles, lasting, leakage_A;
};

/* Words of the clocks, their units, and what a unit is in SI. */
extern const char *const dea_life_clock_names[];
extern const char *const dea_life_clock_units[];
extern const double dea_life_clock_factors[]; // SI -> unit

extern const struct dea_record dea_life_file_record;

/* Errors are findings with their places; DEA_E_DESIGN then. out: owned by the caller, NULL on
 * failure. */
dea_status dea_life_file_read(struct dea_context *ctx, const char *file,
                              struct dea_life_file **out);
void dea_life_file_destroy(struct dea_context *ctx, struct dea_life_file *fit);
