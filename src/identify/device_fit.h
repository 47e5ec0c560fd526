/* A fit of a device to its measured curves: plain data that job/device_fit_run.c fills and output
 * writes. Least squares and statistics are those of materials (docs/theory/fit.md). */
#pragma once

#include "base/text.h"
#include "identify/device_file.h"
#include "identify/fit.h"
#include "result/columns.h"

enum { DEA_DEVICE_CURVES_MAX = 32, DEA_DEVICE_PAIRS_MAX = 8 };

/* What a parameter is in the design. */
enum dea_device_param_kind {
  DEA_DEVICE_KEY,
  DEA_DEVICE_MATERIAL, // a number of a material (study/numbers.h)
};

struct dea_device_param {
  struct dea_fit_param param; // its name is the key; numbers in SI, as the key has them
  enum dea_device_param_kind kind;
  const char *state;                   // " stretched", " unstretched" or ""; static storage
  bool list;                           // the key is a list of one number
  bool whole;                          // the key is a whole number
  size_t material, offset;             // of a number of a material: which one, and where in it
  double designed;                     // the design's value; NAN: it has none
  char prior_of[64];                   // material of the catalogue that the prior is from; "": none
  const struct dea_device_param *ties; // [tie_count] that take the same value; lent
  size_t tie_count;
};

/* One quantity of one file; arrays [rows]. */
struct dea_device_curve {
  const struct dea_device_curve_text *text; // lent
  const char *file;                         // interned
  char sha256[65];
  int column;                        // of the context
  const struct dea_column *quantity; // that; lent
  size_t rows;
  size_t *line, *stop;                                // line in the file; point of the model
  double *voltage_V, *time_s, *depth_m, *value, *std; // time_s, depth_m, std: NAN: there is none
  double *model, *model_std, *designed; // at the parameters found; designed: the design's
  bool *used;                           // fitted: not slack, of a curve that is fitted
  size_t slack;                         // rows that were cut
  double slack_from_V;                  // lowest voltage of them
  double lag, effective;                // as of a material's test; NAN where it is not fitted
  double rms, largest; // misfit of the rows that were not cut; largest over the range of values
};

/* Whether it is over the time, not the voltage. */
static inline bool dea_device_curve_in_time(const struct dea_device_curve *curve)
{
  return curve->text->kind.value == DEA_DEVICE_TRANSIENT;
}

/* Two parameters that the curves do not tell apart, and the measurement that would tell most. */
struct dea_device_pair {
  size_t first, second;
  double correlation; // NAN: not determined at all
  char next[96];      // "" where none of the list helps
  double shrink;      // factor on the larger of the two error bars; 0: then both are known
};

struct dea_device_fit {
  const struct dea_device_file *file; // lent
  const char *design_file, *model;    // interned; static storage
  char design_sha256[65];
  struct dea_device_param params[DEA_DEVICE_PARAMS_MAX];
  size_t param_count;
  struct dea_fit_core core; // of the same parameters
  struct dea_device_curve curves[DEA_DEVICE_CURVES_MAX];
  size_t curve_count;
  bool settled; // the values leave out as slack the rows that were left out for them
  struct dea_device_pair pairs[DEA_DEVICE_PAIRS_MAX];
  size_t pair_count;
  size_t evaluations;     // of the model: sweeps through all voltages
  struct dea_text design; // file of the fitted device
  struct dea_arena memory;
};

/* Fills weak, pairs and next from what was fitted; list [count]: what could be measured. */
void dea_device_identify(struct dea_device_fit *fit, const struct dea_fit_proposal *list,
                         size_t count);
