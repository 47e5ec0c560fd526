/* A rigid probe against the middle of the device, as study "force" presses it. */
#pragma once

#include "model/model.h"
#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/solid.h"
#include "model/solid/load/loads.h"

struct dea_indent {
  struct dea_arena memory; // of the contact
  struct dea_probe probe;
  struct dea_contact *contact;
  double touch_m[3]; // its place when it touches the flat film
  double depth_m;    // where it is
  double copies;     // of the domain in the actuator
};

/* A probe at a depth, added to the solid's loads; the solid is destroyed before it. other: in its
 * place among the solid's loads until dea_indent_end_variant, which destroys the new one, and with
 * the same points in touch with the same pressures, without a penalty of its own: on a changed
 * actuator and its mesh, whose faces are those of the other, for gradients
 * (docs/theory/gradients.md); NULL: there is none. */
dea_status dea_indent_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                             struct dea_solid *solid, const struct dea_pressed *pressed,
                             const struct dea_indent *other, struct dea_indent **out);
void dea_indent_destroy(struct dea_context *ctx, struct dea_indent *indent);

/* Brings it to a depth in steps, at the voltage given. It stays where it came to when a step fails.
 */
dea_status dea_indent_move(struct dea_context *ctx, struct dea_indent *indent,
                           struct dea_solid *solid, double voltage_V, double depth_m,
                           struct dea_solid_report *report);

/* Force of the whole actuator on the probe, away from the film [N]. u: displacements. */
double dea_indent_force(const struct dea_indent *indent, const double *u);
/* Its slopes as dea_contact_force_slope has them, added. */
void dea_indent_force_slope(const struct dea_indent *indent, const double *u, double *by_u,
                            double *by_pressure);

void dea_indent_end_variant(struct dea_context *ctx, struct dea_solid *solid,
                            const struct dea_indent *other, struct dea_indent *variant);
