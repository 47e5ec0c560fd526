#include "model/solid/adapter/buckling_branch.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>

static const double there = 1e-3; // of the film's thickness: on a side, and not flat

struct wanted {
  size_t centre;
  double sign, least_m;
};

static bool on_side(const void *self, const double *displacement_m)
{
  const struct wanted *wanted = self;
  return wanted->sign * displacement_m[3 * wanted->centre + 2] > wanted->least_m;
}

dea_status dea_buckling_branch_take(struct dea_context *ctx, struct dea_solid *solid,
                                    const struct dea_grid *grid, const struct dea_fibre_disc *plate,
                                    size_t centre, enum dea_buckling_branch side,
                                    struct dea_solid_report *report, bool *moved)
{
  const struct wanted wanted = {centre, side == DEA_BRANCH_FIBRES ? 1 : -1,
                                there * plate->film_thickness};
  const double *u = dea_solid_displacement(solid);
  *moved = false;
  if (side == DEA_BRANCH_ANY || on_side(&wanted, u)) {
    return DEA_OK;
  }
  double *push = dea_alloc(ctx, 3 * grid->node_count, sizeof *push);
  if (dea_solid_any(push == NULL)) {
    dea_free(ctx, push);
    return DEA_E_MEMORY;
  }
  // the lowest bending mode of a clamped plate, about as high as the film is thick or as it stands
  double height = wanted.sign * (plate->film_thickness + 2 * fabs(u[3 * centre + 2]));
  for (size_t n = 0; n < grid->node_count; n++) {
    double r = hypot(grid->X[3 * n], grid->X[3 * n + 1]) / plate->electrode_radius;
    push[3 * n + 2] = r < 1 ? height * (1 - r * r) * (1 - r * r) : 0;
  }
  dea_status status = dea_solid_push(ctx, solid, push, on_side, &wanted, report, moved);
  dea_free(ctx, push);
  return status;
}
