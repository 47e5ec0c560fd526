/* What tolerances do to a disc, against designs that are changed by hand. */
#pragma once

#include "fabricate/tolerance_effect.h"
#include "model/model.h"
#include "workshop_fixture.h"

/* The displacement by a model of the text of a design with one value changed; on the mesh of
 * another device, moved, if there is one. */
static inline double displacement(const struct dea_sensitivity *of,
                                  const struct dea_override sets[2],
                                  const struct dea_device *mesh_of)
{
  const struct dea_model_type *type = dea_model_find(of->model);
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
  assert_int_equal(type->solve(ctx, model, of->voltage_V, &point), DEA_OK);
  type->destroy(ctx, model);
  type->destroy(ctx, of_mesh);
  dea_device_destroy(ctx, changed);
  dea_design_destroy(ctx, changed_design);
  return device->fibre_count > 0 ? point.fibre_tip_z_m : point.electrode_edge_u_m;
}

/* Effects against designs that are changed by hand, by all of the tolerance to either side. */
static inline void check_sensitivity(const struct dea_sensitivity *found,
                                     struct dea_override as_made, double tolerance)
{
  static const struct {
    enum dea_deviation which;
    const char *key, *low, *high;
  } rows[] = {
      {DEA_DEVIATION_THICKNESS, "film.thickness", "95 um", "105 um"},
      {DEA_DEVIATION_PRE_STRETCH, "pre_stretch", "1.48", "1.52"},
      {DEA_DEVIATION_ELECTRODE, "electrodes.diameter", "4.9 mm unstretched", "5.1 mm unstretched"},
      {DEA_DEVIATION_FRAME, "frame.inner_diameter", "29.9 mm", "30.1 mm"},
      {DEA_DEVIATION_FIBRE, "fibres.overlap", "0.2 mm stretched", "-0.2 mm stretched"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    const bool tips = rows[i].which == DEA_DEVIATION_FIBRE;
    if (tips && device->fibre_count == 0) {
      assert_true(isnan(found->effect_m[rows[i].which]));
      continue;
    }
    const struct dea_override low[2] = {as_made, {rows[i].key, rows[i].low}};
    const struct dea_override high[2] = {as_made, {rows[i].key, rows[i].high}};
    const struct dea_device *mesh_of = tips ? NULL : device; // tips that cross an edge: anew
    const double difference =
        0.5 * (displacement(found, high, mesh_of) - displacement(found, low, mesh_of));
    assert_close(found->effect_m[rows[i].which], difference, tolerance, 0);
  }
}
