/* A solid made of layered hexahedra: assembly, equilibrium at a voltage, count of unstable modes.
 *
 * The energy of hex.h is minimised by Newton's method with line search. While the tangent K is not
 * positive definite (a negative pivot of its LDL^T) a multiple of a lumped metric is added to it,
 * so that every step goes down. Incompressibility is brought in by multipliers: after each minimum
 * they take over the pressure kappa theta, until J - 1 has no projection left.
 *
 * PETSc must be initialised (dea_solid_start). One process for now. */
#ifndef DEA_MODEL_SOLID_SOLVE_SOLID_H
#define DEA_MODEL_SOLID_SOLVE_SOLID_H

#include "model/solid/grid.h"

struct dea_solid;

struct dea_solid_options {
  int order_z;
  size_t layer_count;
  const struct dea_hex_layer *layers; // copied
  /* Layer of an element, and whether it lies between electrodes. */
  int (*layer_of)(const void *self, int region, int sheet);
  bool (*active)(const void *self, int region, int sheet);
  /* Components of a node that are held, as bits 1, 2, 4. */
  int (*held)(const void *self, const double X[3]);
  const void *self;
};

/* How a solve went. */
struct dea_solid_report {
  int iterations, factorisations, shifted; // shifted: of the factorisations
  int unstable_modes;                      // negative pivots of the unshifted tangent at the end
  double energy_J, residual;               // residual: relative to the sum of element forces
  double theta_max;                        // largest projected J - 1 left
};

/* PETSc for this process; harmless when it runs already. */
dea_status dea_solid_start(struct dea_context *ctx);
void dea_solid_stop(void);

/* grid: lent, outlives the solid. out: owned by the caller, NULL on failure. */
dea_status dea_solid_create(struct dea_context *ctx, const struct dea_grid *grid,
                            const struct dea_solid_options *options, struct dea_solid **out);
void dea_solid_destroy(struct dea_context *ctx, struct dea_solid *solid);

/* Equilibrium at a voltage, from the last one; where the whole step fails it goes there in smaller
 * ones. DEA_E_NOT_CONVERGED leaves the solid at the last equilibrium that was found. */
dea_status dea_solid_solve(struct dea_context *ctx, struct dea_solid *solid, double voltage_V,
                           struct dea_solid_report *report);

/* Displacements [node_count][3], lent; they may be written to set a start. */
double *dea_solid_displacement(struct dea_solid *solid);

/* Dead loads on the nodes [node_count][3] [N], lent; at first 0. Set them before a solve. */
double *dea_solid_force(struct dea_solid *solid);

#endif
