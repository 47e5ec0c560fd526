/* Monitors and channels of a layout at an equilibrium of its solid. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/load/loads.h"
#include "model/solid/recovery/recover_error.h"
#include "result/observation.h"

struct dea_observer; // where each monitor is on the mesh, and its last values

/* mesh: lent, outlives the observer. A monitor off its ply is a finding at its place and
 * DEA_E_DESIGN. pressures: [pressure_count], of the solid's loads, NULL where none of it is meshed;
 * contacts: [contact_count] the same; lent. memory: of the observer. */
dea_status dea_observer_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                               struct dea_pressure *const *pressures,
                               struct dea_contact *const *contacts, struct dea_arena *memory,
                               struct dea_observer **out);
/* *out lends from the observer until the next call. */
dea_status dea_observer_read(struct dea_context *ctx, struct dea_observer *observer,
                             struct dea_solid *solid, struct dea_observation *out);

/* Puts the currents of the channels' sources, [channels of the layout], into what was taken. */
void dea_observer_set_currents(struct dea_observer *observer, const double *current_A);

/* How much the monitors' motions change by two small motions v [3 node_count] from where the solid
 * is, out [monitor_count * DEA_OBSERVED_MOTIONS]; NAN as in an observation. */
dea_status dea_observer_differentiate(struct dea_context *ctx, struct dea_observer *observer,
                                      struct dea_solid *solid, const double *const v[2],
                                      double (*out)[2]);

/* How a motion of a monitor changes with each displacement, from where the solid is: weight
 * [dofs]. false: that is not known of this motion (forces). */
bool dea_observer_gradient(struct dea_observer *observer, struct dea_solid *solid, size_t monitor,
                           enum dea_observed motion, double *weight);

/* The monitors that a disc brings, which are columns of load points (device/disc_layout.h): all of
 * them at displacements u; one of them, NAN: the column is none; how it changes with each
 * displacement, weight [dofs], false: the column is none; and their estimated errors at the
 * solid's equilibrium, if the point is one of which they say something. */
void dea_observer_describe(const struct dea_observer *observer, const double *u,
                           struct dea_load_point *out);
double dea_observer_column(const struct dea_observer *observer, int column, const double *u);
bool dea_observer_column_gradient(struct dea_observer *observer, struct dea_solid *solid,
                                  int column, double *weight);
dea_status dea_observer_errors(struct dea_context *ctx, struct dea_observer *observer,
                               struct dea_solid *solid, struct dea_load_point *out);

/* Where a motion of a point or a line is read, 0 to 2 of them; 0 of other monitors. */
size_t dea_observer_probes(const struct dea_observer *observer, struct dea_solid *solid,
                           size_t monitor, enum dea_observed motion,
                           struct dea_recover_probe out[2]);

/* The motion that a force or moment of a body's monitor does work along, direction [3 node_count],
 * 0 before: it is direction . R, with the forces R on what is held. false: not one of these, or not
 * known (a moment on a body that may turn). */
bool dea_observer_force_direction(const struct dea_observer *observer,
                                  const struct dea_solid *solid, size_t monitor,
                                  enum dea_observed motion, double *direction);
