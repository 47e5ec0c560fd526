#include "model/solid/model3d/air_mass.h"

#include "geometry/region.h"
#include "model/solid/element/membrane.h"
#include "model/solid/point/part_material.h"

#include <math.h>
#include <string.h>

/* A parallelogram of the surface, the product of its area and the shapes' normal components, and
 * the potential of a source of one in it at its middle, the sums over others being taken at theirs.
 */
struct cell {
  double x[3], own, flux[DEA_AIR_SHAPES_MAX];
};

struct work {
  const struct dea_field_mesh *surface;
  const double *displacement, *shapes;
  size_t count, cell_count;
  double area;        // about, of all elements that were divided
  struct cell *cells; // NULL: they are counted
};

/* Of a lattice of such cells, what the sum of 1/r over the others lacks of the integral over all:
 * less its Epstein zeta function at 1/2, 3.90 for unit squares, by Ewald's sums, of which the two
 * are equal in the plane. */
static double own_potential(const double a[3], const double b[3], double area)
{
  enum { FAR = 8 };
  double sum = 0;
  for (int i = -FAR; i <= FAR; i++) {
    for (int j = -FAR; j <= FAR; j++) {
      const double r =
          sqrt(fmax(i * i * dea_dot(a, a) + 2 * i * j * dea_dot(a, b) + j * j * dea_dot(b, b), 0));
      sum += i != 0 || j != 0 ? erfc(sqrt(DEA_PI / area) * r) / r : 0;
    }
  }
  return 4 / sqrt(area) - 2 * sum;
}

/* Value and slopes of a vector [points][3] at a place of an element, as the basis. */
static void interpolate(const double *values, const int *nodes, int row,
                        double basis[3][DEA_FACE_NODES_MAX], double out[3][3])
{
  memset(out, 0, 9 * sizeof out[0][0]);
  for (int n = 0; n < row * row; n++) {
    for (int i = 0; i < 9; i++) {
      out[i / 3][i % 3] += basis[i / 3][n] * values[3 * nodes[n] + i % 3];
    }
  }
}

/* Place and slopes of the surface. */
static void find_place(const struct work *w, const int *nodes, int row, const double at[2],
                       double basis[3][DEA_FACE_NODES_MAX], double x[3][3])
{
  double moved[3][3];
  dea_face_basis((const int[2]){row - 1, row - 1}, at, basis[0], basis + 1);
  interpolate(w->surface->X, nodes, row, basis, x);
  interpolate(w->displacement, nodes, row, basis, moved);
  for (int i = 0; i < 9; i++) {
    x[i / 3][i % 3] += moved[i / 3][i % 3];
  }
}

static void add_cell(struct work *w, const int *nodes, int row, const double at[2],
                     const double size[2])
{
  double basis[3][DEA_FACE_NODES_MAX], x[3][3], v[3][3];
  struct cell *cell = &w->cells[w->cell_count];
  find_place(w, nodes, row, at, basis, x);
  for (int i = 0; i < 3; i++) {
    x[1][i] *= size[0];
    x[2][i] *= size[1];
  }
  const double *a = x[1], *b = x[2];
  double normal[3];
  dea_cross(a, b, normal);
  memcpy(cell->x, x[0], sizeof cell->x);
  cell->own = own_potential(a, b, sqrt(dea_dot(normal, normal)));
  for (size_t k = 0; k < w->count; k++) {
    interpolate(w->shapes + 3 * k * w->surface->point_count, nodes, row, basis, v);
    cell->flux[k] = dea_dot(v[0], normal);
  }
}

/* Cells about as long as wide, of elements that are. */
static void divide(struct work *w, const int *nodes, int row, double length)
{
  enum { SLIM = 6 };
  double basis[3][DEA_FACE_NODES_MAX], x[3][3], side[2];
  size_t n[2];
  find_place(w, nodes, row, (const double[2]){0, 0}, basis, x);
  for (int k = 0; k < 2; k++) {
    side[k] = 2 * sqrt(dea_dot(x[k + 1], x[k + 1]));
  }
  w->area += side[0] * side[1];
  length = fmin(length, SLIM * fmin(side[0], side[1]));
  for (int k = 0; k < 2; k++) {
    n[k] = (size_t)ceil(side[k] / length);
  }
  const double size[2] = {2 / (double)n[0], 2 / (double)n[1]};
  for (size_t i = 0; i < n[0]; i++) {
    for (size_t j = 0; j < n[1]; j++, w->cell_count++) {
      if (w->cells != NULL) {
        const double at[2] = {((double)i + 0.5) * size[0] - 1, ((double)j + 0.5) * size[1] - 1};
        add_cell(w, nodes, row, at, size);
      }
    }
  }
}

static void divide_all(struct work *w, double length)
{
  w->cell_count = 0;
  for (size_t k = 0; k < w->surface->block_count; k++) {
    const struct dea_mesh_block *block = &w->surface->blocks[k];
    const int row = block->order + 1;
    for (size_t e = 0; e < block->count; e++) {
      divide(w, block->nodes + e * (size_t)(row * row), row, length);
    }
  }
}

/* What a cell has of the masses by all sources: these stay, and it goes to all its copies. */
static void add_products(const struct work *w, size_t i, const struct dea_layout_sector *sector,
                         double *out)
{
  const struct cell *to = &w->cells[i];
  double potential[DEA_AIR_SHAPES_MAX] = {0};
  for (size_t c = 0; c < dea_layout_sector_copies(sector); c++) {
    const struct dea_motion motion = dea_layout_sector_copy(sector, c);
    double x[2];
    dea_motion_apply(&motion, to->x, x);
    for (size_t j = 0; j < w->cell_count; j++) {
      const struct cell *from = &w->cells[j];
      const double d[3] = {x[0] - from->x[0], x[1] - from->x[1], to->x[2] - from->x[2]};
      const double by = c == 0 && i == j ? from->own : 1 / sqrt(dea_dot(d, d));
      dea_add(w->count, by, from->flux, potential);
    }
  }
  for (size_t k = 0; k < w->count * w->count; k++) {
    out[k] += to->flux[k / w->count] * potential[k % w->count] / DEA_PI;
  }
}

dea_status dea_air_mass(struct dea_context *ctx, const struct dea_field_mesh *surface,
                        const struct dea_layout_sector *sector, size_t cells, const double *shapes,
                        size_t count, double *out)
{
  struct work w = {.surface = surface,
                   .displacement = dea_field_mesh_find(surface, "displacement_m")->values,
                   .shapes = shapes,
                   .count = count};
  divide_all(&w, INFINITY);
  const double length = sqrt(w.area * (double)dea_layout_sector_copies(sector) / (double)cells);
  divide_all(&w, length);
  w.cells = dea_alloc(ctx, w.cell_count, sizeof *w.cells);
  DEA_TRY_MEMORY(w.cells != NULL);
  divide_all(&w, length);
  memset(out, 0, count * count * sizeof *out);
  for (size_t i = 0; i < w.cell_count; i++) {
    add_products(&w, i, sector, out);
  }
  dea_free(ctx, w.cells);
  return DEA_OK;
}
