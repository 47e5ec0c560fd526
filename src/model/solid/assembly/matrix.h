/* The matrix K of a solid and linear algebra with it: rows node by node, split over the ranks, in
 * the local axes of nodes that have them. */
#pragma once

#include "model/solid/assembly/problem.h"

/* Upper block row lengths of this rank's rows: columns that are here and on other ranks. */
struct dea_solid_row_lengths {
  struct dea_arena memory;
  PetscInt *own, *others; // [end_node - first_node] each
};

/* Splits rows and elements over the ranks; K and vectors of its rows. *lengths: for other matrices
 * of the nodes; the caller frees its memory. before: how the creation went up to here, agreed on
 * with the others. */
dea_status dea_solid_create_matrix(struct dea_context *ctx, struct dea_solid *s, dea_status before,
                                   struct dea_solid_row_lengths *lengths);
void dea_solid_destroy_matrix(struct dea_solid *s);

/* ---- local axes of nodes on mirror planes that are not x = 0 or y = 0 (docs/theory/mesh.md) ----
 * Displacements and forces are kept in global components everywhere; K and the held components of
 * such a node are in local ones, v_local = Q v. */

dea_status dea_solid_frames_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options);
/* K [per_node node_count] squared of some nodes, from global to local components. */
void dea_solid_frame_matrix(const struct dea_solid *s, int node_count, const int *nodes, double *K);
/* v [dofs] from global to local components, or back. */
void dea_solid_frame_vector(const struct dea_solid *s, bool back, double *v);
/* Sets held components of v [dofs], which is in global ones, to 0; not those that follow a body. */
void dea_solid_release_held(const struct dea_solid *s, double *v);

/* ---- entries ---- */

/* Ends what was added to A, which has to be done after a failure too: else its next zeroing fails.
 */
dea_status dea_solid_end_matrix(struct dea_context *ctx, Mat A);
/* The same in the middle of adding: A keeps room for what did not come any more. */
dea_status dea_solid_stop_matrix(struct dea_context *ctx, Mat A);
/* A += factor B; both have the pattern of K. */
dea_status dea_solid_add_matrix(struct dea_context *ctx, Mat A, double factor, Mat B);
/* A += amount times what is the same for the three components of the displacement, made of a matrix
 * [nodes][nodes] for each element, without the rows and columns of held components. A: K, or a
 * matrix of its pattern. */
dea_status dea_solid_add_scalar(struct dea_context *ctx, struct dea_solid *s, Mat A, double amount,
                                dea_status (*of)(const struct dea_solid *s, size_t e,
                                                 double *scalar));

/* ---- factor and solutions ---- */

/* LDL^T of A into *factor, which is analysed when it is NULL. */
dea_status dea_solid_factor(struct dea_context *ctx, Mat A, Mat *factor);
/* Factor of K; *negative: its negative pivots beyond those of free potentials. rough: a K with up
 * to so many is counted, and solved with roughly at most; of more some may be left out, and then
 * there is no factor. */
enum { DEA_FACTOR_EXACT = -1 }; // K is solved with, of whatever definiteness
dea_status dea_solid_factorise(struct dea_context *ctx, struct dea_solid *s, int rough,
                               int *negative);
/* x = K^-1 right with the present factor; vectors of K's rows, not the same. */
dea_status dea_solid_solve_rows(struct dea_context *ctx, struct dea_solid *s, Vec right, Vec x);
/* out = K^-1 right with the present factor, [dofs] both, in global components; what is on followers
 * of a body goes to the body, and they move with it. */
dea_status dea_solid_solve_linear(struct dea_context *ctx, struct dea_solid *s, const double *right,
                                  double *out);
/* Unknowns of the whole [dofs] in global components into a vector of K's rows; they are in local
 * ones after that. */
dea_status dea_solid_to_vector(struct dea_context *ctx, const struct dea_solid *s, double *values,
                               Vec vector);
/* A vector of K's rows as unknowns of the whole [dofs] in global components, followers of bodies
 * carried along. */
dea_status dea_solid_from_vector(struct dea_context *ctx, const struct dea_solid *s, Vec vector,
                                 double *out);
