/* All elements of a solid with their fields. */
#include "model/solid/recovery/recover_points.h"

#include <lapacke.h>
#include <math.h>
#include <string.h>

enum { SUMS = 23, FORCE = 17 }; // F 9, stress 6, energy, field, membrane force 6

/* Points while sums are taken. */
struct work {
  struct dea_context *ctx;
  struct dea_arena memory; // of all arrays
  const struct dea_recover_input *in;
  struct dea_stacked *stack;
  struct dea_recover_points points;
  struct dea_recovered *at;
  double (*sum)[SUMS];
  double *weight; // of a point
  double *volume; // of an element [m^3]
  double *error;  // of an element: largest |J - 1|
};

/* Takes the elements of one ply in one column; their membrane forces add up. */
static dea_status add_column(struct work *w, size_t from, size_t end)
{
  double force[DEA_ELEMENT_LEVEL_MAX][6] = {{0}};
  struct dea_recovered *at = w->at;
  for (size_t k = from; k < end; k++) {
    size_t e = w->stack[k].element;
    DEA_TRY(w->ctx, dea_recover_element(w->ctx, w->in, e, at));
    w->volume[e] = at->volume_m3;
    w->error[e] = at->volume_error;
    for (int n = 0; n < at->nodes; n++) {
      const size_t p = dea_recover_point(&w->points, w->in->grid, e, n);
      w->weight[p] += at->volume_m3;
      for (int i = 0; i < 9; i++) {
        w->sum[p][i] += at->volume_m3 * at->F[n][i];
      }
      for (int i = 0; i < 6; i++) {
        w->sum[p][9 + i] += at->volume_m3 * at->stress[n][i];
      }
      w->sum[p][15] += at->volume_m3 * at->energy[n];
      w->sum[p][16] += at->volume_m3 * at->field[n];
    }
    for (int n = 0; n < at->plane_nodes; n++) {
      for (int i = 0; i < 6; i++) {
        force[n][i] += at->force[n][i];
      }
    }
  }
  for (size_t k = from; k < end; k++) {
    size_t e = w->stack[k].element;
    for (int n = 0; n < at->nodes; n++) {
      const size_t p = dea_recover_point(&w->points, w->in->grid, e, n);
      for (int i = 0; i < 6; i++) {
        w->sum[p][FORCE + i] += w->volume[e] * force[n % at->plane_nodes][i];
      }
    }
  }
  return DEA_OK;
}

static dea_status get_means(struct work *w)
{
  size_t count = w->in->grid->element_count;
  DEA_TRY(w->ctx, dea_recover_number(&w->memory, w->in->grid, &w->points));
  w->stack = dea_recover_stack(&w->memory, w->in);
  w->at = dea_arena_alloc(&w->memory, 1, sizeof *w->at);
  w->sum = dea_arena_alloc(&w->memory, w->points.count, sizeof *w->sum);
  w->weight = dea_arena_alloc(&w->memory, w->points.count, sizeof *w->weight);
  w->volume = dea_arena_alloc(&w->memory, count, sizeof *w->volume);
  w->error = dea_arena_alloc(&w->memory, count, sizeof *w->error);
  DEA_TRY(w->ctx, dea_arena_status(&w->memory));
  for (size_t from = 0; from < count;) {
    size_t end = dea_recover_column_end(w->stack, count, from, true);
    DEA_TRY(w->ctx, add_column(w, from, end));
    from = end;
  }
  for (size_t p = 0; p < w->points.count; p++) {
    for (int i = 0; i < SUMS; i++) {
      w->sum[p][i] /= w->weight[p];
    }
  }
  return DEA_OK;
}

/* Eigenvalues of a symmetric matrix xx yy zz xy yz zx, the largest first, and their directions. */
static void principal(const double m[6], double value[3], double (*axis)[3])
{
  double A[9] = {m[0], m[3], m[5], m[3], m[1], m[4], m[5], m[4], m[2]}, rising[3] = {NAN, NAN, NAN};
  double work[32];
  LAPACKE_dsyev_work(LAPACK_COL_MAJOR, axis != NULL ? 'V' : 'N', 'L', 3, A, 3, rising, work, 32);
  for (int k = 0; k < 3; k++) {
    value[k] = rising[2 - k];
    if (axis != NULL) {
      memcpy(axis[k], A + 3 * (2 - k), sizeof axis[k]);
    }
  }
}

/* Principal stretches of F G. */
static void principal_stretch(const struct dea_part_material *part_material, const double F[9],
                              double out[3])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  const double *G = part_material->pre_stretch, s = part_material->pre_shear;
  double C[6] = {0};
  for (int m = 0; m < 6; m++) {
    for (int i = 0; i < 3; i++) {
      C[m] += F[3 * i + row[m]] * F[3 * i + column[m]];
    }
  }
  double plane[3] = {C[0], C[1], C[3]}, yz = C[4], zx = C[5];
  dea_part_material_pull_back(part_material, plane, plane);
  C[0] = plane[0];
  C[1] = plane[1];
  C[2] *= G[2] * G[2];
  C[3] = plane[2];
  C[4] = G[1] * G[2] * yz + s * G[2] * zx;
  C[5] = G[2] * G[0] * zx + s * G[2] * yz;
  principal(C, out, NULL);
  for (int k = 0; k < 3; k++) {
    out[k] = sqrt(fmax(out[k], 0));
  }
}

/* Where the values of the fields go. */
struct fields {
  double *displacement, *stretch, *plane, *stress, *axis[3], *tension, *field, *energy;
  double *error, *ply, *region;
};

#define AXIS(name, meaning)                                                                        \
  {                                                                                                \
    name, "1", meaning, DEA_MESH_AXIS, 3, false, NULL                                              \
  }

static dea_status add_fields(struct dea_context *ctx, struct dea_field_mesh *mesh,
                             struct fields *out)
{
  const struct dea_recover_field all[] = {
      {dea_recover_displacement, &out->displacement},
      {DEA_RECOVER_VALUES("principal_stretch", "1",
                          "principal stretches from the unstretched state", 3),
       &out->stretch},
      {dea_recover_plane_stretch, &out->plane},
      {DEA_RECOVER_VALUES(
           "principal_stress_Pa", "Pa",
           "principal true stresses, elastic, pressure and Maxwell together, largest first", 3),
       &out->stress},
      {AXIS("stress_axis_1", "direction of the largest principal stress"), &out->axis[0]},
      {AXIS("stress_axis_2", "direction of the second principal stress"), &out->axis[1]},
      {AXIS("stress_axis_3", "direction of the smallest principal stress"), &out->axis[2]},
      {dea_recover_tension, &out->tension},
      {dea_recover_true_field, &out->field},
      {DEA_RECOVER_VALUES(
           "energy_J_per_m3", "J/m3",
           "elastic energy per volume of the stretched flat film, pre-stretch included", 1),
       &out->energy},
      {DEA_RECOVER_OF_CELLS("volume_error", "largest |J - 1| in the element"), &out->error},
      {DEA_RECOVER_OF_CELLS("sheet", "number of the layer, from below"), &out->ply},
      {DEA_RECOVER_OF_CELLS("region", "number of the region in the plane"), &out->region},
  };
  return dea_recover_add(ctx, mesh, all, sizeof all / sizeof all[0]);
}

static void fill_point(const struct work *w, size_t p, const struct fields *to)
{
  const struct dea_recover_input *in = w->in;
  size_t e = w->points.element[p];
  const struct dea_part_material *part_material = &in->part_materials[in->part_material[e]];
  const double *sum = w->sum[p];
  struct dea_plane_state plane;
  double axis[3][3];
  memcpy(to->displacement + 3 * p, in->u + 3 * w->points.node[p], 3 * sizeof(double));
  principal_stretch(part_material, sum, to->stretch + 3 * p);
  principal(sum + 9, to->stress + 3 * p, axis);
  for (int k = 0; k < 3; k++) {
    memcpy(to->axis[k] + 3 * p, axis[k], sizeof axis[k]);
  }
  to->energy[p] = sum[15];
  dea_recover_plane(part_material, sum, sum + FORCE, &plane);
  memcpy(to->plane + 3 * p, plane.stretch, sizeof plane.stretch);
  memcpy(to->tension + 2 * p, plane.tension, sizeof plane.tension);
  to->field[p] = sum[16];
}

/* A block of the elements of so many levels of nodes, if there are any. */
static dea_status add_block(struct work *w, struct dea_field_mesh *mesh, int levels)
{
  const struct dea_grid *grid = w->in->grid;
  size_t count = 0;
  int *nodes;
  for (size_t e = 0; e < grid->element_count; e++) {
    count += grid->levels[e] == levels;
  }
  if (count == 0) {
    return DEA_OK;
  }
  DEA_TRY(w->ctx, dea_field_mesh_add_block(w->ctx, mesh, grid->order, levels - 1, count, &nodes));
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e) && grid->levels[e] == levels; n++) {
      *nodes++ = (int)dea_recover_point(&w->points, grid, e, n);
    }
  }
  return DEA_OK;
}

static dea_status fill_mesh(struct work *w, struct dea_field_mesh *mesh)
{
  const struct dea_grid *grid = w->in->grid;
  struct fields to;
  for (int levels = grid->order_z + 1; levels > 0; levels--) {
    DEA_TRY(w->ctx, add_block(w, mesh, levels));
  }
  DEA_TRY(w->ctx, add_fields(w->ctx, mesh, &to));
  for (int levels = grid->order_z + 1; levels > 0; levels--) { // block by block
    for (size_t e = 0; e < grid->element_count; e++) {
      if (grid->levels[e] == levels) {
        *to.error++ = w->error[e];
        *to.ply++ = grid->ply[e];
        *to.region++ = grid->region[e];
      }
    }
  }
  for (size_t p = 0; p < w->points.count; p++) {
    memcpy(mesh->X + 3 * p, grid->X + 3 * w->points.node[p], 3 * sizeof(double));
    fill_point(w, p, &to);
  }
  return DEA_OK;
}

dea_status dea_recover_volume(struct dea_context *ctx, const struct dea_recover_input *in,
                              struct dea_field_mesh **out)
{
  struct work work = {.ctx = ctx, .memory = {.ctx = ctx}, .in = in};
  *out = NULL;
  dea_status status = get_means(&work);
  status = status == DEA_OK ? dea_field_mesh_create(ctx, work.points.count, out) : status;
  status = status == DEA_OK ? fill_mesh(&work, *out) : status;
  dea_arena_free(&work.memory);
  return dea_field_mesh_finish(ctx, status, out);
}
