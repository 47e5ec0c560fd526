/* A fit of life tests: the specimens as they are read, and Weibull's law of their lives. */
#pragma once

#include "base/arena.h"
#include "identify/fit_head.h"
#include "identify/weibull.h"

enum dea_life_clock {
  DEA_LIFE_CYCLES,
  DEA_LIFE_TIME,          // s
  DEA_LIFE_UNDER_VOLTAGE, // s
  DEA_LIFE_CHARGE,        // C, brought to the film
  DEA_LIFE_CLOCKS
};

enum dea_life_end {
  DEA_LIFE_SURVIVED,
  DEA_LIFE_STROKE,
  DEA_LIFE_LEAKAGE,
  DEA_LIFE_BREAKDOWN,
  DEA_LIFE_TOLD, // by who wrote the file
  DEA_LIFE_ENDS
};

/* The life of a specimen that was cycled. */
struct dea_life {
  enum dea_life_end end;
  size_t row;                       // of the cycle that failed first, or the last one
  double clock[DEA_LIFE_CLOCKS];    // at its end
  double first_stroke, last_stroke; // mean of the first cycles, that by `row`
};

/* Specimens that were cycled until they failed or the test ended. */
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

extern const struct dea_fit_form dea_life_form;

struct dea_life_fit {
  struct dea_arena memory;
  const struct dea_life_file *file; // lent
  size_t rows, failed;
  struct dea_life *lives; // [rows]; clocks that are not known are NAN
  double *value;          // [rows] of the chosen clock, SI
  bool *survived;         // [rows]
  bool has_law;           // false: fewer than two failures
  struct dea_weibull_fit fit;
};

/* Words for why a life ended: "survived", "stroke", ... */
extern const char *const dea_life_end_names[];

/* Reads the tables life.csv of the specimens' folders, judges and fits. What is wrong becomes
 * findings with file and line; DEA_E_IO then. fit: freed by the caller, also after a failure. */
dea_status dea_life_fit_run(struct dea_context *ctx, const struct dea_life_file *file,
                            struct dea_life_fit *fit);
void dea_life_fit_free(struct dea_life_fit *fit);

/* Least share of specimens of which it is 95 % certain that fewer have failed by the shortest
 * survived life, where none has failed: 1 - 0.05^(1/n). */
double dea_life_fit_bound(const struct dea_life_fit *fit, double *life);
