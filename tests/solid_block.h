/* A block of one material as a solid, for tests of loads and supports. */
#pragma once

#include "model/solid/assembly/solid.h"
#include "testing.h"

/* Size from the origin, elements along each edge, orders. */
struct block {
  double size[3];
  size_t count[3];
  int order, order_z;
};

static inline void block_map(const void *self, double s, double t, double x[2])
{
  const struct block *block = self;
  x[0] = block->size[0] * s;
  x[1] = block->size[1] * t;
}

static inline struct dea_grid *block_grid(struct dea_context *ctx, const struct block *block)
{
  double cuts[2][33];
  for (int a = 0; a < 2; a++) {
    assert_true(block->count[a] <= 32);
    for (size_t i = 0; i <= block->count[a]; i++) {
      cuts[a][i] = (double)i / (double)block->count[a];
    }
  }
  const struct dea_block quad = {block_map,       block,           cuts[0], cuts[1],
                                 block->count[0], block->count[1], 0};
  const struct dea_ply ply = {block->size[2], block->count[2], block->order_z};
  struct dea_grid *grid;
  assert_int_equal(dea_grid_create(ctx, block->order, &quad, 1, &ply, 1, NULL, 0,
                                   fmax(block->size[0], block->size[1]), &grid),
                   DEA_OK);
  return grid;
}

static inline struct dea_solid *block_solid(struct dea_context *ctx, const struct dea_grid *grid,
                                            int order_z, const struct dea_part_material *layer,
                                            int (*held)(const void *self, const double X[3]))
{
  const struct dea_solid_options options = {
      .order_z = order_z, .part_material_count = 1, .part_materials = layer, .held = held};
  struct dea_solid *solid;
  assert_int_equal(dea_solid_create(ctx, grid, &options, &solid), DEA_OK);
  return solid;
}

// Ways to fill and hold one -----------------------------------------------------------------------

static inline bool everywhere(const void *self, int region, int ply)
{
  return true;
}

static inline bool first_region(const void *self, int region, int ply)
{
  return region == 0;
}

static inline int layer_of_region(const void *self, int region, int ply)
{
  return region;
}

static inline int layer_of_ply(const void *self, int region, int ply)
{
  return ply;
}

/* Slides on the three planes through the origin. */
static inline int on_planes(const void *self, const double X[3])
{
  return (X[0] < 1e-9 ? 1 : 0) | (X[1] < 1e-9 ? 2 : 0) | (X[2] < 1e-9 ? 4 : 0);
}

/* At x = 0. */
static inline int clamped(const void *self, const double X[3])
{
  return X[0] < 1e-9 ? 7 : 0;
}
