/* Numbers for people's eyes. */
#pragma once

#include <math.h>

/* A number to be printed, without what rounding left of 0: to the sixth digit behind the point. */
static inline double dea_rounded(double value)
{
  return 1e-6 * round(1e6 * value) + 0.0;
}
