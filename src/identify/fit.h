/* A fit of a material: the law and its branches, error bars, what the measurements cannot tell.
 *
 * docs/theory/fit.md says how each number is found, docs/fit.md how it is used. */
#pragma once

#include "base/text.h"
#include "identify/fit_model.h"

/* A law that is stable over the range of the tests is taken before one that is not, unless that one
 * foretells held-out tests so many times better; and laws that foretell them so many times as badly
 * at most are compared where no test was made. */
#define DEA_FIT_STABLE_FACTOR 2.0
enum { DEA_FIT_WEAK_CONDITION = 1000 }; // singular values that far below the largest are told

/* A law of the list. */
struct dea_fit_candidate {
  char name[DEA_NAME_SIZE];
  bool failed; // it could not be fitted; `why`
  char why[160];
  size_t free_count, branch_count;
  double chi2, aicc; // of all rows
  /* Root mean square of what it misses of tests that were held out, NAN: none. It is what a law is
   * chosen by: in uncertainties where they are known, else over the largest stress of all tests. */
  double held_out;
  double
      held_out_share; // the same over the largest stress of each test, whatever uncertainties say
  enum dea_coupon_mode unstable_mode;
  double
      unstable_from; // lowest stretch of the range of the tests where it is not stable, NAN: none
};

/* A test beside the fit; arrays [series->rows]. */
struct dea_fit_curve {
  const struct dea_fit_series *series;
  double *stress_Pa,
      *std_Pa; // of the law, and the standard uncertainty that the parameters give it; INFINITY:
               // not determined
  double lag, effective;  // of a test that was fitted: correlation of neighbours, rows that count
  double rms_Pa, largest; // misfit [Pa], NAN of a prediction; largest share of the own stress
};

struct dea_fit_stability {
  enum dea_coupon_mode mode;
  bool measured;        // a test of that mode was fitted
  double to;            // stretch up to which it was looked at
  double unstable_from; // NAN: stable
};

/* How far laws that foretell held-out tests about as well are apart where no test was made. */
struct dea_fit_spread {
  enum dea_coupon_mode mode;
  double stretch; // with the I1 that the tests reach
  char other[DEA_NAME_SIZE];
  double share; // largest difference from the law that was taken, over its stress
};

struct dea_fit {
  const struct dea_fit_file *file; // lent
  const struct dea_fit_series *series;
  size_t series_count;
  struct dea_fit_candidate candidates[DEA_FIT_LAWS_MAX];
  size_t candidate_count, chosen;
  struct dea_fit_model model;
  struct dea_fit_core core;     // of the model
  struct dea_fit_curve *curves; // [series_count]
  struct dea_fit_stability stability[DEA_COUPON_MODES];
  struct dea_fit_spread
      spreads[DEA_COUPON_MODES]; // of modes without a test, where there is another
  size_t spread_count;
  double stretch_min, stretch_max, I1_max; // of the rows that were fitted
  struct dea_arena memory, tests;          // tests: the series, where they were read from the file
};

/* Fits; file and series: lent for as long as the result. profiles: of all parameters, not only
 * where the normal form is poor. Status as the model and the least squares give it; DEA_E_DESIGN
 * after findings. fit: freed by the caller, also after a failure. */
dea_status dea_fit_run(struct dea_context *ctx, const struct dea_fit_file *file,
                       const struct dea_fit_series *series, size_t series_count, bool profiles,
                       struct dea_fit *fit);
/* The same of the tests that the file names, in CSV files from its folder; what is wrong with them
 * becomes findings with their places, DEA_E_IO then, or DEA_E_DESIGN. fit: zeroed before. */
dea_status dea_fit_file_run(struct dea_context *ctx, const struct dea_fit_file *file, bool profiles,
                            struct dea_fit *fit);
void dea_fit_free(struct dea_fit *fit);

// Parts -------------------------------------------------------------------------------------------

/* Where the law ends to be stable, and the next test. */
void dea_fit_identify_stability(struct dea_fit *fit);
/* Stretch of a mode from which a material is not stable, looked for up to `to`; NAN: it is. */
double dea_fit_unstable_from(const struct dea_material *material, enum dea_coupon_mode mode,
                             double to);
/* Stretch of a mode, at least 1, with that I1. */
double dea_fit_stretch_as_far(enum dea_coupon_mode mode, double I1);
dea_status dea_fit_identify_next(struct dea_context *ctx, struct dea_fit *fit);
