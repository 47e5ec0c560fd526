/* The life of a specimen that was cycled: when it failed by a criterion, or that it survived. The
 * criterion is applied to what was recorded, so that a recording goes on behind a failure and
 * another criterion may be asked later (docs/theory/reduction.md, "Lives"). */
#pragma once

#include <stdbool.h>
#include <stddef.h>

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

/* Cycles in time, of all recordings of a specimen; NAN: not known. */
struct dea_life_rows {
  size_t count;
  double *clock[DEA_LIFE_CLOCKS];                   // [count] at the end of each cycle
  double *asked_V, *stroke, *leakage_A, *breakdown; // [count]; breakdown: how many
};

struct dea_life_criterion {
  double stroke_loss; // share of the first stroke; NAN: not looked at
  double leakage_A;   // NAN: not looked at
  bool breakdown;
  size_t reference_cycles, lasting; // the first stroke's, and in a row
};

struct dea_life {
  enum dea_life_end end;
  size_t row;                       // of the cycle that failed first, or the last one
  double clock[DEA_LIFE_CLOCKS];    // at its end
  double first_stroke, last_stroke; // mean of the first cycles, that by `row`
};

/* Only cycles within 1 % of the largest voltage are judged by stroke and leakage; a breakdown
 * counts in any. rows->count > 0. */
void dea_life_judge(const struct dea_life_rows *rows, const struct dea_life_criterion *criterion,
                    struct dea_life *out);
