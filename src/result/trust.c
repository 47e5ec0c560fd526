#include "result/trust.h"

#include <math.h>
#include <stdio.h>

/* Flags of a kind. */
static unsigned of_kind(unsigned flags, enum dea_flag_kind kind)
{
  for (int k = 0; k < DEA_FLAG_COUNT; k++) {
    flags &= dea_flag_words[k].kind == kind ? ~0u : ~(1u << k);
  }
  return flags;
}

/* Largest voltage of a curve below a limit; NAN for none. */
static double largest_below(const struct dea_curve *curve, double limit_V)
{
  double largest = NAN;
  for (size_t i = 0; i < curve->count; i++) {
    double at = curve->points[i].voltage_V;
    largest = at < limit_V ? fmax(largest, at) : largest;
  }
  return largest;
}

/* Lowest voltage below a limit with a part of the film out of tension; NAN for none. */
static double slack_below(const struct dea_curve *curve, double limit_V)
{
  double lowest = NAN;
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    bool slack = p->min_tension_N_per_m < 0 && p->voltage_V < limit_V;
    lowest = slack ? fmin(lowest, p->voltage_V) : lowest;
  }
  return lowest;
}

struct dea_trust dea_curve_trust(const struct dea_curve *curve)
{
  struct dea_trust trust = {.doubt_V = INFINITY, .danger_V = INFINITY};
  for (size_t i = 0; i < curve->count; i++) {
    const struct dea_load_point *p = &curve->points[i];
    unsigned flags = dea_load_point_flags(p);
    unsigned doubts = of_kind(flags, DEA_FLAG_DOUBT), dangers = of_kind(flags, DEA_FLAG_DANGER);
    trust.limits |= of_kind(flags, DEA_FLAG_LIMIT);
    if (doubts != 0 && p->voltage_V < trust.doubt_V) {
      trust.doubt_V = p->voltage_V;
      trust.doubts = doubts;
    }
    if (dangers != 0 && p->voltage_V < trust.danger_V) {
      trust.danger_V = p->voltage_V;
      trust.dangers = dangers;
    }
  }
  trust.trusted_V = largest_below(curve, trust.doubt_V);
  trust.safe_V = largest_below(curve, trust.danger_V);
  trust.slack_V = slack_below(curve, trust.doubt_V);
  trust.good_V = largest_below(curve, fmin(trust.doubt_V, trust.danger_V));
  return trust;
}

/* "the film ..., and the state ...". */
static void add_flags(struct dea_text *out, unsigned flags)
{
  const char *before = "";
  for (int k = 0; k < DEA_FLAG_COUNT; k++) {
    if ((flags >> k & 1u) != 0) {
      dea_text_add(out, "%s%s", before, dea_flag_words[k].sentence);
      before = ", and ";
    }
  }
}

void dea_trust_text(const struct dea_trust *trust, struct dea_text *out)
{
  if (isnan(trust->good_V)) {
    dea_text_add(out, "at no voltage both valid and below breakdown");
  } else {
    dea_text_add(out, "valid and below breakdown up to %.4g kV", 1e-3 * trust->good_V);
  }
  if (trust->dangers != 0 && trust->danger_V <= trust->doubt_V) {
    dea_text_add(out, "; at %.4g kV ", 1e-3 * trust->danger_V);
    add_flags(out, trust->dangers);
    if (!isnan(trust->trusted_V) && trust->trusted_V > trust->good_V) {
      dea_text_add(out, "; valid up to %.4g kV, for a film that withstands",
                   1e-3 * trust->trusted_V);
    }
  }
  if (!isnan(trust->slack_V)) {
    dea_text_add(
        out,
        "; from %.4g kV on a part of the film has no tension left, with too little compression "
        "to wrinkle it",
        1e-3 * trust->slack_V);
  }
  if (trust->doubts != 0) {
    dea_text_add(out, "; at %.4g kV ", 1e-3 * trust->doubt_V);
    add_flags(out, trust->doubts);
  }
  if (trust->limits != 0) {
    dea_text_add(out, "; at all voltages ");
    add_flags(out, trust->limits);
  }
}

unsigned dea_result_doubts(const struct dea_result *result, const char *model, double voltage_V)
{
  const struct dea_curve *sweep = result != NULL ? dea_result_find(result, model, "sweep") : NULL;
  unsigned doubts = 0;
  for (size_t i = 0; sweep != NULL && i < sweep->count; i++) {
    if (sweep->points[i].voltage_V == voltage_V) {
      doubts |= of_kind(dea_load_point_flags(&sweep->points[i]), DEA_FLAG_DOUBT);
    }
  }
  return doubts;
}

const char *dea_voltage_words(const struct dea_result *result, const char *model, double voltage_V,
                              char out[DEA_VOLTAGE_WORDS])
{
  char words[DEA_FLAGS_SIZE];
  unsigned doubts = dea_result_doubts(result, model, voltage_V);
  snprintf(out, DEA_VOLTAGE_WORDS, "%.4g kV%s%s", 1e-3 * voltage_V,
           doubts != 0 ? ", not to be trusted: " : "", dea_flags_text(doubts, words));
  return out;
}
