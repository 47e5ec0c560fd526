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
  double(*point)[2] = out->point + (out->count > 0 ? out->end[out->count - 1] : 0);
  for (unsigned k = 0; k + 1 < count; k++, point++) { // the last one is the first
    GEOSCoordSeq_getXY_r(g->handle, points, k, &(*point)[0], &(*point)[1]);
  }
  out->end[out->count] = (size_t)(point - out->point);
  out->polygon[out->count++] = polygon;
  return DEA_OK;
}

/* All polygons of a result; lines and points are left out. */
static dea_status read_polygons(const struct geos *g, const GEOSGeometry *from,
                                struct dea_rings *out)
{
  const int points = GEOSGetNumCoordinates_r(g->handle, from); // more than rings
  const int parts = GEOSGetNumGeometries_r(g->handle, from);
  if (points < 0 || parts < 0) {
    return report_failure(g);
  }
  const size_t most = (size_t)points;
  out->point = dea_alloc(g->ctx, most, sizeof *out->point);
  out->end = dea_alloc(g->ctx, most, sizeof *out->end);
  out->polygon = dea_alloc(g->ctx, most, sizeof *out->polygon);
  DEA_TRY_MEMORY(out->point != NULL && out->end != NULL && out->polygon != NULL);
  for (int i = 0; i < parts; i++) {
    const GEOSGeometry *part = GEOSGetGeometryN_r(g->handle, from, i);
    if (GEOSGeomTypeId_r(g->handle, part) != GEOS_POLYGON || GEOSisEmpty_r(g->handle, part) != 0) {
      continue;
    }
    DEA_TRY(g->ctx, add_ring(g, GEOSGetExteriorRing_r(g->handle, part), (size_t)i, out));
    const int holes = GEOSGetNumInteriorRings_r(g->handle, part);
    for (int k = 0; k < holes; k++) {
      DEA_TRY(g->ctx, add_ring(g, GEOSGetInteriorRingN_r(g->handle, part, k), (size_t)i, out));
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
  return status;
}

const struct dea_overlay_type dea_geos_module = {.overlay = overlay};
