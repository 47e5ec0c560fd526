#include "cli/cli.h"

#include "model/reduced/reduced.h"

#include <math.h>

struct request {
  const char *design, *output, *files[DEA_REDUCED_FORMATS];
  double bias_V, damping;
  struct cli_overrides overrides;
};

static void print_order(const struct request *request, const struct dea_reduced_order *o,
                        const struct dea_device *device)
{
  const bool turns = dea_reduced_order_turns(o);
  const double display = turns ? 180 / DEA_PI : 1e6;
  struct dea_reduced_point at;
  char name[120];
  dea_reduced_order_name(o, device, name, sizeof name);
  dea_reduced_at(&o->core, 0, 0, &at);
  printf("%-20s %s\n", "coordinate", name);
  printf("%-20s %.4g to %.4g kV\n", "voltage", 1e-3 * o->voltage_V[0], 1e-3 * o->voltage_V[1]);
  printf("%-20s %.4g to %.4g %s\n", turns ? "moment" : "force", 1e3 * o->force[0],
         1e3 * o->force[1], turns ? "mN m" : "mN");
  printf("%-20s %.5g %s\n", "stroke", display * o->stroke, turns ? "degrees" : "um");
  printf("%-20s %.2g %% of the stroke, %.2g %% of the charge\n", "held-out error", 100 * o->error,
         100 * o->charge_error);
  printf("%-20s %.5g %s\n", "stiffness", turns ? 1 / at.by_force : 1e-3 / at.by_force,
         turns ? "N m/rad" : "N/mm");
  for (int i = 0; i < o->core.small_count; i++) {
    const struct dea_reduced_mode *mode = &o->core.modes[i];
    const double x = at.q - o->core.middle;
    printf("%-20s %.5g Hz, %.3g %% of the compliance, %.3g %% of the slope by voltage\n",
           "frequency",
           sqrt(1 / (at.by_force * (mode->mass[0] + x * (mode->mass[1] + x * mode->mass[2])))) /
               (2 * DEA_PI),
           100 * mode->share, 100 * mode->voltage_share);
  }
  printf("%-20s %d\n", "branches", o->core.branch_count);
  printf("%-20s %.3g s\n", "time", o->made_s);
  if (request->output != NULL) {
    printf("%-20s %s\n", "file", request->output);
  }
}

/* All files that are asked for. */
static dea_status write_files(struct dea_context *ctx, const struct request *request,
                              const struct dea_reduced_order *o, const struct dea_device *device)
{
  if (request->output != NULL) {
    DEA_TRY(ctx, dea_reduced_order_write(ctx, o, device, request->output));
  }
  for (int k = 0; k < DEA_REDUCED_FORMATS; k++) {
    if (request->files[k] != NULL) {
      DEA_TRY(ctx, dea_reduced_order_export(ctx, o, device, (enum dea_reduced_format)k,
                                            request->bias_V, request->damping, request->files[k]));
    }
  }
  return DEA_OK;
}

static dea_status build(struct dea_cli *cli, const void *user, const struct dea_design *design,
                        const struct dea_device *device)
{
  const struct request *request = user;
  struct dea_model_settings settings = dea_model_settings_of(design);
  struct dea_reduced_order *order;
  DEA_TRY(cli->ctx, dea_model_check(cli->ctx, dea_model_find("reduced"), design, device));
  dea_status status =
      settings.reduced.file != NULL && request->output == NULL
          ? dea_reduced_order_read(cli->ctx, settings.reduced.file, device, &settings, &order)
          : dea_reduced_order_build(cli->ctx, device, &settings, &order);
  status = status == DEA_OK ? write_files(cli->ctx, request, order, device) : status;
  if (status == DEA_OK) {
    print_order(request, order, device);
  }
  dea_reduced_order_destroy(cli->ctx, order);
  return status;
}

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  return cli_with_device(cli, request->design, &request->overrides, build, request);
}

static const struct cli_option options[] = {
    CLI_DESIGN_ROW,
    CLI_OUTPUT_ROW(CLI_NEW_FILE, "FILE",
                   "write the model as FILE (JSON), for compute.reduced.file"),
    {"c", 0, CLI_NEW_FILE, "FILE", "write it as C99 source, with its test",
     CLI_AT(files[DEA_REDUCED_C])},
    {"fmu", 0, CLI_NEW_FILE, "FILE", "write it as a unit of FMI 3.0 for co-simulation",
     CLI_AT(files[DEA_REDUCED_FMU])},
    {"state-space", 0, CLI_NEW_FILE, "FILE",
     "write A, B, C, D of small motions at the bias (JSON), from voltage and force to displacement "
     "and charge",
     CLI_AT(files[DEA_REDUCED_STATE_SPACE])},
    {"spice", 0, CLI_NEW_FILE, "FILE",
     "write it as a subcircuit dea_film of ngspice: electrodes and displacement, at any voltage",
     CLI_AT(files[DEA_REDUCED_SPICE])},
    {"mujoco", 0, CLI_NEW_FILE, "FILE",
     "write it as a joint with an actuator of MuJoCo (XML), linear about the bias",
     CLI_AT(files[DEA_REDUCED_MUJOCO])},
    {"bias", 0, CLI_TEXT, "V",
     "voltage of state space, actuator and --damping, as '3 kV'; 0 if not given", CLI_AT(bias_V),
     cli_parse_quantity, .measure = {"V", "3 kV"}},
    {"damping", 0, CLI_TEXT, "RATIO", "of the critical damping of each mode, as 0.02",
     CLI_AT(damping), cli_parse_quantity, .measure = {"1", "0.02"}},
    CLI_SET_ROW('s', CLI_KEY, "compute.reduced.monitor=hub"),
    {0}};

const struct dea_command cmd_reduce_order = {
    .name = "reduce-order",
    .summary = "Make a fast model of a device from 3D: one coordinate, its force and the charge",
    .about = "Model 3d is solved at voltages and forces along one coordinate, a monitor of the "
             "design. The result has one energy, so that force and charge are reciprocal, mass, "
             "viscous branches, its range and its error at samples that were left out. "
             "`dea run --model reduced` uses it: sweep, transient, frequency.",
    CLI_RUN};
