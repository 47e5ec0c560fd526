#include "model/solid/recovery/recover_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct dea_mesh_field
    dea_recover_displacement = {"displacement_m",
                                "m",
                                "displacement from the stretched flat film",
                                DEA_MESH_VECTOR,
                                3,
                                false,
                                NULL},
    dea_recover_plane_stretch = DEA_RECOVER_VALUES(
        "plane_stretch", "1",
        "stretch from the unstretched film: larger and smaller in its plane, thickness", 3),
    dea_recover_tension = DEA_RECOVER_VALUES(
        "tension_N_per_m", "N/m",
        "true stress through the thickness of the layer, per current length: larger, smaller", 2),
    dea_recover_true_field =
        DEA_RECOVER_VALUES("true_field_V_per_m", "V/m",
                           "voltage over the current thickness; 0 outside of the electrodes", 1);

/* ---- columns ---- */

static int by_place(const void *a, const void *b)
{
  const struct dea_stacked *p = a, *q = b;
  if (p->x != q->x) {
    return p->x < q->x ? -1 : 1;
  }
  if (p->y != q->y) {
    return p->y < q->y ? -1 : 1;
  }
  if (p->ply != q->ply) {
    return p->ply < q->ply ? -1 : 1;
  }
  return (p->z > q->z) - (p->z < q->z);
}

struct dea_stacked *dea_recover_stack(struct dea_arena *memory, const struct dea_recover_input *in)
{
  const struct dea_grid *grid = in->grid;
  int plane_nodes = (grid->order + 1) * (grid->order + 1);
  struct dea_stacked *stack = dea_arena_alloc(memory, grid->element_count, sizeof *stack);
  for (size_t e = 0; stack != NULL && e < grid->element_count; e++) {
    stack[e].element = e;
    stack[e].ply = grid->ply[e];
    for (int n = 0; n < plane_nodes; n++) {
      const double *X = grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n];
      stack[e].x += X[0];
      stack[e].y += X[1];
      stack[e].z += X[2];
    }
  }
  if (stack != NULL) {
    qsort(stack, grid->element_count, sizeof *stack, by_place);
  }
  return stack;
}

size_t dea_recover_column_end(const struct dea_stacked *stack, size_t count, size_t from,
                              bool by_ply)
{
  size_t end = from + 1;
  while (end < count && stack[end].x == stack[from].x && stack[end].y == stack[from].y &&
         (!by_ply || stack[end].ply == stack[from].ply)) {
    end++;
  }
  return end;
}

/* ---- points ---- */

static int *number_of(const struct dea_recover_points *points, const struct dea_grid *grid,
                      size_t e, int n)
{
  return &points->number[(size_t)points->group[e] * grid->node_count +
                         (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n]];
}

dea_status dea_recover_number(struct dea_arena *memory, const struct dea_grid *grid,
                              struct dea_recover_points *out)
{
  int plies = 1, regions = 1;
  size_t elements = grid->element_count, most = 0;
  for (size_t e = 0; e < elements; e++) {
    plies = plies > grid->ply[e] ? plies : grid->ply[e] + 1;
    regions = regions > grid->region[e] ? regions : grid->region[e] + 1;
    most += (size_t)dea_grid_nodes_of(grid, e);
  }
  *out = (struct dea_recover_points){
      .group = dea_arena_alloc(memory, elements, sizeof *out->group),
      .number = dea_arena_alloc(memory, (size_t)(plies * regions) * grid->node_count,
                                sizeof *out->number),
      .node = dea_arena_alloc(memory, most, sizeof *out->node),
      .element = dea_arena_alloc(memory, most, sizeof *out->element)};
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t e = 0; e < elements; e++) {
    out->group[e] = grid->region[e] * plies + grid->ply[e];
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      int *number = number_of(out, grid, e, n);
      if (*number == 0) {
        out->node[out->count] = grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n];
        out->element[out->count] = e;
        *number = (int)++out->count;
      }
    }
  }
  return DEA_OK;
}

size_t dea_recover_point(const struct dea_recover_points *points, const struct dea_grid *grid,
                         size_t element, int n)
{
  return (size_t)*number_of(points, grid, element, n) - 1;
}

/* ---- elements ---- */

/* What an element is asked with. */
struct asked {
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], potential_V[DEA_HEX_NODES_MAX];
  struct dea_part_material part_material;
  struct dea_element_input in;
};

static void select_element(const struct dea_recover_input *in, size_t e, struct asked *out)
{
  const struct dea_element *element = &in->elements->of[in->kind[e]];
  const int *nodes = in->grid->nodes + e * DEA_HEX_NODES_MAX;
  for (int n = 0; n < element->nodes; n++) {
    memcpy(out->X + 3 * n, in->grid->X + 3 * nodes[n], 3 * sizeof *out->X);
    memcpy(out->u + 3 * n, in->u + 3 * nodes[n], 3 * sizeof *out->u);
    out->potential_V[n] = in->potential_V != NULL ? in->potential_V[nodes[n]] : 0;
  }
  out->part_material = in->part_materials[in->part_material[e]];
  out->part_material.kappa_Pa *= in->bulk_factor;
  out->in = (struct dea_element_input){
      .part_material = &out->part_material,
      .X = out->X,
      .u = out->u,
      .multiplier = in->multiplier + e * (size_t)in->elements->pressures,
      .potential = out->potential_V,
      .potential_V_per_m = 1,
      .voltage_V = in->across_V[e],
  };
}

dea_status dea_recover_element(struct dea_context *ctx, const struct dea_recover_input *in,
                               size_t e, struct dea_recovered *out)
{
  const struct dea_element *element = &in->elements->of[in->kind[e]];
  struct asked asked;
  select_element(in, e, &asked);
  const dea_status status = element->type->recover(element, &asked.in, out);
  return status == DEA_OK
             ? DEA_OK
             : dea_fail(ctx, status, "element %zu is inverted or beyond its law's domain", e);
}

dea_status dea_recover_state(const struct dea_recover_input *in, size_t e, bool stress,
                             struct dea_element_state *out)
{
  const struct dea_element *element = &in->elements->of[in->kind[e]];
  struct asked asked;
  select_element(in, e, &asked);
  return element->type->state(element, &asked.in, stress, out);
}

double dea_recover_height(const struct dea_recover_input *in, size_t element, int level)
{
  int plane_nodes = (in->grid->order + 1) * (in->grid->order + 1);
  int node = in->grid->nodes[element * DEA_HEX_NODES_MAX + (size_t)(level * plane_nodes)];
  return in->grid->X[3 * node + 2];
}

/* ---- state in the plane ---- */

/* Eigenvalues of a symmetric 2 x 2 matrix, the larger first. */
static void principal(double xx, double yy, double xy, double out[2])
{
  double mean = 0.5 * (xx + yy), radius = hypot(0.5 * (xx - yy), xy);
  out[0] = mean + radius;
  out[1] = mean - radius;
}

void dea_recover_plane(const struct dea_part_material *part_material, const double F[9],
                       const double force[6], struct dea_plane_state *out)
{
  const double a[3] = {F[0], F[3], F[6]}, b[3] = {F[1], F[4], F[7]};
  double normal[3], e[2][3], T[2][2], squares[2], cof[9],
      C[3] = {dea_dot(a, a), dea_dot(b, b), dea_dot(a, b)};
  double length = sqrt(dea_dot(a, a));
  dea_cross(a, b, normal);
  out->area = sqrt(dea_dot(normal, normal));
  dea_part_material_pull_back(part_material, C, C);
  principal(C[0], C[1], C[2], squares);
  out->stretch[0] = sqrt(squares[0]);
  out->stretch[1] = sqrt(fmax(squares[1], 0));
  out->stretch[2] = part_material->pre_stretch[2] * dea_cofactors(F, cof) / out->area;
  for (int i = 0; i < 3; i++) { // an orthonormal basis of the current tangent plane
    e[0][i] = a[i] / length;
  }
  for (int i = 0; i < 3; i++) {
    e[1][i] = (normal[(i + 1) % 3] * e[0][(i + 2) % 3] - normal[(i + 2) % 3] * e[0][(i + 1) % 3]) /
              out->area;
  }
  for (int r = 0; r < 2; r++) { // T = N F^T / area
    for (int c = 0; c < 2; c++) {
      double ea = dea_dot(e[c], a), eb = dea_dot(e[c], b);
      T[r][c] = 0;
      for (int i = 0; i < 3; i++) {
        T[r][c] += e[r][i] * (force[2 * i] * ea + force[2 * i + 1] * eb) / out->area;
      }
    }
  }
  principal(T[0][0], T[1][1], 0.5 * (T[0][1] + T[1][0]), out->tension);
}

dea_status dea_recover_add(struct dea_context *ctx, struct dea_field_mesh *mesh,
                           const struct dea_recover_field *fields, size_t count)
{
  for (size_t i = 0; i < count; i++) {
    DEA_TRY(ctx, dea_field_mesh_add(ctx, mesh, &fields[i].field, fields[i].values));
  }
  return DEA_OK;
}
