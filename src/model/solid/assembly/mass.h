/* Matrices that do not depend on the state, of numbers between the nodes: the consistent mass of
 * the part materials' densities (docs/theory/vibration.md), the volume lumped to the nodes, and the
 * integral of grad : grad that shifts K (docs/theory/branches.md). */
#pragma once

#include "model/solid/assembly/problem.h"

/* A += factor M; A as in dea_solid_add_scalar. */
dea_status dea_solid_add_mass(struct dea_context *ctx, struct dea_solid *s, Mat A, double factor);
/* M as a matrix of K's pattern, owned by the caller. DEA_E_ARGUMENT where there is no mass. */
dea_status dea_solid_create_mass(struct dea_context *ctx, struct dea_solid *s, Mat *out);

/* Volume lumped to the displacements [dofs]; 0 for potentials. */
void dea_solid_lump_volume(const struct dea_solid *s, double *volume);
/* The same as a matrix of K's pattern, without what is held, owned by the caller. */
dea_status dea_solid_create_volume(struct dea_context *ctx, struct dea_solid *s, Mat *out);
/* Volume of an element; 0 for an inverted one. */
double dea_solid_volume_of(const struct dea_solid *s, size_t e);
/* A += amount_Pa int grad : grad of the displacements; A as in dea_solid_add_scalar. */
dea_status dea_solid_add_laplace(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                 double amount_Pa);
/* The same of 1 Pa as a matrix of K's pattern, owned by the caller. */
dea_status dea_solid_create_laplace(struct dea_context *ctx, struct dea_solid *s, Mat *out);
