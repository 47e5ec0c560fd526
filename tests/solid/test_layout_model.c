/* Model 3d of devices of any layout, against closed forms and tables. */
// ctest: solid
#include "devices.h"
#include "material/plane.h"
#include "model/model.h"
#include "model/solid/actuator/layout_mesh.h"

#include "layout_device.h"

#include <stdio.h>

static struct dea_model *model_of(const struct dea_device *device, enum dea_solid_film film,
                                  double refinement)
{
  const struct dea_model_settings settings = {.film = film, .refinement = refinement};
  return layout_model(device, &settings);
}

/* A square of film whose edges at y are held apart and whose edges at x slide: pure shear, uniform,
 * l1 of the closed form (plane stress, incompressible). */
TEST(test_pure_shear)
{
  static const struct {
    double kV, l1;
  } table[] = {{0, 1}, {2, 1.007072}, {4, 1.029909}, {6, 1.074743}};
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  double a = 10e-3;
  add_rectangle(device, "film", 0, 0, a, a);
  const size_t low = add_rectangle(device, "low", 0, -1e-3, a, 1e-3);
  const size_t high = add_rectangle(device, "high", 0, a, a, 1e-3);
  const size_t left = add_rectangle(device, "left", -1e-3, 0, 1e-3, a);
  add_film(device, 0, 1, 1);
  add_electrodes(device, 0, 0);
  hold_edge(device, 0, low, 2);
  hold_edge(device, 0, high, 2);
  hold_edge(device, 0, left, 1);
  hold_flat(device, 0);
  add_film_monitor(device);
  l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
      .name = "line", .kind = DEA_MONITOR_LINE, .at_m = {{1e-3, 2e-3}, {8e-3, 2e-3}}};
  add_point(device, "corner", a, a);
  struct dea_model *model = model_of(device, DEA_FILM_SOLID, 1);
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    struct dea_load_point point;
    struct dea_observation seen = observed_at(model, 1e3 * table[i].kV, &point);
    double l1 = table[i].l1;
    assert_close(seen.monitor[0][DEA_OBSERVED_STRETCH_X], l1, 0, 1e-6);
    assert_close(seen.monitor[0][DEA_OBSERVED_STRETCH_Y], 1, 1e-9, 0);
    assert_close(seen.monitor[0][DEA_OBSERVED_AREA_STRETCH], l1, 0, 1e-6);
    assert_close(seen.monitor[1][DEA_OBSERVED_STRETCH], l1, 0, 1e-6);
    assert_close(seen.monitor[2][DEA_OBSERVED_X], a * (l1 - 1), 0, 1e-6 * a);
    double charge = DEA_EPSILON_0 * 2.8 * a * a * l1 * l1 / 100e-6 * 1e3 * table[i].kV;
    assert_close(seen.channel[1].charge_C, charge, 3e-6, 1e-20);
    assert_close(seen.channel[0].charge_C, -charge, 3e-6, 1e-20);
    assert_close(point.highest_z_m, 0.5 * 100e-6 * (1 / l1 - 1), 0, 1e-10); // the film's middle
    assert_close(point.lowest_z_m, point.highest_z_m, 0, 1e-12);
  }
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* A strip of neo-Hookean film that slides at its left edge, pulled by a dead force along its right
 * one or spread over all of it: the stretch in its middle under the force there, by the closed form
 * of uniaxial stress, F/(W H) = mu (l1 - l3^2/l1) - eps E^2/l1, mu (l2^2 - l3^2) = eps E^2,
 * E = V/(l3 H). */
static void check_dead_force(bool edge, double force_N, double tolerance)
{
  static const struct {
    double kV, l1; // at 50 mN in the middle
  } table[] = {{0, 1.1974293369}, {1, 1.2037741519}, {2, 1.2258917466}};
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  const double a = 40e-3, b = 10e-3;
  add_rectangle(device, "film", 0, -0.5 * b, a, b);
  const size_t left = add_rectangle(device, "left", -1e-3, -b, 1e-3, 2 * b);
  const size_t right = add_rectangle(device, "right", a, -b, 1e-3, 2 * b);
  add_film(device, 0, 1, 1);
  l->plies[0].material.law = dea_law_find("neo-hookean");
  l->plies[0].material.param[0] = 100e3;
  l->plies[0].material.permittivity.at_rest = 3;
  add_electrodes(device, 0, 0);
  hold_edge(device, 0, left, 1 | 4);
  l->supports[l->support_count++] =
      (struct dea_layout_support){.region = 0,
                                  .edge = edge,
                                  .within = edge ? right : DEA_LAYOUT_NONE,
                                  .force_N = {force_N, 0, 0}};
  hold_edge(device, 0, right, 4);
  l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
      .name = "line", .kind = DEA_MONITOR_LINE, .at_m = {{0.5 * a - 2e-3, 0}, {0.5 * a + 2e-3, 0}}};
  assert_int_equal(dea_layout_find_symmetry(ctx, l), DEA_OK);
  const struct dea_layout_sector sector = dea_layout_sector_of(l);
  assert_int_equal(sector.fold, 1); // the force has the line along x only
  struct dea_model *model = model_of(device, DEA_FILM_SOLID, 1);
  for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
    struct dea_load_point point;
    const struct dea_observation seen = observed_at(model, 1e3 * table[i].kV, &point);
    assert_close(seen.monitor[0][DEA_OBSERVED_STRETCH], table[i].l1, tolerance, 0);
  }
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

TEST(test_dead_force)
{
  check_dead_force(true, 50e-3, 1e-6);
  check_dead_force(false, 100e-3, 1e-3); // half of it pulls in the middle; it is no even stretch
}

/* The mesh ends where a support does: a held part of an edge is as long as it was drawn, on any
 * mesh. */
TEST(test_end_of_a_support)
{
  const double a = 10e-3, end_m = 3.7e-3;
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  add_rectangle(device, "film", 0, 0, a, a);
  const size_t part = add_rectangle(device, "part", -1e-3, -1e-3, 1e-3 + end_m, 2e-3);
  add_film(device, 0, 1, 1);
  hold_edge(device, 0, part, 7);
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE, .refinement = 1};
  struct dea_layout_mesh mesh;
  assert_int_equal(dea_layout_mesh_create(ctx, l, &settings, &mesh), DEA_OK);
  bool *marked = dea_alloc(ctx, mesh.plane->node_count, sizeof *marked);
  assert_non_null(marked);
  assert_true(dea_layout_mesh_mark(&mesh, 0, true, part, marked) > 2);
  double last[2] = {0};
  for (size_t n = 0; n < mesh.plane->node_count; n++) {
    for (int i = 0; i < 2 && marked[n]; i++) {
      last[i] = fmax(last[i], mesh.plane->x[2 * n + (size_t)i]);
    }
  }
  assert_close(last[0], end_m, 0, 1e-9);
  assert_close(last[1], 1e-3, 0, 1e-9);
  dea_free(ctx, marked);
  dea_layout_mesh_free(ctx, &mesh);
  dea_device_destroy(ctx, device);
}

/* A stretched layer on one that is free of stress, both of one law, released: it bends evenly to
 * the curvature of Timoshenko (J. Opt. Soc. Am. 11 (1925) 233), n = 1, m = 1, moduli by the plane
 * stress of two directions: 3/2 of the mismatch over the thickness of both. Small strains; what is
 * left is of the free edges, by the square of thickness over length. */
static void check_bilayer(double h, double mismatch, double tolerance)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  double a = 2e-3;
  add_rectangle(device, "plate", 0, 0, a, a);
  const size_t left = add_rectangle(device, "left", -a, 0, a, a);
  const size_t low = add_rectangle(device, "low", 0, -a, a, a);
  const size_t corner = add_rectangle(device, "corner", -1e-6, -1e-6, 2e-6, 2e-6);
  add_film(device, 0, 1, 1);
  add_film(device, 0, 1 + mismatch, 1 + mismatch);
  l->plies[0].name = "base";
  l->plies[0].thickness_m = l->plies[1].thickness_m = h;
  const struct dea_layout_support held[] = {
      {.region = 0, .edge = true, .within = left, .components = 1},
      {.region = 0, .edge = true, .within = low, .components = 2},
      {.region = 0, .edge = true, .within = corner, .components = 4, .hinged = true},
  };
  for (size_t i = 0; i < sizeof held / sizeof held[0]; i++) {
    l->supports[l->support_count++] = held[i];
  }
  const double at[3][2] = {{0, 0}, {0.5 * a, 0}, {0.5 * a, 0.5 * a}};
  for (size_t i = 0; i < 3; i++) {
    l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
        .name = "point", .kind = DEA_MONITOR_POINT, .at_m = {{at[i][0], at[i][1]}}, .ply = 1};
  }
  struct dea_model *model = model_of(device, DEA_FILM_SOLID, 2);
  struct dea_load_point point;
  struct dea_observation seen = observed_at(model, 0, &point);
  double curvature = 1.5 * mismatch / (2 * h);
  for (size_t i = 1; i < 3; i++) {
    double rise = seen.monitor[i][DEA_OBSERVED_Z] - seen.monitor[0][DEA_OBSERVED_Z];
    double square = at[i][0] * at[i][0] + at[i][1] * at[i][1];
    assert_close(rise, 0.5 * curvature * square, tolerance, 0);
  }
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

TEST(test_release_of_a_bilayer)
{
  check_bilayer(100e-6, 1e-4, 1e-3);
  check_bilayer(50e-6, 2.5e-5, 2.5e-4);
}

/* A square of film with an electrode, its lower left corner at a place turned by an angle about the
 * origin; pre-stretched along its sides. */
static struct dea_device *turned_square(double angle, bool fibres)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  static const double box[2][4] = {{0, 0, 10e-3, 10e-3}, {2e-3, 3e-3, 7e-3, 7e-3}};
  double c = cos(angle), s = sin(angle);
  for (int i = 0; i < 2; i++) {
    struct dea_vertex corners[4] = {{0}};
    for (int k = 0; k < 4; k++) {
      double x = box[i][k == 1 || k == 2 ? 2 : 0], y = box[i][k > 1 ? 3 : 1];
      corners[k] = (struct dea_vertex){.x_m = c * x - s * y, .y_m = s * x + c * y};
    }
    dea_region_add(add_region(device, i == 0 ? "film" : "active"), corners, 4);
  }
  add_film(device, 0, 1.3, 1.1);
  l->plies[0].angle_rad = angle;
  if (fibres) {
    l->plies[0].material.law = dea_law_find("holzapfel-gasser-ogden");
    memcpy(l->plies[0].material.param, (double[]){50e3, 80e3, 0.3, 0.05}, 4 * sizeof(double));
    l->plies[0].material.fibre_angle_rad = 0.2; // to the first axis of the pre-stretch
  }
  add_electrodes(device, 0, 1);
  hold_edge(device, 0, DEA_LAYOUT_NONE, 7);
  add_point(device, "side", c * 7e-3 - s * 5e-3, s * 7e-3 + c * 5e-3);
  l->monitors[l->monitor_count++] =
      (struct dea_layout_monitor){.name = "active", .kind = DEA_MONITOR_REGION, .region = 1};
  return device;
}

/* A device that is turned does what it did, turned, but for the mesh, which gmsh makes anew (to
 * 1e-9 on one mesh); looked at in the middle of a side, as the electrode's
 * corner is 0.5 % off on meshes that are not the same (docs/theory/trust.md). */
static void check_turned(bool fibres)
{
  const double angle = 37 * acos(-1.0) / 180, c = cos(angle), s = sin(angle);
  double u[2][2], area[2], charge[2], tension[2];
  for (int i = 0; i < 2; i++) {
    struct dea_device *device = turned_square(i * angle, fibres);
    struct dea_model *model = model_of(device, fibres ? DEA_FILM_SOLID : DEA_FILM_MEMBRANE, 1);
    struct dea_load_point point;
    struct dea_observation seen = observed_at(model, 3e3, &point);
    u[i][0] = seen.monitor[0][DEA_OBSERVED_X];
    u[i][1] = seen.monitor[0][DEA_OBSERVED_Y];
    area[i] = seen.monitor[1][DEA_OBSERVED_AREA_STRETCH];
    charge[i] = seen.channel[1].charge_C;
    tension[i] = point.min_tension_N_per_m;
    dea_model_find("3d")->destroy(ctx, model);
    dea_device_destroy(ctx, device);
  }
  double scale = hypot(u[0][0], u[0][1]);
  assert_true(scale > 20e-6);
  const double same = fibres ? 1e-3 : 1e-4; // of meshes
  assert_close(u[1][0], c * u[0][0] - s * u[0][1], 0, same * scale);
  assert_close(u[1][1], s * u[0][0] + c * u[0][1], 0, same * scale);
  assert_close(area[1], area[0], 0.1 * same, 0);
  assert_close(charge[1], charge[0], 0.1 * same, 0);
  if (!fibres) { // of which a corner of the electrode is slack, as its mesh has it
    assert_close(tension[1], tension[0], 1e-3, 0);
  }
}

TEST(test_pre_stretch_at_an_angle)
{
  check_turned(false);
}

TEST(test_fibres_at_an_angle)
{
  check_turned(true);
}

/* Tension of a film that is held: by the closed form of its law, s_i = dW/dl_i, with fibres along
 * the first axis of the pre-stretch and across it, whatever the angle of that axis. */
TEST(test_tension_of_fibres)
{
  const double degree = acos(-1.0) / 180, H = 100e-6;
  static const double angles[] = {0, 90, 25};
  for (int i = 0; i < 6; i++) {
    struct dea_device *device = turned_square(0, true);
    struct dea_layout_ply *ply = &device->layout->plies[0];
    const double *l = ply->pre_stretch;
    struct dea_plane plane;
    struct dea_load_point point;
    ply->angle_rad = angles[i % 3] * degree;
    ply->material.fibre_angle_rad = i < 3 ? 0 : 90 * degree;
    assert_int_equal(dea_plane_elastic(&ply->material, l[0], l[1], &plane), DEA_OK);
    struct dea_model *model = model_of(device, DEA_FILM_SOLID, 1);
    observed_at(model, 0, &point);
    assert_close(point.min_tension_N_per_m, H * fmin(plane.s1 / l[1], plane.s2 / l[0]), 1e-6, 0);
    dea_model_find("3d")->destroy(ctx, model);
    dea_device_destroy(ctx, device);
  }
}

/* A film alone that lets go: from the flat state it goes back to G^-1, turned so that the edge that
 * is held along x stays straight: F is lower triangular with F^T F = G^-2. */
TEST(test_release_at_an_angle)
{
  const double angle = 0.5, c = cos(angle), s = sin(angle), a = 2e-3;
  const double x1 = 1 / (1.3 * 1.3), x2 = 1 / (1.1 * 1.1); // of G^-2
  const double C[3] = {c * c * x1 + s * s * x2, s * s * x1 + c * c * x2, c * s * (x1 - x2)};
  const double F22 = sqrt(C[1]), F21 = C[2] / F22, F11 = sqrt(C[0] - F21 * F21);
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  add_rectangle(device, "film", 0, 0, a, a);
  const size_t left = add_rectangle(device, "left", -a, 0, a, a);
  const size_t corner = add_rectangle(device, "corner", -1e-6, -1e-6, 2e-6, 2e-6);
  add_film(device, 0, 1.3, 1.1);
  l->plies[0].angle_rad = angle;
  hold_edge(device, 0, left, 1);
  hold_edge(device, 0, corner, 2);
  hold_flat(device, 0);
  add_point(device, "corner", a, a);
  struct dea_model *model = model_of(device, DEA_FILM_SOLID, 1);
  struct dea_load_point point;
  struct dea_observation seen = observed_at(model, 0, &point);
  assert_close(seen.monitor[0][DEA_OBSERVED_X], (F11 - 1) * a, 0, 1e-8 * a);
  assert_close(seen.monitor[0][DEA_OBSERVED_Y], (F21 + F22 - 1) * a, 0, 1e-8 * a);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Two films between alternating electrodes move as one does, with twice its charge. */
TEST(test_stack)
{
  struct dea_observation seen;
  struct dea_load_point point;
  double u[2] = {0}, charge[2] = {0};
  for (size_t films = 1; films <= 2; films++) {
    struct dea_device *device = device_new();
    size_t film = add_rectangle(device, "film", 0, 0, 10e-3, 10e-3);
    size_t active = add_rectangle(device, "active", 2e-3, 3e-3, 5e-3, 4e-3);
    for (size_t i = 0; i < films; i++) {
      add_film(device, film, 1.3, 1.2);
      add_electrode(device, i, true, active, 1 - i % 2);
    }
    add_electrode(device, 0, false, active, 0);
    hold_edge(device, film, DEA_LAYOUT_NONE, 7);
    add_point(device, "edge", 7e-3, 5e-3);
    struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE, 1);
    seen = observed_at(model, 4e3, &point);
    u[films - 1] = seen.monitor[0][DEA_OBSERVED_X];
    charge[films - 1] = seen.channel[1].charge_C;
    assert_true(u[films - 1] > 50e-6); // it moves
    dea_model_find("3d")->destroy(ctx, model);
    dea_device_destroy(ctx, device);
  }
  assert_close(u[1], u[0], 1e-8, 0);
  assert_close(charge[1], 2 * charge[0], 1e-8, 0);
}

/* A strip of `layers` on a passive ply, held at one end: each a ply of its own, or one of that many
 * with elements for each of them. The field comes by turns, or not, to a ply on it. */
static struct dea_device *bender_new(size_t layers, bool as_one, size_t elements)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  const size_t strip = add_rectangle(device, "strip", 0, 0, 8e-3, 4e-3);
  l->plies = dea_arena_alloc(&l->memory, layers + 2, sizeof *l->plies);
  l->electrodes = dea_arena_alloc(&l->memory, layers + 2, sizeof *l->electrodes);
  add_film(device, strip, 1, 1);
  for (size_t i = 0; i < (as_one ? 1 : layers); i++) {
    add_film(device, strip, 1, 1);
    l->plies[1 + i].elements = 1;
    add_electrode(device, 1 + i, true, strip, as_one ? 1 : 1 - i % 2);
  }
  add_electrode(device, 1, false, strip, 0);
  if (as_one) {
    struct dea_layout_ply *stack = &l->plies[1];
    stack->layers = layers;
    stack->elements = elements;
    stack->thickness_m *= (double)layers;
    stack->thickness_unstretched_m *= (double)layers;
  }
  add_film(device, strip, 1, 1);
  l->plies[l->ply_count - 1].thickness_m = 50e-6;
  add_electrode(device, l->ply_count - 1, true, strip, 1);
  const size_t end = add_rectangle(device, "end", -1e-3, -1e-3, 1e-3, 6e-3);
  hold_edge(device, strip, end, 7);
  add_point(device, "tip", 8e-3, 2e-3);
  return device;
}

/* A ply of several layers does what as many plies do. */
TEST(test_layers)
{
  static const size_t counts[] = {2, 3, 10};
  for (size_t k = 0; k < 3; k++) {
    const size_t layers = counts[k], runs = layers == 2 ? 3 : 2;
    const struct dea_model_settings settings = {.film = DEA_FILM_SOLID, .order = runs == 3 ? 2 : 1};
    double tip[3], charge[3];
    for (size_t i = 0; i < runs; i++) {
      struct dea_load_point point;
      struct dea_device *device = bender_new(layers, i > 0, i == 1 ? layers : 1);
      struct dea_model *model = layout_model(device, &settings);
      const struct dea_observation seen = observed_at(model, 1e3, &point);
      tip[i] = seen.monitor[0][DEA_OBSERVED_Z];
      charge[i] = seen.channel[1].charge_C;
      dea_model_find("3d")->destroy(ctx, model);
      dea_device_destroy(ctx, device);
    }
    assert_true(fabs(tip[0]) > 5e-6);
    assert_close(tip[1], tip[0], 1e-8, 0);
    assert_close(charge[1], charge[0], 1e-8, 0);
    if (runs == 3) { // one element through the thickness
      assert_close(tip[2], tip[0], 1e-3, 0);
      assert_close(charge[2], charge[0], 1e-5, 0);
    }
  }
}

/* The plain disc on a free mesh and on that of blocks: two models of one film. */
TEST(test_disc_of_both_models)
{
  struct dea_device plain = test_disc(silicone(), 1.5, 3.75e-3, 0.25, 0);
  struct dea_device *device = disc_new(plain.frame_radius_m, 3.75e-3, 1.5);
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE};
  struct dea_model *blocks, *free_mesh = model_of(device, DEA_FILM_MEMBRANE, 1);
  const struct dea_model_type *type = dea_model_find("3d");
  assert_int_equal(type->create(ctx, &plain, &settings, &blocks), DEA_OK);
  for (int kV = 2; kV <= 6; kV += 2) {
    struct dea_load_point of_blocks, of_free;
    assert_int_equal(type->solve(ctx, blocks, 1e3 * kV, &of_blocks), DEA_OK);
    struct dea_observation seen = observed_at(free_mesh, 1e3 * kV, &of_free);
    assert_close(seen.monitor[0][DEA_OBSERVED_X], of_blocks.electrode_edge_u_m, 1e-3, 0);
    assert_close(of_free.capacitance_F, of_blocks.capacitance_F, 1e-4, 0);
    assert_close(of_free.min_tension_N_per_m, of_blocks.min_tension_N_per_m, 3e-3, 0);
  }
  type->destroy(ctx, blocks);
  type->destroy(ctx, free_mesh);
  dea_device_destroy(ctx, device);
}

/* The cone with the bistable spring of docs/verification/cone.md: a sweep snaps past both limit
 * points, and tells where they are. */
TEST(test_snaps_are_located)
{
  static const double at[] = {0, 0.5e-3, 1e-3, 2e-3, 3e-3, 4e-3, 6e-3, 8e-3};
  static const double force[] = {-0.1, -0.097, -0.096, -0.16, -0.33, -0.4, -0.43, -0.43};
  static const struct {
    double kV, passed_kV; // 0: none
  } steps[] = {{3, 0}, {4, 0}, {4.5, 4.30488}, {3, 0}, {2, 0}, {1, 0}, {0, 0.69665}};
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  l->bodies[0].free = 4;
  l->springs[l->spring_count++] = (struct dea_layout_spring){
      .body = 0, .component = 2, .count = sizeof at / sizeof at[0], .at = at, .force = force};
  struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE, 1);
  for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
    struct dea_load_point point;
    assert_int_equal(type->solve(ctx, model, 1e3 * steps[i].kV, &point), DEA_OK);
    const struct dea_event *passed = type->passed(model);
    assert_true((passed != NULL) == (steps[i].passed_kV > 0));
    if (passed != NULL) {
      bool out = i < 3;
      assert_int_equal(passed->kind, out ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK);
      assert_close(1e-3 * passed->point.voltage_V, steps[i].passed_kV, out ? 5e-5 : 1e-3, 0);
    }
    // one of several from where it snapped on, until it is back where it was released
    bool told = ((point.own_flags >> DEA_FLAG_STATES) & 1) != 0;
    assert_true(told == (i >= 2 && steps[i].kV > 0));
  }
  type->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* The bytes of a saved state's mark. */
static const struct dea_state_mark *mark_of(const struct dea_state *state, const char *name)
{
  for (size_t i = 0; i < state->mark_count; i++) {
    if (strcmp(state->marks[i].name, name) == 0) {
      return &state->marks[i];
    }
  }
  fail_msg("no mark '%s'", name);
  return NULL;
}

/* A hub that is pushed by a dead force: another model that takes over a saved state goes on as the
 * one that left it, to the last digit; a device with another force does not take it for its own. */
TEST(test_saved_state)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_load_point a, b;
  struct dea_state saved, other;
  struct dea_device *device = cone_new();
  struct dea_layout_body *hub = &device->layout->bodies[0];
  hub->free = 4;
  hub->force_N[2] = 0.1;
  struct dea_model *first = model_of(device, DEA_FILM_MEMBRANE, 1);
  struct dea_model *second = model_of(device, DEA_FILM_MEMBRANE, 1);
  observed_at(first, 2e3, &a);
  assert_int_equal(type->save(ctx, first, &saved), DEA_OK);
  assert_int_equal(type->load(ctx, second, &saved), DEA_OK);
  struct dea_observation seen = observed_at(first, 3e3, &a);
  double z_m = seen.monitor[0][DEA_OBSERVED_Z];
  seen = observed_at(second, 3e3, &b);
  assert_true(z_m > 1e-3);
  assert_close(seen.monitor[0][DEA_OBSERVED_Z], z_m, 0, 0);
  assert_close(b.energy_J, a.energy_J, 0, 0);
  type->destroy(ctx, second);
  hub->force_N[2] = 0.2;
  second = model_of(device, DEA_FILM_MEMBRANE, 1);
  assert_int_equal(type->save(ctx, second, &other), DEA_OK);
  const struct dea_state_mark *mine = mark_of(&saved, "loads"), *its = mark_of(&other, "loads");
  assert_int_equal(mine->size, its->size);
  assert_memory_not_equal(mine->bytes, its->bytes, mine->size);
  assert_memory_equal(mark_of(&saved, "mesh")->bytes, mark_of(&other, "mesh")->bytes, 8);
  struct dea_model *third = model_of(device, DEA_FILM_MEMBRANE, 1);
  z_m = observed_at(third, 3e3, &a).monitor[0][DEA_OBSERVED_Z]; // a state is no force of its own
  assert_int_equal(type->load(ctx, second, &saved), DEA_OK);
  assert_close(observed_at(second, 3e3, &b).monitor[0][DEA_OBSERVED_Z], z_m, 1e-7, 0);
  type->destroy(ctx, third);
  type->destroy(ctx, first); // whose state was lent
  type->destroy(ctx, second);
  dea_device_destroy(ctx, device);
}

/* Why the model of a device cannot be made. */
static const char *why_none(struct dea_device *device, const struct dea_model_settings *settings)
{
  struct dea_model *model;
  assert_int_equal(dea_model_find("3d")->create(ctx, device, settings, &model),
                   DEA_E_NOT_CONVERGED);
  dea_device_destroy(ctx, device);
  return dea_context_message(ctx);
}

/* A pressure above the largest that a film bears is said to be that, and about how large that is.
 */
TEST(test_limit_of_the_pressure)
{
  only_nightly();
  const struct dea_model_settings settings = {.film = DEA_FILM_MEMBRANE, .refinement = 0.5};
  struct dea_device *device = disc_new(10e-3, 5e-3, 1.1);
  struct dea_layout *l = device->layout;
  l->plies[0].material.law = dea_law_find("neo-hookean");
  l->plies[0].material.param[0] = 100e3;
  l->pressures[l->pressure_count++] =
      (struct dea_layout_pressure){.region = 0, .ply = 0, .top = false, .pressure_Pa = 6e3};
  double limit_Pa, of_Pa;
  const char *why = why_none(device, &settings);
  assert_non_null(strstr(why, "a limit of the pressure"));
  assert_int_equal(sscanf(strstr(why, "about "), "about %lf Pa of %lf", &limit_Pa, &of_Pa), 2);
  assert_close(of_Pa, 6e3, 0, 0);
  assert_close(limit_Pa, 1.95e3, 0.03, 0); // 2.0 kPa where the square of the stiffness is 0
  dea_context_clear(ctx);
}

TESTS(context_set_up, context_tear_down)
