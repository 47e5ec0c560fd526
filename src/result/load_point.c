#include "result/load_point.h"

#include <math.h>

struct dea_load_point dea_load_point_empty(void)
{
  return (struct dea_load_point){
#define LOAD_POINT_NAN(member, si, display, factor, header, meaning) .member = NAN,
      DEA_LOAD_POINT_LIST(LOAD_POINT_NAN)
#undef LOAD_POINT_NAN
          .stable = true,
      .unstable_modes = 0,
  };
}
