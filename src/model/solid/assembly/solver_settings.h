/* How a solid is solved: the tolerances and limits that a caller may change, with the words of
 * PETSc and SUNDIALS. What nobody varies is a constant where it is used (docs/theory/branches.md).
 */
#pragma once

#include "base/context.h"

#include <stdbool.h>

/* X(type, member, former name, default, unit, meaning); all are above 0. "of ...": what a relative
 * number is relative to. dea_solid_settings_set takes a former name too. */
#define DEA_SOLID_SETTINGS(X)                                                                      \
  /* ---- Newton's method: one minimum at fixed controls ---- */                                   \
  X(double, newton_rtol, "residual", 1e-9, "of the sum of element forces",                         \
    "forces left at an equilibrium")                                                               \
  X(double, newton_stol, "step", 1e-10, "of the solid's length", "last step to an equilibrium")    \
  X(double, energy_rtol, "energy", 1e-11, "of the element energies",                               \
    "changes that rounding hides")                                                                 \
  X(double, volume_tol, "theta", 1e-7, "1", "projected J - 1 left at an equilibrium")              \
  X(int, newton_max_iterations, "iterations", 80, "1",                                             \
    "iterations of one minimum, twice that of a slack film")                                       \
  X(int, newton_max_nonmonotone, "iterations_free", 50, "1",                                       \
    "those that may go up in energy; then pressures are fixed")                                    \
  X(int, multiplier_max_iterations, "rounds", 30, "1", "minima with multipliers that follow")      \
  X(int, lag_jacobian, "chords", 8, "1", "steps in a row with one factor")                         \
  X(int, linesearch_max_iterations, "halvings", 12, "1", "of a step in the line search")           \
  X(double, linesearch_alpha, "downhill", 1e-4, "of the slope",                                    \
    "fall of the energy that is asked for (Armijo)")                                               \
  X(double, shift_initial, "shift_first", 3e-3, "of the softest modulus",                          \
    "first shift of an indefinite tangent")                                                        \
  X(int, shift_max_modes, "shift_modes", 8, "1",                                                   \
    "negative pivots whose lowest eigenvalue is computed")                                         \
  X(double, descent_bulk_factor, "bulk_soft", 1.0 / 16, "1",                                       \
    "power of 2, factor of kappa on the way down")                                                 \
  /* ---- load steps, and the descent from an unstable equilibrium ---- */                         \
  X(int, anderson_max_iterations, "follow_steps", 30, "1",                                         \
    "with the factor of the last equilibrium")                                                     \
  X(double, anderson_rtol, "follow_accuracy", 1e-8, "of the first step",                           \
    "last one with that factor")                                                                   \
  X(double, anderson_step_min, "follow_part", 0.02, "of the increment",                            \
    "shortest load step with that factor")                                                         \
  X(double, load_step_min, "load_step_least", 1.0 / 64, "of the increment", "shortest load step")  \
  X(int, descent_max_modes, "descent_modes", 4, "1",                                               \
    "unstable modes that are left one after the other")                                            \
  X(double, descent_perturbation, "descent_push", 0.05, "of the solid's length",                   \
    "first perturbation along a mode")                                                             \
  /* ---- continuation by arc length; modes ---- */                                                \
  X(double, arc_rtol, "path_residual", 1e-8, "of the sum of element forces",                       \
    "forces left: what kappa leaves")                                                              \
  X(int, arc_max_iterations, "path_iterations", 15, "1", "of the corrector")                       \
  X(int, arc_max_points, "approach_points", 40, "1",                                               \
    "of the path in a load step, twice that where it bends")                                       \
  X(double, limit_point_rtol, "critical_limit", 1e-6, "of the arc between two points",             \
    "to a limit point")                                                                            \
  X(double, bifurcation_rtol, "critical_bifurcation", 1e-4, "of the arc between two points",       \
    "to a bifurcation")                                                                            \
  X(double, eps_tol, "mode_residual", 1e-10, "of the mode", "residual of a mode")                  \
  X(int, eps_max_iterations, "mode_iterations", 1000, "1", "of one search for modes")

#define DEA_SOLID_SETTING_MEMBER(type, member, former, value, unit, meaning) type member;
struct dea_solid_settings {
  DEA_SOLID_SETTINGS(DEA_SOLID_SETTING_MEMBER)
  int max_divergent;    // iterates out of balance in a row that end a minimum; 0: none do
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
