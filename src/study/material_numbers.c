#include "study/material_numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Materials that have a number. */
enum has { ANY, LINEAR, DIELECTRIC };

#define AT(member) offsetof(struct dea_material, member)

/* All but the parameters of laws. */
static const struct row {
  const char *key, *unit;
  size_t offset;
  double low, high;
  bool zero; // it may be 0; else that says that it is not known
  enum has has;
} rows[] = {
    {"young_modulus", "Pa", AT(young_modulus_Pa), 0, INFINITY, false, LINEAR},
    {"poisson_ratio", "1", AT(poisson_ratio), -1, 0.5, true, LINEAR},
    {"permittivity.at_rest", "1", AT(permittivity.at_rest), 1, INFINITY, false, DIELECTRIC},
    {"permittivity.slope", "1", AT(permittivity.slope), -INFINITY, INFINITY, true, DIELECTRIC},
    {"density", "kg/m^3", AT(density_kg_per_m3), 0, INFINITY, false, ANY},
};

struct dea_material *dea_material_at(struct dea_device *device, size_t material)
{
  return material == DEA_OF_FILM         ? &device->film
         : material == DEA_OF_ELECTRODES ? &device->electrode
         : material == DEA_OF_FIBRES     ? &device->fibre
                                         : &device->layout->plies[material - DEA_OF_PLIES].material;
}

const struct dea_material *dea_material_of(const struct dea_device *device, size_t material)
{
  return dea_material_at((struct dea_device *)device, material);
}

void dea_material_prefix(const struct dea_device *device, size_t material,
                         char out[DEA_MATERIAL_PREFIX_SIZE])
{
  static const char *const prefixes[] = {"film", "electrodes", "fibres"};
  if (material < DEA_OF_PLIES) {
    snprintf(out, DEA_MATERIAL_PREFIX_SIZE, "%s", prefixes[material]);
  } else {
    snprintf(out, DEA_MATERIAL_PREFIX_SIZE, "plies.%.80s",
             device->layout->plies[material - DEA_OF_PLIES].name);
  }
}

/* Of a disc's own materials. */
static bool is_there(const struct dea_device *device, size_t material)
{
  return material == DEA_OF_ELECTRODES ? device->electrode_thickness_m > 0
         : material == DEA_OF_FIBRES   ? device->fibre_count > 0
                                       : material == DEA_OF_FILM;
}

static bool is_dielectric(const struct dea_device *device, size_t material)
{
  return material < DEA_OF_PLIES
             ? material == DEA_OF_FILM
             : dea_layout_is_dielectric(device->layout, material - DEA_OF_PLIES);
}

/* Its value and key: of a name "law." + "c1". */
static void fill(const struct dea_device *device, const char *name, const char *param,
                 struct dea_material_number *out)
{
  char prefix[DEA_MATERIAL_PREFIX_SIZE];
  dea_material_prefix(device, out->material, prefix);
  snprintf(out->key, sizeof out->key, "%s.%.20s%.15s", prefix, name, param);
  memcpy(&out->value, (const char *)dea_material_of(device, out->material) + out->offset,
         sizeof out->value);
}

static void add_material(const struct dea_device *device, size_t i,
                         void (*take)(void *user, const struct dea_material_number *number),
                         void *user)
{
  const struct dea_law *law = dea_material_of(device, i)->law;
  for (size_t k = 0; law != NULL && k < law->param_count; k++) {
    const struct dea_law_param *param = &law->params[k];
    struct dea_material_number number = {.unit = param->unit,
                                         .low = param->min,
                                         .high = param->max,
                                         .material = i,
                                         .offset = AT(param) + k * sizeof(double)};
    fill(device, "law.", param->key, &number);
    take(user, &number);
  }
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    const struct row *row = &rows[k];
    struct dea_material_number number = {.unit = row->unit,
                                         .low = row->low,
                                         .high = row->high,
                                         .material = i,
                                         .offset = row->offset};
    fill(device, row->key, "", &number);
    const bool has = row->has == ANY || (row->has == LINEAR && law == NULL) ||
                     (row->has == DIELECTRIC && is_dielectric(device, i));
    if (has && (number.value != 0 || row->zero) && !isnan(number.value)) {
      take(user, &number);
    }
  }
}

void dea_material_numbers(const struct dea_device *device, bool plies,
                          void (*take)(void *user, const struct dea_material_number *number),
                          void *user)
{
  const size_t end = DEA_OF_PLIES + (plies ? device->layout->ply_count : 0);
  for (size_t i = plies ? DEA_OF_PLIES : 0; i < end; i++) {
    if (plies || is_there(device, i)) {
      add_material(device, i, take, user);
    }
  }
}
