/* The stable states of the paper's actuator where its film is slack: energies and shapes. The small
 * form: both arms of the film without pre-stretch, against what verify_branches follows by
 * arc-length and from 0 V. */
#include "verify.h"

#include "design/design.h"
#include "model/model.h"
#include "result/result.h"
#include "result/richardson.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>

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
  verify_ok(ctx, dea_study_states.run(ctx, &dea_solid_module, NULL, found.result));
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
  const struct dea_result_table_type *type = &found->table->type;
  size_t i = 0;
  while (strcmp(type->columns[i].key, key) != 0) {
    i++;
  }
  return dea_result_table_cell(found->table, row, i)->text;
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

/* Letter of the state of a row, on that mesh too. */
static bool stays(const struct found *meshes, size_t row)
{
  return strcmp(text(meshes, row, "state"), text(meshes, row, "is")) == 0;
}

/* Energies above the lowest state of the same mesh, and shapes, from mesh to mesh. */
static void print_meshes(const struct found *meshes)
{
  puts("| V (kV) | state | refinement | unknowns | energy (uJ) | above the lowest | centre (um) | "
       "fibre tip | edge | highest | lowest |\n|---|---|---|---|---|---|---|---|---|---|---|");
  for (size_t i = 0; i < meshes->table->row_count; i++) {
    const char *is = text(meshes, i, "is");
    if (stays(meshes, i) && number(meshes, i, "refinement") < 2.5) {
      continue; // the second table has these
    }
    printf("| %.2f | %s%s%s | %g | %.0f ", 1e-3 * number(meshes, i, "voltage_V"),
           text(meshes, i, "state"), stays(meshes, i) ? "" : " > ", stays(meshes, i) ? "" : is,
           number(meshes, i, "refinement"), number(meshes, i, "unknowns"));
    if (strcmp(is, "-") == 0) {
      puts("| lost | | | | | | |");
    } else {
      printf("| %.4f | %.4f | %.1f | %.1f | %.2f | %+.1f | %+.1f |\n",
             1e6 * number(meshes, i, "energy_J"), 1e6 * number(meshes, i, "above_J"),
             1e6 * number(meshes, i, "centre_z_m"), 1e6 * number(meshes, i, "fibre_tip_z_m"),
             1e6 * number(meshes, i, "electrode_edge_u_m"), 1e6 * number(meshes, i, "highest_z_m"),
             1e6 * number(meshes, i, "lowest_z_m"));
    }
  }
}

/* Rows of a table of meshes come state by state, each on all of them. */
enum { MESHES = 4 };

/* A number of a state on the last three meshes, and what the last one is off by. of: the first row
 * of a state from which it counts; none: it stands for itself. */
static const size_t none = (size_t)-1;

static void print_limit(const struct found *meshes, size_t first, size_t of, const char *key)
{
  double refinement[MESHES], values[MESHES], errors[MESHES], order, limit;
  size_t count = 0;
  for (size_t m = 0; m < MESHES; m++) {
    if (stays(meshes, first + m) && (of == none || stays(meshes, of + m))) {
      refinement[count] = number(meshes, first + m, "refinement");
      values[count++] =
          1e6 * (number(meshes, first + m, key) - (of == none ? 0 : number(meshes, of + m, key)));
    }
  }
  if (count < 3) {
    printf("| - ");
    return;
  }
  bool observed =
      dea_richardson(refinement, values, count, &order, &limit, errors) == DEA_ORDER_OBSERVED;
  printf("| %.3f, %.3f, %.3f +- %.3f%s ", values[count - 3], values[count - 2], values[count - 1],
         errors[count - 1] * fabs(observed ? limit : values[count - 1]), observed ? "" : "*");
}

static void print_limits(const struct found *meshes)
{
  puts("\n| V (kV) | state | above the lowest (uJ) | centre (um) | fibre tip | edge | lowest "
       "|\n|---|---|---|---|---|---|---|");
  for (size_t first = 0, lowest = 0; first < meshes->table->row_count; first += MESHES) {
    if (first == 0 || number(meshes, first, "voltage_V") != number(meshes, lowest, "voltage_V")) {
      lowest = first;
    }
    if (!stays(meshes, first + MESHES - 1)) {
      continue;
    }
    printf("| %.2f | %s ", 1e-3 * number(meshes, first, "voltage_V"), text(meshes, first, "state"));
    print_limit(meshes, first, lowest, "energy_J");
    static const char *const keys[] = {"centre_z_m", "fibre_tip_z_m", "electrode_edge_u_m",
                                       "lowest_z_m"};
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
      print_limit(meshes, first, none, keys[k]);
    }
    puts("|");
  }
}

static void as_built(void)
{
  static const struct dea_override sets[] = {
      {"compute.states", "{voltage: [7 kV, 7.25 kV, 7.5 kV, 7.75 kV, 8 kV], modes: 3, push: [200 "
                         "um, 400 um], relaxed: no}"}};
  puts("## As built\n\nOn the default mesh.\n\n| V (kV) | state | energy (uJ) | above the lowest | "
       "centre (um) | fibre tip | edge | highest | lowest | reached | leads up to | down to "
       "|\n|---|---|---|---|---|---|---|---|---|---|---|---|");
  struct found found = find(sets, sizeof sets / sizeof sets[0]);
  print_rows(&found);
  puts("\nA letter is a branch. A dent goes to one side, a state with a highest and a lowest place "
       "of like size has waves.\n");
  release(&found);
}

/* States at voltages, on four meshes each. */
static void carry(const char *states)
{
  const struct dea_override sets[] = {{"compute.states", states}};
  struct found found = find(sets, 1);
  const struct found meshes = {.table =
                                   dea_result_find_table(found.result, "3d", "states", "meshes")};
  print_meshes(&meshes);
  puts("\nHow that goes on: energy above the state that is listed first, and shape, on the last "
       "three meshes, and the\nestimated error of the last one by their order or, where they show "
       "none (*), three times the last change.");
  print_limits(&meshes);
  release(&found);
}

static void finer(void)
{
  puts("## On meshes that are finer where the film is slack\n"
       "\n"
       "States at voltages, each transferred from mesh to mesh (`compute.states: {refined: "
       "tips}`): on the finest, and where one becomes\n"
       "another (after the arrow) or is lost (no equilibrium, by itself or along its branch).\n");
  carry("{voltage: [7.25 kV, 7.5 kV, 8 kV], modes: 3, push: [400 um], refined: tips, refinement: "
        "[1.5, 2, "
        "2.5], relaxed: no}");
  puts("\nAt 7 kV by itself, whose letters are its own:\n");
  carry("{voltage: [7 kV], modes: 3, push: [200 um, 400 um], refined: tips, refinement: [1.5, 2, "
        "2.5], relaxed: no}");
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
    finer();
  }
  dea_context_destroy(ctx);
  return verify_end();
}
