#include "result/field_mesh.h"

#include <limits.h>
#include <math.h>
#include <string.h>

dea_status dea_field_mesh_create(struct dea_context *ctx, size_t point_count,
                                 struct dea_field_mesh **out)
{
  *out = NULL;
  struct dea_field_mesh *mesh = dea_alloc(ctx, 1, sizeof *mesh);
  DEA_TRY_MEMORY(mesh != NULL);
  mesh->point_count = point_count;
  mesh->X = dea_alloc(ctx, point_count, 3 * sizeof *mesh->X);
  if (mesh->X == NULL) {
    dea_free(ctx, mesh);
    return DEA_E_MEMORY;
  }
  *out = mesh;
  return DEA_OK;
}

void dea_field_mesh_destroy(struct dea_context *ctx, struct dea_field_mesh *mesh)
{
  if (mesh == NULL) {
    return;
  }
  for (size_t i = 0; i < mesh->block_count; i++) {
    dea_free(ctx, mesh->blocks[i].nodes);
  }
  for (size_t i = 0; i < mesh->field_count; i++) {
    dea_free(ctx, mesh->fields[i].values);
  }
  dea_free(ctx, mesh->X);
  dea_free(ctx, mesh);
}

dea_status dea_field_mesh_finish(struct dea_context *ctx, dea_status made,
                                 struct dea_field_mesh **mesh)
{
  if (made != DEA_OK) {
    dea_field_mesh_destroy(ctx, *mesh);
    *mesh = NULL;
    return dea_fail_chain(ctx, made, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

int dea_mesh_block_nodes(const struct dea_mesh_block *block)
{
  return (block->order + 1) * (block->order + 1) * (block->order_z + 1);
}

dea_status dea_field_mesh_add_block(struct dea_context *ctx, struct dea_field_mesh *mesh, int order,
                                    int order_z, size_t count, int **nodes)
{
  const struct dea_mesh_block block = {.order = order, .order_z = order_z, .count = count};
  *nodes = NULL;
  if (mesh->block_count == DEA_MESH_BLOCKS_MAX || mesh->field_count > 0 || order < 1 ||
      order > DEA_MESH_ORDER_MAX || order_z < 0 || order_z > DEA_MESH_ORDER_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh of fields takes no such block");
  }
  *nodes = dea_alloc(ctx, count * (size_t)dea_mesh_block_nodes(&block), sizeof **nodes);
  DEA_TRY_MEMORY(*nodes != NULL);
  mesh->blocks[mesh->block_count] = block;
  mesh->blocks[mesh->block_count++].nodes = *nodes;
  mesh->cell_count += count;
  return DEA_OK;
}

size_t dea_mesh_field_count(const struct dea_field_mesh *mesh, const struct dea_mesh_field *field)
{
  return field->of_cells ? mesh->cell_count : mesh->point_count;
}

dea_status dea_field_mesh_add(struct dea_context *ctx, struct dea_field_mesh *mesh,
                              const struct dea_mesh_field *field, double **values)
{
  *values = NULL;
  if (mesh->field_count == DEA_MESH_FIELDS_MAX || field->components < 1 ||
      (field->kind != DEA_MESH_VALUES && field->components != 3)) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a mesh of fields takes no field '%.60s'", field->name);
  }
  *values = dea_alloc(ctx, dea_mesh_field_count(mesh, field) * (size_t)field->components,
                      sizeof **values);
  DEA_TRY_MEMORY(*values != NULL);
  mesh->fields[mesh->field_count] = *field;
  mesh->fields[mesh->field_count++].values = *values;
  return DEA_OK;
}

const struct dea_mesh_field *dea_field_mesh_find(const struct dea_field_mesh *mesh,
                                                 const char *name)
{
  for (size_t i = 0; i < mesh->field_count; i++) {
    if (strcmp(mesh->fields[i].name, name) == 0) {
      return &mesh->fields[i];
    }
  }
  return NULL;
}

double dea_field_mesh_radius_m(const struct dea_field_mesh *mesh)
{
  double radius_m = 0;
  for (size_t p = 0; p < mesh->point_count; p++) {
    radius_m = fmax(radius_m, hypot(mesh->X[3 * p], mesh->X[3 * p + 1]));
  }
  return radius_m;
}

// Mirrored copies that make up the whole ---------------------------------------------------------

size_t dea_copy_count(const struct dea_field_mesh *mesh)
{
  return mesh->fold > 0 ? 2 * (size_t)mesh->fold : 1;
}

struct dea_copy dea_copy_at(const struct dea_field_mesh *mesh, size_t number)
{
  struct dea_copy copy = {{1, 0, 0, 1}, number % 2 == 1};
  if (number == 0) {
    return copy;
  }
  const size_t pair = number / 2;
  double turn = 2 * DEA_PI * (double)pair / mesh->fold;
  // a turn by t after a mirror at angle a is a mirror at a + t/2
  double angle = copy.mirrored ? 2 * mesh->symmetry_angle + turn : turn;
  double c = cos(angle), s = sin(angle), sign = copy.mirrored ? -1 : 1;
  memcpy(copy.m, (double[4]){c, -sign * s, s, sign * c}, sizeof copy.m);
  return copy;
}

void dea_copy_move(const struct dea_copy *copy, const double in[3], double out[3])
{
  out[0] = copy->m[0] * in[0] + copy->m[1] * in[1];
  out[1] = copy->m[2] * in[0] + copy->m[3] * in[1];
  out[2] = in[2];
}

/* Nodes of the copies of an element. In a mirrored copy the first axis is turned round, so that the
 * element does not stand inside out. */
static void copy_nodes(const struct dea_mesh_block *block, size_t copies, size_t point_count,
                       int *out)
{
  size_t row = (size_t)block->order + 1, nodes = (size_t)dea_mesh_block_nodes(block);
  for (size_t c = 0; c < copies; c++) {
    for (size_t i = 0; i < block->count * nodes; i++) {
      size_t along = i % row;
      size_t from = c % 2 == 1 ? i - along + (row - 1 - along) : i;
      out[c * block->count * nodes + i] = block->nodes[from] + (int)(c * point_count);
    }
  }
}

/* Rows of a field in a copy. */
static void copy_values(const struct dea_mesh_field *field, const struct dea_copy *copy,
                        const double *in, size_t rows, double *out)
{
  size_t n = (size_t)field->components;
  for (size_t i = 0; i < rows; i++) {
    if (field->kind == DEA_MESH_VALUES) {
      memcpy(out + i * n, in + i * n, n * sizeof *out);
    } else {
      dea_copy_move(copy, in + 3 * i, out + 3 * i);
    }
  }
}

static void copy_field(const struct dea_field_mesh *mesh, const struct dea_mesh_field *field,
                       size_t copies, double *out)
{
  size_t n = (size_t)field->components;
  for (size_t c = 0; c < copies; c++) {
    struct dea_copy copy = dea_copy_at(mesh, c);
    if (!field->of_cells) {
      copy_values(field, &copy, field->values, mesh->point_count, out + c * mesh->point_count * n);
      continue;
    }
    size_t before = 0; // cells of the blocks so far
    for (size_t b = 0; b < mesh->block_count; b++) {
      size_t count = mesh->blocks[b].count;
      copy_values(field, &copy, field->values + before * n, count,
                  out + (before * copies + c * count) * n);
      before += count;
    }
  }
}

static dea_status fill_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                             size_t copies, struct dea_field_mesh *out)
{
  for (size_t c = 0; c < copies; c++) {
    struct dea_copy copy = dea_copy_at(mesh, c);
    for (size_t i = 0; i < mesh->point_count; i++) {
      dea_copy_move(&copy, mesh->X + 3 * i, out->X + 3 * (c * mesh->point_count + i));
    }
  }
  for (size_t b = 0; b < mesh->block_count; b++) {
    const struct dea_mesh_block *block = &mesh->blocks[b];
    int *nodes;
    DEA_TRY(ctx, dea_field_mesh_add_block(ctx, out, block->order, block->order_z,
                                          copies * block->count, &nodes));
    copy_nodes(block, copies, mesh->point_count, nodes);
  }
  for (size_t f = 0; f < mesh->field_count; f++) {
    double *values;
    DEA_TRY(ctx, dea_field_mesh_add(ctx, out, &mesh->fields[f], &values));
    copy_field(mesh, &mesh->fields[f], copies, values);
  }
  out->fibres = mesh->fibres;
  return DEA_OK;
}

dea_status dea_field_mesh_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                struct dea_field_mesh **out)
{
  size_t copies = dea_copy_count(mesh);
  *out = NULL;
  if (mesh->point_count > (size_t)INT_MAX / copies) {
    return dea_fail(ctx, DEA_E_UNSUPPORTED, "the whole mesh has too many points");
  }
  DEA_TRY(ctx, dea_field_mesh_create(ctx, copies * mesh->point_count, out));
  return dea_field_mesh_finish(ctx, fill_whole(ctx, mesh, copies, *out), out);
}
