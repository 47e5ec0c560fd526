/* A device in one coordinate, reduced from model 3d (docs/theory/reduced-model.md). */
#pragma once

#include "base/arena.h"
#include "base/text.h"
#include "model/model.h"
#include "model/reduced/reduced_core.h"

/* A number of the device by force and voltage: a column of load points, or a motion of a monitor.
 */
struct dea_reduced_output {
  int column; // 0: of a monitor
  size_t monitor;
  enum dea_observed motion;
  struct dea_reduced_spline of; // in the variables of the energy
};

enum { DEA_REDUCED_VOLTAGES_MAX = 65, DEA_REDUCED_FORCES_MAX = 17 };

struct dea_reduced_order {
  struct dea_arena memory;
  struct dea_reduced core; // its arrays live in memory
  struct dea_control coordinate;
  double voltage_V[2], force[2]; // range
  double stroke;                 // change of the coordinate with the voltage, without a force
  double error, charge_error;    // largest of samples that were left out of a fit of the others,
                                 // over stroke and largest charge
  double mode_share;             // smallest part of dq/dF that the modes have; NAN
  // How far the part of dq/dV of each mode in time is off at the worst voltage, and at
  // [mode_count] what all of them lack of 1; the lowest frequency that has of it.
  double share_off[DEA_REDUCED_MODES + 1], left_Hz;
  struct dea_reduced_output *outputs;
  size_t output_count;
  char device[65]; // hash of the design that it is of
  double made_s;   // time that it took
};

/* By model 3d of a device, as settings.reduced says. out: owned by the caller, NULL on failure. */
dea_status dea_reduced_order_build(struct dea_context *ctx, const struct dea_device *device,
                                   const struct dea_model_settings *settings,
                                   struct dea_reduced_order **out);
/* Hash of all values of the design that an equilibrium at any voltage depends on. */
dea_status dea_reduced_hash(struct dea_context *ctx, const struct dea_device *device,
                            const struct dea_model_settings *settings, char out[65]);
/* As a file. read: DEA_E_DESIGN where it is of another device. */
dea_status dea_reduced_order_write(struct dea_context *ctx, const struct dea_reduced_order *order,
                                   const struct dea_device *device, const char *path);
dea_status dea_reduced_order_read(struct dea_context *ctx, const char *path,
                                  const struct dea_device *device,
                                  const struct dea_model_settings *settings,
                                  struct dea_reduced_order **out);

/* Files for other programs: the two files of reduced_core.[ch] and the device's numbers in C99; a
 * functional mock-up unit of FMI 3.0 (co-simulation), with a library where cc is; and about a
 * voltage without a force a linear system (A, B, C, D in JSON), a subcircuit of ngspice at any
 * voltage of the range, a joint with an actuator of MuJoCo. */
enum dea_reduced_format {
  DEA_REDUCED_C,
  DEA_REDUCED_FMU,
  DEA_REDUCED_STATE_SPACE,
  DEA_REDUCED_SPICE,
  DEA_REDUCED_MUJOCO,
  DEA_REDUCED_FORMATS
};
/* damping_ratio: of each mode at the voltage, of the critical one; C and FMU look at neither. */
dea_status dea_reduced_order_export(struct dea_context *ctx, const struct dea_reduced_order *order,
                                    const struct dea_device *device, enum dea_reduced_format format,
                                    double voltage_V, double damping_ratio, const char *path);

/* What is exported. */
struct dea_reduced_export {
  const struct dea_reduced_order *order;
  char name[120];
  struct dea_reduced_point at; // of a linear one, at the voltage
  double damping_ratio;
};
/* The formats as text, in the C locale. */
dea_status dea_reduced_add_c(const struct dea_reduced_export *e, struct dea_text *out);
dea_status dea_reduced_add_state_space(const struct dea_reduced_export *e, struct dea_text *out);
dea_status dea_reduced_add_spice(const struct dea_reduced_export *e, struct dea_text *out);
dea_status dea_reduced_add_mujoco(const struct dea_reduced_export *e, struct dea_text *out);
dea_status dea_reduced_write_fmu(struct dea_context *ctx, const struct dea_reduced_export *e,
                                 const char *path);
/* Whether the coordinate is a rotation (rad, N m) and no displacement (m, N). */
bool dea_reduced_order_turns(const struct dea_reduced_order *order);
void dea_reduced_order_destroy(struct dea_context *ctx, struct dea_reduced_order *order);

/* "hub z", with its unit. */
void dea_reduced_order_name(const struct dea_reduced_order *order, const struct dea_device *device,
                            char *out, size_t size);
/* A message for an end other than DEA_REDUCED_OK. */
dea_status dea_reduced_fail(struct dea_context *ctx, const struct dea_reduced_order *order, int end,
                            double voltage_V);
