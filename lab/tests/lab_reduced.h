/* What the programs that test the reduction as a whole share. */
#pragma once

#include "context_fixture.h"
#include "lab_signals.h"
#include "reduce/reduce.h"

static const struct dea_reduce_options plain = {NAN, NAN, NAN, 0.0, NAN};

static struct dea_recording r;    // that was made last
static struct dea_reduction *out; // of it

/* Of a bench, in place of the one before. */
static inline void record(const struct signal_bench *b, uint64_t seed)
{
  signal_free(&r);
  r = signal_record(b, seed);
}

/* Of a voltage and a displacement, to be filled. */
static inline void record_two(double rate_Hz, size_t count)
{
  signal_free(&r);
  r = (struct dea_recording){.file = "", .title = "", .complete = true};
  signal_channel(&r, "voltage", DEA_CHANNEL_VOLTAGE, rate_Hz, count);
  signal_channel(&r, "displacement", DEA_CHANNEL_DISPLACEMENT, rate_Hz, count);
}

static inline void reduce(const struct dea_reduce_options *options)
{
  dea_reduction_destroy(ctx, out);
  dea_finding_clear(ctx);
  dea_status status = dea_reduce(ctx, &r, options, &out);
  if (status != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
}

static inline int reduced_tear_down(void **state)
{
  dea_reduction_destroy(ctx, out);
  signal_free(&r);
  return context_tear_down(state);
}

static inline bool noted(const char *words)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; i < count; i++) {
    if (strstr(findings[i].text, words) != NULL) {
      return true;
    }
  }
  return false;
}

/* A film under a line laser that is tilted, drifts, loses points and has outliers. */
static inline struct signal_bench line_laser(void)
{
  struct signal_bench b = signal_bench_plain();
  b.points = 250;
  b.cycles = 3;
  b.point_sigma = 8e-6;
  b.common_sigma = 6e-6;
  b.rho = 0.3;
  b.tilt = 0.03;
  b.height_m = -1.2e-3;
  b.centre_m = 0.8e-3;
  b.outliers = 0.01;
  b.lost = 0.03;
  b.drift_per_s = 1e-6;
  return b;
}
