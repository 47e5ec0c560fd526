/* Displacements of one mesh at the nodes of another: fields that both can have come out the same,
 * of any order, of films with and without thickness, across curved edges that the two cut in other
 * ways; what is outside is said. */
#include "model/solid/mesh/transfer.h"
#include "quarter_grid.h"

#include "message_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>

static const double a_m = 4e-3, b_m = 10e-3;

static struct dea_grid *quarter(int order, int order_z, size_t fine, bool membrane)
{
  const struct dea_quarter q = {.order = order,
                                .order_z = order_z,
                                .a = a_m,
                                .b = b_m,
                                .film_thickness = 44e-6,
                                .fibres = 8,
                                .fibre_width = 0.5e-3,
                                .fibre_thickness = 80e-6,
                                .fine = fine,
                                .across = 1,
                                .edge = 0.2e-3,
                                .membrane = membrane};
  struct dea_grid *grid;
  assert_int_equal(dea_grid_quarter(ctx, &q, &grid), DEA_OK);
  return grid;
}

/* A displacement that is linear in the plane and through the thickness [m]. */
static void linear(const double X[3], double u[3])
{
  u[0] = 1e-5 + 0.2 * X[0] - 0.1 * X[1] + 0.3 * X[2];
  u[1] = -2e-5 + 0.05 * X[0] + 0.15 * X[1];
  u[2] = 3e-5 - 0.4 * X[0] + 0.02 * X[1] - 0.2 * X[2];
}

/* Largest difference from the field at nodes of the other mesh [m], and how many of them are off by
 * more than rounding. */
static double difference(const struct dea_grid *from, const struct dea_grid *to, size_t *off)
{
  double *u = calloc(3 * from->node_count, sizeof *u), *v = calloc(3 * to->node_count, sizeof *v);
  double most = 0;
  *off = 0;
  assert_true(u != NULL && v != NULL);
  for (size_t n = 0; n < from->node_count; n++) {
    linear(from->X + 3 * n, u + 3 * n);
  }
  assert_int_equal(dea_grid_transfer(ctx, from, u, to, v), DEA_OK);
  for (size_t n = 0; n < to->node_count; n++) {
    double exact[3], worst = 0;
    linear(to->X + 3 * n, exact);
    for (int c = 0; c < 3; c++) {
      worst = fmax(worst, fabs(v[3 * n + (size_t)c] - exact[c]));
    }
    *off += worst > 1e-14;
    most = fmax(most, worst);
  }
  free(u);
  free(v);
  return most;
}

/* Coarse to fine and back: only nodes on circles that the other mesh cuts short are off, and by no
 * more than that cut (of a chord, or of a parabola through three points) times the gradient. */
TEST(test_linear)
{
  static const struct {
    int order, order_z, other, other_z;
    bool membrane;
  } pairs[] = {{2, 2, 2, 2, false}, {3, 1, 2, 2, false}, {1, 2, 3, 3, false}, {2, 2, 2, 2, true}};
  for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
    struct dea_grid *coarse = quarter(pairs[i].order, pairs[i].order_z, 3, pairs[i].membrane);
    struct dea_grid *fine = quarter(pairs[i].other, pairs[i].other_z, 5, pairs[i].membrane);
    size_t off;
    const double half = 3.14159265358979323846 / 24; // of the coarser elements on the frame
    double cut = pairs[i].order == 1 ? b_m * (1 - cos(half)) : b_m * pow(half, 4) / 8;
    assert_true(difference(coarse, fine, &off) < 0.5 * cut);
    assert_true(off < fine->node_count / 20);
    assert_true(difference(fine, coarse, &off) < 0.5 * cut);
    dea_grid_destroy(ctx, coarse);
    dea_grid_destroy(ctx, fine);
  }
}

TEST(test_outside)
{
  struct dea_grid *grid = quarter(2, 2, 3, false), *other = quarter(2, 2, 3, false);
  double *u = calloc(3 * grid->node_count, sizeof *u);
  assert_non_null(u);
  other->X[0] = -b_m;
  assert_message(dea_grid_transfer(ctx, grid, u, other, u), DEA_E_ARGUMENT,
                 "mm is outside of the other mesh");
  free(u);
  dea_grid_destroy(ctx, grid);
  dea_grid_destroy(ctx, other);
}

TESTS(context_set_up, context_tear_down)
