/* Model "reduced" of a cone pushed out by a mass against model 3d that it is made of: forces and
 * charges, held-out voltages, the jump and the creep of a viscous film, its file and its C source.
 */
// ctest: solid
#include "model/reduced/reduced.h"

#include "layout_device.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct dea_control hub = {.kind = DEA_CONTROL_CONJUGATE, .component = DEA_OBSERVED_Z};
static const struct dea_model_settings settings = {
    .film = DEA_FILM_MEMBRANE, .refinement = 1, .reduced = {.motion = -1, .voltage_V = 4e3}};

/* A hub of 20 g that may move up and down, of a film with a branch. */
static struct dea_device *hung_new(void)
{
  struct dea_device *device = cone_new();
  struct dea_layout *l = device->layout;
  l->bodies[0].mass_kg = 20e-3;
  l->bodies[0].free = 1 << 2;
  l->gravity_m_per_s2[2] = -9.80665;
  l->plies[0].material.branches[0] = (struct dea_branch){60e3, 0.5};
  l->plies[0].material.branches[1] = (struct dea_branch){30e3, 20};
  l->plies[0].material.branch_count = 2;
  return device;
}

static struct dea_compliance look(struct dea_model *model, double force_N, double voltage_V)
{
  const struct dea_model_type *type = dea_model_find("3d");
  struct dea_load_point at;
  struct dea_compliance out;
  assert_int_equal(type->solve(ctx, model, voltage_V, &at), DEA_OK);
  assert_int_equal(type->move(ctx, model, &hub, force_N, &at), DEA_OK);
  assert_int_equal(type->compliance(ctx, model, &hub, DEA_COMPLIANCE_WITH_MODES, &out), DEA_OK);
  return out;
}

/* Slopes of q and Q by linear answers against equilibria with other forces and voltages. */
TEST(test_compliance)
{
  struct dea_device *device = hung_new();
  struct dea_model *model;
  static const double F = 30e-3, V = 3e3, dF = 2e-3, dV = 40;
  assert_int_equal(dea_model_find("3d")->create(ctx, device, &settings, &model), DEA_OK);
  const struct dea_compliance at = look(model, F, V), less = look(model, F - dF, V),
                              more = look(model, F + dF, V), low = look(model, F, V - dV),
                              high = look(model, F, V + dV);
  assert_close(at.by_force, (more.value - less.value) / (2 * dF), 1e-4, 0);
  assert_close(at.by_voltage, (high.value - low.value) / (2 * dV), 1e-4, 0);
  assert_close(at.charge_by_force, (more.charge_C - less.charge_C) / (2 * dF), 1e-4, 0);
  assert_close(at.charge_by_voltage, (high.charge_C - low.charge_C) / (2 * dV), 1e-4, 0);
  assert_close(at.by_voltage, at.charge_by_force, 1e-7, 0);
  assert_close(at.force, F, 1e-12, 0);
  // one mass on a spring: the film's own is some 60 mg
  const double omega = 2 * acos(-1) * at.modes[0].frequency_Hz;
  assert_close(1 / (at.by_force * omega * omega), 20e-3, 5e-3, 0);
  assert_close(at.modes[0].share, 1, 1e-3, 0);
  dea_model_find("3d")->destroy(ctx, model);
  dea_device_destroy(ctx, device);
}

/* Steps of both models through the same history; the largest difference of z over the stroke. */
static double compare_history(struct dea_model *model[2], const struct dea_time_options *options,
                              const double (*steps)[2], size_t count, double stroke_m)
{
  const struct dea_model_type *type[2] = {dea_model_find("3d"), dea_model_find("reduced")};
  double worst = 0, z[2], stored_J = 0;
  for (size_t i = 0; i <= count; i++) {
    for (int k = 0; k < 2; k++) {
      struct dea_load_point point;
      struct dea_observation seen;
      double error;
      if (i == 0) {
        assert_int_equal(type[k]->solve(ctx, model[k], 1e3, &point), DEA_OK);
        assert_int_equal(type[k]->begin(ctx, model[k], options, &point), DEA_OK);
        stored_J = point.stored_energy_J; // of the last: model reduced
      } else {
        const struct dea_time_step step = {.length_s = steps[i - 1][0],
                                           .source_voltage_V = steps[i - 1][1]};
        assert_int_equal(type[k]->advance(ctx, model[k], &step, &point, &error), DEA_OK);
        type[k]->accept(model[k]);
        if (k == 1 && options->inertia == false) { // what the supply gave is stored or lost
          assert_close(point.supply_work_J, point.stored_energy_J - stored_J + point.dissipated_J,
                       1e-3, 0);
        }
      }
      assert_int_equal(type[k]->observe(ctx, model[k], &seen), DEA_OK);
      z[k] = seen.monitor[0][DEA_OBSERVED_Z];
    }
    worst = fmax(worst, fabs(z[1] - z[0]) / stroke_m);
  }
  return worst;
}

/* C source: its own test, by a compiler. */
static void check_source(const struct dea_reduced_order *order, const struct dea_device *device)
{
  char command[200];
  assert_int_equal(
      dea_reduced_order_export(ctx, order, device, DEA_REDUCED_C, 0, 0, "reduced_cone.c"), DEA_OK);
  snprintf(command, sizeof command,
           "cc -std=c99 -O2 -Wall -Wextra -Werror "
           "-DDEA_REDUCED_TEST reduced_cone.c -o reduced_cone -lm && ./reduced_cone");
  assert_int_equal(system(command), 0); // NOLINT(cert-env33-c): a test of what was written
}

static void check_file(const struct dea_reduced_order *order, const struct dea_device *device)
{
  struct dea_reduced_order *read;
  struct dea_reduced_point a, b;
  assert_int_equal(dea_reduced_order_write(ctx, order, device, "reduced_cone.json"), DEA_OK);
  assert_int_equal(dea_reduced_order_read(ctx, "reduced_cone.json", device, &settings, &read),
                   DEA_OK);
  dea_reduced_at(&order->core, 0.3 * order->force[1], 2345, &a);
  dea_reduced_at(&read->core, 0.3 * order->force[1], 2345, &b);
  assert_memory_equal(&a, &b, sizeof a);
  assert_int_equal(read->core.branch_count, 2);
  dea_reduced_order_destroy(ctx, read);
}

/* The force that holds q changes with V as the charge does with q; one energy. */
static void check_reciprocity(const struct dea_reduced_order *order)
{
  static const double h = 4e-3, weight[] = {-1, 9, -45, 0, 45, -9, 1}; // of the range; over 60 h
  const double dV = h * order->voltage_V[1], V = 0.75 * order->voltage_V[1];
  const double dq = h * order->stroke, q = order->core.middle + 0.2 * order->stroke;
  double by_V = 0, by_q = 0;
  struct dea_reduced_point p = {.force = 0};
  for (int i = 0; i < 7; i++) {
    assert_int_equal(dea_reduced_held(&order->core, q, V + (i - 3) * dV, &p), DEA_REDUCED_OK);
    by_V += weight[i] * p.force / (60 * dV);
    assert_int_equal(dea_reduced_held(&order->core, q + (i - 3) * dq, V, &p), DEA_REDUCED_OK);
    by_q += weight[i] * p.charge_C / (60 * dq);
  }
  assert_close(by_V, -by_q, 1e-10, 0);
  assert_int_equal(dea_reduced_held(&order->core, q, V, &p), DEA_REDUCED_OK);
  assert_close(by_V, -p.by_voltage / p.by_force, 1e-10, 0);
}

/* Film, field, mass, branches and what these have lost, at a voltage and a force that stay. */
static double all_J(const struct dea_reduced_state *s)
{
  return s->at.energy_J + s->branch_J + s->kinetic_J + s->loss_J - s->external_J;
}

/* Free motion after a jump of voltage and force, of a device with a second mode. */
static void check_energy(const struct dea_reduced_order *order)
{
  enum { STEPS = 20000 };
  struct dea_reduced two = order->core;
  struct dea_reduced_state s;
  const double V = 0.7 * order->voltage_V[1], F = 0.1 * order->force[1];
  double largest = 0, worst_J = 0;
  two.mode_count = 2;
  two.modes[0].share = two.modes[0].voltage_share = 0.7;
  two.modes[1] = two.modes[0];
  two.modes[1].share = 0.2;
  two.modes[1].voltage_share = 0.25;
  for (int k = 0; k < 3; k++) {
    two.modes[1].mass[k] *= 0.1;
  }
  assert_int_equal(dea_reduced_begin(&two, 0.6 * V, F, &s), DEA_REDUCED_OK);
  assert_int_equal(dea_reduced_step(&two, &s, 0, V, F, 1, 1, &s), DEA_REDUCED_OK);
  const double begin_J = all_J(&s);
  for (int i = 0; i < STEPS; i++) {
    assert_int_equal(dea_reduced_step(&two, &s, 2e-5, V, F, 1, 1, &s), DEA_REDUCED_OK);
    largest = fmax(largest, s.kinetic_J);
    worst_J = fmax(worst_J, fabs(all_J(&s) - begin_J));
  }
  print_message("energy off by %.1e of the largest kinetic energy; lost: %.2g of it\n",
                worst_J / largest, s.loss_J / largest);
  assert_true(worst_J < 1e-6 * largest && s.loss_J > 0.01 * largest);
}

/* The drive, by a file: a jump to V or a slow rise. What the coordinate may be off by then, over
 * the stroke. */
static dea_status drive(struct dea_reduced_order *order, const struct dea_device *device,
                        double share_off, double V, int steps, double *off)
{
  const struct dea_model_type *type = dea_model_find("reduced");
  const struct dea_time_options fast = {.circuit = {0, INFINITY}, .rho_inf = 0.8, .inertia = true};
  struct dea_model_settings from_file = settings;
  struct dea_model *model;
  struct dea_load_point at;
  dea_status status = DEA_OK;
  double error;
  const double was = order->share_off[0];
  order->share_off[0] = share_off;
  from_file.reduced.file = "reduced_drive.json";
  assert_int_equal(dea_reduced_order_write(ctx, order, device, from_file.reduced.file), DEA_OK);
  order->share_off[0] = was;
  assert_int_equal(type->create(ctx, device, &from_file, &model), DEA_OK);
  assert_int_equal(type->solve(ctx, model, 0, &at), DEA_OK);
  assert_int_equal(type->begin(ctx, model, &fast, &at), DEA_OK);
  for (int k = 1; k <= steps && status == DEA_OK; k++) {
    const struct dea_time_step step = {.length_s = steps > 1 ? 0.02 : 0,
                                       .source_voltage_V = V * k / steps};
    status = type->advance(ctx, model, &step, &at, &error);
    type->accept(model);
  }
  assert_int_equal(type->errors(ctx, model, off), DEA_OK);
  *off = *off / fabs(order->stroke) - order->error;
  type->destroy(ctx, model);
  assert_int_equal(remove(from_file.reduced.file), 0);
  return status;
}

/* A mode whose share is not sure is off by that much of how far it is from its rest: at once by the
 * whole of a jump, which is refused where that is much; hardly where the voltage rises slowly. */
static void check_drive(struct dea_reduced_order *order, const struct dea_device *device)
{
  struct dea_reduced_point rest[2];
  double off;
  dea_reduced_at(&order->core, 0, 0, &rest[0]);
  dea_reduced_at(&order->core, 0, 3e3, &rest[1]);
  assert_int_equal(drive(order, device, 0.04, 3e3, 1, &off), DEA_OK);
  // branches take a fiftieth of the jump
  assert_close(off, 0.04 * fabs((rest[1].q - rest[0].q) / order->stroke), 5e-2, 0);
  assert_int_equal(drive(order, device, 0.06, 4e3, 1, &off), DEA_E_DOMAIN);
  assert_non_null(strstr(dea_context_message(ctx), "faster"));
  dea_context_clear(ctx);
  assert_int_equal(drive(order, device, 0.06, 4e3, 200, &off), DEA_OK);
  assert_true(off < 1e-3);
}

TEST(test_cone)
{
  static const double creep[][2] = {{0, 3.5e3},  {0.1, 3.5e3}, {0.4, 3.5e3}, {2, 3.5e3},
                                    {10, 3.5e3}, {0, 2e3},     {0.5, 2e3},   {5, 2e3}};
  static const double V[] = {300, 1130, 2210, 3330, 3890};
  const struct dea_model_type *type[2] = {dea_model_find("3d"), dea_model_find("reduced")};
  struct dea_device *device = hung_new();
  struct dea_reduced_order *order;
  struct dea_model *model[2];
  assert_int_equal(dea_reduced_order_build(ctx, device, &settings, &order), DEA_OK);
  assert_in_range((int)(1e6 * order->error), 0, 1000); // 1e-3
  check_file(order, device);
  check_source(order, device);
  check_reciprocity(order);
  check_energy(order);
  check_drive(order, device);
  const double stroke_m = fabs(order->stroke);
  struct dea_model_settings from_file = settings;
  from_file.reduced.file = "reduced_cone.json";
  for (int k = 0; k < 2; k++) {
    assert_int_equal(type[k]->create(ctx, device, k == 0 ? &settings : &from_file, &model[k]),
                     DEA_OK);
  }
  for (size_t i = 0; i < sizeof V / sizeof V[0]; i++) {
    struct dea_load_point point[2];
    struct dea_observation seen;
    double z[2];
    for (int k = 0; k < 2; k++) {
      assert_int_equal(type[k]->solve(ctx, model[k], V[i], &point[k]), DEA_OK);
      assert_int_equal(type[k]->observe(ctx, model[k], &seen), DEA_OK);
      z[k] = seen.monitor[0][DEA_OBSERVED_Z];
    }
    assert_close(z[1], z[0], 0, 1e-4 * stroke_m);
    assert_close(point[1].capacitance_F, point[0].capacitance_F, 1e-4, 0);
    assert_close(point[1].energy_J - point[0].energy_J, 0, 0, 1e-4 * fabs(point[0].energy_J));
  }
  const struct dea_time_options slow = {.circuit = {0, INFINITY}, .rho_inf = 0.8};
  const double worst = compare_history(model, &slow, creep, 8, stroke_m);
  print_message("creep within %.1e of the stroke\n", worst);
  assert_in_range((int)(1e6 * worst), 0, 3000);
  static const double swing[][2] = {{0.005, 2e3}, {0.005, 2e3}, {0.005, 2e3}, {0.005, 2e3},
                                    {0.005, 2e3}, {0.005, 2e3}, {0.005, 1e3}, {0.005, 2e3}};
  const struct dea_time_options fast = {.circuit = {0, INFINITY}, .rho_inf = 0.8, .inertia = true};
  const double swung = compare_history(model, &fast, swing, 8, stroke_m);
  print_message("with inertia within %.1e of the stroke\n", swung);
  assert_in_range((int)(1e6 * swung), 0, 3000);
  struct dea_load_point beyond;
  assert_int_equal(type[1]->solve(ctx, model[1], 4.1e3, &beyond), DEA_E_DOMAIN);
  assert_non_null(strstr(dea_context_message(ctx), "outside the range"));
  dea_context_clear(ctx);
  for (int k = 0; k < 2; k++) {
    type[k]->destroy(ctx, model[k]);
  }
  dea_reduced_order_destroy(ctx, order);
  dea_device_destroy(ctx, device);
  static const char *const files[] = {"reduced_cone.json", "reduced_cone.c", "reduced_cone"};
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(remove(files[i]), 0);
  }
}

TESTS(context_set_up, context_tear_down)
