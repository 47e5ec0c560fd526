/* The sector of a layout between lines of symmetry: which it is, and what model 3d makes of it. */
// ctest: solid
#include "device/layout_sector.h"
#include "model/model.h"

#include "layout_device.h"

static const double l_pre = 1.05, pi = 3.14159265358979323846;

static void add_polygon(struct dea_device *device, const char *name, size_t corners,
                        const double centre_m[2], double radius_m, double angle)
{
  struct dea_vertex v[12];
  for (size_t i = 0; i < corners; i++) {
    double at = angle + 2 * pi * (double)i / (double)corners;
    v[i] = (struct dea_vertex){.x_m = centre_m[0] + radius_m * cos(at),
                               .y_m = centre_m[1] + radius_m * sin(at)};
  }
  dea_region_add(add_region(device, name), v, corners);
}

/* A triangle with one line of symmetry, its tip at the centre. */
static void add_kite(struct dea_device *device, const double centre_m[2], double radius_m,
                     double angle)
{
  struct dea_vertex v[3] = {{.x_m = centre_m[0], .y_m = centre_m[1]}};
  for (int i = 1; i < 3; i++) {
    double at = angle + (i == 1 ? -0.7 : 0.7);
    v[i] = (struct dea_vertex){.x_m = centre_m[0] + radius_m * cos(at),
                               .y_m = centre_m[1] + radius_m * sin(at)};
  }
  dea_region_add(add_region(device, "film"), v, 3);
}

static struct dea_layout_sector sector_of(struct dea_device *device)
{
  assert_int_equal(dea_layout_find_symmetry(ctx, device->layout), DEA_OK);
  return dea_layout_sector_of(device->layout);
}

static void assert_fold(struct dea_device *device, int fold, double angle)
{
  const struct dea_layout_sector sector = sector_of(device);
  assert_int_equal(sector.fold, fold);
  if (fold > 0) {
    assert_close(sector.angle_rad, angle, 0, 1e-6);
  }
}

/* What acts on the cone's hub takes lines of symmetry away. */
TEST(test_lines_that_everything_has)
{
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  struct dea_layout_body *hub = &l->bodies[0];
  assert_int_equal(dea_layout_sector_of(l).fold, 0); // nobody looked for it
  assert_fold(device, 4, 0);
  hub->force_N[2] = 1;
  l->gravity_m_per_s2[2] = -DEA_STANDARD_GRAVITY_M_PER_S2;
  l->springs[l->spring_count++] = (struct dea_layout_spring){.component = 2, .free_at = 1e-3};
  assert_fold(device, 4, 0);
  hub->force_N[0] = 1; // along x, on the line along x
  assert_fold(device, 1, 0);
  hub->moment_N_m[0] = 1; // about x: on no line that has the force
  assert_fold(device, 0, 0);
  hub->force_N[0] = 0;
  assert_fold(device, 1, 0.5 * pi);
  hub->moment_N_m[0] = 0;
  hub->turn_rad[2] = 0.1;
  assert_fold(device, 0, 0);
  hub->turn_rad[2] = 0;
  l->springs[0] = (struct dea_layout_spring){.component = 0, .stiffness = 3};
  assert_fold(device, 2, 0); // not at 45 degrees
  l->springs[0].free_at = 1e-3;
  assert_fold(device, 1, 0);
  l->spring_count = 0;
  l->supports[0].components = 2; // along y only
  assert_fold(device, 2, 0);
  l->supports[0].components = 3;
  l->supports[0].move_m[1] = 1e-3;
  assert_fold(device, 1, 0.5 * pi);
  dea_device_destroy(ctx, device);
}

static struct dea_model *model_of(const struct dea_device *device, enum dea_solid_film film,
                                  enum dea_solid_domain domain)
{
  const struct dea_model_settings settings = {.film = film, .domain = domain, .refinement = 1};
  return layout_model(device, &settings);
}

/* A polygon of pre-stretched film that lies free: it goes back to where it came from, all points
 * towards the centre, wherever they lie. No corners: a triangle with one line of symmetry. */
static void check_release(size_t corners, int fold)
{
  enum { POINTS = 6 };
  const double centre[2] = {2e-3, -1e-3}, radius = 5e-3, angle = 0.35;
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  if (corners > 0) {
    add_polygon(device, "film", corners, centre, radius, angle);
  } else {
    add_kite(device, centre, radius, angle);
    dea_region_add_circle(add_region(device, "tip"), centre[0], centre[1], 1e-6, false, nowhere);
    hold_edge(device, 0, 1, 3);
  }
  add_film(device, 0, l_pre, l_pre);
  add_electrodes(device, 0, 0);
  l->supports[l->support_count++] = (struct dea_layout_support){
      .region = 0, .within = DEA_LAYOUT_NONE, .components = 4, .hinged = true};
  double at[POINTS][2];
  for (size_t i = 0; i < POINTS; i++) {
    double turn = corners > 0 ? (double)i : angle - 0.25 + 0.1 * (double)i;
    at[i][0] = centre[0] + 0.5 * radius * cos(turn);
    at[i][1] = centre[1] + 0.5 * radius * sin(turn);
    add_point(device, "point", at[i][0], at[i][1]);
  }
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = "line",
                                  .kind = DEA_MONITOR_LINE,
                                  .at_m = {{at[0][0], at[0][1]}, {at[5][0], at[5][1]}}};
  add_film_monitor(device);
  assert_int_equal(sector_of(device).fold, fold);
  struct dea_model *model = model_of(device, DEA_FILM_SOLID, DEA_DOMAIN_SECTOR);
  struct dea_load_point point;
  struct dea_observation seen = observed_at(model, 0, &point);
  for (size_t i = 0; i < POINTS; i++) {
    for (int k = 0; k < 2; k++) {
      assert_close(seen.monitor[i][k], (1 / l_pre - 1) * (at[i][k] - centre[k]), 0, 1e-9 * radius);
    }
  }
  assert_close(seen.monitor[POINTS][DEA_OBSERVED_STRETCH], 1 / l_pre, 0, 1e-9);
  assert_close(seen.monitor[POINTS + 1][DEA_OBSERVED_STRETCH_X], 1 / l_pre, 0, 1e-9);
  double area_m2 = dea_region_area_m2(&l->regions[0].region) / (l_pre * l_pre);
  assert_close(seen.channel[1].capacitance_F, DEA_EPSILON_0 * 2.8 * area_m2 / 100e-6, 1e-6, 0);
  assert_close(point.capacitance_F, seen.channel[1].capacitance_F, 1e-5, 0);
  struct dea_field_mesh *fields;
  assert_int_equal(dea_model_find("3d")->fields(ctx, model, DEA_FIELDS_SURFACE, &fields), DEA_OK);
  double low = INFINITY, high = -INFINITY, low_all = INFINITY, high_all = -INFINITY;
  double box[4];
  dea_region_box_m(&l->regions[0].region, box);
  for (size_t i = 0; i < fields->point_count; i++) {
    low = fmin(low, fields->X[3 * i]);
    high = fmax(high, fields->X[3 * i]);
    low_all = fmin(low_all, fields->X[3 * i + 1]);
    high_all = fmax(high_all, fields->X[3 * i + 1]);
  }
  assert_int_equal(fields->fold, 0); // all of it is handed out
  assert_close(low, box[0], 0, 1e-8);
  assert_close(low_all, box[1], 0, 1e-8);
  assert_close(high, box[2], 0, 1e-8);
  assert_close(high_all, box[3], 0, 1e-8);
  dea_field_mesh_destroy(ctx, fields);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

TEST(test_free_films)
{
  check_release(0, 1);
  check_release(4, 4);
  check_release(6, 3);
}

/* A cone off the origin with all that acts on a hub: what its eighth says is what all of it says,
 * but for the mesh. */
static struct dea_device *loaded_cone(void)
{
  static const double at[4] = {-1e-3, 0, 1e-3, 4e-3}, force[4] = {-1e-2, 0, 1e-2, 2e-2};
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  struct dea_layout_body *hub = &l->bodies[0];
  for (size_t i = 0; i < l->region_count; i++) {
    for (size_t k = 0; k < l->regions[i].region.vertex_count; k++) {
      l->regions[i].region.vertex[k].x_m += 3e-3;
      l->regions[i].region.vertex[k].y_m -= 2e-3;
    }
  }
  dea_region_add_circle(add_region(device, "blown"), 3e-3, -2e-3, 10e-3, false, nowhere);
  hub->free = 63;
  hub->mass_kg = 5e-3;
  hub->force_N[2] = 0.02;
  l->gravity_m_per_s2[2] = DEA_STANDARD_GRAVITY_M_PER_S2;
  l->springs[l->spring_count++] = (struct dea_layout_spring){
      .component = 2, .free_at = 0.2e-3, .count = 4, .at = at, .force = force};
  l->springs[l->spring_count++] = (struct dea_layout_spring){.component = 2, .stiffness = 5};
  l->pressures[l->pressure_count++] =
      (struct dea_layout_pressure){.region = 3, .ply = 0, .pressure_Pa = 150};
  add_point(device, "point", 3e-3 - 8e-3, -2e-3 - 6e-3);
  add_film_monitor(device);
  assert_int_equal(dea_layout_find_symmetry(ctx, l), DEA_OK);
  return device;
}

TEST(test_loaded_cone)
{
  struct dea_device *device = loaded_cone();
  struct dea_load_point part, all;
  struct dea_model *sector = model_of(device, DEA_FILM_MEMBRANE, DEA_DOMAIN_SECTOR);
  struct dea_model *whole = model_of(device, DEA_FILM_MEMBRANE, DEA_DOMAIN_DISC);
  struct dea_model_size small, large;
  dea_model_find("3d")->size(sector, &small);
  dea_model_find("3d")->size(whole, &large);
  assert_true(large.unknowns > 6 * small.unknowns);
  struct dea_observation b = observed_at(whole, 3e3, &all), a = observed_at(sector, 3e3, &part);
  assert_true(b.monitor[0][DEA_OBSERVED_Z] > 8e-4);
  for (size_t i = 0; i < 2; i++) { // hub and point
    double scale = fabs(b.monitor[i][DEA_OBSERVED_Z]);
    for (int k = 0; k < 3; k++) {
      assert_close(a.monitor[i][k], b.monitor[i][k], 0, 1e-3 * scale);
    }
  }
  for (int k = DEA_OBSERVED_STRETCH_X; k <= DEA_OBSERVED_AREA_STRETCH; k++) {
    assert_close(a.monitor[2][k], b.monitor[2][k], 1e-3, 0);
  }
  assert_close(part.energy_J, all.energy_J, 2e-3, 0);
  assert_close(part.capacitance_F, all.capacitance_F, 1e-3, 0);
  assert_close(a.channel[1].charge_C, b.channel[1].charge_C, 1e-3, 0);
  assert_close(a.channel[1].capacitance_F, b.channel[1].capacitance_F, 1e-3, 0);
  // a force that the hub is held by, and one that breaks the symmetry
  const struct dea_control up = {.kind = DEA_CONTROL_PLACE, .component = 2},
                           secondary = {.kind = DEA_CONTROL_PLACE};
  const struct dea_model_type *type = dea_model_find("3d");
  assert_int_equal(type->move(ctx, sector, &up, 2e-3, &part), DEA_OK);
  assert_int_equal(type->move(ctx, whole, &up, 2e-3, &all), DEA_OK);
  assert_int_equal(type->observe(ctx, sector, &a), DEA_OK);
  assert_int_equal(type->observe(ctx, whole, &b), DEA_OK);
  assert_close(a.monitor[0][DEA_OBSERVED_FORCE_Z], b.monitor[0][DEA_OBSERVED_FORCE_Z], 5e-3, 0);
  assert_int_equal(type->move(ctx, sector, &secondary, 1e-4, &part), DEA_E_UNSUPPORTED);
  type->destroy(ctx, sector);
  type->destroy(ctx, whole);
  dea_device_destroy(ctx, device);
}

TESTS(context_set_up, context_tear_down)
