/* Equilibrium paths of small models (up to DEA_PATH_UNKNOWNS_MAX unknowns) under a voltage.
 *
 * A system is an energy Pi(u, V); its equilibria g = dPi/du = 0 form curves in (u, V). They are
 * followed by pseudo arc-length (Keller): from a point with unit tangent t the next one solves
 *
 *     g(u, V) = 0,   t_u . (u - u0)/n + t_V (V - V0)/V_s^2 = ds
 *
 * so that limit points (pull-in, snap-back) are points like any other. The inertia of K = d2Pi/du2
 * says how many unstable modes there are at fixed voltage. Theory: docs/theory/path.md. */
#pragma once

#include "model/model.h"

enum { DEA_PATH_UNKNOWNS_MAX = 96 };

struct dea_path_system {
  size_t unknowns; // n; u is scaled so that 1 is a large change of any of them
  void *self;
  /* g [n], K [n x n] symmetric and full, gV = dg/dV [n], all in units that make K of order one.
   * DEA_E_DOMAIN where the energy is not defined. */
  dea_status (*evaluate)(void *self, const double *u, double voltage_V, double *g, double *K,
                         double *gV);
  /* What the model says of this equilibrium; stability is filled in by the path. */
  dea_status (*point)(void *self, const double *u, double voltage_V, struct dea_load_point *out);
  double voltage_scale_V; // V_s
  /* A number of the system that keeps it from being at rest at the start it is given (stiffness of
   * electrodes); with 0 the start is its rest. NULL: none. */
  double *ramped;
  double pre_stretch; // total stretch over electrode_stretch
  double end_stretch; // electrode_stretch at which a search for a snapped state gives up
  const char *model;  // that it is of
};

struct dea_path_state {
  double u[DEA_PATH_UNKNOWNS_MAX];
  double voltage_V;
  double tangent_u[DEA_PATH_UNKNOWNS_MAX], tangent_V; // unit; tangent_V in volts per arc length
  int negative;                                       // unstable modes at fixed voltage
};

struct dea_path; // workspace for one system

/* system: lent. start: unknowns of the equilibrium at 0 V, or near it; it is solved for, where that
 * fails as what is ramped grows from 0. */
dea_status dea_path_create(struct dea_context *ctx, const struct dea_path_system *system,
                           const double *start, struct dea_path **out);
void dea_path_destroy(struct dea_context *ctx, struct dea_path *path);

/* Current state; lent. */
const struct dea_path_state *dea_path_state_get(const struct dea_path *path);

/* The stable equilibrium at `voltage_V` that follows the current state along the path: the same
 * branch, or after a limit point the next stable branch at that voltage (a snap). The path is left
 * at it. Where none comes before total electrode stretch `max_stretch` the state stays as it was:
 * DEA_E_NO_EQUILIBRIUM beyond a limit point (dea_path_limit), DEA_E_SLACK where the path reaches
 * the voltage at a state that compression has made unstable, DEA_E_DOMAIN where it ends with the
 * law or there, DEA_E_NOT_CONVERGED. */
dea_status dea_path_seek(struct dea_context *ctx, struct dea_path *path, double voltage_V,
                         double max_stretch);

/* Load point of the current state. */
dea_status dea_path_point(struct dea_context *ctx, struct dea_path *path,
                          struct dea_load_point *out);

// As functions of a model's type: the first member of such a model is its path ------------------

/* Ends the path and the model, which has no other memory. */
void dea_path_model_destroy(struct dea_context *ctx, struct dea_model *model);

/* dea_path_seek, and what it says of the state. Where that is beyond a limit point on the way there
 * is a warning, and the flag DEA_FLAG_STATES until the path has snapped back. */
dea_status dea_path_solve(struct dea_context *ctx, struct dea_model *model, double voltage_V,
                          struct dea_load_point *out);

/* The limit point that the last seek, which found a state, has gone past; lent until the next.
 * NULL: none. */
const struct dea_event *dea_path_passed(const struct dea_model *model);

/* Where the last seek that found nothing came to its end: the first limit point, where a taut film
 * thins in one place before it, or the loss of tension; lent until the next. NULL: none. */
const struct dea_event *dea_path_limit(const struct dea_model *model);

/* The whole path from rest. */
dea_status dea_path_trace(struct dea_context *ctx, struct dea_model *model,
                          const struct dea_path_options *options, dea_point_sink points,
                          dea_event_sink events, void *user);
