#include "lab/instrument/zero.h"

#include <math.h>
#include <stdio.h>

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

void dea_zero_text(struct dea_zero zero, char out[DEA_ZERO_TEXT_SIZE])
{
  if (isnan(zero.volts)) {
    snprintf(out, DEA_ZERO_TEXT_SIZE, "%s", dea_zero_name(zero.state));
  } else {
    snprintf(out, DEA_ZERO_TEXT_SIZE, "%s (%.3g V read back)", dea_zero_name(zero.state),
             zero.volts);
  }
}
