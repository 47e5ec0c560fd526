#include "model/solid/model3d/buckling_branch.h"
#include "model/solid/assembly/problem.h"
#include "model/solid/equilibrium/load_steps.h"

#include <math.h>

static const double there = 1e-3; // of the film's thickness: on a side, and not flat

bool dea_film_band_has(const struct dea_film_band *film, double z_m)
{
  return fabs(z_m - film->middle_m) <= 0.5 * film->thickness_m * (1 + 1e-9);
}

struct wanted {
  const struct dea_grid *grid;
  const struct dea_film_band *film;
  double sign, least_m;
};

/* Whether the largest displacement out of the plane is to the side that is wanted: that of the
 * centre is not where a dimple stands in a dome, nor that of the fibres where clamped ends turn
 * them away from it. */
static bool on_side(const void *self, const double *u)
{
  const struct wanted *wanted = self;
  double to_m = 0, from_m = 0;
  for (size_t n = 0; n < wanted->grid->node_count && wanted->grid->column[n] >= 0; n++) {
    double z = wanted->sign * u[3 * n + 2];
    to_m = fmax(to_m, z);
    from_m = fmax(from_m, -z);
  }
  return to_m > fmax(from_m, wanted->least_m);
}

/* Displacement of the film's middle in the column of nodes from n on; *end: behind the column. */
static void find_middle(const struct wanted *wanted, const double *u, size_t n, size_t *end,
                        double middle[3])
{
  const struct dea_grid *grid = wanted->grid;
  size_t low = n, high = n;
  double lowest = INFINITY, highest = -INFINITY;
  for (*end = n; *end < grid->node_count && grid->column[*end] == grid->column[n]; ++*end) {
    double z = grid->X[3 * *end + 2];
    if (dea_film_band_has(wanted->film, z)) {
      low = z < lowest ? *end : low;
      high = z > highest ? *end : high;
      lowest = fmin(lowest, z);
      highest = fmax(highest, z);
    }
  }
  for (size_t i = 0; i < 3; i++) {
    middle[i] = 0.5 * (u[3 * low + i] + u[3 * high + i]);
  }
}

/* What brings the middle of a column of nodes [n, end) from where it is to a height, and leans the
 * column by a factor: 1 leaves it, -1 turns it about. */
static void move_column(const double *u, size_t n, size_t end, const double middle[3],
                        double height_m, double lean, double *out)
{
  for (size_t k = 3 * n; k < 3 * end; k += 3) {
    out[k] = (lean - 1) * (u[k] - middle[0]);
    out[k + 1] = (lean - 1) * (u[k + 1] - middle[1]);
    out[k + 2] = height_m - middle[2];
  }
}

/* What turns each column on the other side about the middle of its film: that goes to its mirror
 * image, and the column leans to the other side with it. */
static void set_push(const struct wanted *wanted, const double *u, double *push)
{
  // nodes of bodies are the last
  for (size_t n = 0, end; n < wanted->grid->node_count && wanted->grid->column[n] >= 0; n = end) {
    double middle[3];
    find_middle(wanted, u, n, &end, middle);
    const double turns = wanted->sign * middle[2] < 0 ? -1 : 1;
    move_column(u, n, end, middle, turns * middle[2], turns, push);
  }
}

dea_status dea_buckling_branch_select(struct dea_context *ctx, struct dea_solid *solid,
                                      const struct dea_grid *grid, const struct dea_film_band *film,
                                      enum dea_buckling_branch side,
                                      struct dea_solid_report *report, bool *moved)
{
  struct wanted wanted = {.grid = grid,
                          .film = film,
                          .sign = side == DEA_BRANCH_FIBRES ? 1 : -1,
                          .least_m = there * film->thickness_m};
  *moved = false;
  if (side == DEA_BRANCH_ANY || on_side(&wanted, dea_solid_displacement(solid))) {
    return DEA_OK;
  }
  double *push = dea_solid_alloc(ctx, 3 * grid->node_count, sizeof *push);
  DEA_TRY_MEMORY(push != NULL);
  set_push(&wanted, dea_solid_displacement(solid), push);
  dea_status status = dea_solid_perturb(ctx, solid, push, on_side, &wanted, report, moved);
  dea_free(ctx, push);
  return status;
}

void dea_buckling_branch_fold(const struct dea_solid *solid, const struct dea_grid *grid,
                              const struct dea_film_band *film, int sign, double *out)
{
  const struct wanted wanted = {.grid = grid, .film = film, .sign = sign};
  const double *u = solid->state.u;
  double h = film->thickness_m;
  for (size_t n = 0, end; n < grid->node_count && grid->column[n] >= 0; n = end) {
    double middle[3];
    find_middle(&wanted, u, n, &end, middle);
    const double far = hypot(middle[2], h);
    move_column(u, n, end, middle, sign * (far - h), sign * middle[2] / far, out);
  }
}
