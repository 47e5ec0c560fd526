#include "reduce/reduce_parts.h"

/* One way through the samples; y follows x with the time constant tau_s, exactly for a value that
 * stays over each interval, so that the samples may lie unevenly. */
static void pass(const struct dea_channel *channel, double tau_s, bool backward, double *values)
{
  double y = NAN, before_s = 0.0;
  for (size_t k = 0; k < channel->count; k++) {
    size_t i = backward ? channel->count - 1 - k : k;
    double time_s = dea_channel_time(channel, i);
    if (isnan(values[i])) {
      continue;
    }
    double share = isnan(y) ? 1.0 : -expm1(-fabs(time_s - before_s) / tau_s);
    y = isnan(y) ? values[i] : y + share * (values[i] - y);
    values[i] = y;
    before_s = time_s;
  }
}

/* Time constant of each way. Both ways together: 1 / (1 + (f / f1)^2) = 1 / sqrt(2) at the cutoff.
 */
static double time_constant(double cutoff_Hz)
{
  double f1_Hz = cutoff_Hz / sqrt(sqrt(2.0) - 1.0);
  return 1.0 / (2.0 * DEA_PI * f1_Hz);
}

double dea_filter_reach(double cutoff_Hz)
{
  return cutoff_Hz > 0.0 ? 15.0 * time_constant(cutoff_Hz) : 0.0; // exp(-15) = 3e-7
}

double dea_filter_rise(double cutoff_Hz)
{
  // of a step behind both ways: 1 - exp(-t/tau)/2 after it, and the mirror image before it
  return cutoff_Hz > 0.0 ? 2.0 * log(5.0) * time_constant(cutoff_Hz) : 0.0;
}

void dea_filter_apply(const struct dea_channel *channel, double cutoff_Hz, double *values)
{
  for (size_t i = 0; i < channel->count; i++) {
    values[i] = channel->values[i];
  }
  if (!(cutoff_Hz > 0.0)) {
    return;
  }
  double tau_s = time_constant(cutoff_Hz);
  pass(channel, tau_s, false, values);
  pass(channel, tau_s, true, values);
}
