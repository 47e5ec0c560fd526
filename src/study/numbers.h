/* Numbers of a design that can change little by little, by their names: one table for slopes,
 * searches, sweeps, fits and uncertainties; and the device with another value of one of them. */
#pragma once

#include "base/arena.h"
#include "device/device.h"
#include "model/model.h"

enum { DEA_NUMBERS_MAX = 2048 }; // 100 plies, the most of a design, have some 1,200

/* Materials of a device: those of a disc, then those of the plies of its layout. */
enum { DEA_OF_FILM, DEA_OF_ELECTRODES, DEA_OF_FIBRES, DEA_OF_PLIES };

/* Rooms of keys, for names of parts up to 80 letters. */
enum { DEA_NUMBER_KEY_SIZE = 128, DEA_MATERIAL_PREFIX_SIZE = 88 };

/* Where a number is kept. */
enum dea_number_of {
  DEA_NUMBER_OF_SUPPLY,   // nowhere: "voltage"
  DEA_NUMBER_OF_DESIGN,   // in a struct dea_design
  DEA_NUMBER_OF_PART,     // in an item of a list of struct dea_parts
  DEA_NUMBER_OF_MATERIAL, // in a struct dea_material of the device
  DEA_NUMBER_OF_TIP,      // in a struct dea_pressed
};

/* One number: "voltage"; a key of the design file with a value ("film.thickness", of a design with
 * plies "plies.film.thickness", of what has no name "springs[0].stiffness"); or one of a material
 * ("film.law.PARAMETER", "electrodes.young_modulus", "plies.NAME.permittivity.at_rest",
 * "film.branch.1.modulus"). */
struct dea_design_number {
  char key[DEA_NUMBER_KEY_SIZE];
  double value;     // SI, as the file has it: a diameter is a diameter
  const char *unit; // SI; static storage
  double low, high; // what a number of a material can be; infinite: anything
  double tolerance; // of the workshop, SI; NAN: none
  enum dea_number_of of;
  size_t list, item; // of a part: list and place in it; of a material: which one
  size_t offset;     // there
  double scale;      // what is kept over the value
  double reach;      // what small changes are shares of; 0: the value, which then is not 0
};

/* All numbers of a design that its device depends on, but those that are 0; of a design with plies
 * with places of shapes that the file says to be 0. What is held and moved is not among them. all:
 * also those that are 0, and branches of viscosity. out: [DEA_NUMBERS_MAX]; a warning says where
 * there are more. */
dea_status dea_design_numbers(struct dea_context *ctx, const struct dea_design *design,
                              const struct dea_device *device, double voltage_V, bool all,
                              struct dea_design_number *out, size_t *count);
/* Takes those away that nothing but vibrations depends on: densities, where there is no weight. */
void dea_numbers_at_rest(const struct dea_device *device, struct dea_design_number *numbers,
                         size_t *count);
/* Those of the tip that a model is pressed by, but those that are 0: "compute.force.depth", which
 * is here where it stands, and its radii; added to out [DEA_NUMBERS_MAX]. */
void dea_tip_numbers(const struct dea_pressed *pressed, struct dea_design_number *out,
                     size_t *count);

/* A material of a device by its number; lent. */
struct dea_material *dea_material_at(struct dea_device *device, size_t material);
const struct dea_material *dea_material_of(const struct dea_device *device, size_t material);
/* What keys of the design are about it begin with: "film", "plies.NAME". */
void dea_material_prefix(const struct dea_device *device, size_t material,
                         char out[DEA_MATERIAL_PREFIX_SIZE]);

/* A device with another value of one of the numbers. */
struct dea_changed_device {
  struct dea_device device;
  struct dea_arena memory;
};
/* DEA_E_DESIGN: there is no such device, or a finding says what of it does not fit together. Also
 * after a failure to be freed; outlived by design and device. */
dea_status dea_device_change(struct dea_context *ctx, const struct dea_design *design,
                             const struct dea_device *device,
                             const struct dea_design_number *number, double value,
                             struct dea_changed_device *out);
void dea_changed_device_free(struct dea_changed_device *changed);
