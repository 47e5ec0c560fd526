/* Histories in time of devices whose channels have sources of their own (docs/theory/time.md):
 * against histories with one source, equilibria at the same voltages, a symmetry, closed forms. */
// ctest: solid
#include "devices.h"
#include "model/model.h"

#include "layout_device.h"

static const double pi = 3.14159265358979323846;

enum { CHANNELS_MAX = 5 };

/* What a channel plays: mean + amplitude sin(2 pi (t + phase)), in time t of a cycle. */
struct play {
  double mean_V, amplitude_V, phase;
};

static double voltage_of(const struct play *play, double t)
{
  return play->mean_V + play->amplitude_V * sin(2 * pi * (t + play->phase));
}

static struct dea_model *model_of(const struct dea_device *device, enum dea_solid_film film)
{
  const struct dea_model_settings settings = {.film = film, .refinement = 1};
  return layout_model(device, &settings);
}

/* A history whose channels from 1 on have sources. */
struct history {
  const struct dea_model_type *type;
  struct dea_model *model;
  const struct play *plays; // [count - 1] of channels from 1 on
  size_t count;             // of channels, with ground
  bool own[CHANNELS_MAX];
  struct dea_load_point start, point;
};

/* One step of a length to voltages at a time, taken. */
static void go(struct history *h, double length_s, double t)
{
  double own_V[CHANNELS_MAX] = {0}, error;
  for (size_t k = 1; k < h->count; k++) {
    own_V[k] = voltage_of(&h->plays[k - 1], t);
  }
  const struct dea_time_step step = {.length_s = length_s, .source_voltage_V = 0, .own_V = own_V};
  assert_int_equal(h->type->advance(ctx, h->model, &step, &h->point, &error), DEA_OK);
  h->type->accept(h->model);
}

/* From rest, with a jump to the voltages at 0. */
static struct history begin(struct dea_model *model, bool inertia, const struct play *plays,
                            size_t count)
{
  struct history h = {.type = dea_model_find("3d"), .model = model, .plays = plays, .count = count};
  for (size_t k = 1; k < count; k++) {
    h.own[k] = true;
  }
  const struct dea_time_options options = {.circuit = {.current_limit_A = INFINITY},
                                           .own_sources = h.own,
                                           .inertia = inertia,
                                           .rho_inf = 1};
  assert_int_equal(h.type->begin(ctx, model, &options, &h.start), DEA_OK);
  go(&h, 0, 0);
  return h;
}

static struct dea_observation observe(struct dea_model *model)
{
  struct dea_observation seen;
  assert_int_equal(dea_model_find("3d")->observe(ctx, model, &seen), DEA_OK);
  return seen;
}

/* What the sources gave and no energy has taken, over what they gave. */
static double unaccounted(const struct history *h)
{
  const struct dea_load_point *p = &h->point;
  double found = p->stored_energy_J - h->start.stored_energy_J + p->kinetic_energy_J +
                 p->dissipated_J + p->damped_J;
  return (p->supply_work_J - found) / p->supply_work_J;
}

static void end(struct dea_model *model, struct dea_device *device)
{
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Adds a square of viscous film, side 10 mm, free to move in its plane from its corner at x, with
 * electrodes on it and a monitor. */
static void add_square(struct dea_device *device, double x_m, size_t channel)
{
  struct dea_layout *l = device->layout;
  static const char *const names[] = {"a", "b"};
  size_t ply = l->ply_count;
  size_t film = add_rectangle(device, names[ply], x_m, 0, 10e-3, 10e-3);
  size_t low = add_rectangle(device, "low", x_m, -1e-3, 10e-3, 1e-3);
  size_t left = add_rectangle(device, "left", x_m - 1e-3, 0, 1e-3, 10e-3);
  hold_edge(device, film, low, 2);
  hold_edge(device, film, left, 1);
  hold_flat(device, film);
  add_film(device, film, 1, 1);
  l->plies[ply].name = names[ply];
  l->plies[ply].material.branches[0] = (struct dea_branch){.modulus_Pa = 80e3, .time_s = 0.2};
  l->plies[ply].material.branch_count = 1;
  add_electrode(device, ply, false, film, 0);
  add_electrode(device, ply, true, film, channel);
  l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
      .name = names[ply], .kind = DEA_MONITOR_REGION, .ply = ply, .region = film};
}

/* Two films apart with two sources are two devices with one each. */
TEST(test_apart)
{
  static const struct play plays[2] = {{700, 500, 0}, {900, -600, 0.2}};
  struct dea_device *both = device_new(), *one[2];
  struct dea_model *together, *alone[2];
  struct history of_both, of_one[2];
  both->layout->channels[2] = (struct dea_layout_channel){.name = "other", .ratio = 1};
  both->layout->channel_count = 3;
  for (size_t i = 0; i < 2; i++) {
    add_square(both, 20e-3 * (double)i, i + 1);
    one[i] = device_new();
    add_square(one[i], 0, 1);
    alone[i] = model_of(one[i], DEA_FILM_SOLID);
    of_one[i] = begin(alone[i], false, &plays[i], 2);
  }
  together = model_of(both, DEA_FILM_SOLID);
  of_both = begin(together, false, plays, 3);
  for (int n = 1; n <= 10; n++) {
    double work_J = 0, dissipated_J = 0;
    go(&of_both, 0.05, 0.1 * n);
    const struct dea_observation seen = observe(together);
    for (size_t i = 0; i < 2; i++) {
      go(&of_one[i], 0.05, 0.1 * n);
      const struct dea_observation its = observe(alone[i]);
      assert_close(seen.monitor[i][DEA_OBSERVED_STRETCH_X] - 1,
                   its.monitor[0][DEA_OBSERVED_STRETCH_X] - 1, 1e-6, 0);
      assert_close(seen.channel[i + 1].voltage_V, voltage_of(&plays[i], 0.1 * n), 1e-12, 0);
      assert_close(seen.channel[i + 1].charge_C, its.channel[1].charge_C, 1e-8, 0);
      assert_close(seen.channel[i + 1].current_A, its.channel[1].current_A, 1e-7, 0);
      work_J += of_one[i].point.supply_work_J;
      dissipated_J += of_one[i].point.dissipated_J;
    }
    assert_close(of_both.point.supply_work_J, work_J, 1e-7, 0);
    assert_close(of_both.point.dissipated_J, dissipated_J, 1e-5, 0);
  }
  assert_close(unaccounted(&of_both), 0, 0, 1e-3);
  end(together, both);
  end(alone[0], one[0]);
  end(alone[1], one[1]);
}

/* Two films on each other, clamped around, ground below, one channel between them and one on top of
 * a part: their capacitances are coupled, and a bias is on the one between them. */
static struct dea_device *pair_new(double middle_V, double top_V)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  size_t film = add_rectangle(device, "film", 0, 0, 10e-3, 10e-3);
  size_t wide = add_rectangle(device, "wide", 1e-3, 1e-3, 8e-3, 8e-3);
  size_t part = add_rectangle(device, "part", 2e-3, 3e-3, 4e-3, 5e-3);
  add_film(device, film, 1.2, 1.2);
  add_film(device, film, 1.2, 1.2);
  l->plies[1].name = "upper";
  l->channels[1] = (struct dea_layout_channel){.name = "middle", .own_V = middle_V};
  l->channels[2] = (struct dea_layout_channel){.name = "top", .own_V = top_V};
  l->channel_count = 3;
  add_electrodes(device, 0, wide);
  add_electrode(device, 1, true, part, 2);
  hold_edge(device, film, DEA_LAYOUT_NONE, 7);
  l->monitors[l->monitor_count++] = (struct dea_layout_monitor){
      .name = "corner", .kind = DEA_MONITOR_POINT, .ply = 1, .at_m = {{2e-3, 3e-3}}};
  return device;
}

/* Without a memory of the film each moment is the equilibrium at its voltages, and sources and film
 * have the same energy; the account of a step is of second order. */
TEST(test_each_moment)
{
  only_nightly();
  static const struct play plays[2] = {{900, 600, 0}, {-500, 700, 0.4}};
  double missing[2], largest_A = 0;
  for (int fine = 0; fine < 2; fine++) {
    struct dea_device *device = pair_new(0, 0);
    struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE);
    struct history h = begin(model, false, plays, 3);
    int steps = fine == 0 ? 6 : 12;
    for (int n = 1; n <= steps; n++) {
      double t = 0.75 * n / steps;
      go(&h, t, t); // of any length
      go(&h, t, t); // and to the last digit
      if (fine == 0) {
        struct dea_device *still = pair_new(voltage_of(&plays[0], t), voltage_of(&plays[1], t));
        struct dea_model *at_rest = model_of(still, DEA_FILM_MEMBRANE);
        struct dea_load_point point;
        assert_int_equal(h.type->solve(ctx, at_rest, 0, &point), DEA_OK);
        assert_int_equal(h.type->solve(ctx, at_rest, 0, &point), DEA_OK);
        const struct dea_observation a = observe(model), b = observe(at_rest);
        for (int i = 0; i < 2; i++) {
          assert_close(a.monitor[0][i], b.monitor[0][i], 1e-8, 0);
          assert_close(a.channel[i + 1].voltage_V, b.channel[i + 1].voltage_V, 1e-12, 0);
          assert_close(a.channel[i + 1].charge_C, b.channel[i + 1].charge_C, 1e-8, 0);
          largest_A = fmax(largest_A, fabs(a.channel[i + 1].current_A));
          assert_true(isnan(b.channel[i + 1].current_A));
        }
        end(at_rest, still);
      }
    }
    missing[fine] = fabs(unaccounted(&h));
    end(model, device);
  }
  assert_true(largest_A > 0);
  assert_true(missing[0] < 1e-3);
  assert_true(missing[1] < 0.4 * missing[0] || missing[1] < 1e-7);
}

/* Sources that all play the same are one supply, with inertia too. */
TEST(test_as_one_supply)
{
  only_nightly();
  static const struct play plays[1] = {{600, 0, 0}};
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_device *devices[2];
  struct dea_model *models[2];
  for (int i = 0; i < 2; i++) {
    devices[i] = cone_new();
    devices[i]->layout->bodies[0].free = 4;
    devices[i]->layout->bodies[0].mass_kg = 20e-3;
    devices[i]->layout->gravity_m_per_s2[2] = -DEA_STANDARD_GRAVITY_M_PER_S2;
    models[i] = model_of(devices[i], DEA_FILM_MEMBRANE);
  }
  struct history h = begin(models[0], true, plays, 2);
  const struct dea_time_options options = {
      .circuit = {.current_limit_A = INFINITY}, .inertia = true, .rho_inf = 1};
  struct dea_time_step step = {.length_s = 0, .source_voltage_V = 600};
  struct dea_load_point point;
  double error;
  assert_int_equal(type->begin(ctx, models[1], &options, &point), DEA_OK);
  for (int n = 0; n <= 6; n++) {
    assert_int_equal(type->advance(ctx, models[1], &step, &point, &error), DEA_OK);
    type->accept(models[1]);
    step.length_s = 0.004;
    if (n > 0) {
      go(&h, step.length_s, 0);
    }
    const struct dea_observation a = observe(models[0]);
    double z_m = a.monitor[0][DEA_OBSERVED_Z], charge_C = a.channel[1].charge_C;
    double current_A = a.channel[1].current_A;
    const struct dea_observation b = observe(models[1]);
    assert_close(z_m, b.monitor[0][DEA_OBSERVED_Z], 1e-9, 0);
    assert_close(charge_C, b.channel[1].charge_C, 1e-9, 0);
    assert_close(current_A, b.channel[1].current_A, 0, 1e-6 * charge_C / step.length_s);
    assert_close(h.point.kinetic_energy_J, point.kinetic_energy_J, 1e-7, 1e-15);
    assert_close(h.point.supply_work_J, point.supply_work_J, 1e-7, 1e-15);
    assert_close(h.point.stored_energy_J, point.stored_energy_J, 1e-7, 1e-15);
  }
  assert_close(unaccounted(&h), 0, 0, 1e-3);
  end(models[0], devices[0]);
  end(models[1], devices[1]);
}

/* Films that are held leak between their channels: currents G V, the loss V G V of the time. */
TEST(test_leaks)
{
  static const struct play plays[2] = {{1000, 0, 0}, {400, 0, 0}};
  static const double per_s[2] = {5, 20}; // conductance over capacitance
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  size_t film = add_rectangle(device, "film", 0, 0, 10e-3, 10e-3);
  double one_F = DEA_EPSILON_0 * 2.8 * 1e-4 / 100e-6;
  add_film(device, film, 1, 1);
  add_film(device, film, 1, 1);
  l->plies[0].name = "lower";
  for (size_t i = 0; i < 2; i++) {
    l->plies[i].material.resistivity_ohm_m = 1 / (per_s[i] * DEA_EPSILON_0 * 2.8);
  }
  l->channels[2] = (struct dea_layout_channel){.name = "top"};
  l->channel_count = 3;
  add_electrodes(device, 0, film);
  add_electrode(device, 1, true, film, 2);
  l->supports[l->support_count++] =
      (struct dea_layout_support){.region = film, .within = DEA_LAYOUT_NONE, .components = 7};
  struct dea_model *model = model_of(device, DEA_FILM_SOLID);
  struct history h = begin(model, false, plays, 3);
  double time_s = 0.3, lower_A = per_s[0] * one_F * 1000, upper_A = per_s[1] * one_F * 600;
  go(&h, time_s, 0);
  const struct dea_observation seen = observe(model);
  assert_close(seen.channel[1].current_A, lower_A + upper_A, 1e-8, 0);
  assert_close(seen.channel[2].current_A, -upper_A, 1e-8, 0);
  assert_close(seen.channel[0].current_A, -lower_A, 1e-8, 0);
  assert_close(seen.channel[2].charge_C, -one_F * 600, 1e-8, 0);
  assert_close(h.point.dissipated_J, time_s * (1000 * lower_A + 600 * upper_A), 1e-8, 0);
  assert_close(unaccounted(&h), 0, 0, 1e-8);
  end(model, device);
}

/* A bias and a source: afterwards the channels are at what the layout says; and what is refused. */
TEST(test_back_and_refused)
{
  struct dea_device *device = pair_new(800, 0);
  struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE);
  const struct dea_model_type *type = dea_model_find("3d");
  const bool own[3] = {false, false, true};
  struct dea_time_options options = {
      .circuit = {.current_limit_A = INFINITY}, .own_sources = own, .rho_inf = 1};
  const double to_V[3] = {0, 0, 300};
  struct dea_time_step step = {.length_s = 0.1, .source_voltage_V = 0};
  struct dea_load_point point;
  double error;
  assert_int_equal(type->solve(ctx, model, 0, &point), DEA_OK);
  double rest_m = observe(model).monitor[0][DEA_OBSERVED_X];
  assert_int_equal(type->begin(ctx, model, &options, &point), DEA_OK);
  assert_close(observe(model).channel[1].voltage_V, 800, 1e-12, 0);
  assert_int_equal(type->advance(ctx, model, &step, &point, &error), DEA_E_ARGUMENT);
  step.own_V = to_V;
  assert_int_equal(type->advance(ctx, model, &step, &point, &error), DEA_OK);
  type->accept(model);
  assert_close(observe(model).channel[1].voltage_V, 800, 1e-12, 0);
  assert_close(observe(model).channel[2].voltage_V, 300, 1e-12, 0);
  assert_int_equal(type->solve(ctx, model, 0, &point), DEA_OK);
  assert_close(observe(model).channel[2].voltage_V, 0, 0, 1e-12);
  assert_close(observe(model).monitor[0][DEA_OBSERVED_X], rest_m, 1e-7, 0);
  options.circuit.series_resistance_ohm = 1e6;
  assert_int_equal(type->begin(ctx, model, &options, &point), DEA_E_UNSUPPORTED);
  assert_non_null(strstr(dea_context_message(ctx), "ideal"));
  end(model, device);
}

TESTS(context_set_up, context_tear_down)
