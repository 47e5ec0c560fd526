#include "result/observation.h"

#include <math.h>

enum dea_observed dea_observed_main(const double values[DEA_OBSERVED_COUNT])
{
  enum dea_observed main = DEA_OBSERVED_X;
  if (!isnan(values[DEA_OBSERVED_STRETCH])) {
    return DEA_OBSERVED_STRETCH;
  }
  if (!isnan(values[DEA_OBSERVED_AREA_STRETCH])) {
    return DEA_OBSERVED_AREA_STRETCH;
  }
  for (int k = DEA_OBSERVED_Y; k <= DEA_OBSERVED_Z; k++) {
    main = fabs(values[k]) > fabs(values[main]) ? (enum dea_observed)k : main;
  }
  return main;
}
