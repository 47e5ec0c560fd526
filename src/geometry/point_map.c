#include "geometry/point_map.h"

#include <math.h>
#include <stdint.h>

static double cell_size(const struct dea_point_map *map)
{
  return map->cell_m > 0 ? map->cell_m : 2 * map->tolerance_m;
}

/* Where the chain of a cell starts; cells beyond the range of whole numbers share one. */
static size_t hash(const struct dea_point_map *map, double column, double row)
{
  bool countable = fabs(column) < 9e18 && fabs(row) < 9e18;
  uint64_t i = countable ? (uint64_t)(int64_t)column : 0;
  uint64_t j = countable ? (uint64_t)(int64_t)row : 0;
  uint64_t h =
      i * UINT64_C(0x9e3779b97f4a7c15) ^ (j + UINT64_C(0x7f4a7c15)) * UINT64_C(0xc2b2ae3d27d4eb4f);
  h ^= h >> 29;
  h *= UINT64_C(0xbf58476d1ce4e5b9);
  return (size_t)(h ^ h >> 32) & (map->heads - 1);
}

size_t dea_point_map_find(const struct dea_point_map *map, const double x_m[2])
{
  double size = cell_size(map), tolerance = map->tolerance_m;
  size_t found = SIZE_MAX;
  if (map->count == 0) {
    return found;
  }
  // cells that the tolerance reaches: one or two each way, and by rounding even three
  double column = floor((x_m[0] - tolerance) / size), row = floor((x_m[1] - tolerance) / size);
  for (int k = 0; k < 9; k++) {
    int i = k % 3, j = k / 3;
    double across = column + i, up = row + j;
    if (across > floor((x_m[0] + tolerance) / size) || up > floor((x_m[1] + tolerance) / size)) {
      continue;
    }
    for (size_t p = map->head[hash(map, across, up)]; p != SIZE_MAX; p = map->next[p]) {
      double dx = map->point[p][0] - x_m[0], dy = map->point[p][1] - x_m[1];
      if (hypot(dx, dy) <= tolerance && p < found) {
        found = p;
      }
    }
  }
  return found;
}

static void insert(struct dea_point_map *map, size_t i)
{
  double size = cell_size(map);
  size_t h = hash(map, floor(map->point[i][0] / size), floor(map->point[i][1] / size));
  map->next[i] = map->head[h];
  map->head[h] = i;
}

static void grow(struct dea_point_map *map)
{
  size_t capacity = map->capacity == 0 ? 64 : 2 * map->capacity;
  double(*point)[2] = dea_resize(map->ctx, map->point, capacity, sizeof *point);
  map->point = point != NULL ? point : map->point;
  size_t *next = dea_resize(map->ctx, map->next, capacity, sizeof *next);
  map->next = next != NULL ? next : map->next;
  size_t *head = dea_resize(map->ctx, map->head, capacity, sizeof *head);
  map->head = head != NULL ? head : map->head;
  if (point == NULL || next == NULL || head == NULL) {
    map->failed = true;
    return;
  }
  map->capacity = map->heads = capacity;
  for (size_t h = 0; h < map->heads; h++) {
    map->head[h] = SIZE_MAX;
  }
  for (size_t i = 0; i < map->count; i++) {
    insert(map, i);
  }
}

size_t dea_point_map_add(struct dea_point_map *map, const double x_m[2])
{
  size_t index = dea_point_map_find(map, x_m);
  if (index != SIZE_MAX) {
    return index;
  }
  if (map->count == map->capacity && !map->failed) {
    grow(map);
  }
  if (map->failed) {
    return 0;
  }
  map->point[map->count][0] = x_m[0];
  map->point[map->count][1] = x_m[1];
  insert(map, map->count);
  return map->count++;
}

void dea_point_map_free(struct dea_point_map *map)
{
  if (map->ctx != NULL) {
    dea_free(map->ctx, map->point);
    dea_free(map->ctx, map->next);
    dea_free(map->ctx, map->head);
  }
  *map = (struct dea_point_map){0};
}
