/* Something beside the elements that stores energy by the displacements: a spring, a rigid tip, a
 * pressure, two surfaces that meet (docs/theory/loads.md). It comes in pieces of a few nodes each:
 * of an element, whose nodes are coupled in the tangent anyway, or of the solid's couplings. */
#pragma once

#include "model/solid/point/part_material.h"

#include <stddef.h>

enum { DEA_PIECE_NODES_MAX = 17, DEA_PIECE_DOFS_MAX = 3 * DEA_PIECE_NODES_MAX };
struct dea_load_piece {
  int node_count;
  int nodes[DEA_PIECE_NODES_MAX];
  double energy_J;
  double g[DEA_PIECE_DOFS_MAX];                      // [3 node_count]
  double K[DEA_PIECE_DOFS_MAX * DEA_PIECE_DOFS_MAX]; // [3 node_count][3 node_count], symmetric
};

/* The constraint C of a multiplier p, of a few nodes: the energy has p C and, of the penalty k,
 * k C^2 / (2 w). */
struct dea_load_constraint {
  bool held; // false: the energy has neither at this state
  int node_count, nodes[DEA_PIECE_NODES_MAX];
  double value, slope[DEA_PIECE_DOFS_MAX]; // C, and by the displacements of the nodes
  double weight;                           // w
  double stiffness;                        // k
};

struct dea_solid_load {
  void *self; // lent, outlives the solid
  size_t piece_count;
  /* A piece at displacements u [node_count of the solid][3] up to the level; node_count 0 when
   * there is nothing. Each by itself, in any order. DEA_E_DOMAIN where the energy is not defined.
   */
  dea_status (*evaluate)(const void *self, size_t piece, const double *u, enum dea_eval_order level,
                         struct dea_load_piece *out);

  /* The nodes of a piece that no element couples; returns their number. NULL: of elements. Such a
   * load is among those that a solid is made with. */
  int (*couples)(const void *self, size_t piece, int nodes[DEA_PIECE_NODES_MAX]);

  /* Of a load that a number of the whole, such as a volume, determines; NULL: of none. prepare: at
   * u, before elements and pieces there are evaluated. whole: what comes to the tangent beside them
   * is its answer, above 0 unless there is nothing, times s s^T; adds s, by the displacements
   * [node_count][3], where slope is not NULL. along: s . v; needed with whole. */
  void (*prepare)(void *self, const double *u);
  double (*whole)(const void *self, const double *u, double *slope);
  double (*along)(const void *self, const double *u, const double *v);

  /* Numbers by which the load stands, such as its size or the place of a tip. A solve leads them
   * from now to goal, by itself in steps; both are lent, and 0 of them is fine. */
  size_t parameter_count;
  double *now;
  const double *goal;

  /* Multipliers of an augmented Lagrangian, lent. update, NULL where there are none, moves them at
   * a minimum u of the energy; it looks at all pieces. Returns the largest violation of the
   * constraint over the one that is allowed: up to 1 it is settled. */
  size_t multiplier_count;
  double *multiplier;
  double (*update)(void *self, const double *u);
  /* Moves them as a fraction of a step of Newton's method from u does, before u moves; NULL: such a
   * step leaves them. */
  void (*predict)(void *self, const double *u, const double *step, double fraction);
  /* The constraint of multiplier i at u; NULL: it is one of the whole, which `whole` takes. */
  void (*constraint)(const void *self, size_t i, const double *u, struct dea_load_constraint *out);
};
