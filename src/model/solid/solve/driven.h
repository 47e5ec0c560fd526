/* A solid between electrodes in time: its steps together with those of the supply's circuit
 * (docs/theory/time.md). The voltage of a step is that of the circuit for the capacitance which the
 * film then has. */
#ifndef DEA_MODEL_SOLID_SOLVE_DRIVEN_H
#define DEA_MODEL_SOLID_SOLVE_DRIVEN_H

#include "model/model.h"
#include "model/solid/actuator.h"
#include "model/solid/solve/time.h"

struct dea_driven;

/* From the solid's last equilibrium, at rest there for long and charged to its voltage. actuator:
 * what the solid is of; both lent, and the solid in time until *out is destroyed. With inertia also
 * statuses of dea_actuator_check_mass. */
dea_status dea_driven_create(struct dea_context *ctx, struct dea_solid *solid,
                             const struct dea_actuator *actuator,
                             const struct dea_time_options *time, struct dea_driven **out);
void dea_driven_destroy(struct dea_context *ctx, struct dea_driven *driven);

/* advance and accept of struct dea_model_type. */
dea_status dea_driven_advance(struct dea_context *ctx, struct dea_driven *driven,
                              const struct dea_time_step *step, struct dea_solid_report *report,
                              double *error);
void dea_driven_accept(struct dea_driven *driven);

/* Time, voltages, charge, current, energies and works of the last advance into *point; its
 * stored_energy_J and energy_J count from the start. */
void dea_driven_point(const struct dea_driven *driven, struct dea_load_point *point);

#endif
