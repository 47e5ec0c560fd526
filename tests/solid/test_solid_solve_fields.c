/* Fields of model 3d after a solve, and its state: saved, loaded, gone on from. */
// ctest: solid
#include "devices.h"
#include "failing_allocator.h"
#include "model/model.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static const struct dea_model_type *type;
static struct dea_device disc;

static int set_up(void **state)
{
  type = dea_model_find("3d");
  disc = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  return context_set_up(state) == 0 && type != NULL ? 0 : -1;
}

static const double *values(const struct dea_field_mesh *mesh, const char *name)
{
  const struct dea_mesh_field *field = dea_field_mesh_find(mesh, name);
  assert_non_null(field);
  return field->values;
}

/* At rest: the true pre-stress of 797.7 kPa everywhere, over the stretched thickness. */
TEST(test_rest)
{
  struct dea_model *model;
  struct dea_load_point point;
  struct dea_field_mesh *mesh;
  assert_int_equal(type->create(ctx, &disc, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, 0, &point), DEA_OK);
  assert_int_equal(type->fields(ctx, model, DEA_FIELDS_VOLUME, &mesh), DEA_OK);
  assert_int_equal(mesh->fold, 4); // a sector of 45 degrees
  assert_int_equal(mesh->fibres, 0);
  const double *stress = values(mesh, "principal_stress_Pa");
  const double *tension = values(mesh, "tension_N_per_m");
  for (size_t p = 0; p < mesh->point_count; p++) {
    assert_close(stress[3 * p], 797.745e3, 1e-5, 0);
    assert_close(stress[3 * p + 1], 797.745e3, 1e-5, 0);
    assert_close(stress[3 * p + 2], 0, 0, 1);
    assert_close(tension[2 * p + 1], 797.745e3 * disc.film_thickness_m, 1e-5, 0);
  }
  dea_field_mesh_destroy(ctx, mesh);
  type->destroy(ctx, model);
}

/* Value of a column of a profile at a radius. */
static double along(const struct dea_profile *profile, const double *column, double radius_m)
{
  size_t i = 1;
  while (i + 1 < profile->count && profile->radius_m[i] < radius_m) {
    i++;
  }
  double from = profile->radius_m[i - 1], share = (radius_m - from) / (profile->radius_m[i] - from);
  return column[i - 1] + share * (column[i] - column[i - 1]);
}

/* At 5 kV the middle surface is that of the exact disc, an independent model: displacement, both
 * stretches, both tensions; away from the electrode's edge, where they jump and the solid has a
 * layer of the size of its thickness. */
TEST(test_exact_disc)
{
  const struct dea_model_type *exact = dea_model_find("axisymmetric");
  struct dea_model *model, *reference;
  struct dea_load_point point, wanted;
  struct dea_profile profile;
  struct dea_field_mesh *mesh;
  assert_int_equal(exact->create(ctx, &disc, NULL, &reference), DEA_OK);
  assert_int_equal(exact->solve(ctx, reference, 5e3, &wanted), DEA_OK);
  assert_int_equal(exact->profile(ctx, reference, &profile), DEA_OK);
  assert_int_equal(type->create(ctx, &disc, NULL, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, 5e3, &point), DEA_OK);
  assert_int_equal(type->fields(ctx, model, DEA_FIELDS_SURFACE, &mesh), DEA_OK);
  const double *u = values(mesh, "displacement_m"), *tension = values(mesh, "tension_N_per_m");
  const double *field = values(mesh, "true_field_V_per_m");
  const double *stretch = values(mesh, "plane_stretch");
  double highest = 0;
  size_t compared = 0;
  for (size_t p = 0; p < mesh->point_count; p++) {
    const double *X = mesh->X + 3 * p;
    double r = hypot(X[0], X[1]);
    highest = fmax(highest, field[p]);
    assert_close(u[3 * p + 2], 0, 0, 1e-9);
    if (fabs(r / disc.electrode_radius_m - 1) < 0.15 || r == 0) {
      continue;
    }
    double outwards = (u[3 * p] * X[0] + u[3 * p + 1] * X[1]) / r;
    double radial = along(&profile, profile.stretch_r, r);
    double hoop = along(&profile, profile.stretch_t, r);
    double radial_N_per_m = along(&profile, profile.tension_r_N_per_m, r);
    double hoop_N_per_m = along(&profile, profile.tension_t_N_per_m, r);
    assert_close(outwards, along(&profile, profile.displacement_m, r), 0.01, 2e-6);
    assert_close(stretch[3 * p], fmax(radial, hoop), 0.006, 0);
    assert_close(stretch[3 * p + 1], fmin(radial, hoop), 0.006, 0);
    assert_close(tension[2 * p], fmax(radial_N_per_m, hoop_N_per_m), 0.02, 0);
    assert_close(tension[2 * p + 1], fmin(radial_N_per_m, hoop_N_per_m), 0.02, 0);
    compared++;
  }
  assert_true(compared > 100);
  assert_true(highest < point.true_field_V_per_m); // which is of a Gauss point, not of a mean
  assert_close(highest, point.true_field_V_per_m, 0.03, 0);
  dea_field_mesh_destroy(ctx, mesh);
  type->destroy(ctx, model);
  exact->destroy(ctx, reference);
}

/* A copy of a state that outlives its model. */
struct kept {
  struct dea_state state;
  double *values[DEA_STATE_PARTS_MAX];
};

static void keep(struct dea_model *model, struct kept *out)
{
  assert_int_equal(type->save(ctx, model, &out->state), DEA_OK);
  assert_true(out->state.mark_count > 0);
  for (size_t i = 0; i < out->state.array_count; i++) {
    struct dea_state_array *array = &out->state.arrays[i];
    out->values[i] = calloc(array->count, sizeof(double));
    memcpy(out->values[i], array->values, array->count * sizeof(double));
    array->values = out->values[i];
  }
}

static void forget(struct kept *kept)
{
  for (size_t i = 0; i < kept->state.array_count; i++) {
    free(kept->values[i]);
  }
}

/* A model that goes on from a state answers as the one that never stopped. */
TEST(test_state)
{
  struct dea_model *first, *second;
  struct dea_load_point wanted, point;
  struct kept kept;
  assert_int_equal(type->create(ctx, &disc, NULL, &first), DEA_OK);
  assert_int_equal(type->solve(ctx, first, 2e3, &point), DEA_OK);
  assert_int_equal(type->solve(ctx, first, 3e3, &point), DEA_OK);
  keep(first, &kept);
  assert_int_equal(type->solve(ctx, first, 4e3, &wanted), DEA_OK);
  type->destroy(ctx, first);
  assert_int_equal(type->create(ctx, &disc, NULL, &second), DEA_OK);
  assert_int_equal(type->load(ctx, second, &kept.state), DEA_OK);
  assert_int_equal(type->solve(ctx, second, 4e3, &point), DEA_OK);
  assert_close(point.electrode_edge_u_m, wanted.electrode_edge_u_m, 1e-12, 0);
  assert_close(point.energy_J, wanted.energy_J, 1e-12, 0);
  assert_close(point.min_tension_N_per_m, wanted.min_tension_N_per_m, 1e-9, 0);
  for (size_t i = 0; i < kept.state.array_count; i++) { // one that is too short, or lacking
    struct dea_state bad = kept.state;
    bad.arrays[i].count--;
    assert_int_equal(type->load(ctx, second, &bad), DEA_E_ARGUMENT);
    bad.arrays[i] = bad.arrays[--bad.array_count];
    assert_int_equal(type->load(ctx, second, &bad), DEA_E_ARGUMENT);
  }
  forget(&kept);
  type->destroy(ctx, second);
}

TESTS(set_up, context_tear_down)
