/* How far a curve is to be trusted, and how far its device lives, from the flags of its points
 * (docs/theory/trust.md). */
#pragma once

#include "base/text.h"
#include "result/result.h"

/* Largest voltages of a curve below which no point has a doubt (trusted_V), a danger (safe_V),
 * either (good_V); NAN where its first voltage has one. */
struct dea_trust {
  double trusted_V, safe_V, good_V;
  double doubt_V, danger_V; // of the first point with one [V]; INFINITY: none
  double slack_V;           // first without tension somewhere, below doubt_V; NAN: none
  unsigned doubts, dangers; // flags of the points with a doubt and a danger
  unsigned limits;          // of the model, at any point
};
/* curve: with points. */
struct dea_trust dea_curve_trust(const struct dea_curve *curve);
/* One sentence without its full stop: "valid and below breakdown up to 3.3 kV; at 3.4 kV ...". */
void dea_trust_text(const struct dea_trust *trust, struct dea_text *out);

/* Flags with a doubt at a voltage of the model's sweep; 0 where none is known, also without a
 * result. */
unsigned dea_result_doubts(const struct dea_result *result, const char *model, double voltage_V);
/* "8 kV", or "8 kV, not to be trusted: slack": what stands beside a picture of that state. Returns
 * out. */
enum { DEA_VOLTAGE_WORDS = 160 };
const char *dea_voltage_words(const struct dea_result *result, const char *model, double voltage_V,
                              char out[DEA_VOLTAGE_WORDS]);
