/* The stable states of the paper's actuator where its film is slack: energies and shapes. The small
 * form: both arms of the film without pre-stretch, against what verify_branches follows by
 * arc-length and from 0 V. */
#include "verify.h"

#include "design/design.h"
#include "model/model.h"
#include "result/result.h"
#include "study/design_file.h"
#include "study/study.h"

extern const struct dea_model_type dea_solid_module;
extern const struct dea_study dea_study_states;

static struct dea_context *ctx;

struct found {
  struct dea_design *design;
  struct dea_device *device;
  struct dea_result *result;
  const struct dea_result_table *table;
};

static struct found find(const struct dea_override *sets, size_t count)
{
  struct found found;
  verify_ok(ctx, dea_design_read(ctx, DEA_SOURCE_DIR "/examples/frdea-4.yaml", sets, count,
                                 &found.design));
  verify_ok(ctx, dea_device_build(ctx, found.design, &found.device));
  verify_ok(ctx, dea_result_create(ctx, found.design, found.device, &found.result));
  verify_ok(ctx, dea_study_states.run(ctx, &(struct dea_study_job){.type = &dea_solid_module,
                                                                   .result = found.result}));
  found.table = dea_result_find_table(found.result, "3d", "states", "found");
  return found;
}

static void release(struct found *found)
{
  dea_result_destroy(ctx, found->result);
  dea_device_destroy(ctx, found->device);
  dea_design_destroy(ctx, found->design);
}

static double number(const struct found *found, size_t row, const char *key)
{
  return dea_result_table_number(found->table, row, key, 0);
}

static const char *text(const struct found *found, size_t row, const char *key)
{
  return dea_result_table_text(found->table, row, key);
}

static void print_rows(const struct found *found)
{
  for (size_t i = 0; i < found->table->row_count; i++) {
    printf("| %.2f | %s | %.4f | %.4f | %.1f | %.1f | %.2f | %+.1f | %+.1f | %s | %s | "
           "%s |\n",
           1e-3 * number(found, i, "voltage_V"), text(found, i, "state"),
           1e6 * number(found, i, "energy_J"), 1e6 * number(found, i, "above_J"),
           1e6 * number(found, i, "centre_z_m"), 1e6 * number(found, i, "fibre_tip_z_m"),
           1e6 * number(found, i, "electrode_edge_u_m"), 1e6 * number(found, i, "highest_z_m"),
           1e6 * number(found, i, "lowest_z_m"), text(found, i, "reached"),
           text(found, i, "leads_up"), text(found, i, "leads_down"));
    verify_absolute("unstable modes", number(found, i, "unstable_modes"), 0, 0);
  }
}

/* ---- without pre-stretch ---- */

/* Centre and energy of both arms at 1 and 2 kV as docs/validation/paper.md has them: the one by a
 * sweep from 0 V, the other by the mirror image of it. */
static void arms(void)
{
  static const struct {
    double kV, centre_um, energy_uJ;
  } wanted[] = {{1, -118, -5.482}, {1, 100, -5.481}, {2, -349, -22.053}, {2, 337, -22.051}};
  const struct dea_override sets[] = {
      {"pre_stretch", "1"},
      {"electrodes.diameter", "7.5 mm stretched"},
      {"compute.states", "{voltage: [0.5 kV, 1 kV, 2 kV], modes: 1, push: [200 um]}"}};
  struct found found = find(sets, sizeof sets / sizeof sets[0]);
  puts("## Without pre-stretch\n\nBoth arms of the buckled film, in brackets those of sweeps.\n\n| "
       "V (kV) | state | energy (uJ) | centre (um) | reached | leads up to | "
       "down to |\n|---|---|---|---|---|---|---|");
  verify_absolute("states without pre-stretch", (double)found.table->row_count, 5, 0);
  for (size_t i = 1; i < 5 && i < found.table->row_count; i++) {
    double centre_um = 1e6 * number(&found, i, "centre_z_m");
    double energy_uJ = 1e6 * number(&found, i, "energy_J");
    printf("| %.0f | %s | %.3f (%.3f) | %+.1f (%+.0f) | %s | %s | %s |\n", wanted[i - 1].kV,
           text(&found, i, "state"), energy_uJ, wanted[i - 1].energy_uJ, centre_um,
           wanted[i - 1].centre_um, text(&found, i, "reached"), text(&found, i, "leads_up"),
           text(&found, i, "leads_down"));
    verify_absolute("voltage", 1e-3 * number(&found, i, "voltage_V"), wanted[i - 1].kV, 1e-9);
    verify_absolute("centre, um", centre_um, wanted[i - 1].centre_um, 0.6);
    verify_absolute("energy, uJ", energy_uJ, wanted[i - 1].energy_uJ, 0.0006);
  }
  puts("\nAt 0.5 kV there is one state; the arm to the fibres goes over to the other one on its "
       "way down to there (its\nlimit point is at 0.89 kV).\n");
  release(&found);
}

/* ---- as built ---- */

static void as_built(void)
{
  static const struct dea_override sets[] = {
      {"compute.states", "{voltage: [7 kV, 7.25 kV, 7.5 kV, 7.75 kV, 8 kV], modes: 3, push: [200 "
                         "um, 400 um]}"}};
  puts("## As built\n\nOn the default mesh.\n\n| V (kV) | state | energy (uJ) | above the lowest | "
       "centre (um) | fibre tip | edge | highest | lowest | reached | leads up to | down to "
       "|\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  struct found found = find(sets, sizeof sets / sizeof sets[0]);
  print_rows(&found);
  puts("\nA letter is a branch. A dent goes to one side, a state with a highest and a lowest place "
       "of like size has waves.\n");
  release(&found);
}

int main(int argc, char **argv)
{
  bool small = verify_is_small(argc, argv);
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  puts("# The states of the slack film\n\nMade by `scripts/verify states`; not to be "
       "edited. What study `states` finds ([theory](../theory/states.md)) for "
       "[frdea-4.yaml](../../examples/frdea-4.yaml),\na sector; every state listed has no unstable "
       "mode.\n");
  arms();
  if (!small) {
    as_built();
  }
  dea_context_destroy(ctx);
  return verify_end();
}
