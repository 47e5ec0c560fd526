#include "study/number_rows.h"

#include "study/material_numbers.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

void dea_number_text(double value, const char *unit, char *out, size_t size)
{
  static const struct {
    const char *unit, *shown;
    double least, factor;
  } scales[] = {{"m", " mm", 0.9995e-3, 1e3},
                {"m", " um", 0, 1e6},
                {"N", " mN", 0, 1e3},
                {"Pa", " MPa", 1e6, 1e-6},
                {"Pa", " kPa", 1e3, 1e-3},
                {"V", " kV", 1e3, 1e-3},
                {"1", "", 0, 1}};
  for (size_t i = 0; i < COUNT(scales); i++) {
    if (strcmp(unit, scales[i].unit) == 0 && fabs(value) >= scales[i].least) {
      snprintf(out, size, "%.5g%s", scales[i].factor * value, scales[i].shown);
      return;
    }
  }
  snprintf(out, size, "%.5g %.20s", value, unit);
}

struct dea_tolerated dea_number_tolerated(const struct dea_design_number *number, double slope,
                                          const char *unit)
{
  struct dea_tolerated out = {"", ""};
  if (number->tolerance > 0) {
    dea_number_text(number->tolerance, number->unit, out.tolerance, sizeof out.tolerance);
    dea_number_text(slope * number->tolerance, unit, out.change, sizeof out.change);
  }
  return out;
}

size_t dea_numbers_order(const double *sizes, size_t count, size_t *order)
{
  size_t placed = 0;
  for (size_t i = 0; i < count; i++) {
    if (sizes[i] > 0) { // not of NAN
      size_t at = placed++;
      for (; at > 0 && sizes[order[at - 1]] < sizes[i]; at--) {
        order[at] = order[at - 1];
      }
      order[at] = i;
    }
  }
  return placed;
}

void dea_number_add(const struct dea_design_number *number, struct dea_design_number *out,
                    size_t *count)
{
  if (*count < DEA_NUMBERS_MAX && (number->value != 0 || number->reach > 0) &&
      !isnan(number->value)) {
    out[(*count)++] = *number;
  }
}

/* What numbers of materials go to. */
struct materials {
  const struct dea_device *device;
  struct dea_design_number *numbers;
  size_t *count;
};

static void store_material(void *user, const struct dea_material_number *of)
{
  const struct materials *to = user;
  const char *material = (const char *)dea_material_of(to->device, of->material);
  const bool ply = of->material >= DEA_OF_PLIES;
  struct dea_design_number number = {
      .unit = of->unit,
      .value = of->value,
      .tolerance = NAN,
      .of = ply ? DEA_NUMBER_OF_PLY : DEA_NUMBER_OF_DEVICE,
      .item = ply ? of->material - DEA_OF_PLIES : 0,
      .offset = of->offset + (ply ? 0 : (size_t)(material - (const char *)to->device)),
      .scale = 1};
  snprintf(number.key, sizeof number.key, "%s", of->key);
  dea_number_add(&number, to->numbers, to->count);
}

void dea_numbers_of_materials(const struct dea_device *device, bool plies,
                              struct dea_design_number *out, size_t *count)
{
  dea_material_numbers(device, plies, store_material, &(struct materials){device, out, count});
}
