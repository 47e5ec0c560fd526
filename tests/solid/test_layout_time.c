/* Histories in time of devices of any layout, against closed forms, vibrations, and the disc. */
// ctest: solid
#include "devices.h"
#include "model/model.h"

#include "layout_device.h"

static const double pi = 3.14159265358979323846;

static struct dea_model *model_of(const struct dea_device *device, enum dea_solid_film film)
{
  const struct dea_model_settings settings = {.film = film, .refinement = 1};
  return layout_model(device, &settings);
}

/* From rest as the circuit and inertia say, with a jump of the supply to a voltage. */
static void begin(struct dea_model *model, double resistance_ohm, bool inertia, double voltage_V,
                  struct dea_load_point *point)
{
  const struct dea_model_type *type = dea_model_find("3d");
  const struct dea_time_options options = {
      .circuit = {.series_resistance_ohm = resistance_ohm, .current_limit_A = INFINITY},
      .inertia = inertia,
      .rho_inf = 1};
  const struct dea_time_step jump = {.length_s = 0, .source_voltage_V = voltage_V};
  double error;
  assert_int_equal(type->begin(ctx, model, &options, point), DEA_OK);
  assert_int_equal(type->advance(ctx, model, &jump, point, &error), DEA_OK);
  type->accept(model);
}

/* disconnected: the supply is, at 0 V. */
static void step_of(struct dea_model *model, double step_s, double voltage_V, bool disconnected,
                    struct dea_load_point *point)
{
  const struct dea_model_type *type = dea_model_find("3d");
  const struct dea_time_step forward = {
      .length_s = step_s, .source_voltage_V = voltage_V, .disconnected = disconnected};
  double error;
  assert_int_equal(type->advance(ctx, model, &forward, point, &error), DEA_OK);
  type->accept(model);
}

static void step(struct dea_model *model, double step_s, double voltage_V,
                 struct dea_load_point *point)
{
  step_of(model, step_s, voltage_V, false, point);
}

static const double *first_monitor(struct dea_model *model)
{
  struct dea_observation seen;
  assert_int_equal(dea_model_find("3d")->observe(ctx, model, &seen), DEA_OK);
  return seen.monitor[0];
}

static double current_of_channel_A(struct dea_model *model)
{
  struct dea_observation seen;
  assert_int_equal(dea_model_find("3d")->observe(ctx, model, &seen), DEA_OK);
  return seen.channel[1].current_A;
}

/* What the supply gave and no energy has taken, over what it gave. */
static double unaccounted(const struct dea_load_point *start, const struct dea_load_point *p)
{
  double found = p->stored_energy_J - start->stored_energy_J + p->kinetic_energy_J +
                 p->dissipated_J + p->damped_J;
  return (p->supply_work_J - found) / p->supply_work_J;
}

/* A square of film, side 10 mm, electrodes on it. */
static struct dea_device *square_new(void)
{
  struct dea_device *device = device_new();
  add_rectangle(device, "film", 0, 0, 10e-3, 10e-3);
  add_film(device, 0, 1, 1);
  add_electrodes(device, 0, 0);
  return device;
}

/* The same that is free to move in its plane; a monitor of all of it. */
static struct dea_device *free_square_new(void)
{
  struct dea_device *device = square_new();
  const size_t low = add_rectangle(device, "low", 0, -1e-3, 10e-3, 1e-3);
  const size_t left = add_rectangle(device, "left", -1e-3, 0, 1e-3, 10e-3);
  hold_edge(device, 0, low, 2);
  hold_edge(device, 0, left, 1);
  hold_flat(device, 0);
  add_film_monitor(device);
  return device;
}

/* With one branch G beside mu: after a small step of the voltage the strain eps E^2 / (6 mu) comes
 * up as that of the standard linear solid. */
TEST(test_creep)
{
  struct dea_device *device = free_square_new();
  struct dea_material *film = &device->layout->plies[0].material;
  double mu = 2 * film->param[0], G = 0.5 * mu, time_s = 0.2;
  film->branches[0] = (struct dea_branch){.modulus_Pa = G, .time_s = time_s};
  film->branch_count = 1;
  struct dea_model *model = model_of(device, DEA_FILM_SOLID);
  struct dea_load_point start, point;
  double voltage_V = 400, field = voltage_V / 100e-6;
  double slow = DEA_EPSILON_0 * 2.8 * field * field / (6 * mu), late_s = time_s * (mu + G) / mu;
  begin(model, 0, false, 0, &start);
  begin(model, 0, false, voltage_V, &point);
  enum { STEPS = 20 };
  for (int i = 0; i <= STEPS; i++) {
    double t = 3 * late_s * i / STEPS;
    double strain = slow * (1 - G / (mu + G) * exp(-t / late_s));
    assert_close(first_monitor(model)[DEA_OBSERVED_STRETCH_X] - 1, strain, 2e-3, 0);
    assert_close(first_monitor(model)[DEA_OBSERVED_STRETCH_Y] - 1, strain, 2e-3, 0);
    if (i < STEPS) {
      step(model, 3 * late_s / STEPS, voltage_V, &point);
    }
  }
  assert_true(point.dissipated_J > 0);
  assert_close(unaccounted(&start, &point), 0, 0, 1e-6);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* A neo-Hookean film with a branch whose supply is disconnected after the jump: it creeps at that
 * charge Q to l^6 - 1 = D^2/(eps mu), D = Q over the area at rest; nothing is given or taken. */
TEST(test_disconnected)
{
  struct dea_device *device = free_square_new();
  struct dea_material *film = &device->layout->plies[0].material;
  const double mu = 60e3, eps = DEA_EPSILON_0 * 2.8, voltage_V = 4.6e3;
  film->law = dea_law_find("neo-hookean");
  film->param[0] = mu;
  film->branches[0] = (struct dea_branch){.modulus_Pa = 2 * mu, .time_s = 0.1};
  film->branch_count = 1;
  struct dea_model *model = model_of(device, DEA_FILM_SOLID);
  struct dea_load_point start, point;
  begin(model, 0, false, 0, &start);
  begin(model, 0, false, voltage_V, &start);
  const double charge_C = start.charge_C, stored_J = start.stored_energy_J;
  for (int i = 0; i < 24; i++) {
    step_of(model, i < 14 ? 0.02 : 0.5, 0, true, &point);
    assert_close(point.charge_C, charge_C, 1e-7, 0);
    assert_close(point.supply_work_J, start.supply_work_J, 1e-9, 0);
  }
  const double D = charge_C / 1e-4, l = pow(1 + D * D / (eps * mu), 1.0 / 6);
  assert_true(l > 1.15);
  assert_close(first_monitor(model)[DEA_OBSERVED_STRETCH_X], l, 1e-5, 0);
  assert_close(point.voltage_V, D * 100e-6 / (eps * pow(l, 4)), 1e-5, 0);
  assert_close(point.dissipated_J, stored_J - point.stored_energy_J, 0.05, 0);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Two films that leak in their own ways, all held: a resistance charges them as a capacitor beside
 * a resistor, exactly for steps of any length. */
TEST(test_charging)
{
  static const double per_s[2] = {5, 20}; // conductance over capacitance
  struct dea_device *device = square_new();
  struct dea_layout *l = device->layout;
  double one_F = DEA_EPSILON_0 * 2.8 * 1e-4 / 100e-6, ohm = 1e9, supply_V = 1e3;
  add_film(device, 0, 1, 1);
  l->plies[0].name = "lower";
  add_electrode(device, 1, true, 0, 0);
  for (size_t i = 0; i < 2; i++) {
    l->plies[i].material.resistivity_ohm_m = 1 / (per_s[i] * DEA_EPSILON_0 * 2.8);
  }
  l->supports[l->support_count++] =
      (struct dea_layout_support){.region = 0, .within = DEA_LAYOUT_NONE, .components = 7};
  struct dea_model *model = model_of(device, DEA_FILM_SOLID);
  struct dea_load_point start, point;
  double farad = 2 * one_F, siemens = (per_s[0] + per_s[1]) * one_F;
  double end_V = supply_V / (1 + ohm * siemens), time_s = farad / (1 / ohm + siemens), t = 0;
  begin(model, ohm, false, supply_V, &start);
  for (int i = 0; i < 6; i++) {
    double h = time_s * (0.1 + 0.3 * i);
    step(model, h, supply_V, &point);
    t += h;
    assert_close(point.voltage_V, end_V * (1 - exp(-t / time_s)), 1e-7, 0);
    assert_close(point.charge_C, farad * point.voltage_V, 1e-7, 0);
  }
  assert_close(unaccounted(&start, &point), 0, 0, 0.02); // the loss in long steps
  const double last_V = point.voltage_V;
  step_of(model, 2 * time_s, 0, true, &point);
  assert_close(point.voltage_V, last_V * exp(-2 * time_s * siemens / farad), 1e-7, 0);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* A disc with a branch on a free mesh creeps as that of the model of discs does. */
TEST(test_disc_of_both_models)
{
  struct dea_material film = silicone();
  film.branches[0] = (struct dea_branch){.modulus_Pa = 100e3, .time_s = 0.5};
  film.branch_count = 1;
  struct dea_device plain = test_disc(film, 1.5, 3.75e-3, 0.25, 0);
  struct dea_device *device = disc_new(plain.frame_radius_m, 3.75e-3, 1.5);
  device->layout->plies[0].material = film;
  struct dea_model *blocks = model_of(&plain, DEA_FILM_MEMBRANE);
  struct dea_model *free_mesh = model_of(device, DEA_FILM_MEMBRANE);
  struct dea_load_point of_blocks, of_free;
  begin(blocks, 100e6, false, 4e3, &of_blocks);
  begin(free_mesh, 100e6, false, 4e3, &of_free);
  for (int i = 0; i < 6; i++) {
    step(blocks, 0.1 * (i + 1), 4e3, &of_blocks);
    step(free_mesh, 0.1 * (i + 1), 4e3, &of_free);
    assert_close(first_monitor(free_mesh)[DEA_OBSERVED_X], of_blocks.electrode_edge_u_m, 1e-3, 0);
    assert_close(of_free.capacitance_F, of_blocks.capacitance_F, 1e-4, 0);
    assert_close(of_free.dissipated_J, of_blocks.dissipated_J, 1e-3, 0);
    assert_close(current_of_channel_A(free_mesh), current_of_channel_A(blocks), 1e-3, 0);
  }
  dea_model_find("3d")->destroy(ctx, blocks);
  dea_model_find("3d")->destroy(ctx, free_mesh);
  dea_device_destroy(ctx, device);
}

/* A hub that hangs in a film swings about its new place after a small step of the voltage: half a
 * period of its lowest vibration later it is as far beyond as it was away. */
TEST(test_swing)
{
  enum { STEPS = 24 };
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  l->bodies[0].free = 4;
  l->bodies[0].mass_kg = 20e-3;
  l->gravity_m_per_s2[2] = -DEA_STANDARD_GRAVITY_M_PER_S2;
  struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE);
  struct dea_load_point start, point, mode;
  struct dea_field_mesh *shapes;
  assert_int_equal(type->solve(ctx, model, 500, &point), DEA_OK);
  double there_m = first_monitor(model)[DEA_OBSERVED_Z];
  assert_int_equal(type->modes(ctx, model, &point, 1, &mode, &shapes), DEA_OK);
  dea_field_mesh_destroy(ctx, shapes);
  assert_int_equal(type->solve(ctx, model, 0, &point), DEA_OK);
  double from_m = first_monitor(model)[DEA_OBSERVED_Z];
  double half_s = 0.5 / mode.frequency_Hz;
  begin(model, 0, true, 0, &start);
  begin(model, 0, true, 500, &point);
  for (int i = 1; i <= STEPS; i++) {
    double away = cos(pi * i / STEPS) * (from_m - there_m);
    step(model, half_s / STEPS, 500, &point);
    assert_close(first_monitor(model)[DEA_OBSERVED_Z], there_m + away, 0,
                 0.01 * fabs(from_m - there_m));
  }
  assert_close(unaccounted(&start, &point), 0, 0, 1e-4);
  type->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* ---- electrodes with a sheet resistance ---- */

static const double sheet_ohm = 1e9, line_m = 20e-3;

/* A held strip of film, on its upper face an ideal electrode, 1 mm, and beside it two with a sheet
 * resistance, one fed by the other. */
static struct dea_device *line_new(void)
{
  struct dea_device *device = device_new();
  struct dea_layout *l = device->layout;
  add_rectangle(device, "film", -1e-3, 0, line_m + 1e-3, 4e-3);
  add_rectangle(device, "lead", -1e-3, 0, 1e-3, 4e-3);
  add_rectangle(device, "far", 0.5 * line_m, 0, 0.5 * line_m, 4e-3);
  add_rectangle(device, "near", 0, 0, 0.5 * line_m, 4e-3);
  add_film(device, 0, 1.2, 1.2);
  add_electrode(device, 0, false, 0, 0);
  add_electrode(device, 0, true, 1, 1);
  for (size_t i = 2; i < 4; i++) {
    add_electrode(device, 0, true, i, 1);
    l->electrodes[i].sheet_resistance_ohm = sheet_ohm;
  }
  hold_edge(device, 0, DEA_LAYOUT_NONE, 7);
  return device;
}

/* Capacitance of a film by its area. */
static double per_area(const struct dea_layout_ply *film)
{
  return DEA_EPSILON_0 * film->material.permittivity.at_rest / film->thickness_m;
}

/* The far end of a line of resistance R and capacitance C comes up as
 * 1 - 4/pi sum of (-1)^k/(2k + 1) exp(-((2k + 1) pi/2)^2 t/(R C)). */
TEST(test_line_charges)
{
  enum { STEPS = 18 };
  struct dea_device *device = line_new();
  struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE);
  const double V = 10, time_s = sheet_ohm * per_area(&device->layout->plies[0]) * line_m * line_m;
  struct dea_load_point point;
  double t = 0;
  begin(model, 0, false, V, &point);
  for (int i = 0; i < STEPS; i++) {
    const double h = time_s * (i < 4 ? 5e-3 : 0.06);
    double share = 1;
    step(model, h, V, &point);
    t += h / time_s;
    for (int k = 0; k < 20; k++) {
      const double odd = 2 * k + 1;
      share -= 4 / pi * (k % 2 == 0 ? 1 : -1) / odd * exp(-odd * odd * pi * pi / 4 * t);
    }
    assert_close(point.lowest_voltage_V, i < 4 ? 0 : share * V, 0, 0.01 * V);
  }
  assert_close(point.charge_C,
               per_area(&device->layout->plies[0]) * 4e-3 * V *
                   (1e-3 + line_m * (1 - 8 / pi / pi * exp(-pi * pi / 4 * t))),
               2e-3, 0);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Where the film leaks the far end stays below: V/cosh(L sqrt(R/(rho h))); and what the supply
 * gives is lost. */
TEST(test_line_leaks)
{
  struct dea_device *device = line_new();
  struct dea_layout_ply *film = &device->layout->plies[0];
  film->material.resistivity_ohm_m = sheet_ohm * line_m * line_m / film->thickness_m;
  struct dea_model *model = model_of(device, DEA_FILM_MEMBRANE);
  const double V = 10, long_s = 50 * sheet_ohm * per_area(film) * line_m * line_m;
  struct dea_load_point last, point;
  begin(model, 0, false, V, &point);
  for (int i = 0; i < 3; i++) {
    last = point;
    step(model, long_s, V, &point);
  }
  assert_close(point.lowest_voltage_V, V / cosh(1), 2e-3, 0);
  assert_close(point.current_A, V * 4e-3 / line_m / sheet_ohm * (tanh(1) + 1e-3 / line_m), 2e-3, 0);
  assert_close(point.supply_work_J - last.supply_work_J, V * point.current_A * long_s, 1e-6, 0);
  assert_close(point.dissipated_J - last.dissipated_J, V * point.current_A * long_s, 1e-6, 0);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Lowest and highest voltage on the film as a field. */
static void field_V(struct dea_model *model, double out[2])
{
  struct dea_field_mesh *mesh;
  assert_int_equal(dea_model_find("3d")->fields(ctx, model, DEA_FIELDS_SURFACE, &mesh), DEA_OK);
  const double *V = dea_field_mesh_find(mesh, DEA_VOLTAGE_FIELD)->values;
  const double *r = mesh->X;
  out[0] = INFINITY;
  out[1] = 0;
  for (size_t i = 0; i < mesh->point_count; i++) {
    const bool inside = hypot(r[3 * i], r[3 * i + 1]) < 3.7e-3;
    out[0] = inside ? fmin(out[0], V[i]) : out[0];
    out[1] = fmax(out[1], V[i]);
  }
  dea_field_mesh_destroy(ctx, mesh);
}

/* Both electrodes of a disc are fed along their edge: the voltage at the centre is
 * 1 - sum of 2/(j J_1(j)) exp(-j^2 t/(2 R c a^2)) over the zeros j of J_0. On a ramp of V' each of
 * them loses pi R (c V')^2 a^4/8. */
TEST(test_disc_charges)
{
  enum { STEPS = 30, SUM = 3 };
  static const double zero[SUM] = {2.404825557695773, 5.520078110286311, 8.653727912911013},
                      J1[SUM] = {0.5191474972894669, -0.3402648065583682, 0.2714522999283819};
  struct dea_device disc = test_disc(silicone(), 1.5, 3.75e-3, 0.25, 0);
  disc.sheet_resistance_ohm[0] = disc.sheet_resistance_ohm[1] = sheet_ohm;
  struct dea_model *model = model_of(&disc, DEA_FILM_MEMBRANE);
  const double a = disc.electrode_radius_m,
               c = DEA_EPSILON_0 * disc.film.permittivity.at_rest / disc.film_thickness_m, V = 10,
               time_s = 2 * sheet_ohm * c * a * a;
  struct dea_load_point point, last;
  begin(model, 0, false, V, &point);
  for (int i = 1; i <= STEPS; i++) {
    double share = 1, t = 0.5 * i * i / (STEPS * STEPS);
    step(model, time_s * (t - 0.5 * (i - 1) * (i - 1) / (STEPS * STEPS)), V, &point);
    for (int k = 0; k < SUM; k++) {
      share -= 2 / (zero[k] * J1[k]) * exp(-zero[k] * zero[k] * t);
    }
    assert_close(point.lowest_voltage_V, i > 10 ? share * V : 0, 0, (i > 10 ? 5e-3 : 0.2) * V);
  }
  double range_V[2];
  field_V(model, range_V); // means over elements
  assert_close(range_V[0], point.lowest_voltage_V, 0.02, 0);
  assert_close(range_V[1], V, 0.02, 0);
  const double rate = V / time_s;
  for (int i = 1; i <= 12; i++) {
    last = point;
    step(model, 0.25 * time_s, V + 0.25 * i * V, &point);
  }
  assert_close(point.dissipated_J - last.dissipated_J,
               0.25 * time_s * pi / 4 * sheet_ohm * c * c * rate * rate * a * a * a * a, 5e-3, 0);
  dea_model_find("3d")->destroy(ctx, model);
}

/* A film that moves takes up, with its electrodes, all that the supply gives; where it has charged
 * it is at the equilibrium of ideal electrodes. */
TEST(test_sheet_moves)
{
  struct dea_device disc = test_disc(silicone(), 1.5, 3.75e-3, 0.25, 0);
  disc.sheet_resistance_ohm[1] = sheet_ohm;
  struct dea_model *model = model_of(&disc, DEA_FILM_MEMBRANE);
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_load_point start, point, ideal;
  begin(model, 0, false, 0, &start);
  begin(model, 0, false, 5e3, &point);
  for (int i = 0; i < 24; i++) {
    step(model, 1e-5 * pow(1.4, i), 5e3, &point);
    assert_close(unaccounted(&start, &point), 0, 0, 1e-4);
    assert_true(point.dissipated_J > 0);
  }
  assert_true(isnan(point.capacitance_F));
  assert_int_equal(type->solve(ctx, model, 5e3, &ideal), DEA_OK);
  assert_close(point.electrode_edge_u_m, ideal.electrode_edge_u_m, 1e-3, 0);
  assert_close(point.charge_C, ideal.capacitance_F * 5e3, 1e-3, 0);
  type->destroy(ctx, model);
}

/* What is not known of them is refused. */
TEST(test_sheet_refuses)
{
  struct dea_device disc = test_disc(silicone(), 1.5, 3.75e-3, 0.25, 0);
  disc.sheet_resistance_ohm[1] = sheet_ohm;
  struct dea_model *model = model_of(&disc, DEA_FILM_MEMBRANE);
  const struct dea_model_type *type = dea_model_find("3d");
  const struct dea_time_options slow = {
      .circuit = {.series_resistance_ohm = 1e6, .current_limit_A = INFINITY}, .rho_inf = 1};
  const struct dea_time_step open = {.length_s = 1, .disconnected = true};
  const struct dea_ac_excitation excitation = {.amplitude_V = 1};
  const double frequency_Hz = 100;
  struct dea_load_point point;
  double error;
  assert_int_equal(type->begin(ctx, model, &slow, &point), DEA_E_UNSUPPORTED);
  begin(model, 0, false, 10, &point);
  assert_int_equal(type->advance(ctx, model, &open, &point, &error), DEA_E_UNSUPPORTED);
  assert_int_equal(type->respond(ctx, model, &point, &excitation, &frequency_Hz, 1, &point),
                   DEA_E_UNSUPPORTED);
  type->destroy(ctx, model);
}

TESTS(context_set_up, context_tear_down)
