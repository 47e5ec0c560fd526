/* A state of one mesh on another: from displacements of whatever origin to the equilibrium that is
 * nearest to them (docs/theory/states.md). */
#pragma once

#include "model/solid/assembly/solid.h"

/* Moves nodes of inverted elements of the softest part materials, and of elements around them where
 * that is not enough, towards the mean of their neighbours' displacements u [node_count][3], until
 * none is inverted. What is held, and what stiffer elements have, stays. *left: elements that are
 * inverted still; u is as it was then. */
dea_status dea_solid_untangle(struct dea_context *ctx, struct dea_solid *solid, double *u,
                              size_t *left);

/* A stable equilibrium at a voltage, with the loads that are asked for, next to displacement_m
 * [node_count][3]: down from there or, where that comes to none, held near to it by springs that
 * fade. Where that finds none *found is false and the solid and *report are as they were. */
dea_status dea_solid_transfer_solution(struct dea_context *ctx, struct dea_solid *solid,
                                       double voltage_V, const double *displacement_m,
                                       struct dea_solid_report *report, bool *found);
