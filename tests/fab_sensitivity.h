/* What tolerances do to a disc, against designs that are changed by hand. */
#pragma once

#include "fabricate/tolerance_effect.h"
#include "model/model.h"
#include "workshop_fixture.h"

static struct dea_tolerance_effects found;

static inline void find_effects(void)
{
  assert_int_equal(dea_tolerance_effects_find(ctx, design, device, true, &found), DEA_OK);
}

/* On the first displacement; NAN where there is no such number. */
static inline double effect_of(const char *key)
{
  const double *effect = dea_tolerance_effect(&found, key);
  return effect != NULL ? effect[0] : NAN;
}

/* The displacement by a model of the text of a design with one value changed; on the mesh of
 * another device, moved, if there is one. */
static inline double displacement(const struct dea_override sets[2],
                                  const struct dea_device *mesh_of)
{
  const struct dea_model_type *type = dea_model_find(found.model);
  struct dea_design *changed_design;
  struct dea_device *changed;
  struct dea_model *model, *of_mesh = NULL;
  struct dea_load_point point;
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, sets, 2, &changed_design, &changed), DEA_OK);
  struct dea_model_settings settings = dea_model_settings_of(changed_design);
  if (mesh_of != NULL) {
    assert_int_equal(type->create(ctx, mesh_of, &settings, &of_mesh), DEA_OK);
    settings.mesh_from = of_mesh;
  }
  assert_int_equal(type->create(ctx, changed, &settings, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, found.voltage_V, &point), DEA_OK);
  type->destroy(ctx, model);
  type->destroy(ctx, of_mesh);
  dea_device_destroy(ctx, changed);
  dea_design_destroy(ctx, changed_design);
  return device->fibre_count > 0 ? point.fibre_tip_z_m : point.electrode_edge_u_m;
}

/* Effects against designs that are changed by hand, by all of the tolerance to either side. */
static inline void check_sensitivity(struct dea_override as_made, double tolerance)
{
  static const struct {
    const char *which, *key, *low, *high;
  } rows[] = {
      {"film.thickness", "film.thickness", "95 um", "105 um"},
      {"pre_stretch", "pre_stretch", "1.48", "1.52"},
      {"electrodes.", "electrodes.diameter", "4.9 mm unstretched", "5.1 mm unstretched"},
      {"frame.", "frame.inner_diameter", "29.9 mm", "30.1 mm"},
      {"fibres.", "fibres.overlap", "0.2 mm stretched", "-0.2 mm stretched"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    const bool tips = strcmp(rows[i].which, "fibres.") == 0;
    if (tips && device->fibre_count == 0) {
      assert_true(isnan(effect_of(rows[i].which)));
      continue;
    }
    const struct dea_override low[2] = {as_made, {rows[i].key, rows[i].low}};
    const struct dea_override high[2] = {as_made, {rows[i].key, rows[i].high}};
    const struct dea_device *mesh_of = tips ? NULL : device; // tips that cross an edge: anew
    const double difference = 0.5 * (displacement(high, mesh_of) - displacement(low, mesh_of));
    assert_close(effect_of(rows[i].which), difference, tolerance, 0);
  }
}
