/* What recovery on a volume and on a surface share: columns of elements, sums at points. */
#pragma once

#include "model/solid/recovery/recover.h"

/* Elements by column (those above each other), ply and height. A column has the same x and y, the
 * sum over the nodes of one level, to the bit. */
struct dea_stacked {
  double x, y, z;
  int ply;
  size_t element;
};
/* [element_count]; NULL for want of memory. */
struct dea_stacked *dea_recover_stack(struct dea_arena *memory, const struct dea_recover_input *in);
/* First element after `from` of another column, or of another ply with by_ply. */
size_t dea_recover_column_end(const struct dea_stacked *stack, size_t count, size_t from,
                              bool by_ply);

/* One point for each node in each group, which is a ply in a region, numbered in the order of the
 * elements. */
struct dea_recover_points {
  size_t count;
  int *group;      // [elements]
  int *number;     // [groups][node_count] one more than that of the point; 0: none
  int *node;       // [count] of a point
  size_t *element; // [count] one that has it
};
/* memory: of the arrays. */
dea_status dea_recover_number(struct dea_arena *memory, const struct dea_grid *grid,
                              struct dea_recover_points *out);
/* That of node n of an element. */
size_t dea_recover_point(const struct dea_recover_points *points, const struct dea_grid *grid,
                         size_t element, int n);

/* One element of any kind. */
dea_status dea_recover_element(struct dea_context *ctx, const struct dea_recover_input *in,
                               size_t element, struct dea_recovered *out);
/* The same at its Gauss points; stress: false leaves P untouched. */
dea_status dea_recover_state(const struct dea_recover_input *in, size_t e, bool stress,
                             struct dea_element_state *out);
/* Height of a level of nodes of an element. */
double dea_recover_height(const struct dea_recover_input *in, size_t element, int level);

/* In the plane of the film at a point: F, membrane force as in struct dea_recovered. */
struct dea_plane_state {
  double stretch[3]; // principal, from the unstretched film: larger, smaller, through the thickness
  double tension[2]; // principal, per current length: larger, smaller [N/m]
  double area;       // |F_1 x F_2|
};
void dea_recover_plane(const struct dea_part_material *part_material, const double F[9],
                       const double force[6], struct dea_plane_state *out);

/* Fields, and where their values go. */
struct dea_recover_field {
  struct dea_mesh_field field;
  double **values;
};
#define DEA_RECOVER_VALUES(name, unit, meaning, components)                                        \
  {                                                                                                \
    name, unit, meaning, DEA_MESH_VALUES, components, false, NULL                                  \
  }
#define DEA_RECOVER_OF_CELLS(name, meaning)                                                        \
  {                                                                                                \
    name, "1", meaning, DEA_MESH_VALUES, 1, true, NULL                                             \
  }
dea_status dea_recover_add(struct dea_context *ctx, struct dea_field_mesh *mesh,
                           const struct dea_recover_field *fields, size_t count);

/* Fields that volume and surface have in common. */
extern const struct dea_mesh_field dea_recover_displacement, dea_recover_plane_stretch,
    dea_recover_tension, dea_recover_true_field;
