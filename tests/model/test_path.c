/* Arc-length paths: the homogeneous ideal dielectric elastomer (benchmark 2), free and under a dead
 * load, against its closed form. */
#include "devices.h"
#include "model/equilibrium_path.h"
#include "model/film.h"
#include "testing.h"

/* A free film under an equibiaxial nominal stress; the unknown is the stretch. */
struct free_film {
  struct dea_film film;
  double load_Pa, scale_Pa;
};

static dea_status free_evaluate(void *self, const double *u, double voltage_V, double *g, double *K,
                                double *gV)
{
  const struct free_film *free = self;
  double H0 = free->film.thickness_m;
  struct dea_plane plane, unit;
  dea_status status = dea_film_eval(&free->film, true, voltage_V / H0, u[0], u[0], &plane);
  if (status == DEA_OK) {
    dea_plane_electric(free->film.material, 1, u[0], u[0], &unit);
    g[0] = (plane.s1 - free->load_Pa) / free->scale_Pa;
    K[0] = (plane.k11 + plane.k12) / free->scale_Pa;
    gV[0] = unit.s1 * 2 * voltage_V / (H0 * H0) / free->scale_Pa;
  }
  return status;
}

static dea_status free_point(void *self, const double *u, double voltage_V,
                             struct dea_load_point *out)
{
  const struct free_film *free = self;
  *out = dea_load_point_empty();
  out->voltage_V = voltage_V;
  out->electrode_stretch = u[0];
  out->nominal_field_V_per_m = voltage_V / free->film.thickness_m;
  return DEA_OK;
}

struct record {
  struct dea_event events[8];
  size_t event_count, point_count;
  int mode_changes, last_modes;
  double last_stretch, stable_after_limit;
};

static dea_status take_event(void *user, const struct dea_event *event)
{
  struct record *record = user;
  assert_true(record->event_count < 8);
  record->events[record->event_count++] = *event;
  return DEA_OK;
}

static dea_status take_point(void *user, const struct dea_load_point *point)
{
  struct record *record = user;
  record->mode_changes += record->point_count > 0 && point->unstable_modes != record->last_modes;
  record->last_modes = point->unstable_modes;
  record->last_stretch = point->electrode_stretch;
  record->point_count++;
  return DEA_OK;
}

struct dea_model {
  struct dea_path *path;
};

/* Path of a free film of 100 um to total stretch `end`, at dead load of pre-stretch `pre`. */
static struct record trace(const struct dea_material *material, double pre, double end)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct free_film free = {.film = {.material = material, .thickness_m = 100e-6}};
  struct dea_plane plane;
  assert_int_equal(dea_film_eval(&free.film, false, 0, pre, pre, &plane), DEA_OK);
  free.load_Pa = plane.s1;
  free.scale_Pa = dea_film_modulus(&free.film);
  const struct dea_path_system system = {
      1, &free, free_evaluate, free_point, dea_film_voltage_scale(&free.film), NULL, 1, 10, "free"};
  const struct dea_path_options options = {
      .max_stretch = end, .max_voltage_V = INFINITY, .max_points = 5000};
  struct dea_model model;
  struct record record = {0};
  assert_int_equal(dea_path_create(ctx, &system, &pre, &model.path), DEA_OK);
  assert_int_equal(dea_path_trace(ctx, &model, &options, take_point, take_event, &record), DEA_OK);
  dea_path_destroy(ctx, model.path);
  dea_context_destroy(ctx);
  return record;
}

/* E~ sqrt(eps/mu) of an event. */
static double field_of(const struct dea_event *event, const struct dea_material *material,
                       double mu)
{
  double eps = DEA_EPSILON_0 * material->permittivity.at_rest;
  return event->point.nominal_field_V_per_m * sqrt(eps / mu);
}

TEST(test_neo_hookean_pull_in)
{
  static const struct {
    double pre, field, stretch;
  } wanted[] = {{1, 0.687365, 1.259921}, {1.2, 0.41535, 1.59036}, {2, 0.19507, 2.97042}};
  struct dea_material m = test_material("neo-hookean", 1e5, 0, 0);
  for (size_t i = 0; i < 3; i++) {
    struct record r = trace(&m, wanted[i].pre, 4);
    assert_int_equal(r.event_count, 1);
    assert_int_equal(r.events[0].kind, DEA_EVENT_PULL_IN);
    assert_close(field_of(&r.events[0], &m, 1e5), wanted[i].field, 0, i == 0 ? 5e-7 : 5e-6);
    assert_close(r.events[0].point.electrode_stretch, wanted[i].stretch, 0, i == 0 ? 1e-6 : 5e-6);
    assert_int_equal(r.mode_changes, 1);
    assert_int_equal(r.last_modes, 1);
    assert_close(r.last_stretch, 4, 1e-9, 0);
  }
  // closed form of the first: stretch 2^(1/3), field^2 = l^-2 - l^-8
  struct record r = trace(&m, 1, 4);
  double l = cbrt(2);
  assert_close(r.events[0].point.electrode_stretch, l, 1e-6, 0);
  assert_close(field_of(&r.events[0], &m, 1e5), sqrt(pow(l, -2) - pow(l, -8)), 1e-11, 0);
}

TEST(test_gent_snaps_through)
{
  struct dea_material m = test_material("gent", 1e5, 90, 0);
  struct record r = trace(&m, 1, 6.5);
  assert_int_equal(r.event_count, 2);
  assert_int_equal(r.events[0].kind, DEA_EVENT_PULL_IN);
  assert_close(field_of(&r.events[0], &m, 1e5), 0.68959, 0, 5e-6);
  assert_close(r.events[0].point.electrode_stretch, 1.2643, 0, 5e-5);
  assert_int_equal(r.events[1].kind, DEA_EVENT_SNAP_BACK);
  assert_close(field_of(&r.events[1], &m, 1e5), 0.28852, 0, 5e-6);
  assert_close(r.events[1].point.electrode_stretch, 4.8216, 0, 5e-5);
  assert_int_equal(r.mode_changes, 2);
  assert_int_equal(r.last_modes, 0);
}

TEST(test_stiff_gent_has_no_limit_and_ends_at_lock_up)
{
  struct dea_material m = test_material("gent", 1e5, 7, 0);
  struct record r = trace(&m, 1, 10); // lock-up: 2 l^2 + l^-4 = 10
  assert_int_equal(r.event_count, 0);
  assert_int_equal(r.mode_changes, 0);
  assert_true(r.last_stretch > 2.2 && r.last_stretch < sqrt(5));
}

TEST(test_table_1_pull_in)
{
  struct dea_material m = test_yeoh();
  struct record r = trace(&m, 1, 2);
  assert_true(r.event_count >= 1);
  assert_int_equal(r.events[0].kind, DEA_EVENT_PULL_IN);
  assert_close(r.events[0].point.voltage_V, 8183, 0, 0.5);
  assert_close(r.events[0].point.electrode_stretch, 1.2668, 0, 5e-5);
}

/* Every point of the traced path lies on the closed form E~^2 = s(l)/(eps l^3). */
static dea_status check_on_curve(void *user, const struct dea_load_point *point)
{
  const struct dea_material *m = user;
  struct dea_plane plane;
  double l = point->electrode_stretch;
  assert_int_equal(dea_plane_elastic(m, l, l, &plane), DEA_OK);
  double eps = DEA_EPSILON_0 * m->permittivity.at_rest;
  double wanted = 100e-6 * sqrt(plane.s1 / (eps * l * l * l));
  assert_close(point->voltage_V, wanted, 1e-9, 1e-3);
  return DEA_OK;
}

TEST(test_points_lie_on_the_closed_form)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_material m = test_yeoh();
  struct free_film free = {.film = {.material = &m, .thickness_m = 100e-6}, .scale_Pa = 3e5};
  const struct dea_path_system system = {
      1, &free, free_evaluate, free_point, dea_film_voltage_scale(&free.film), NULL, 1, 10, "free"};
  const struct dea_path_options options = {
      .max_stretch = 2.5, .max_voltage_V = INFINITY, .max_points = 5000};
  const double start = 1;
  struct dea_model model;
  assert_int_equal(dea_path_create(ctx, &system, &start, &model.path), DEA_OK);
  assert_int_equal(dea_path_trace(ctx, &model, &options, check_on_curve, NULL, &m), DEA_OK);
  dea_path_destroy(ctx, model.path);
  dea_context_destroy(ctx);
}

/* Up to beyond pull-in the film snaps to the far branch, and it comes back only below the valley
 * (peak and valley in closed form). Both are said, and states beyond have a flag. So it is with the
 * voltage the other way round. */
static void seek_with(double sign)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_material m = test_material("gent", 1e5, 90, 0);
  struct free_film free = {.film = {.material = &m, .thickness_m = 100e-6}, .scale_Pa = 1e5};
  double unit_V = dea_film_voltage_scale(&free.film);
  const struct dea_path_system system = {1, &free, free_evaluate, free_point, unit_V, NULL,
                                         1, 10,    "free"};
  const double start = 1;
  struct dea_model model;
  struct dea_load_point p;
  assert_int_equal(dea_path_create(ctx, &system, &start, &model.path), DEA_OK);
  static const struct {
    double field;
    bool far;
    double passed; // field of a limit point on the way; 0: none
  } steps[] = {{0.4, false, 0}, {0.68, false, 0}, {0.70, true, 0.68959},
               {0.5, true, 0},  {0.30, true, 0},  {0.28, false, 0.28852}};
  for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
    size_t told = dea_finding_count(ctx, DEA_WARNING);
    assert_int_equal(dea_path_solve(ctx, &model, sign * steps[i].field * unit_V, &p), DEA_OK);
    const struct dea_event *passed = dea_path_passed(&model);
    assert_int_equal(passed != NULL, steps[i].passed > 0);
    assert_int_equal(dea_finding_count(ctx, DEA_WARNING) - told, passed != NULL);
    if (passed != NULL) {
      assert_int_equal(passed->kind, steps[i].far ? DEA_EVENT_PULL_IN : DEA_EVENT_SNAP_BACK);
      assert_close(passed->point.voltage_V, sign * steps[i].passed * unit_V, 2e-5, 0);
    }
    assert_int_equal(p.own_flags >> DEA_FLAG_STATES & 1, steps[i].far);
    assert_close(p.voltage_V, sign * steps[i].field * unit_V, 1e-12, 0);
    assert_true(p.stable);
    assert_int_equal(p.electrode_stretch > 3, steps[i].far);
  }
  dea_path_destroy(ctx, model.path);
  dea_context_destroy(ctx);
}

TEST(test_seek_snaps_and_shows_hysteresis)
{
  seek_with(1);
  seek_with(-1);
}

TEST(test_seek_beyond_pull_in_keeps_the_last_point)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_material m = test_material("neo-hookean", 1e5, 0, 0);
  struct free_film free = {.film = {.material = &m, .thickness_m = 100e-6}, .scale_Pa = 1e5};
  double unit_V = dea_film_voltage_scale(&free.film);
  const struct dea_path_system system = {1, &free, free_evaluate, free_point, unit_V, NULL,
                                         1, 10,    "free"};
  const double start = 1;
  struct dea_model model;
  struct dea_load_point before, after;
  assert_int_equal(dea_path_create(ctx, &system, &start, &model.path), DEA_OK);
  assert_int_equal(dea_path_seek(ctx, model.path, 0.68 * unit_V, 10), DEA_OK);
  assert_int_equal(dea_path_point(ctx, model.path, &before), DEA_OK);
  assert_null(dea_path_limit(&model));
  assert_int_equal(dea_path_seek(ctx, model.path, 0.69 * unit_V, 10), DEA_E_NO_EQUILIBRIUM);
  const struct dea_event *limit = dea_path_limit(&model);
  assert_non_null(limit); // stretch 2^(1/3), field^2 = l^-2 - l^-8
  double l = pow(2, 1.0 / 3);
  assert_int_equal(limit->kind, DEA_EVENT_PULL_IN);
  assert_close(limit->point.electrode_stretch, l, 1e-7, 0);
  assert_close(limit->point.voltage_V, unit_V * sqrt(pow(l, -2) - pow(l, -8)), 1e-10, 0);
  assert_int_equal(dea_path_point(ctx, model.path, &after), DEA_OK);
  assert_close(after.electrode_stretch, before.electrode_stretch, 0, 0);
  assert_close(after.voltage_V, before.voltage_V, 0, 0);
  dea_path_destroy(ctx, model.path);
  dea_context_destroy(ctx);
}

/* A free film whose tension and breakdown margin vanish just before its limit point. */
static dea_status crowded_point(void *self, const double *u, double voltage_V,
                                struct dea_load_point *out)
{
  dea_status status = free_point(self, u, voltage_V, out);
  out->min_tension_N_per_m = 1.2598 - u[0];
  out->breakdown_margin = 1.2595 - u[0];
  return status;
}

/* Events that share a segment are reported in their order along the path, and none beyond its end.
 */
TEST(test_events_come_in_order)
{
  struct dea_context *ctx;
  assert_int_equal(dea_context_create(NULL, &ctx), DEA_OK);
  struct dea_material m = test_material("neo-hookean", 1e5, 0, 0);
  struct free_film free = {.film = {.material = &m, .thickness_m = 100e-6}, .scale_Pa = 1e5};
  const struct dea_path_system system = {
      1, &free, free_evaluate, crowded_point, dea_film_voltage_scale(&free.film), NULL,
      1, 10,    "free"};
  const double start = 1;
  struct dea_model model;
  assert_int_equal(dea_path_create(ctx, &system, &start, &model.path), DEA_OK);
  static const enum dea_event_kind kinds[] = {DEA_EVENT_BREAKDOWN, DEA_EVENT_SLACK,
                                              DEA_EVENT_PULL_IN};
  static const struct {
    double end;
    size_t events;
  } runs[] = {{1.5, 3}, {1.25985, 2}, {1.2597, 1}, {1.259, 0}};
  for (size_t k = 0; k < sizeof runs / sizeof runs[0]; k++) {
    const struct dea_path_options options = {
        .max_stretch = runs[k].end, .max_voltage_V = INFINITY, .max_points = 5000};
    struct record r = {0};
    assert_int_equal(dea_path_trace(ctx, &model, &options, take_point, take_event, &r), DEA_OK);
    assert_close(r.last_stretch, runs[k].end, 1e-9, 0);
    assert_int_equal(r.event_count, runs[k].events);
    for (size_t i = 0; i < r.event_count; i++) {
      assert_int_equal(r.events[i].kind, kinds[i]);
    }
  }
  dea_path_destroy(ctx, model.path);
  dea_context_destroy(ctx);
}

TESTS(NULL, NULL)
