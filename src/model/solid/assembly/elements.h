/* What a solid gives its elements: a kind, and what they are asked with. */
#pragma once

#include "model/solid/assembly/problem.h"

/* Sets problem.kind. DEA_E_UNSUPPORTED for an element that cannot be of its part material, or has
 * no potential in a coupled field. */
dea_status dea_solid_set_kinds(struct dea_context *ctx, struct dea_solid *s);

/* Sets problem.laminate: elements on the same quadrilateral of the plane mesh, whose plies lie on
 * each other. */
dea_status dea_solid_find_laminates(struct dea_context *ctx, struct dea_solid *s);

/* An element as it is asked, and the memory that the input lends from. */
struct dea_solid_element_input {
  struct dea_element_input in;
  struct dea_part_material part_material;
  double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], potential[DEA_HEX_NODES_MAX];
};

/* An element at unknowns u [dofs] and a voltage. */
void dea_solid_element_input(const struct dea_solid *s, size_t e, const double *u, double voltage_V,
                             struct dea_solid_element_input *out);

/* Middle of an element in the stretched flat film [mm]. */
void dea_solid_element_middle(const struct dea_solid *s, size_t e, double x_mm[3]);

/* Strains of an element at the state. DEA_E_DOMAIN for an inverted one. */
dea_status dea_solid_element_strains(const struct dea_solid *s, size_t e,
                                     struct dea_element_strains *out);
