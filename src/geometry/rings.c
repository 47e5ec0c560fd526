#include "geometry/overlay.h"

void dea_rings_free(struct dea_context *ctx, struct dea_rings *rings)
{
  dea_free(ctx, rings->point);
  dea_free(ctx, rings->end);
  dea_free(ctx, rings->polygon);
  *rings = (struct dea_rings){0};
}
