#include "model/solid/mesh/places.h"

#include "base/context.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

void dea_places_empty(struct dea_places *places)
{
  memset(places->table, -1, places->table_size * sizeof *places->table);
  places->count = 0;
}

dea_status dea_places_create(struct dea_context *ctx, double *x, size_t capacity, double close,
                             struct dea_places *out)
{
  *out = (struct dea_places){.x = x, .close = close, .table_size = 2 * capacity + 1};
  out->table = dea_alloc(ctx, out->table_size, sizeof *out->table);
  DEA_TRY_MEMORY(out->table != NULL);
  dea_places_empty(out);
  return DEA_OK;
}

void dea_places_release(struct dea_context *ctx, struct dea_places *places)
{
  dea_free(ctx, places->table);
}

static size_t slot_of(const struct dea_places *p, int64_t i, int64_t j)
{
  uint64_t h = (uint64_t)i * 0x9E3779B97F4A7C15u ^ (uint64_t)j * 0xC2B2AE3D27D4EB4Fu;
  return (size_t)(h ^ (h >> 29)) % p->table_size;
}

/* The place is looked up in its cell and the neighbours'. */
int dea_places_node(struct dea_places *p, const double x[2])
{
  double cell = 4 * p->close;
  int64_t ci = (int64_t)floor(x[0] / cell), cj = (int64_t)floor(x[1] / cell);
  for (int64_t i = ci - 1; i <= ci + 1; i++) {
    for (int64_t j = cj - 1; j <= cj + 1; j++) {
      for (size_t k = slot_of(p, i, j); p->table[k] >= 0; k = (k + 1) % p->table_size) {
        const double *other = p->x + 2 * p->table[k];
        if (fabs(other[0] - x[0]) < p->close && fabs(other[1] - x[1]) < p->close) {
          return p->table[k];
        }
      }
    }
  }
  size_t k = slot_of(p, ci, cj);
  while (p->table[k] >= 0) {
    k = (k + 1) % p->table_size;
  }
  p->table[k] = (int)p->count;
  memcpy(p->x + 2 * p->count, x, 2 * sizeof *x);
  return (int)p->count++;
}
