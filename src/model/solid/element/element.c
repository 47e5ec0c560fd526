#include "model/solid/element/element.h"

#define DECLARE_ELEMENT(KIND, name) extern const struct dea_element_type dea_element_##name;
DEA_ELEMENT_LIST(DECLARE_ELEMENT)
#undef DECLARE_ELEMENT

const struct dea_element_type *const dea_element_types[DEA_ELEMENT_COUNT] = {
#define ELEMENT_ADDRESS(KIND, name) &dea_element_##name,
    DEA_ELEMENT_LIST(ELEMENT_ADDRESS)
#undef ELEMENT_ADDRESS
};

dea_status dea_element_set_create(struct dea_context *ctx, int order, int order_z,
                                  struct dea_arena *memory, struct dea_element_set *out)
{
  *out = (struct dea_element_set){0};
  for (size_t kind = 0; kind < DEA_ELEMENT_COUNT; kind++) {
    struct dea_element *e = &out->of[kind];
    e->type = dea_element_types[kind];
    e->basis = dea_arena_alloc(memory, 1, e->type->basis_size);
    DEA_TRY(ctx, dea_arena_status(memory));
    dea_status status = e->type->create(order, order_z, e);
    if (status != DEA_OK) {
      return dea_fail(ctx, status, "elements have the orders 1 to %d, not %d and %d",
                      (int)DEA_HEX_ORDER_MAX, order, order_z);
    }
    size_t predicted = e->type->predict != NULL ? (size_t)(e->pressures + 6 * e->points) : 0;
    out->pressures = e->pressures > out->pressures ? e->pressures : out->pressures;
    out->predicted_count = predicted > out->predicted_count ? predicted : out->predicted_count;
  }
  return DEA_OK;
}

dea_status dea_element_mass(const struct dea_element *e,
                            const struct dea_part_material *part_material, const double *X,
                            double *mass)
{
  double kilograms[DEA_HEX_GAUSS_MAX];
  DEA_TRY_STATUS(e->type->masses(e, part_material, X, kilograms));
  memset(mass, 0, (size_t)(e->nodes * e->nodes) * sizeof *mass);
  for (int q = 0; q < e->points; q++) {
    const double *value = e->value + q * e->value_width;
    for (int a = 0; a < e->nodes; a++) {
      const double weight = kilograms[q] * value[a];
      for (int b = 0; b < e->nodes; b++) {
        mass[a * e->nodes + b] += weight * value[b];
      }
    }
  }
  return DEA_OK;
}

dea_status dea_element_mass_times(const struct dea_element *e,
                                  const struct dea_part_material *part_material, const double *X,
                                  const double *v, double *out)
{
  double kilograms[DEA_HEX_GAUSS_MAX], here[3];
  DEA_TRY_STATUS(e->type->masses(e, part_material, X, kilograms));
  memset(out, 0, (size_t)(3 * e->nodes) * sizeof *out);
  for (int q = 0; q < e->points; q++) {
    const double *value = e->value + q * e->value_width;
    dea_element_at(e->nodes, value, v, here);
    for (int i = 0; i < 3 * e->nodes; i++) {
      out[i] += kilograms[q] * value[i / 3] * here[i % 3];
    }
  }
  return DEA_OK;
}
