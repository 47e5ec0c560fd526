/* Steps in time of a solid: viscous, with or without inertia (docs/theory/time.md).
 *
 * A step is the minimum of a potential, found by the descent of every solve:
 *
 *   Pi + 1/2 B : C per volume + c/2 (u - u*) . M (u - u*) + d . u
 *
 * without inertia the first two terms; with it generalised-alpha, Pi with its pressures at the end
 * of the step. A step is tried, closed, looked at, and then taken or dropped. */
#pragma once

#include "model/solid/assembly/internal_variables.h"

struct dea_solid_time;

struct dea_solid_time_options {
  const struct dea_branches *branches; // [part materials of the solid], copied; NULL: elastic
  bool inertia;                        // by the part materials' densities
  /* Of the steps with inertia for what they cannot resolve, 0 to 1: 1 damps nothing, 0 takes it
   * away in one step. */
  double spectral_radius;
  /* Channels or elements have voltages of their own, which `dea_solid_time_drive` and the drops of
   * the solid say; otherwise none may. Not for a coupled field. */
  bool own_voltages;
};

/* Of the grid, not of its copies [J]; sums are from the creation on. */
struct dea_solid_energies {
  double supply;     // work of the source, the integral of V dQ
  double motion;     // work of what moves supports and bodies
  double stored;     // elastic, electric and that of loads, less what it was at first
  double branches;   // stored in them
  double kinetic;    // with the velocity
  double dissipated; // in the branches
  double damped;     // by the steps themselves: what the forces' work did not bring to motion
};

/* Starts at the solid's last equilibrium, at rest and held so for long. solid: lent, and in time
 * until *out is destroyed: solves of it are then steps. DEA_E_ARGUMENT for a radius out of range.
 */
dea_status dea_solid_time_create(struct dea_context *ctx, struct dea_solid *solid,
                                 const struct dea_solid_time_options *options,
                                 struct dea_solid_time **out);
void dea_solid_time_destroy(struct dea_context *ctx, struct dea_solid_time *time);

/* Velocities [node_count][3], lent; they may be written before the start. */
double *dea_solid_velocity(struct dea_solid_time *time);

/* Voltages of the channels beside their shares, [channel_count + 1], at the end of the steps and
 * jumps that follow; at first those of the start, to which solves go again afterwards. */
void dea_solid_time_drive(struct dea_solid_time *time, const double *own_V);

/* Tries a step to a voltage. A step that fails leaves the accepted state. */
dea_status dea_solid_time_step(struct dea_context *ctx, struct dea_solid_time *time,
                               double voltage_V, double step_s, struct dea_solid_report *report);
/* The step that was tried once more, to another voltage, from where it is. */
dea_status dea_solid_time_again(struct dea_context *ctx, struct dea_solid_time *time,
                                double voltage_V, struct dea_solid_report *report);
/* Tries a change of the voltage, or from rest to velocities that were written, in no time. Without
 * inertia the film answers as fast as its branches let it, with it by its acceleration. */
dea_status dea_solid_time_jump(struct dea_context *ctx, struct dea_solid_time *time,
                               double voltage_V, struct dea_solid_report *report);
/* Finds all that goes with the step or jump that was tried. *error_m: estimate of what the step's
 * size costs, the largest displacement's; NULL: not wanted. */
dea_status dea_solid_time_close(struct dea_context *ctx, struct dea_solid_time *time,
                                double *error_m);
/* Takes the step or jump that was tried and closed; or goes back to the accepted state. */
void dea_solid_time_accept(struct dea_solid_time *time);
void dea_solid_time_reject(struct dea_solid_time *time);

/* Of the step that was closed last, or at the accepted state. */
struct dea_solid_energies dea_solid_time_energies(const struct dea_solid_time *time, bool tried);

/* With own voltages: sum of charges times voltages, of the step that was closed last, or at the
 * accepted state. */
double dea_solid_time_charged_J(const struct dea_solid_time *time, bool tried);

/* Largest component of a displacement from where the solid was at the start [m]. */
double dea_solid_time_motion(const struct dea_solid_time *time);
