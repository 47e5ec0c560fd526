/* What is known of one measured voltage: whether it follows what was sent to the output. Everybody
 * who has to say something of that output asks here (docs/theory/interlocks.md, "Evidence").
 *
 * The output is where it was asked to be after a time that is not known, up to `lag_s`. A voltage
 * that no such time explains contradicts what was sent; so do a few of them whose peak, least,
 * mean or effective value none explains: what was sent at the same moments is compared, so that a
 * meter may be as slow as it likes. 0 V is believed of a meter that was seen away from it, as was
 * sent, the last time that it was looked at there, and that has contradicted nothing.
 * Zero-initialised: of nothing sent. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

enum {
  DEA_EVIDENCE_LAGS = 33,
  DEA_EVIDENCE_BINS = 144,
  DEA_EVIDENCE_READINGS = 8, // that are compared at a time
  DEA_EVIDENCE_TEXT_SIZE = 160
};

enum dea_evidence_verdict {
  DEA_EVIDENCE_FOLLOWS,
  DEA_EVIDENCE_WRONG, // by more than error_V: it contradicts
  DEA_EVIDENCE_OFF // once: by more than `share` (and zero_V) for 5 s, and by no more than error_V
};

/* Of some voltages: the second largest and least, which one stray value does not move. */
struct dea_evidence_statistics {
  double sum, square, most[2], least[2];
};

struct dea_evidence_window {
  size_t count;
  double away_s; // for how long it was looked at away from 0 V
  struct dea_evidence_statistics measured;
  // of what was sent, for each lag: the output was between these
  struct dea_evidence_statistics low[DEA_EVIDENCE_LAGS], high[DEA_EVIDENCE_LAGS];
};

struct dea_evidence {
  // set before it is used
  double lag_s, slew_V_per_s;    // of the output, at most; the second 0: not known
  double error_V, share, zero_V; // what is wrong, off, and 0 V
  // what the output was at, in bins of time: the newest has this number
  double bin, low_V[DEA_EVIDENCE_BINS], high_V[DEA_EVIDENCE_BINS];
  double sent_V, output_V, largest_V; // the last by amount
  // what was measured
  struct dea_evidence_window few[2], many; // the first two begin at different readings
  double looked_s;
  size_t readings, wrong,
      unseen; // wrong: in a row; unseen: near 0 V where more is sent, in a row
  bool follows, contradicted, off;
  /* The last that did not fit: "peak" of so many readings, of 1 itself. */
  const char *what;
  size_t of;
  double measured_V, set_V;
};

/* A voltage was sent. */
void dea_evidence_sent(struct dea_evidence *evidence, double volts, double now_s);
/* A voltage was measured, at a time between these. */
enum dea_evidence_verdict dea_evidence_measured(struct dea_evidence *evidence, double volts,
                                                double from_s, double to_s);
/* Whether it has to be looked at away from 0 V, should it be there. */
bool dea_evidence_wants(const struct dea_evidence *evidence);
/* Why 0 V is not believed should it be measured, static; NULL: it is. */
const char *dea_evidence_doubt(const struct dea_evidence *evidence);
/* "measures 0.8 kV as the peak of 8 readings where 2 kV was set"; gain: of these voltages. */
void dea_evidence_text(const struct dea_evidence *evidence, double gain,
                       char out[DEA_EVIDENCE_TEXT_SIZE]);
