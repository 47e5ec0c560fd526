/* Model 3d in time: creep to where it comes to rest, also under a tip. */
// ctest: solid
#include "devices.h"
#include "model/model.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

static const struct dea_model_type *type;

/* The paper's film without fibres on a coarse mesh, with a branch of half the law's modulus. */
static struct dea_device viscous_disc(void)
{
  struct dea_device d = test_disc(test_yeoh(), 1.5, 3.75e-3, 0.25, 0);
  d.film.density_kg_per_m3 = 1080;
  d.film.branches[0] = (struct dea_branch){180e3, 0.1};
  d.film.branch_count = 1;
  return d;
}

static struct dea_model *model_create(const struct dea_device *device)
{
  struct dea_model *model;
  type = dea_model_find("3d");
  assert_int_equal(type->create(ctx, device, NULL, &model), DEA_OK);
  return model;
}

static struct dea_load_point begin(struct dea_model *model, double resistance_ohm, bool inertia)
{
  const struct dea_time_options options = {
      .circuit = {resistance_ohm, INFINITY}, .inertia = inertia, .rho_inf = 0.8};
  struct dea_load_point point;
  assert_int_equal(type->begin(ctx, model, &options, &point), DEA_OK);
  return point;
}

/* A trial, which is taken if so wanted. */
static struct dea_load_point go(struct dea_model *model, double step_s, double voltage_V, bool take)
{
  const struct dea_time_step step = {.length_s = step_s, .source_voltage_V = voltage_V};
  struct dea_load_point point;
  double error;
  assert_int_equal(type->advance(ctx, model, &step, &point, &error), DEA_OK);
  if (take) {
    type->accept(model);
  }
  return point;
}

static double balance(const struct dea_load_point *p)
{
  return (p->stored_energy_J + p->dissipated_J + p->kinetic_energy_J + p->damped_J) /
             p->supply_work_J -
         1;
}

/* A ramp to 4 kV and a long hold: the film creeps to where model 3d has its equilibrium. Steps that
 * were tried and dropped leave no trace. */
TEST(test_creep_to_the_equilibrium)
{
  const struct dea_device device = viscous_disc();
  struct dea_load_point ends[2], rest;
  for (int dropped = 0; dropped < 2; dropped++) {
    struct dea_model *model = model_create(&device);
    begin(model, 0, false);
    for (int i = 1; i <= 16; i++) {
      if (dropped) {
        go(model, 0.01, 125.0 * i, false);
        go(model, 0.5, 6e3, false);
      }
      ends[dropped] = go(model, 0.005, 250.0 * i, true);
    }
    assert_close(balance(&ends[dropped]), 0, 0, 1e-3);
    assert_true(ends[dropped].dissipated_J > 4e-3 * ends[dropped].stored_energy_J);
    if (dropped) {
      double soon = ends[1].electrode_edge_u_m;
      for (int i = 0; i < 12; i++) {
        rest = go(model, 0.1, 4e3, true);
      }
      assert_close(rest.time_s, 16 * 0.005 + 12 * 0.1, 1e-12, 0);
      assert_true(rest.electrode_edge_u_m > 1.1 * soon);
      struct dea_load_point still;
      assert_int_equal(type->solve(ctx, model, 4e3, &still), DEA_OK);
      assert_close(rest.electrode_edge_u_m, still.electrode_edge_u_m, 1e-3, 0);
      assert_close(rest.charge_C, rest.capacitance_F * 4e3, 1e-12, 0);
    }
    type->destroy(ctx, model);
  }
  assert_close(ends[1].electrode_edge_u_m, ends[0].electrode_edge_u_m, 1e-7, 0);
  assert_close(ends[1].supply_work_J, ends[0].supply_work_J, 1e-7, 0);
  assert_close(ends[1].dissipated_J, ends[0].dissipated_J, 1e-7, 0);
}

/* A tip that is pressed in first is relieved by the voltage, and stays where it is. */
TEST(test_tip)
{
  const struct dea_device device = viscous_disc();
  const struct dea_probe tip = {
      .shape = DEA_PROBE_SPHERE, .radius_m = 2e-3, .from_fibre_side = true};
  struct dea_model *model = model_create(&device);
  struct dea_load_point first, p;
  assert_int_equal(type->indent(ctx, model, &tip, 0.5e-3, &first), DEA_OK);
  p = begin(model, 0, false);
  assert_close(p.force_N, first.force_N, 1e-6, 0);
  for (int i = 1; i <= 4; i++) {
    p = go(model, 0.01, 1e3 * i, true);
  }
  assert_true(p.force_N < 0.95 * first.force_N);
  assert_close(p.tip_depth_m, 0.5e-3, 1e-12, 0);
  assert_close((p.stored_energy_J - first.energy_J + p.dissipated_J + p.damped_J) / p.supply_work_J,
               1, 5e-3, 0);
  type->destroy(ctx, model);
}

TESTS(context_set_up, context_tear_down)
