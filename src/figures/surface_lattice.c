#include "figures/surface_lattice.h"

#include "base/quadrature.h"
#include "base/sort.h"
#include "result/field_mesh.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PIECES_MAX = 12, OUTLINE_PIECES = 4 };

bool dea_surface_is_first(const struct dea_result *result, size_t i)
{
  return strcmp(result->surfaces[i].model, result->surfaces[0].model) == 0;
}

size_t dea_surface_spread(const struct dea_result *result, size_t max,
                          const struct dea_surface_record *out[])
{
  size_t count = 0, seen = 0, taken = 0;
  for (size_t i = 0; i < result->surface_count; i++) {
    count += dea_surface_is_first(result, i);
  }
  size_t wanted = count < max ? count : max;
  for (size_t i = 0; i < result->surface_count && taken < wanted; i++) {
    if (dea_surface_is_first(result, i) &&
        seen++ == (wanted > 1 ? taken * (count - 1) / (wanted - 1) : count - 1)) {
      out[taken++] = &result->surfaces[i];
    }
  }
  return taken;
}

static bool same_mesh(const struct dea_field_mesh *a, const struct dea_field_mesh *b)
{
  return a->point_count == b->point_count && a->cell_count == b->cell_count &&
         memcmp(a->X, b->X, 3 * a->point_count * sizeof *a->X) == 0;
}

size_t dea_surface_spread_same(const struct dea_result *result, size_t max,
                               const struct dea_surface_record *out[])
{
  const size_t count = dea_surface_spread(result, max, out);
  size_t same = 0;
  for (size_t i = 0; i < count; i++) {
    if (same_mesh(out[i]->mesh, out[0]->mesh)) {
      out[same++] = out[i];
    }
  }
  return same;
}

bool dea_surface_has_shapes(const struct dea_surface_record *record)
{
  char first[32];
  snprintf(first, sizeof first, DEA_SHAPE_FIELD, 1);
  return dea_field_mesh_find(record->mesh, first) != NULL;
}

static const double *displacement_of(const struct dea_field_mesh *mesh)
{
  const struct dea_mesh_field *field = dea_field_mesh_find(mesh, "displacement_m");
  return field != NULL && field->components == 3 && !field->of_cells ? field->values : NULL;
}

static dea_status check(struct dea_context *ctx, const struct dea_field_mesh *mesh)
{
  bool good = displacement_of(mesh) != NULL;
  for (size_t b = 0; b < mesh->block_count; b++) {
    good = good && mesh->blocks[b].order_z == 0;
  }
  return good ? DEA_OK
              : dea_fail(ctx, DEA_E_ARGUMENT,
                         "a surface that is drawn has flat elements and a displacement");
}

/* ---- points ---- */

/* An element of a copy. */
struct element {
  const struct dea_field_mesh *mesh;
  const struct dea_copy *copy;
  const double *u;  // displacement of the mesh's points
  const int *nodes; // n x n
  size_t n;
  double places[DEA_MESH_ORDER_MAX + 1]; // of its nodes along an axis
};

static struct element element_at(const struct dea_field_mesh *mesh,
                                 const struct dea_mesh_block *block, size_t number,
                                 const struct dea_copy *copy)
{
  struct element out = {.mesh = mesh,
                        .copy = copy,
                        .u = displacement_of(mesh),
                        .nodes = block->nodes + number * (size_t)dea_mesh_block_nodes(block),
                        .n = (size_t)block->order + 1};
  dea_lobatto_nodes(out.n - 1, out.places);
  return out;
}

/* At a place in it: s along its first axis, t along the second, in [-1, 1]. */
static void evaluate(const struct element *element, double s, double t,
                     double out[DEA_LATTICE_COLUMNS])
{
  double along[DEA_MESH_ORDER_MAX + 1], across[DEA_MESH_ORDER_MAX + 1];
  double slope[DEA_MESH_ORDER_MAX + 1], X[3] = {0}, v[3] = {0}, moved[3];
  const size_t n = element->n;
  dea_lagrange(n, element->places, s, along, slope);
  dea_lagrange(n, element->places, t, across, slope);
  for (size_t k = 0; k < n * n; k++) {
    double share = along[k % n] * across[k / n];
    for (int i = 0; i < 3; i++) {
      X[i] += share * element->mesh->X[3 * element->nodes[k] + i];
      v[i] += share * element->u[3 * element->nodes[k] + i];
    }
  }
  dea_copy_move(element->copy, X, moved);
  out[DEA_LATTICE_X] = moved[0];
  out[DEA_LATTICE_Y] = moved[1];
  dea_copy_move(element->copy, v, moved);
  out[DEA_LATTICE_UX] = moved[0];
  out[DEA_LATTICE_UY] = moved[1];
  out[DEA_LATTICE_UZ] = moved[2];
}

/* Distance of two corners of an element. */
static double side_m(const struct dea_field_mesh *mesh, int p, int q)
{
  return hypot(mesh->X[3 * p] - mesh->X[3 * q], mesh->X[3 * p + 1] - mesh->X[3 * q + 1]);
}

static int pieces_along(double length_m, double piece_m)
{
  double pieces = ceil(length_m / piece_m - 1e-6);
  return pieces < 1 ? 1 : pieces > PIECES_MAX ? PIECES_MAX : (int)pieces;
}

/* The lattice of an element, its longer sides in pieces of at most piece_m. */
static struct dea_patch choose_lattice(const struct dea_field_mesh *mesh,
                                       const struct dea_mesh_block *block, size_t element,
                                       double piece_m)
{
  int row = block->order + 1;
  const int *nodes = block->nodes + element * (size_t)(row * row);
  int a = nodes[0], b = nodes[row - 1], c = nodes[row * row - 1], d = nodes[row * (row - 1)];
  return (struct dea_patch){
      .n = pieces_along(fmax(side_m(mesh, a, b), side_m(mesh, d, c)), piece_m),
      .m = pieces_along(fmax(side_m(mesh, a, d), side_m(mesh, b, c)), piece_m),
  };
}

/* Size of a piece of that many in the disc. */
static double piece_size(const struct dea_field_mesh *mesh, size_t pieces)
{
  return dea_field_mesh_radius_m(mesh) * sqrt(DEA_PI / (double)(pieces > 0 ? pieces : 1));
}

/* Lattices of the elements of one part, and the number of their points. */
static size_t choose_lattices(const struct dea_field_mesh *mesh, double piece_m,
                              struct dea_patch *patches)
{
  size_t points = 0;
  for (size_t b = 0; b < mesh->block_count; b++) {
    for (size_t e = 0; e < mesh->blocks[b].count; e++, patches++) {
      *patches = choose_lattice(mesh, &mesh->blocks[b], e, piece_m);
      points += (size_t)((patches->n + 1) * (patches->m + 1));
    }
  }
  return points;
}

/* Fills a patch and takes its extremes. */
static void fill_patch(const struct element *element, struct dea_patch *patch,
                       struct dea_surface_lattice *out)
{
  int row = patch->n + 1;
  for (int k = 0; k < row * (patch->m + 1); k++) {
    double *at = patch->at[k];
    const int line = k / row;
    evaluate(element, 2.0 * (k % row) / patch->n - 1, 2.0 * line / patch->m - 1, at);
    const double x_m[2] = {at[DEA_LATTICE_X], at[DEA_LATTICE_Y]};
    for (int i = 0; i < 2; i++) {
      out->low_m[i] = fmin(out->low_m[i], x_m[i]);
      out->high_m[i] = fmax(out->high_m[i], x_m[i]);
    }
    out->z_min_m = fmin(out->z_min_m, at[DEA_LATTICE_UZ]);
    out->z_max_m = fmax(out->z_max_m, at[DEA_LATTICE_UZ]);
  }
}

/* The middle of the box and what lies farthest from it. */
static void find_centre(struct dea_surface_lattice *out)
{
  for (int i = 0; i < 2; i++) {
    const double middle_m = 0.5 * (out->low_m[i] + out->high_m[i]);
    out->centre_m[i] = fabs(middle_m) > 1e-6 * (out->high_m[i] - out->low_m[i]) ? middle_m : 0;
  }
  for (size_t p = 0; p < out->patch_count; p++) {
    const struct dea_patch *patch = &out->patches[p];
    for (int k = 0; k < (patch->n + 1) * (patch->m + 1); k++) {
      out->radius_m = fmax(out->radius_m, hypot(patch->at[k][DEA_LATTICE_X] - out->centre_m[0],
                                                patch->at[k][DEA_LATTICE_Y] - out->centre_m[1]));
    }
  }
}

dea_status dea_surface_lattice_create(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                      size_t pieces, struct dea_surface_lattice *out)
{
  *out = (struct dea_surface_lattice){.low_m = {INFINITY, INFINITY},
                                      .high_m = {-INFINITY, -INFINITY},
                                      .z_min_m = INFINITY,
                                      .z_max_m = -INFINITY};
  DEA_TRY(ctx, check(ctx, mesh));
  size_t copies = dea_copy_count(mesh), cells = mesh->cell_count;
  out->patches = dea_alloc(ctx, cells * copies, sizeof *out->patches);
  DEA_TRY_MEMORY(out->patches != NULL);
  size_t points = choose_lattices(mesh, piece_size(mesh, pieces), out->patches);
  out->at = dea_alloc(ctx, points * copies, sizeof *out->at);
  DEA_TRY_MEMORY(out->at != NULL);
  double(*to)[DEA_LATTICE_COLUMNS] = out->at;
  for (size_t c = 0; c < copies; c++) {
    const struct dea_copy copy = dea_copy_at(mesh, c);
    for (size_t b = 0; b < mesh->block_count; b++) {
      for (size_t e = 0; e < mesh->blocks[b].count; e++) {
        struct dea_patch *patch = &out->patches[out->patch_count++];
        *patch = out->patches[(out->patch_count - 1) % cells];
        patch->at = to;
        to += (patch->n + 1) * (patch->m + 1);
        const struct element element = element_at(mesh, &mesh->blocks[b], e, &copy);
        fill_patch(&element, patch, out);
      }
    }
  }
  find_centre(out);
  return DEA_OK;
}

void dea_surface_lattice_free(struct dea_context *ctx, struct dea_surface_lattice *drawing)
{
  dea_free(ctx, drawing->patches);
  dea_free(ctx, drawing->at);
  *drawing = (struct dea_surface_lattice){0};
}

/* ---- outlines ---- */

/* An edge of an element, with the sums of its ends' places: equal, to the bit, for the elements on
 * both of its sides. */
struct edge {
  double x, y;
  const struct dea_mesh_block *block;
  size_t element, cell;
  int side; // t = -1, s = 1, t = 1, s = -1
  bool outermost;
};

static int by_place(const void *a, const void *b)
{
  const struct edge *p = a, *q = b;
  if (p->x != q->x) {
    return p->x < q->x ? -1 : 1;
  }
  return (p->y > q->y) - (p->y < q->y);
}

static bool cell_has(const struct dea_field_mesh *mesh, const char *name, size_t cell)
{
  const struct dea_mesh_field *field = dea_field_mesh_find(mesh, name);
  return field != NULL && field->of_cells && field->components == 1 && field->values[cell] != 0;
}

static void list_edges(const struct dea_field_mesh *mesh, struct edge *to)
{
  const double radius = dea_field_mesh_radius_m(mesh);
  for (size_t b = 0, cell = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    int n = block->order, row = n + 1;
    const int corner[4] = {0, n, row * row - 1, row * n};
    for (size_t e = 0; e < block->count; e++, cell++) {
      const int *nodes = block->nodes + e * (size_t)(row * row);
      for (int side = 0; side < 4; side++, to++) {
        const double *p = mesh->X + 3 * nodes[corner[side]];
        const double *q = mesh->X + 3 * nodes[corner[(side + 1) % 4]];
        *to = (struct edge){p[0] + q[0], p[1] + q[1], block, e, cell, side, false};
        to->outermost = fmin(hypot(p[0], p[1]), hypot(q[0], q[1])) > radius * (1 - 1e-6);
      }
    }
  }
}

/* Whether an edge is drawn; twin: that of its other side, NULL at the end of the part. */
static bool is_outline(const struct dea_field_mesh *mesh, const struct edge *edge,
                       const struct edge *twin, enum dea_outline_kind *kind)
{
  *kind = DEA_OUTLINE_FRAME;
  if (twin == NULL) { // of a sector the sides are none
    return edge->outermost || dea_copy_count(mesh) == 1;
  }
  *kind = DEA_OUTLINE_ELECTRODE;
  if (cell_has(mesh, "between_electrodes", edge->cell) !=
      cell_has(mesh, "between_electrodes", twin->cell)) {
    return true;
  }
  *kind = DEA_OUTLINE_FIBRE;
  return cell_has(mesh, "under_fibre", edge->cell) != cell_has(mesh, "under_fibre", twin->cell);
}

static void draw_edge(const struct dea_field_mesh *mesh, const struct edge *edge,
                      const struct dea_copy *copy, struct dea_outline *out)
{
  const struct element element = element_at(mesh, edge->block, edge->element, copy);
  int pieces = OUTLINE_PIECES * edge->block->order;
  out->count = pieces + 1;
  for (int k = 0; k <= pieces; k++) {
    double along = 2.0 * k / pieces - 1;
    double s = edge->side == 1 ? 1 : edge->side == 3 ? -1 : along;
    double t = edge->side == 0 ? -1 : edge->side == 2 ? 1 : along;
    evaluate(&element, s, t, out->at[k]);
  }
}

dea_status dea_surface_lattice_outlines(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                        struct dea_outline **out, size_t *count)
{
  size_t edges = 4 * mesh->cell_count, copies = dea_copy_count(mesh);
  *out = NULL;
  *count = 0;
  DEA_TRY(ctx, check(ctx, mesh));
  struct edge *edge = dea_alloc(ctx, edges, sizeof *edge);
  DEA_TRY_MEMORY(edge != NULL);
  list_edges(mesh, edge);
  if (edges > 0) {
    qsort(edge, edges, sizeof *edge, by_place);
  }
  size_t drawn = 0;
  for (size_t i = 0; i < edges; i++) { // those that are drawn come to the front
    bool twins = i + 1 < edges && by_place(&edge[i], &edge[i + 1]) == 0;
    enum dea_outline_kind kind;
    if (is_outline(mesh, &edge[i], twins ? &edge[i + 1] : NULL, &kind)) {
      edge[drawn] = edge[i];
      edge[drawn++].cell = kind; // the cell is of no use any more
    }
    i += twins;
  }
  *out = dea_alloc(ctx, drawn * copies, sizeof **out);
  for (size_t c = 0; c < copies && *out != NULL; c++) {
    const struct dea_copy copy = dea_copy_at(mesh, c);
    for (size_t i = 0; i < drawn; i++) {
      (*out)[*count].kind = (enum dea_outline_kind)edge[i].cell;
      draw_edge(mesh, &edge[i], &copy, &(*out)[(*count)++]);
    }
  }
  dea_free(ctx, edge);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

/* ---- section ---- */

struct crossing {
  double s, z;
};

/* Where the line from p to q of a lattice meets the diameter; false when it does not. A point on
 * the diameter counts for the line that ends there. */
static bool cross(const double *p, const double *q, const double centre_m[2],
                  const double direction[2], double close, struct crossing *out)
{
  const double px = p[DEA_LATTICE_X] - centre_m[0], py = p[DEA_LATTICE_Y] - centre_m[1];
  const double qx = q[DEA_LATTICE_X] - centre_m[0], qy = q[DEA_LATTICE_Y] - centre_m[1];
  double dp = direction[0] * py - direction[1] * px;
  double dq = direction[0] * qy - direction[1] * qx;
  bool on = fabs(dq) <= close;
  if (!on && (fabs(dp) <= close || dp * dq > 0)) {
    return false;
  }
  double share = on ? 1 : dp / (dp - dq);
  double x = px + share * (qx - px), y = py + share * (qy - py);
  out->s = x * direction[0] + y * direction[1];
  out->z = p[DEA_LATTICE_UZ] + share * (q[DEA_LATTICE_UZ] - p[DEA_LATTICE_UZ]);
  return true;
}

/* All crossings of the patches' lattices, several times where patches meet. found: with room for
 * two a lattice point, or NULL to count them only. */
static size_t find_crossings(const struct dea_surface_lattice *drawing, const double direction[2],
                             struct crossing *found)
{
  double close = 1e-9 * drawing->radius_m;
  size_t count = 0;
  for (size_t i = 0; i < drawing->patch_count; i++) {
    const struct dea_patch *patch = &drawing->patches[i];
    int row = patch->n + 1;
    for (int k = 0; k < row * (patch->m + 1); k++) {
      // a lattice point ends the line from the one before it, in each direction
      const int from[2] = {k % row > 0 ? k - 1 : k + 1, k >= row ? k - row : k + row};
      for (int way = 0; way < 2; way++) {
        struct crossing here;
        if (cross(patch->at[from[way]], patch->at[k], drawing->centre_m, direction, close, &here)) {
          count++;
          if (found != NULL) {
            found[count - 1] = here;
          }
        }
      }
    }
  }
  return count;
}

dea_status dea_surface_lattice_section(struct dea_context *ctx,
                                       const struct dea_surface_lattice *drawing, double angle,
                                       double **out, size_t *count)
{
  const double direction[2] = {cos(angle), sin(angle)};
  size_t all = find_crossings(drawing, direction, NULL), kept = 0;
  struct crossing *found = dea_alloc(ctx, all, sizeof *found);
  *out = dea_alloc(ctx, 2 * all, sizeof **out);
  *count = 0;
  if (found == NULL || *out == NULL) {
    dea_free(ctx, found);
    dea_free(ctx, *out);
    *out = NULL;
    return DEA_E_MEMORY;
  }
  find_crossings(drawing, direction, found);
  if (all > 0) {
    qsort(found, all, sizeof *found, dea_rising);
  }
  for (size_t i = 0; i < all; i++) { // one a place
    if (kept == 0 || found[i].s - found[kept - 1].s > 1e-6 * drawing->radius_m) {
      found[kept++] = found[i];
    }
  }
  for (size_t i = 0; i < kept; i++) {
    (*out)[i] = found[i].s;
    (*out)[kept + i] = found[i].z;
  }
  *count = kept;
  dea_free(ctx, found);
  return DEA_OK;
}
