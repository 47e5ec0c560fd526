/* The loadable module that knows GEOS, which boolean.c opens. */
#include "geometry/overlay.h"
#include "base/module.h"

#include <geos_c.h>
#include <stdio.h>

extern DEA_MODULE_SYMBOL const struct dea_overlay_type dea_geos_module;

struct geos {
  struct dea_context *ctx;
  GEOSContextHandle_t handle;
  char said[200];
};

static void keep_message(const char *message, void *user)
{
  struct geos *g = user;
  snprintf(g->said, sizeof g->said, "%s", message);
}

static dea_status report_failure(const struct geos *g)
{
  return dea_fail(g->ctx, DEA_E_DESIGN, "the regions cannot be combined: %s",
                  g->said[0] != '\0' ? g->said : "GEOS gives no reason");
}

/* Points [first, end) as a closed ring. */
static GEOSGeometry *build_ring(const struct geos *g, const struct dea_rings *rings, size_t i)
{
  size_t first = i > 0 ? rings->end[i - 1] : 0, count = rings->end[i] - first;
  GEOSCoordSequence *points = GEOSCoordSeq_create_r(g->handle, (unsigned)count + 1, 2);
  for (size_t k = 0; k <= count && points != NULL; k++) {
    const double *x = rings->point[first + k % count];
    GEOSCoordSeq_setXY_r(g->handle, points, (unsigned)k, x[0], x[1]);
  }
  return points != NULL ? GEOSGeom_createLinearRing_r(g->handle, points) : NULL;
}

static void destroy(const struct geos *g, GEOSGeometry **parts, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    if (parts[i] != NULL) {
      GEOSGeom_destroy_r(g->handle, parts[i]);
    }
  }
}

/* The polygon whose outline is ring i, and the number of the ring after its holes. rings_made: room
 * for a geometry a ring. */
static GEOSGeometry *build_polygon(const struct geos *g, const struct dea_rings *rings, size_t i,
                                   GEOSGeometry **rings_made, size_t *next)
{
  unsigned count = 0;
  bool good = true;
  for (*next = i; *next < rings->count && rings->polygon[*next] == rings->polygon[i]; ++*next) {
    rings_made[count] = build_ring(g, rings, *next);
    good = good && rings_made[count] != NULL;
    count++;
  }
  if (!good) {
    destroy(g, rings_made, count);
    return NULL;
  }
  return GEOSGeom_createPolygon_r(g->handle, rings_made[0], rings_made + 1, count - 1);
}

/* Union of all polygons; NULL on failure. parts: room for a geometry a ring and one more. */
static GEOSGeometry *build_polygons(const struct geos *g, const struct dea_rings *rings,
                                    GEOSGeometry **parts)
{
  unsigned polygons = 0;
  for (size_t i = 0; i < rings->count; polygons++) {
    parts[polygons] = build_polygon(g, rings, i, parts + polygons, &i);
    if (parts[polygons] == NULL) {
      destroy(g, parts, polygons);
      return NULL;
    }
  }
  if (polygons < 2) {
    return polygons == 1 ? parts[0] : GEOSGeom_createEmptyPolygon_r(g->handle);
  }
  GEOSGeometry *all =
      GEOSGeom_createCollection_r(g->handle, GEOS_GEOMETRYCOLLECTION, parts, polygons);
  GEOSGeometry *united = all != NULL ? GEOSUnaryUnion_r(g->handle, all) : NULL;
  destroy(g, &all, 1);
  return united;
}

static dea_status add_ring(const struct geos *g, const GEOSGeometry *ring, size_t polygon,
                           struct dea_rings *out)
{
  const GEOSCoordSequence *points = GEOSGeom_getCoordSeq_r(g->handle, ring);
  unsigned count = 0;
  if (points == NULL || !GEOSCoordSeq_getSize_r(g->handle, points, &count) || count < 4) {
    return report_failure(g);
  }
  size_t first = out->count > 0 ? out->end[out->count - 1] : 0, n = first + count - 1;
  double(*point)[2] = dea_resize(g->ctx, out->point, n + 1, sizeof *point);
  DEA_TRY_MEMORY(point != NULL);
  out->point = point;
  size_t *end = dea_resize(g->ctx, out->end, out->count + 1, sizeof *end);
  DEA_TRY_MEMORY(end != NULL);
  out->end = end;
  size_t *numbers = dea_resize(g->ctx, out->polygon, out->count + 1, sizeof *numbers);
  DEA_TRY_MEMORY(numbers != NULL);
  out->polygon = numbers;
  for (unsigned k = 0; k + 1 < count; k++) { // the last one is the first
    GEOSCoordSeq_getXY_r(g->handle, points, k, &point[first + k][0], &point[first + k][1]);
  }
  end[out->count] = n;
  numbers[out->count++] = polygon;
  return DEA_OK;
}

/* All polygons of a result; lines and points are left out. */
static dea_status read_polygons(const struct geos *g, const GEOSGeometry *from,
                                struct dea_rings *out)
{
  size_t polygon = out->count > 0 ? out->polygon[out->count - 1] + 1 : 0;
  if (GEOSisEmpty_r(g->handle, from) != 0) {
    return DEA_OK;
  }
  if (GEOSGeomTypeId_r(g->handle, from) == GEOS_POLYGON) {
    DEA_TRY(g->ctx, add_ring(g, GEOSGetExteriorRing_r(g->handle, from), polygon, out));
    int holes = GEOSGetNumInteriorRings_r(g->handle, from);
    for (int i = 0; i < holes; i++) {
      DEA_TRY(g->ctx, add_ring(g, GEOSGetInteriorRingN_r(g->handle, from, i), polygon, out));
    }
    return DEA_OK;
  }
  int type = GEOSGeomTypeId_r(g->handle, from);
  int count = type == GEOS_MULTIPOLYGON || type == GEOS_GEOMETRYCOLLECTION
                  ? GEOSGetNumGeometries_r(g->handle, from)
                  : 0;
  for (int i = 0; i < count; i++) {
    const GEOSGeometry *part = GEOSGetGeometryN_r(g->handle, from, i);
    if (GEOSGeomTypeId_r(g->handle, part) == GEOS_POLYGON) {
      DEA_TRY(g->ctx, read_polygons(g, part, out));
    }
  }
  return DEA_OK;
}

static GEOSGeometry *combine(const struct geos *g, enum dea_boolean what, GEOSGeometry *a,
                             GEOSGeometry *b)
{
  switch (what) {
  case DEA_DIFFERENCE:
    return GEOSDifference_r(g->handle, a, b);
  case DEA_INTERSECTION:
    return GEOSIntersection_r(g->handle, a, b);
  case DEA_UNION:
    break;
  }
  return GEOSUnion_r(g->handle, a, b);
}

static dea_status overlay(struct dea_context *ctx, enum dea_boolean what, const struct dea_rings *a,
                          const struct dea_rings *b, struct dea_rings *out)
{
  struct geos g = {.ctx = ctx};
  *out = (struct dea_rings){0};
  GEOSGeometry **parts = dea_alloc(ctx, a->count + b->count + 2, sizeof(GEOSGeometry *));
  DEA_TRY_MEMORY(parts != NULL);
  g.handle = GEOS_init_r();
  if (g.handle == NULL) {
    dea_free(ctx, parts);
    return dea_fail(ctx, DEA_E_MEMORY, "out of memory in GEOS");
  }
  GEOSContext_setErrorMessageHandler_r(g.handle, keep_message, &g);
  GEOSGeometry *first = build_polygons(&g, a, parts);
  GEOSGeometry *second = first != NULL ? build_polygons(&g, b, parts) : NULL;
  GEOSGeometry *result = second != NULL ? combine(&g, what, first, second) : NULL;
  dea_status status = result != NULL ? read_polygons(&g, result, out) : report_failure(&g);
  GEOSGeometry *made[3] = {first, second, result};
  destroy(&g, made, 3);
  GEOS_finish_r(g.handle);
  dea_free(ctx, parts);
  if (status != DEA_OK) {
    dea_rings_free(ctx, out);
  }
  return status;
}

const struct dea_overlay_type dea_geos_module = {.overlay = overlay};
