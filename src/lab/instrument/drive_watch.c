#include "lab/instrument/drive_watch.h"

#include <math.h>
#include <stdio.h>

static const double blind_s = 0.5;

static size_t samples_of(double time_s, double rate_Hz)
{
  double samples = ceil(time_s * rate_Hz);
  return samples > 1 ? (size_t)samples : 1;
}

void dea_drive_watch_start(struct dea_drive_watch *watch, const struct dea_protocol *protocol,
                           double settle_s)
{
  double rate_Hz = protocol->rate_Hz.si;
  *watch = (struct dea_drive_watch){.protocol = protocol, .largest_current_A = NAN};
  watch->lasting = samples_of(protocol->safety.trip_time_s.si, rate_Hz);
  watch->blind = samples_of(blind_s, rate_Hz);
  watch->window = samples_of(settle_s, rate_Hz) + 1; // a sample may show what was asked before it
}

static void follow(struct dea_drive_watch *watch, double asked_V)
{
  if (++watch->in_window > watch->window) {
    watch->lowest_V[1] = watch->lowest_V[0];
    watch->highest_V[1] = watch->highest_V[0];
    watch->lowest_V[0] = watch->highest_V[0] = asked_V;
    watch->in_window = 1;
  }
  watch->lowest_V[0] = fmin(watch->lowest_V[0], asked_V);
  watch->highest_V[0] = fmax(watch->highest_V[0], asked_V);
}

static bool check_current(struct dea_drive_watch *watch, size_t i, double current_A,
                          char why[DEA_WHY_ENDED_SIZE])
{
  double limit_A = watch->protocol->safety.trip_current_A.si;
  watch->largest_current_A = fmax(watch->largest_current_A, fabs(current_A));
  watch->exceeded[i] = fabs(current_A) > limit_A ? watch->exceeded[i] + 1 : 0;
  if (watch->exceeded[i] < watch->lasting) {
    return true;
  }
  snprintf(why, DEA_WHY_ENDED_SIZE,
           "the current is %.4g uA, above safety.trip_current of %.4g uA for %.3g ms",
           1e6 * current_A, 1e6 * limit_A, 1e3 * watch->protocol->safety.trip_time_s.si);
  return false;
}

static bool check_voltage(struct dea_drive_watch *watch, size_t i, double asked_V, double voltage_V,
                          char why[DEA_WHY_ENDED_SIZE])
{
  double error_V = watch->protocol->safety.voltage_error_V.si;
  double lowest_V = fmin(watch->lowest_V[0], watch->lowest_V[1]);
  double highest_V = fmax(watch->highest_V[0], watch->highest_V[1]);
  bool wrong = voltage_V < lowest_V - error_V || voltage_V > highest_V + error_V;
  watch->exceeded[i] = wrong ? watch->exceeded[i] + 1 : 0;
  if (watch->exceeded[i] < watch->lasting) {
    return true;
  }
  snprintf(why, DEA_WHY_ENDED_SIZE,
           "the voltage is %.4g kV where %.4g kV is asked: more than safety.voltage_error of %.4g "
           "V away; is the amplifier on, and are gain and channel right?",
           1e-3 * voltage_V, 1e-3 * asked_V, error_V);
  return false;
}

static bool check_missing(struct dea_drive_watch *watch, size_t i, char why[DEA_WHY_ENDED_SIZE])
{
  if (++watch->missing[i] < watch->blind) {
    return true;
  }
  snprintf(why, DEA_WHY_ENDED_SIZE, "channel '%.64s' has given no value for %.2g s",
           watch->protocol->inputs[i].name.text, blind_s);
  return false;
}

bool dea_drive_watch_sample(struct dea_drive_watch *watch, double asked_V, const double *values,
                            char why[DEA_WHY_ENDED_SIZE])
{
  bool good = true;
  follow(watch, asked_V);
  for (size_t i = 0; i < watch->protocol->input_count && good; i++) {
    int kind = watch->protocol->inputs[i].kind.value;
    if (kind != DEA_CHANNEL_CURRENT && kind != DEA_CHANNEL_VOLTAGE) {
      continue;
    }
    if (isnan(values[i])) { // neither good nor bad
      good = check_missing(watch, i, why);
      continue;
    }
    watch->missing[i] = 0;
    good = kind == DEA_CHANNEL_CURRENT ? check_current(watch, i, values[i], why)
                                       : check_voltage(watch, i, asked_V, values[i], why);
  }
  return good;
}
