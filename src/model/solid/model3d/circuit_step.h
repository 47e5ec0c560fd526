/* A solid between electrodes in time: its steps together with those of the supply's circuit
 * (docs/theory/time.md). The voltage of a step is that of the circuit for the capacitance which the
 * film then has. Where channels have sources of their own all sources are ideal, and their voltages
 * those of the step. */
#pragma once

#include "model/model.h"
#include "model/solid/model3d/sheet.h"
#include "model/solid/motion/time.h"

struct dea_circuit_step;

/* What is driven. All lent. */
struct dea_driven_solid {
  struct dea_solid *solid;
  const struct dea_layout_mesh *mesh;  // for electrodes with a sheet resistance; NULL: without
  const struct dea_branches *branches; // [part_material_count]
  const double *leakage_per_s;         // [part_material_count] conductance over capacitance
  /* Channels have currents, which are found. Otherwise there is one, on which the supply is. */
  bool channels;
  double copies;      // of the grid in the device
  double thickness_m; // of a film: errors are not relative to motions far below
};

/* 1/(resistivity permittivity) of a film of a material; 0: it does not leak. */
double dea_leakage_per_s(const struct dea_material *material,
                         const struct dea_part_material *part_material);

/* From the solid's last equilibrium, at rest there for long and charged to its voltage. driven:
 * lent, and its solid in time, until *out is destroyed; of time->own_sources as well.
 * DEA_E_UNSUPPORTED for channels with a voltage or a source of their own in a circuit that is not
 * ideal. */
dea_status dea_circuit_step_create(struct dea_context *ctx, const struct dea_driven_solid *driven,
                                   const struct dea_time_options *time,
                                   struct dea_circuit_step **out);
void dea_circuit_step_destroy(struct dea_context *ctx, struct dea_circuit_step *driven);

/* advance and accept of struct dea_model_type. */
dea_status dea_circuit_step_advance(struct dea_context *ctx, struct dea_circuit_step *driven,
                                    const struct dea_time_step *step,
                                    struct dea_solid_report *report, double *error);
void dea_circuit_step_accept(struct dea_circuit_step *driven);

/* Time, voltages, charge, current, energies and works of the last advance into *point; its
 * stored_energy_J and energy_J count from the start. */
void dea_circuit_step_point(const struct dea_circuit_step *driven, struct dea_load_point *point);

/* Sum of charges times voltages after the last advance, or at the start [J]. */
double dea_circuit_step_charged_J(const struct dea_circuit_step *driven);
/* Mean current from the source of each channel into the film in the last step, [channel_count + 1]
 * with ground, 0 of a jump; lent. NULL: currents of channels are not found. */
const double *dea_circuit_step_currents_A(const struct dea_circuit_step *driven);
