/* The actuator with four fibres and without pre-stress buckles to either side: both stable arms,
 * which one follows from 0 V, and where the other ends. Against what tests/prototypes.h has:
 * centre 1.2 mm from its place at 6 kV on the side away from the fibres, which is the one that
 * connects to 0 V; flat until 0.8 to 0.9 kV. */
#include "../tests/prototypes.h"
#include "verify.h"

#include "design/design.h"
#include "model/model.h"
#include "model/solid/actuator/actuator.h"
#include "model/solid/adapter/solid_of_actuator.h"
#include "model/solid/equilibrium/continuation.h"
#include "model/solid/equilibrium/load_steps.h"
#include "study/design_file.h"

extern const struct dea_model_type dea_solid_module;

static struct dea_context *ctx;

static struct dea_design *design;
static struct dea_device *device;

static void device_create(const char *refinement, const char *side)
{
  const struct dea_override slack[] = {{"pre_stretch", "1"},
                                       {"electrodes.diameter", "7.5 mm stretched"},
                                       {"compute.solid.refinement", refinement},
                                       {"compute.solid.buckling_branch", side}};
  verify_ok(ctx, dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", slack,
                                 sizeof slack / sizeof slack[0], &design));
  verify_ok(ctx, dea_device_build(ctx, design, &device));
}

static void device_destroy(void)
{
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

/* ---- arms ---- */

enum { VOLTAGES = 8 };
static const double voltage_kV[VOLTAGES] = {0.5, 1, 1.5, 2, 3, 4, 5, 6};

static void sweep(const char *refinement, const char *side, int count,
                  struct dea_load_point *points)
{
  struct dea_model *model;
  device_create(refinement, side);
  verify_ok(ctx, dea_model_create(ctx, &dea_solid_module, design, device, &model));
  for (int i = 0; i < count; i++) {
    verify_ok(ctx, dea_solid_module.solve(ctx, model, 1e3 * voltage_kV[i], &points[i]));
    verify_absolute("unstable modes", points[i].unstable_modes, 0, 0);
  }
  dea_solid_module.destroy(ctx, model);
  device_destroy();
}

static void arms(const char *refinement, int count)
{
  struct dea_load_point back[VOLTAGES], front[VOLTAGES];
  sweep(refinement, "any", count, back);
  sweep(refinement, "fibres", count, front);
  for (int i = 0; i < count; i++) {
    bool two = front[i].centre_z_m > 0;
    double difference = front[i].energy_J - back[i].energy_J;
    verify_absolute("side that follows from 0 V", back[i].centre_z_m < 0, 1, 0);
    verify_absolute("second state", two, voltage_kV[i] > 0.9, 0);
    printf("| %s | %.1f | %+.4f | ", refinement, voltage_kV[i], 1e3 * back[i].centre_z_m);
    if (two) {
      printf("%+.4f | %+.1e |\n", 1e3 * front[i].centre_z_m, difference / fabs(back[i].energy_J));
    } else {
      puts("| |");
    }
    if (voltage_kV[i] == 6) {
      verify_absolute("centre at 6 kV, mm", 1e3 * back[i].centre_z_m,
                      1e3 * prototype_slack_centre_6kV_m, 0.06);
    }
  }
  fflush(stdout);
}

/* ---- paths ---- */

static struct dea_actuator actuator;
static struct dea_grid *grid;
static struct dea_solid *solid;
static size_t centre;

static void solid_create(const char *refinement)
{
  device_create(refinement, "any");
  const struct dea_model_settings settings = dea_model_settings_of(design);
  verify_ok(ctx, dea_actuator_create(ctx, device, &settings, &actuator));
  verify_ok(ctx, dea_fibre_disc_create(ctx, &actuator.plate, &grid));
  verify_ok(ctx, dea_solid_of_actuator(ctx, &actuator, grid, &solid));
  centre = dea_grid_nearest(grid, (const double[3]){0});
}

static void solid_destroy(void)
{
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  device_destroy();
}

static double centre_mm(void)
{
  return 1e3 * dea_solid_displacement(solid)[3 * centre + 2];
}

static struct dea_solid_continuation *trace_to(double voltage_V)
{
  const struct dea_continuation_options options = {0.05, 0.5, 100e-6};
  struct dea_solid_continuation *trace;
  verify_ok(ctx, dea_solid_continuation_create(ctx, solid, voltage_V, &options, &trace));
  return trace;
}

static void row(const char *refinement, const char *what, double voltage_V, double z_mm,
                const char *modes)
{
  printf("| %s | %s | %.4f | %+.4f | %s |\n", refinement, what, 1e-3 * voltage_V, z_mm, modes);
  fflush(stdout);
}

/* From rest to 2 kV: no limit point, no unstable mode. */
static void path_from_rest(const char *refinement)
{
  struct dea_continuation_point point = {0};
  int unstable = 0, limits = 0;
  solid_create(refinement);
  struct dea_solid_continuation *trace = trace_to(2000);
  while (point.load < 1) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, trace, &point));
    unstable += point.unstable_modes;
    limits += point.passed != DEA_CONTINUATION_NOTHING;
  }
  verify_absolute("critical points from rest", limits, 0, 0);
  verify_absolute("unstable modes from rest", unstable, 0, 0);
  row(refinement, "from 0 V, end", point.voltage_V, centre_mm(), "0 all the way");
  dea_solid_continuation_destroy(ctx, trace);
  solid_destroy();
}

static bool to_fibres(const void *self, const double *displacement_m)
{
  (void)self;
  return displacement_m[3 * centre + 2] > 0;
}

static void push_over(double height_m)
{
  struct dea_solid_report report = {0};
  bool found;
  double *push = dea_alloc(ctx, 3 * grid->node_count, sizeof *push);
  verify_ok(ctx, push != NULL ? DEA_OK : DEA_E_MEMORY);
  for (size_t n = 0; n < grid->node_count; n++) {
    double r = hypot(grid->X[3 * n], grid->X[3 * n + 1]) / actuator.plate.electrode_radius;
    push[3 * n + 2] = r < 1 ? height_m * (1 - r * r) * (1 - r * r) : 0;
  }
  verify_ok(ctx, dea_solid_push(ctx, solid, push, to_fibres, NULL, &report, &found));
  verify_absolute("second state for the path", found, 1, 0);
  dea_free(ctx, push);
}

/* On the other arm from 1.2 kV down, through its limit point, and up on the unstable one. */
static void path_of_other(const char *refinement)
{
  struct dea_continuation_point point = {0}, limit;
  struct dea_solid_report report;
  solid_create(refinement);
  verify_ok(ctx, dea_load_steps_solve(ctx, solid, 1200, &report));
  push_over(450e-6);
  row(refinement, "other arm, start", 1200, centre_mm(), "0");
  struct dea_solid_continuation *trace = trace_to(0);
  while (point.passed != DEA_CONTINUATION_LIMIT) {
    verify_absolute("unstable modes of the other arm", point.unstable_modes, 0, 0);
    verify_ok(ctx, dea_solid_continuation_step(ctx, trace, &point));
  }
  verify_ok(ctx, dea_solid_continuation_locate(ctx, trace, &limit));
  verify_absolute("limit point of the other arm, kV", 1e-3 * limit.voltage_V, 0.85, 0.15);
  row(refinement, "**its limit point**", limit.voltage_V, centre_mm(), "");
  while (point.voltage_V < 1200) {
    verify_ok(ctx, dea_solid_continuation_step(ctx, trace, &point));
    verify_absolute("unstable modes between the arms", point.unstable_modes, 1, 0);
  }
  row(refinement, "between the arms, end", point.voltage_V, centre_mm(), "1 since the limit point");
  dea_solid_continuation_destroy(ctx, trace);
  solid_destroy();
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  verify_ok(ctx, dea_solid_start(ctx));
  puts(
      "# The actuator without pre-stress: two sides\n\n"
      "Made by `scripts/verify branches`; not to be edited. `examples/frdea-4.yaml` with "
      "`pre_stretch: 1` and electrodes of 7.5 mm,\nmodel 3d on a sector: what the paper's finite "
      "elements were run on. Under voltage the film is pushed together and\nbuckles. Fibres lie on "
      "one side, so this is an imperfect pitchfork ([branches.md](../theory/branches.md)). An "
      "independent program (tests/prototypes.h) had\n1.2 mm at 6 kV away "
      "from the fibres, on the arm that connects to "
      "0 V, and a flat film until 0.8 to 0.9 kV.\nTolerances: 5 % of the 1.2 mm; the limit point "
      "between 0.7 and 1 kV; the side and the unstable modes that are said.\n\n"
      "## Stable arms\n\n"
      "Centre of the film, positive to the fibres: sweep from 0 V, and with "
      "`compute.solid.buckling_branch: "
      "fibres`. Energy: by how much\nthat of the second is higher, over that of the first.\n\n"
      "| refinement | kV | from 0 V, mm | the other, mm | energy |\n|---|---|---|---|---|");
  arms("1", small ? 3 : VOLTAGES);
  if (!small) {
    arms("2", VOLTAGES);
    puts("\n## Paths by arc-length\n\n"
         "| refinement | | kV | centre, mm | unstable modes |\n|---|---|---|---|---|");
    path_from_rest("1");
    path_of_other("1");
    path_from_rest("2");
    path_of_other("2");
    puts("\nThe other arm is detached: it ends at its limit point, and no way of the voltage leads "
         "from rest to it. A film gets\nthere by being pushed.");
  }
  dea_solid_stop();
  dea_context_destroy(ctx);
  return verify_end();
}
