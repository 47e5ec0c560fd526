/* The linear answer of an equilibrium to loads that are objectives' slopes, for gradients
 * (docs/theory/gradients.md): lambda of
 *
 *   A lambda + B mu = Q_u,   B^T lambda = Q_p,
 *
 * with the tangent A, the slope B of the constraints J = 1 and of those that loads hold at the
 * solid's state, and the slopes of a quantity Q by displacements and pressures. */
#pragma once

#include "model/solid/assembly/problem.h"

struct dea_adjoint;

/* Room for `count` answers. The factor is that of the solid's last equilibrium where there is one
 * and no constraint of a load is held, else the tangent is factorised at its state. solid: lent,
 * outlives the answers, and where it is when they are solved. memory: of the answers. */
dea_status dea_adjoint_create(struct dea_context *ctx, struct dea_solid *solid, size_t count,
                              struct dea_arena *memory, struct dea_adjoint **out);

/* Where slopes of a quantity go before dea_adjoint_solve, 0 at first: by u [dofs] and by the
 * multipliers [elements][pressures], then those of each load. */
double *dea_adjoint_slope(struct dea_adjoint *adjoint, size_t number);
double *dea_adjoint_pressure_slope(struct dea_adjoint *adjoint, size_t number);
/* The answers to all of them, [count] wanted, in place of what they were; the slopes are then gone.
 * DEA_E_NOT_CONVERGED where the constraints do not settle. */
dea_status dea_adjoint_solve(struct dea_context *ctx, struct dea_adjoint *adjoint,
                             const bool *wanted);
/* Q_u . lambda + Q_p . mu of an answer, with the slopes of a quantity that is not solved for yet.
 */
double dea_adjoint_pair(struct dea_adjoint *adjoint, size_t answer, size_t number);
/* Adds `times` times an answer to another one. */
void dea_adjoint_add(struct dea_adjoint *adjoint, size_t number, double times, size_t answer);
/* lambda [dofs] of an answer; lent. */
const double *dea_adjoint_answer(const struct dea_adjoint *adjoint, size_t number);
/* Residuals and energy of the solid at its state, of another problem than the answers are of, for
 * dea_adjoint_product. Held potentials become those of the voltage, and stay so. */
dea_status dea_adjoint_assemble(struct dea_context *ctx, struct dea_adjoint *adjoint,
                                double voltage_V, double *energy_J);
/* lambda . R + mu . C of the last assembly. */
double dea_adjoint_product(const struct dea_adjoint *adjoint, size_t number);
/* The constraints C of the last assembly of the problem that the answers are of, added `times`
 * times to out [multipliers of the solid]. */
void dea_adjoint_add_constraints(const struct dea_adjoint *adjoint, double times, double *out);
/* Multipliers with which the solid as good as incompressible and the penalties of what is held
 * answer a motion v, out [multipliers]: kappa M^-1 B^T v. */
void dea_adjoint_mode_pressures(const struct dea_adjoint *adjoint, const double *v, double *out);
