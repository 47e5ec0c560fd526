/* From one equilibrium to the next voltage and loads, and from an unstable equilibrium down to a
 * stable one (docs/theory/branches.md). */
#pragma once

#include "model/solid/assembly/solid.h"

/* Equilibrium at a voltage, with the dead loads, prescribed displacements and parameters of loads
 * that were asked for, from the last one. Where the whole increment fails it is divided, for all of
 * them alike. DEA_E_NOT_CONVERGED leaves the solid at the last equilibrium that was found, at
 * report->load_factor of the increment. */
dea_status dea_load_steps_solve(struct dea_context *ctx, struct dea_solid *solid, double voltage_V,
                                struct dea_solid_report *report);

/* The same with steps of `least` of the increment or more, in place of settings.load_step_min. */
dea_status dea_load_steps_solve_within(struct dea_context *ctx, struct dea_solid *solid,
                                       double voltage_V, double least,
                                       struct dea_solid_report *report);

/* The same to the controls `goal` [control_count], as dea_solid_controls_goal orders them; memory
 * for them is prepared. */
dea_status dea_load_steps_solve_to(struct dea_context *ctx, struct dea_solid *solid,
                                   const double *goal, double least,
                                   struct dea_solid_report *report);

/* From an unstable equilibrium down along its most unstable mode v to a stable one, at the same
 * voltage and loads. side: 1 along v, -1 against it, 0 where the energy is lower (along v when that
 * is equal). Goes on until there is no unstable mode. The solid stays where it was with
 * DEA_E_NOT_CONVERGED. Nothing to do at a stable one. *report: as of a solve. */
dea_status dea_solid_descend_unstable(struct dea_context *ctx, struct dea_solid *solid, int side,
                                      struct dea_solid_report *report);

/* Looks for another equilibrium at the same voltage and loads: down from displacements + push_m
 * [node_count][3] (what is held stays), to a stable one that is accepted. accept: NULL takes any,
 * also one that an unstable equilibrium found there leads down to. Where that finds none the solid
 * stays where it was, *found is false and *report as it was. */
dea_status dea_solid_perturb(struct dea_context *ctx, struct dea_solid *solid, const double *push_m,
                             bool (*accept)(const void *self, const double *displacement_m),
                             const void *self, struct dea_solid_report *report, bool *found);
