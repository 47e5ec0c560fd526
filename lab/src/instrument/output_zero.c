#include "instrument/output_zero.h"

#include <math.h>
#include <stdio.h>

const char dea_zero_no_answer[] = "no answer that can be believed",
           dea_zero_not_for_long[] = "not for as long as `behind` within `zero_time`",
           dea_zero_contradicted[] = "it had measured another voltage than was set",
           dea_zero_other[] = "another program drives it",
           dea_zero_unseen[] = "what measures it was not seen to follow the output away from 0 V";

const char *dea_zero_name(enum dea_zero_state state)
{
  switch (state) {
  case DEA_ZERO_NONE:
    return "not armed";
  case DEA_ZERO_READ_BACK:
    return "at 0 V";
  case DEA_ZERO_COMMANDED:
    return "commanded to 0 V, not read back";
  default:
    return "not known to be at 0 V";
  }
}

void dea_zero_doubt(struct dea_zero *zero, const char *why)
{
  if (zero->state != DEA_ZERO_UNKNOWN || zero->why == NULL) {
    zero->why = why;
  }
  zero->state = DEA_ZERO_UNKNOWN;
}

struct dea_zero dea_zero_believe(struct dea_zero zero, const char *doubt)
{
  if (doubt != NULL && (zero.state == DEA_ZERO_READ_BACK || doubt == dea_zero_contradicted)) {
    dea_zero_doubt(&zero, doubt);
  }
  return zero;
}

void dea_zero_text(struct dea_zero zero, char out[DEA_ZERO_TEXT_SIZE])
{
  const char *why = zero.state == DEA_ZERO_UNKNOWN ? zero.why : NULL;
  char volts[32] = "";
  if (!isnan(zero.volts)) {
    snprintf(volts, sizeof volts, "%.3g V read back", zero.volts);
  }
  if (volts[0] == '\0' && why == NULL) {
    snprintf(out, DEA_ZERO_TEXT_SIZE, "%s", dea_zero_name(zero.state));
  } else {
    snprintf(out, DEA_ZERO_TEXT_SIZE, "%s (%s%s%s)", dea_zero_name(zero.state), volts,
             volts[0] != '\0' && why != NULL ? "; " : "", why != NULL ? why : "");
  }
}
