/* Rigid bodies (docs/theory/bodies.md): nodes that move as one, by a shift t and a rotation vector
 * w. t is the displacement of a node of the body's own, L w that of the node after it, so that all
 * unknowns are lengths and all that is conjugate to them are forces. Nodes that follow are held in
 * K: what acts on them goes to the two nodes of their body. */
#pragma once

#include "model/solid/assembly/problem.h"

/* Unknowns that one element or piece of a load has by itself and through bodies. */
enum {
  DEA_BODIES_MAX = 10, // that the nodes of one element follow
  DEA_JOINT_NODES_MAX = DEA_HEX_NODES_MAX + 2 * DEA_BODIES_MAX,
};

/* Copies bodies, who follows what, and point masses. */
dea_status dea_solid_bodies_create(struct dea_context *ctx, struct dea_solid *s,
                                   const struct dea_solid_options *options);
/* Sets problem.held of followers and of the bodies' own nodes, after supports and local axes. */
dea_status dea_solid_bodies_hold(struct dea_context *ctx, struct dea_solid *s);

/* Whether a node is one of a body's own. */
bool dea_solid_is_of_body(const struct dea_solid *s, size_t node);

/* Whether a node carries the turn of a body. */
bool dea_solid_turns_body(const struct dea_solid *s, size_t node);

/* Places of the followers in u [dofs] from the unknowns of the bodies in it. */
void dea_solid_bodies_place(const struct dea_solid *s, double *u);
/* The same for a small motion v [dofs] from state.u on: v_n = A_n v_q. */
void dea_solid_bodies_transfer(const struct dea_solid *s, double *v);
/* Forces g [dofs] on the followers become those on their bodies: g_q += A_n^T g_n, g_n = 0. */
void dea_solid_bodies_collect(const struct dea_solid *s, double *g);

/* Into work: dR/d(L w_j) at state.u, which the functions beside it take. */
void dea_solid_bodies_prepare(const struct dea_solid *s);
/* nodes [count], and behind them the two nodes of each body that some of them follow. joint:
 * [DEA_JOINT_NODES_MAX]; returns their number. */
int dea_solid_bodies_nodes(const struct dea_solid *s, int count, const int *nodes, int *joint);
/* K of nodes [3 count] squared as the one of all that `joint` has, [3 all] squared in `out`; it may
 * be in the same place. Rows of the followers stay as they are; those of held components too. */
void dea_solid_bodies_join(const struct dea_solid *s, int count, int all, const int *joint,
                           const double *K, double *out);

/* A += a diagonal at the followers, which may have no element. A: not ended. */
dea_status dea_solid_bodies_add_pins(struct dea_context *ctx, struct dea_solid *s, Mat A);
/* A += the geometric term of forces g [dofs] on the followers, sum g_n . d^2 u_n/dq^2, and what
 * keeps held rows from being empty. With increment [dofs], not NULL, also g_q += that term times
 * it. A: not ended. */
dea_status dea_solid_bodies_add_geometric(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                          const double *increment, double *g);
/* What that term adds to v . K v, v [dofs]. */
double dea_solid_bodies_curvature(const struct dea_solid *s, const double *g, const double *v);
/* A += factor A_n^T d_n A_n with a number d_n for each follower n, which stands at apart * n in d.
 * A: not ended. */
dea_status dea_solid_bodies_add_diagonal(struct dea_context *ctx, struct dea_solid *s, Mat A,
                                         double factor, const double *d, size_t apart);
