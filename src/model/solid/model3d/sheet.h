/* Electrodes with a sheet resistance in time (docs/theory/time.md, "Electrodes with a resistance"):
 * their potential, which each step finds with the capacitances of the film, and with it the voltage
 * across each element. */
#pragma once

#include "model/solid/actuator/layout_mesh.h"
#include "model/solid/assembly/solid.h"

struct dea_sheet;

/* At the voltages that the solid's channels have. *out: NULL where all electrodes are ideal or
 * there is no mesh. per_s: [part materials] conductance of the films over their capacitance. All
 * lent. DEA_E_UNSUPPORTED for a coupled field. */
dea_status dea_sheet_create(struct dea_context *ctx, const struct dea_layout_mesh *mesh,
                            struct dea_solid *solid, const double *per_s, struct dea_sheet **out);
void dea_sheet_destroy(struct dea_context *ctx, struct dea_sheet *sheet);

/* Potentials at the end of a step from the accepted state, with the film as it is now, into the
 * goals of the solid's next solve. Length 0: the leads jump. voltage_V, own_V [channels]: of the
 * solid then. first: of this step. *change_V: largest difference to what the film has. */
dea_status dea_sheet_solve(struct dea_context *ctx, struct dea_sheet *sheet, bool first,
                           double length_s, double voltage_V, const double *own_V,
                           double *change_V);
void dea_sheet_accept(struct dea_sheet *sheet);

/* Of the last solve. Error: of charge, over the largest charge so far; lowest: voltage between
 * electrodes where it is lowest of places with a sheet resistance. */
double dea_sheet_error(const struct dea_sheet *sheet);
double dea_sheet_lowest_V(const struct dea_sheet *sheet);
