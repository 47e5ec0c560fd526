/* Slopes of the constraints J = 1 of a solid's elements, at the state where they are found
 * (dea_element_type.constraint). Pressures are [elements][most of an element]; what is of elements
 * is of this rank's, and 0 of the others. */
#pragma once

#include "model/solid/assembly/problem.h"

struct dea_constraints {
  const struct dea_solid *s; // lent
  size_t most;               // pressures of an element at most
  double *b, *L;             // [own_count][most * DEA_HEX_DOFS_MAX], [own_count][most * most]
};

/* Those of one element. */
struct dea_element_constraint {
  size_t first, count; // its pressures
  const double *b, *L; // [count][dofs], [count][count]; L[0] is 0 of what takes no pressure
};

/* memory: of the arrays. */
dea_status dea_constraints_find(struct dea_context *ctx, struct dea_arena *memory,
                                struct dea_solid *s, struct dea_constraints *out);
/* Of the k-th of this rank's elements. */
struct dea_element_constraint dea_constraints_at(const struct dea_constraints *c, size_t k);
/* out [dofs] = b^T nu, of all ranks. */
void dea_constraints_push(const struct dea_constraints *c, const double *nu, double *out);
/* out [pressures] = b v, v [dofs]. */
void dea_constraints_grow(const struct dea_constraints *c, const double *v, double *out);
/* Pressures with which the solid as good as incompressible answers a motion v [dofs]: out
 * [pressures] = kappa M^-1 B^T v, of all ranks. */
void dea_constraints_pressures(const struct dea_constraints *c, const double *v, double *out);
/* x [pressures] = L^-1 x, or L^-T x; 0 of what takes no pressure. */
void dea_constraints_solve(const struct dea_constraints *c, bool transposed, double *x);
