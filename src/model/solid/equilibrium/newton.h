/* One equilibrium at the controls as they are: Newton descent on the energy with multipliers that
 * follow (docs/theory/branches.md). */
#pragma once

#include "model/solid/assembly/problem.h"

/* Equilibrium at the controls and multipliers of loads as they are, downhill from where it is: a
 * minimum, or a point that has a valley on all sides that a Newton step sees. Pressures follow;
 * where they do not, report->theta_max is above settings.volume_tol. soft: with a soft bulk modulus
 * at first, which may lead further away. */
dea_status dea_solid_minimise(struct dea_context *ctx, struct dea_solid *s, bool soft,
                              struct dea_solid_report *report);
/* One linear step in which the held components go their work.increment and the rest follows. */
dea_status dea_solid_prescribed_increment(struct dea_context *ctx, struct dea_solid *s,
                                          struct dea_solid_report *report);

/* The first linear step of a way, where that is wanted: the displacements that the tangent at its
 * start foresees for its end; NULL: they are not known. */
void dea_solid_predict_tangent(struct dea_solid *s, const double *step);

/* Counts the unstable modes at an equilibrium; a factor without any starts the next step.
 * tangent: K of there has been assembled. */
dea_status dea_solid_count_unstable(struct dea_context *ctx, struct dea_solid *s, bool tangent,
                                    struct dea_solid_report *report);

/* ---- for continuation and load steps with one factor, which are Newton's method too ---- */

/* work.step = -K^-1 work.g with the factor that is there. */
dea_status dea_solid_linear_step(struct dea_context *ctx, struct dea_solid *s);
/* Size of work.g over that of the element forces. */
double dea_solid_residual(const struct dea_solid *s);

/* Before u goes on by fraction step: stresses there into work.predicted, pressures there into the
 * multipliers, each if it is wanted. */
dea_status dea_solid_predict(struct dea_context *ctx, struct dea_solid *s, double voltage_V,
                             const double *step, double fraction, bool stresses, bool pressures);
/* Whether the energy of the last assembly can tell a change of this size from rounding. */
bool dea_solid_resolved(const struct dea_solid *s, double change);
/* Moves the multipliers of the loads; the largest violation over what is allowed. */
double dea_solid_update_loads(struct dea_solid *s);
