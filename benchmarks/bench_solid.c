/* A hexahedron of 27 nodes, film with field, on one core: residual and tangent; and how much less
 * the energy alone takes, of which a line search needs many. */
#include "model/solid/element/hex.h"
#include "timing.h"

#include <string.h>

enum { REPEATS = 500 };

static struct dea_hex_shape shape;
static struct dea_part_material layer;
static double X[DEA_HEX_DOFS_MAX], u[DEA_HEX_DOFS_MAX], pressures[DEA_HEX_PRESSURES_MAX];
static struct dea_element_result result;

static void evaluate(void *user)
{
  enum dea_eval_order level = *(enum dea_eval_order *)user;
  const struct dea_element element = {.basis = &shape};
  const struct dea_element_input in = {
      .part_material = &layer, .X = X, .u = u, .multiplier = pressures, .voltage_V = 4e3};
  for (int i = 0; i < REPEATS; i++) {
    if (dea_hex_evaluate(&element, &in, level, &result) != DEA_OK) {
      abort();
    }
  }
}

int main(void)
{
  layer = (struct dea_part_material){.law = dea_law_find("yeoh"),
                                     .param = {178.4e3, -6e3, 4.2e3},
                                     .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                     .kappa_Pa = 4e7,
                                     .permittivity_F_per_m = 2.5e-11,
                                     .thickness_m = 44e-6};
  if (dea_hex_shape_create(2, 2, &shape) != DEA_OK || dea_part_material_relax(&layer) != DEA_OK) {
    return 1;
  }
  for (int n = 0; n < shape.nodes; n++) {
    for (int i = 0; i < 3; i++) {
      X[3 * n + i] = shape.node_at[n][i] * (i == 2 ? 22e-6 : 100e-6);
      u[3 * n + i] = (i == 2 ? 2e-6 : 1e-5) * (n % 5) * 0.1;
    }
  }
  enum dea_eval_order energy = DEA_ENERGY, force = DEA_FORCE, tangent = DEA_TANGENT;
  double time_s = bench_best_s(evaluate, &tangent, 20);
  bench_print("solid.hex27", REPEATS / time_s, "elements/s");
  bench_print("solid.hex27_energy", bench_best_s(evaluate, &energy, 20) / time_s, "of the tangent");
  bench_print("solid.hex27_force", bench_best_s(evaluate, &force, 20) / time_s, "of the tangent");
  return 0;
}
