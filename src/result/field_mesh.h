/* A mesh with named fields: what a model hands out of its inside after a solve.
 *
 * Points carry their place in the stretched flat film; where the parts of a device meet there is
 * one point a part, so that a value that jumps there has both its sides. */
#pragma once

#include "base/context.h"

enum { DEA_MESH_ORDER_MAX = 3, DEA_MESH_FIELDS_MAX = 16, DEA_MESH_BLOCKS_MAX = 4 };

/* How a field goes over to a mirrored copy of the mesh. */
enum dea_mesh_kind {
  DEA_MESH_VALUES, // numbers that do not know directions
  DEA_MESH_VECTOR, // three components, x y z
  DEA_MESH_AXIS,   // the same, of length one, its sign without meaning
};

/* values: [points or cells][components], owned by the mesh. The name ends in the unit as elsewhere
 * ("displacement_m"). */
struct dea_mesh_field {
  char name[32], unit[16], meaning[128];
  enum dea_mesh_kind kind;
  int components;
  bool of_cells;
  double *values;
};

/* Elements of one kind. order: in the plane, 1 to DEA_MESH_ORDER_MAX; order_z: through the
 * thickness, 0 for flat ones. nodes: [count][(order + 1)^2 (order_z + 1)], first local axis
 * fastest, at the Gauss-Lobatto places; owned by the mesh. */
struct dea_mesh_block {
  int order, order_z;
  size_t count;
  int *nodes;
};

/* Name of the fields that hold shapes of modes in the film's middle surface, counted from 1; and
 * what is added to a model's name for surfaces of a result that hold them. */
#define DEA_SHAPE_FIELD "mode_%d"
#define DEA_SHAPES_SUFFIX "_modal"
/* Voltage across a film of electrodes with a sheet resistance. */
#define DEA_VOLTAGE_FIELD "film_voltage_V"

/* How large the system of a model on a mesh is. */
struct dea_model_size {
  size_t elements, nodes, unknowns;
};

struct dea_field_mesh {
  size_t point_count;
  double *X;         // [point_count][3] places in the stretched flat film [m]
  size_t cell_count; // of all blocks; values of cells come block by block
  size_t block_count;
  struct dea_mesh_block blocks[DEA_MESH_BLOCKS_MAX];
  size_t field_count;
  struct dea_mesh_field fields[DEA_MESH_FIELDS_MAX];
  /* The whole is made of 2 * fold copies of this part, which lies between the planes of symmetry
   * through the z axis at angle `symmetry_angle` and pi/fold further; fold 0: this is the whole. */
  int fold;
  double symmetry_angle; // [rad]
  int fibres;            // of the whole, the first along +x; 0: none
};

/* An empty mesh with room for points; out: owned by the caller. */
dea_status dea_field_mesh_create(struct dea_context *ctx, size_t point_count,
                                 struct dea_field_mesh **out);
void dea_field_mesh_destroy(struct dea_context *ctx, struct dea_field_mesh *mesh);
/* The end of making one: passes `made` on, and keeps *mesh only when that is DEA_OK. */
dea_status dea_field_mesh_finish(struct dea_context *ctx, dea_status made,
                                 struct dea_field_mesh **mesh);
/* Nodes of an element of a block. */
int dea_mesh_block_nodes(const struct dea_mesh_block *block);
/* Adds a block, its nodes 0; *nodes lent. */
dea_status dea_field_mesh_add_block(struct dea_context *ctx, struct dea_field_mesh *mesh, int order,
                                    int order_z, size_t count, int **nodes);
/* Adds a field after all blocks, its values 0; field->values is not read. *values lent. */
dea_status dea_field_mesh_add(struct dea_context *ctx, struct dea_field_mesh *mesh,
                              const struct dea_mesh_field *field, double **values);
/* Field of that name, NULL when there is none; lent. */
const struct dea_mesh_field *dea_field_mesh_find(const struct dea_field_mesh *mesh,
                                                 const char *name);
/* Distance of the farthest point from the z axis. */
double dea_field_mesh_radius_m(const struct dea_field_mesh *mesh);
/* Points or cells that a field has values of. */
size_t dea_mesh_field_count(const struct dea_field_mesh *mesh, const struct dea_mesh_field *field);

// Mirrored copies that make up the whole ---------------------------------------------------------

/* x' = m x in the plane; z stays. */
struct dea_copy {
  double m[4];
  bool mirrored;
};

/* Number of copies, the part itself included. */
size_t dea_copy_count(const struct dea_field_mesh *mesh);
/* Copy 2k is turned by k times 2 pi/fold, copy 2k + 1 mirrored at the first plane of symmetry
 * before that. Copy 0 is the part itself. */
struct dea_copy dea_copy_at(const struct dea_field_mesh *mesh, size_t number);
/* A place or a vector in a copy. */
void dea_copy_move(const struct dea_copy *copy, const double in[3], double out[3]);

/* All copies of a part as one mesh; of a whole a copy of it. DEA_E_UNSUPPORTED for one with too
 * many points. out: owned by the caller, NULL on failure. */
dea_status dea_field_mesh_whole(struct dea_context *ctx, const struct dea_field_mesh *mesh,
                                struct dea_field_mesh **out);
