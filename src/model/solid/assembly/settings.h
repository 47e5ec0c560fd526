/* How a solid is solved: tolerances and limits of Newton's method, of load steps, of paths and of
 * modes. What they do stands in docs/theory/branches.md and where they are used. */
#pragma once

#include "base/context.h"

#include <stdbool.h>

/* X(type, member, default, unit, meaning); all are above 0. "of ...": what a relative number is
 * relative to. */
#define DEA_SOLID_SETTINGS(X)                                                                      \
  /* ---- Newton's method: one minimum at fixed controls ---- */                                   \
  X(double, residual, 1e-9, "of the sum of element forces", "forces left at an equilibrium")       \
  X(double, step, 1e-10, "of the solid's length", "last step to an equilibrium")                   \
  X(double, energy, 1e-11, "of the element energies", "changes that rounding hides")               \
  X(double, theta, 1e-7, "1", "projected J - 1 left at an equilibrium")                            \
  X(int, iterations, 80, "1", "iterations of one minimum")                                         \
  X(int, iterations_free, 50, "1", "those that may go up in energy; then pressures are fixed")     \
  X(int, lost, 80, "1", "of them in a row out of balance, which end it")                           \
  X(double, lost_residual, 0.3, "of the sum of element forces", "forces left there, at least")     \
  X(int, stuck, 3, "1", "shifted steps in a row below `step`, which end it")                       \
  X(int, rounds, 30, "1", "minima with multipliers that follow")                                   \
  X(int, rounds_worse, 4, "1", "of them in a row that violate the constraints more")               \
  X(int, chords, 8, "1", "steps in a row with one factor")                                         \
  X(double, chord_rate, 0.2, "of the residual before", "at which an old factor is good enough")    \
  X(int, follow_steps, 30, "1", "with the factor of the last equilibrium, at first")               \
  X(double, follow_rate, 0.6, "of the first step", "later ones, at most")                          \
  X(double, follow_aim, 0.5, "of the first step", "second one that the next part aims at")         \
  X(double, follow_accuracy, 1e-8, "of the first step", "last step")                               \
  X(double, follow_on_the_way, 1e-3, "of the first step",                                          \
    "last step to no point that is asked for")                                                     \
  X(double, follow_bend, 0.1, "of the first step", "what the step before adds to it, at most")     \
  X(double, follow_bend_way, 3, "of the step before", "longest step that this adds to")            \
  X(double, follow_part, 0.02, "of the way asked for", "shortest way with it")                     \
  X(int, halvings, 12, "1", "of a step in the line search")                                        \
  X(double, uphill, 20, "of the slope", "rise of the energy along a step that is let pass")        \
  X(double, downhill, 1e-4, "of the slope", "fall of the energy that is asked for (Armijo)")       \
  X(int, shifts, 40, "1", "attempts to make the tangent positive definite")                        \
  X(double, shift_first, 3e-3, "of the softest modulus", "first shift of the tangent")             \
  X(double, shift_least, 3e-5, "of the softest modulus", "shift below which there is none")        \
  X(double, shift_up, 4, "1", "factor to a larger shift")                                          \
  X(double, shift_down, 10, "1", "divisor to a smaller one")                                       \
  X(int, shift_modes, 8, "1", "negative pivots whose lowest eigenvalue is looked for")             \
  X(double, shift_margin, 2, "of the lowest eigenvalue", "next shift")                             \
  X(double, bulk_soft, 1.0 / 16, "1", "power of 2, factor of kappa on the way down")               \
  X(double, soft_end, 1e-3, "of theta, and of the sum of element forces",                          \
    "what is left where it ends")                                                                  \
  X(double, bulk_stiff, 128, "1", "power of 2, factor of kappa where unstable modes are counted")  \
  /* ---- load steps, and the descent from an unstable equilibrium ---- */                         \
  X(double, load_step_least, 1.0 / 64, "of the way asked for", "shortest step")                    \
  X(double, approach_part, 0.5, "of the way asked for",                                            \
    "shortest step before the path is followed")                                                   \
  X(double, approach_part_least, 0.25, "of the way asked for",                                     \
    "shortest step where it says nothing")                                                         \
  X(int, approach_rounds, 12, "1", "times that load steps go on from a point of the path")         \
  X(int, coupled_iterations, 15, "1",                                                              \
    "of one minimum of a taut film with a coupled field, before the path is followed")             \
  X(int, approach_lost, 12, "1", "`lost` on the way to a voltage")                                 \
  X(int, approach_points, 40, "1", "points of the path on the way, twice that where it bends")     \
  X(double, approach_unit, 0.1, "of the displacement on the way", "counts as much as all of it")   \
  X(double, approach_step, 0.5, "of the way or of that displacement", "first step on it")          \
  X(double, approach_step_most, 4, "of the way or of that displacement", "longest step")           \
  X(double, left_branch, 1, "of what the tangent foresees",                                        \
    "off it, at most, up to a limit point")                                                        \
  X(double, branch_jump_way, 1e-3, "of the way", "to which load steps close in on where they end") \
  X(int, descent_modes, 4, "1", "unstable modes that are left one after the other")                \
  X(double, descent_push, 0.05, "of the solid's length", "first push along a mode")                \
  X(double, descent_equal, 1e-6, "of the fall", "energies of two sides that count as equal")       \
  /* ---- paths: steps ---- */                                                                     \
  X(int, path_attempts, 16, "1", "at one step, each half as long")                                 \
  X(int, path_iterations_many, 8, "1", "iterations above which the next step is shorter")          \
  X(double, path_off_most, 0.3, "of the step", "distance of a point from its prediction")          \
  X(double, path_off_good, 0.08, "of the step", "distance that steps aim at")                      \
  X(double, path_bend_least, 0.02, "of a unit tangent", "bend below which a path is an arc")       \
  X(double, path_step_least, 1e-6, "of the first step", "shortest step")                           \
  /* ---- paths: the corrector ---- */                                                             \
  X(double, path_residual, 1e-8, "of the sum of element forces", "forces left: what kappa leaves") \
  X(double, path_step, 1e-10, "of the solid's length", "last step of the corrector")               \
  X(double, path_rough, 1e-4, "of the step", "last step of the corrector on the way to an event")  \
  X(double, path_plane, 1e-9, "of the step", "distance to the plane that is left")                 \
  X(double, path_theta, 1e-2, "of theta", "theta where kappa theta is no pressure any more")       \
  X(double, path_bulk, 16, "1", "power of 2, factor of kappa on the way")                          \
  X(double, path_difference, 1e-5, "1", "of tau, for the force by tau")                            \
  X(int, path_iterations, 15, "1", "of the corrector")                                             \
  X(double, path_fall, 0.3, "of the residual before",                                              \
    "where it falls less, stresses are not predicted")                                             \
  X(int, path_hidden, 3, "1", "steps in a row that rounding hides")                                \
  /* ---- paths: limit points and bifurcations ---- */                                             \
  X(int, critical_rounds, 20, "1", "of regula falsi")                                              \
  X(double, critical_limit, 1e-6, "of the way between two points", "to a limit point")             \
  X(double, critical_bifurcation, 1e-4, "of the way between two points", "to a bifurcation")       \
  X(double, critical_flat, 1e-8, "of what it was", "what is left of what is 0 there")              \
  X(double, critical_aside, 0.03, "of the bracket", "how far beside a singular point, at first")   \
  X(int, critical_aside_most, 4, "1", "attempts beside it, each twice as far")                     \
  X(int, branch_attempts, 6, "1", "at another branch, each half as far")                           \
  /* ---- modes ---- */                                                                            \
  X(double, mode_residual, 1e-10, "of the mode", "residual of a mode")                             \
  X(double, mode_apart, 1e-6, "of their values", "distance of two modes that a count can tell")    \
  X(int, mode_rounds, 6, "1", "searches at one end of the spectrum")                               \
  X(int, mode_extra, 4, "1", "modes that more are asked for, at most")                             \
  X(double, mode_room, 0.5, "of the modes", "those that more are asked for at first")              \
  X(int, mode_iterations, 1000, "1", "of one search")

#define DEA_SOLID_SETTING_MEMBER(type, member, value, unit, meaning) type member;
struct dea_solid_settings {
  DEA_SOLID_SETTINGS(DEA_SOLID_SETTING_MEMBER)
  bool accept_unstable; // solves stay at unstable equilibria; false, at first: they descend
};
#undef DEA_SOLID_SETTING_MEMBER

struct dea_solid_settings dea_solid_settings_default(void);

/* A setting as it is: the one of that number in the list, or NULL beyond; *value: its value. */
struct dea_solid_setting {
  const char *name, *unit, *meaning;
};
const struct dea_solid_setting *dea_solid_settings_at(const struct dea_solid_settings *settings,
                                                      size_t number, double *value);
/* Sets one by its name. DEA_E_ARGUMENT for an unknown name, and as dea_solid_settings_check. */
dea_status dea_solid_settings_set(struct dea_context *ctx, struct dea_solid_settings *settings,
                                  const char *name, double value);

/* DEA_E_ARGUMENT for a number that is not above 0, or no power of 2 where it has to be one. */
dea_status dea_solid_settings_check(struct dea_context *ctx,
                                    const struct dea_solid_settings *settings);
