/* The potential of a coupled field: unknowns, electrodes, and the solution at given displacements
 * (docs/theory/coupled.md). Nothing to do for a thin film, where problem.field is NULL. */
#pragma once

#include "model/solid/assembly/matrix.h"

/* Electrodes; then the matrix, with row lengths as those of K. */
dea_status dea_solid_field_create(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_options *options);
dea_status dea_solid_field_matrix(struct dea_context *ctx, struct dea_solid *s,
                                  const struct dea_solid_row_lengths *lengths);
void dea_solid_field_destroy(struct dea_solid *s);
/* c: a potential is c psi [V/m]. */
double dea_solid_field_scale(const struct dea_solid *s);
/* Sets the held potentials in u [dofs] to those of a voltage. */
void dea_solid_hold_potential(const struct dea_solid *s, double voltage_V, double *u);
/* Sets the potentials in u [dofs] to those that belong to its displacements: the maximum of the
 * energy over them. DEA_E_DOMAIN for an inverted element. */
dea_status dea_solid_solve_potential(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *u);
/* The same at the displacements of an equilibrium, which u has, from its potentials: they go with
 * the voltage, and are solved for only where it has none or there are charges. */
dea_status dea_solid_scale_potential(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                                     double *u);
