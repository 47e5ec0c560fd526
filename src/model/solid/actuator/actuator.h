/* A device as a solid: its mesh and what each part of it is made of (docs/theory/mesh.md). */
#ifndef DEA_MODEL_SOLID_ACTUATOR_ACTUATOR_H
#define DEA_MODEL_SOLID_ACTUATOR_ACTUATOR_H

#include "model/model.h"
#include "model/solid/mesh/fibre_disc.h"

enum {
  DEA_CONSTITUENT_FILM,
  DEA_CONSTITUENT_ELECTRODE,
  DEA_CONSTITUENT_GLUE,
  DEA_CONSTITUENT_FIBRE,
  DEA_CONSTITUENT_BOND,           // of a membrane, the next one too: under fibres, free of stress
  DEA_CONSTITUENT_BOND_ELECTRODE, // where fibres lie on electrodes of a thickness
  DEA_CONSTITUENT_COUNT
};

struct dea_actuator {
  const struct dea_device *device; // lent
  struct dea_model_settings settings;
  struct dea_fibre_disc plate;
  struct dea_constituent constituents[DEA_CONSTITUENT_COUNT];
};

/* The plate of a device, on the domain and with the mesh that the settings name. DEA_E_UNSUPPORTED
 * for a domain that cannot show what the device does. */
dea_status dea_fibre_disc_of_device(struct dea_context *ctx, const struct dea_device *device,
                                    const struct dea_model_settings *settings,
                                    struct dea_fibre_disc *out);

/* Plate and constituents. device: lent, outlives the actuator. settings: copied. */
dea_status dea_actuator_create(struct dea_context *ctx, const struct dea_device *device,
                               const struct dea_model_settings *settings, struct dea_actuator *out);

/* Electrodes that were laid on the film when it had a share of its pre-stretch: at 0 they have no
 * stress where it lies flat, at 1 they are those of the device. Fails where their law ends. */
dea_status dea_actuator_lay_electrodes(struct dea_actuator *actuator, double share);

/* Before anything that takes the constituents' densities: DEA_E_DESIGN where that of film or fibres
 * is unknown, a note where that of electrodes or glue is and the film's is taken. */
dea_status dea_actuator_check_mass(struct dea_context *ctx, const struct dea_actuator *actuator);

/* Callbacks for a solid (solve/solid.h); self: a struct dea_actuator. */
int dea_actuator_constituent(const void *self, int region, int ply);
bool dea_actuator_active(const void *self, int region, int ply);
int dea_actuator_held(const void *self, const double X[3]);
/* Of a coupled field: the two faces of the film, the one with the fibres at the voltage. */
bool dea_actuator_electrode(const void *self, const double X[3], double *share);
bool dea_actuator_frame(const void *self, const double X[3], double Q[9]);

/* How often the domain lies in the whole actuator. */
double dea_actuator_copies(const struct dea_actuator *actuator);

#endif
