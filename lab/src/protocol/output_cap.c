/* The largest voltages that may ever go out, whatever a sequence asks for. */
#include "protocol/protocol.h"

#include <math.h>

static const double rounding = 1e-9;
static const double zero_most_V = 60;  // that may be touched, as direct voltage (IEC 61140)
static const double zero_share = 0.01; // of the amplifier's range: errors of its monitor

void dea_protocol_cap(const struct dea_protocol *protocol, double *lowest_V, double *highest_V)
{
  double reach_V = protocol->amplifier.gain.si * protocol->amplifier.control_V.si;
  const struct dea_quantity *specimen = &protocol->specimen.highest_V;
  double most_V = specimen->origin != DEA_ABSENT ? fmin(reach_V, specimen->si) : reach_V;
  *highest_V = fmin(protocol->amplifier.highest_V.si, most_V);
  *lowest_V = fmax(protocol->amplifier.lowest_V.si, -most_V);
}

/* Not within also holds for what is no number. */
static bool is_within(double value_V, double lowest_V, double highest_V)
{
  double rounded_V = rounding * fmax(highest_V, -lowest_V);
  return value_V >= lowest_V - rounded_V && value_V <= highest_V + rounded_V;
}

dea_status dea_protocol_guard(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const double *volts, size_t count)
{
  double lowest_V, highest_V, gain = protocol->amplifier.gain.si;
  dea_protocol_cap(protocol, &lowest_V, &highest_V);
  for (size_t i = 0; i < count; i++) {
    if (!is_within(volts[i] * gain, lowest_V, highest_V)) {
      return dea_fail(ctx, DEA_E_INTERLOCK,
                      "a control voltage of %g V, %g kV at the film, was about to go out, where %g "
                      "kV to %g kV are allowed: it was held back",
                      volts[i], 1e-3 * gain * volts[i], 1e-3 * lowest_V, 1e-3 * highest_V);
    }
  }
  return DEA_OK;
}

bool dea_protocol_factor_is_known(const struct dea_protocol *protocol, double factor)
{
  const double gain = protocol->amplifier.gain.si;
  const double known[] = {1, gain, 1e-3 * gain};
  for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
    if (fabs(factor - known[i]) <= rounding * known[i]) {
      return true;
    }
  }
  return false;
}

double dea_zero_most_V(double range_V)
{
  return fmax(zero_most_V, zero_share * range_V);
}

double dea_protocol_zero_most_V(const struct dea_protocol *protocol)
{
  double reach_V = protocol->amplifier.gain.si * protocol->amplifier.control_V.si;
  double range_V = fmax(protocol->amplifier.highest_V.si, -protocol->amplifier.lowest_V.si);
  return dea_zero_most_V(fmin(range_V, reach_V));
}
