#include "model/solid/mesh/surface.h"

#include <math.h>
#include <string.h>

/* Local nodes of a side of an element, [face nodes]. The axes after that of the side, in cyclic
 * order, turn right around it: that is outwards at its high end, and the other way round at its low
 * one. */
static void side_nodes(const struct dea_grid *grid, enum dea_face side, int order[2], int *nodes)
{
  const int orders[3] = {grid->order, grid->order, grid->order_z};
  const int stride[3] = {1, grid->order + 1, (grid->order + 1) * (grid->order + 1)};
  int axis = (int)side / 2, high = (int)side % 2;
  int first = (axis + (high ? 1 : 2)) % 3, second = (axis + (high ? 2 : 1)) % 3;
  order[0] = orders[first];
  order[1] = orders[second];
  for (int j = 0; j <= order[1]; j++) {
    for (int i = 0; i <= order[0]; i++) {
      *nodes++ = high * orders[axis] * stride[axis] + i * stride[first] + j * stride[second];
    }
  }
}

static void middle_of(const struct dea_surface *surface, size_t face, double middle[3])
{
  double X[3 * DEA_FACE_NODES_MAX];
  dea_face_gather(surface, face, surface->grid->X, X);
  for (int i = 0; i < 3; i++) {
    middle[i] = 0;
    for (int n = 0; n < surface->face_nodes; n++) {
      middle[i] += X[3 * n + i] / surface->face_nodes;
    }
  }
}

dea_status
dea_surface_create(struct dea_context *ctx, const struct dea_grid *grid, enum dea_face side,
                   bool (*select)(const void *self, int region, int ply, const double middle[3]),
                   const void *self, struct dea_arena *memory, struct dea_surface **out)
{
  const size_t count = grid->element_count;
  int local[DEA_FACE_NODES_MAX];
  struct dea_surface *s = dea_arena_alloc(memory, 1, sizeof *s);
  int *nodes = dea_arena_alloc(memory, count, DEA_FACE_NODES_MAX * sizeof *nodes);
  int *element = dea_arena_alloc(memory, count, sizeof *element);
  DEA_TRY(ctx, dea_arena_status(memory));
  *s = (struct dea_surface){.grid = grid, .nodes = nodes, .element = element};
  side_nodes(grid, side, s->order, local);
  s->face_nodes = (s->order[0] + 1) * (s->order[1] + 1);
  for (size_t e = 0; e < count; e++) {
    double middle[3];
    bool surface = grid->levels[e] == 1; // its own bottom and top, without other faces
    if (surface && side != DEA_FACE_BOTTOM && side != DEA_FACE_TOP) {
      continue;
    }
    for (int n = 0; n < s->face_nodes; n++) {
      // a face has its nodes
      // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign,clang-analyzer-core.UndefinedBinaryOperatorResult)
      int node = surface ? local[n] % s->face_nodes : local[n];
      s->nodes[s->face_count * DEA_FACE_NODES_MAX + (size_t)n] =
          grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)node];
    }
    middle_of(s, s->face_count, middle);
    if (select == NULL || select(self, grid->region[e], grid->ply[e], middle)) {
      s->element[s->face_count++] = (int)e;
    }
  }
  *out = s;
  return s->face_count > 0 ? DEA_OK
                           : dea_fail(ctx, DEA_E_ARGUMENT,
                                      "no face of the mesh belongs to the surface of a load");
}

void dea_face_gather(const struct dea_surface *surface, size_t face, const double *v, double *out)
{
  const int *nodes = surface->nodes + face * DEA_FACE_NODES_MAX;
  for (int n = 0; n < surface->face_nodes; n++) {
    memcpy(out + 3 * n, v + 3 * nodes[n], 3 * sizeof *out);
  }
}

void dea_face_normal(const struct dea_face_shape *shape, int point, const double *X,
                     double normal[3])
{
  double t[2][3] = {{0, 0, 0}, {0, 0, 0}};
  for (int a = 0; a < 2; a++) {
    for (int n = 0; n < shape->nodes; n++) {
      for (int i = 0; i < 3; i++) {
        t[a][i] += shape->slope[point][a][n] * X[3 * n + i];
      }
    }
  }
  dea_cross(t[0], t[1], normal);
}

/* Reference area of a point of a face, X at its nodes. */
static double point_area(const struct dea_face_shape *shape, int point, const double *X)
{
  double n[3];
  dea_face_normal(shape, point, X, n);
  return shape->weight[point] * sqrt(dea_dot(n, n));
}

double *dea_surface_weights(struct dea_arena *memory, const struct dea_surface *surface,
                            const struct dea_face_shape *shape)
{
  size_t points = (size_t)shape->points;
  double *weights = dea_arena_alloc(memory, surface->face_count * points, sizeof *weights);
  for (size_t f = 0; f < surface->face_count && weights != NULL; f++) {
    double X[3 * DEA_FACE_NODES_MAX];
    dea_face_gather(surface, f, surface->grid->X, X);
    for (size_t q = 0; q < points; q++) {
      weights[f * points + q] = point_area(shape, (int)q, X);
    }
  }
  return weights;
}

double dea_surface_area(const struct dea_surface *surface)
{
  struct dea_face_shape shape;
  double area = 0;
  dea_face_shape_create(surface->order, DEA_FACE_GAUSS, &shape);
  for (size_t f = 0; f < surface->face_count; f++) {
    double X[3 * DEA_FACE_NODES_MAX];
    dea_face_gather(surface, f, surface->grid->X, X);
    for (int q = 0; q < shape.points; q++) {
      area += point_area(&shape, q, X);
    }
  }
  return area;
}
