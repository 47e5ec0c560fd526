#include "model/solid/model3d/adapt.h"

#include <math.h>
#include <string.h>

/* Of the ratio of sizes between one mesh and the next: estimates do not see further. */
static const double finest = 0.35, coarsest = 1.4;
static const double share = 0.8; // of the error wanted: meshes do not come out as asked for

/* Area and middle of an element of the plane mesh by its corners. */
static double area_of(const struct dea_plane_mesh *plane, size_t q, double middle[2])
{
  int line = plane->order + 1;
  const int corner[4] = {0, line - 1, line * line - 1, line * (line - 1)};
  const double *x[4];
  double area = 0;
  middle[0] = middle[1] = 0;
  for (int k = 0; k < 4; k++) {
    x[k] = plane->x + 2 * plane->quads[q * (size_t)(line * line) + (size_t)corner[k]];
    middle[0] += 0.25 * x[k][0];
    middle[1] += 0.25 * x[k][1];
  }
  for (int k = 0; k < 4; k++) {
    const double *a = x[k], *b = x[(k + 1) % 4];
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

/* What the elements above an element of the plane mesh add together. */
static dea_status gather(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                         const double *part, double *sum)
{
  const struct dea_plane_mesh *plane = mesh->plane;
  const struct dea_grid *grid = mesh->grid;
  size_t per = (size_t)((plane->order + 1) * (plane->order + 1));
  int *next = dea_alloc(ctx, plane->quad_count, sizeof *next); // with the same first node, from 1
  int *first = dea_alloc(ctx, plane->node_count, sizeof *first);
  if (next == NULL || first == NULL) {
    dea_free(ctx, next);
    dea_free(ctx, first);
    return DEA_E_MEMORY;
  }
  for (size_t q = 0; q < plane->quad_count; q++) {
    int *of = &first[plane->quads[q * per]];
    next[q] = *of;
    *of = (int)q + 1;
  }
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    int q = first[grid->column[nodes[0]]];
    while (plane->quads[(size_t)q * per - 1] != grid->column[nodes[per - 1]]) {
      q = next[q - 1];
    }
    sum[q - 1] += fabs(part[e]);
  }
  dea_free(ctx, next);
  dea_free(ctx, first);
  return DEA_OK;
}

dea_status dea_adapt_sizes(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                           const double *part, double wanted, double (*at)[3])
{
  size_t count = mesh->plane->quad_count;
  double *sum = dea_alloc(ctx, count, sizeof *sum), roots = 0;
  dea_status status = sum != NULL ? gather(ctx, mesh, part, sum) : DEA_E_MEMORY;
  for (size_t q = 0; q < count && status == DEA_OK; q++) {
    roots += sqrt(sum[q]);
  }
  for (size_t q = 0; q < count && status == DEA_OK; q++) {
    double ratio = sqrt(share * wanted / (roots * sqrt(sum[q])));
    double size = sqrt(area_of(mesh->plane, q, at[q]));
    at[q][2] = size * fmin(coarsest, fmax(finest, ratio)); // coarsest where the sum is 0
  }
  dea_free(ctx, sum);
  return status;
}
