/* Numbers of a device's materials that can change little by little, by their names: one table for
 * what matters (study sensitivity), for searches, sweeps, fits and uncertainties. */
#pragma once

#include "device/device.h"

/* Materials of a device: those of a disc, then those of the plies of its layout. */
enum { DEA_OF_FILM, DEA_OF_ELECTRODES, DEA_OF_FIBRES, DEA_OF_PLIES };

/* Rooms of keys, for names of parts up to 80 letters. */
enum { DEA_NUMBER_KEY_SIZE = 128, DEA_MATERIAL_PREFIX_SIZE = 88 };

/* "film.law.PARAMETER", "electrodes.young_modulus", "fibres.density",
 * "plies.NAME.permittivity.at_rest". */
struct dea_material_number {
  char key[DEA_NUMBER_KEY_SIZE];
  const char *unit; // SI; static storage
  double value;     // SI
  double low, high; // what it can be; infinite: anything
  size_t material;  // number of it; DEA_OF_PLIES + i of ply i
  size_t offset;    // in struct dea_material
};

/* Calls take with each of them that the device has and whose value is known, 0 among them: of its
 * plies, or of a disc by its short keys. */
void dea_material_numbers(const struct dea_device *device, bool plies,
                          void (*take)(void *user, const struct dea_material_number *number),
                          void *user);
/* A material of a device by its number; lent. */
struct dea_material *dea_material_at(struct dea_device *device, size_t material);
const struct dea_material *dea_material_of(const struct dea_device *device, size_t material);
/* What keys of the design are about it begin with: "film", "plies.NAME". */
void dea_material_prefix(const struct dea_device *device, size_t material,
                         char out[DEA_MATERIAL_PREFIX_SIZE]);
