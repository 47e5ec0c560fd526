/* Meshes of actuators: no folded element, no hanging node, exact areas, the right nodes held. */
// ctest: quick, heavy
#include "disc_grid.h"
#include "failing_allocator.h"
#include "model/solid/mesh/cuts.h"
#include "solid_element.h"
#include "testing.h"

#include "context_fixture.h" // after: its context shadows no name of the headers above

#include <stdlib.h>
#include <string.h>

static const double a = 3.75e-3, b = 15e-3, h = 44e-6;

static struct dea_fibre_disc plate(int fibres, double overlap, double width)
{
  struct dea_fibre_disc p = {.order = 2,
                             .order_z = 2,
                             .fibres = fibres,
                             .sectors = 1,
                             .electrode_radius = a,
                             .frame_radius = b,
                             .film_thickness = h,
                             .size = 0.2 * a,
                             .edge = 0.05 * a};
  if (fibres > 0) {
    p.tip_radius = a - overlap;
    p.outer_radius = b;
    p.tip_width = p.outer_width = width;
    p.fibre_thickness = 100e-6;
  }
  return p;
}

static struct dea_layout_mesh mesh; // the last one

static dea_status create(const struct dea_fibre_disc *p, struct dea_grid **out)
{
  dea_status status = disc_mesh(ctx, p, NULL, &mesh);
  *out = mesh.grid;
  return status;
}

static bool is_close(double x, double y)
{
  return fabs(x - y) < 1e-9 * b;
}

/* ---- faces ---- */

struct face {
  int corner[4]; // ascending
  bool open;     // has no second element yet
};

static void sort4(int v[4])
{
  for (int i = 1; i < 4; i++) {
    for (int j = i; j > 0 && v[j - 1] > v[j]; j--) {
      int keep = v[j];
      v[j] = v[j - 1];
      v[j - 1] = keep;
    }
  }
}

static int compare_faces(const void *x, const void *y)
{
  return memcmp(((const struct face *)x)->corner, ((const struct face *)y)->corner,
                4 * sizeof(int));
}

/* Every side face of the film that only one element has lies on the frame or on a mirror plane, and
 * none has three. With order 2 a face is shared as a whole when its corners are. */
static void check_conforming(const struct dea_fibre_disc *p, const struct dea_grid *grid)
{
  static const int sides[4][2] = {{0, 2}, {2, 8}, {8, 6}, {6, 0}}; // corners of the lower face
  struct face *faces = calloc(4 * grid->element_count, sizeof *faces);
  size_t count = 0, open = 0;
  double beta = dea_fibre_disc_angle(p);
  assert_non_null(faces);
  for (size_t e = 0; e < grid->element_count; e++) {
    const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
    for (int k = 0; k < 4 && grid->ply[e] == DISC_FILM; k++) {
      int *corner = faces[count++].corner;
      for (int i = 0; i < 2; i++) {
        corner[i] = nodes[sides[k][i]];
        corner[2 + i] = nodes[(grid->levels[e] == 1 ? 0 : 18) + sides[k][i]];
      }
      sort4(corner);
    }
  }
  qsort(faces, count, sizeof *faces, compare_faces);
  for (size_t i = 0; i < count; i++) {
    bool same_before = i > 0 && compare_faces(&faces[i - 1], &faces[i]) == 0;
    bool same_after = i + 1 < count && compare_faces(&faces[i], &faces[i + 1]) == 0;
    assert_false(same_before && same_after);
    if (same_before || same_after) {
      continue;
    }
    bool frame = true, first = true, last = true;
    for (int c = 0; c < 4; c++) {
      const double *X = grid->X + 3 * faces[i].corner[c];
      frame = frame && is_close(hypot(X[0], X[1]), b);
      first = first && is_close(X[1], 0) && X[0] > -1e-9;
      last = last && is_close(-sin(beta) * X[0] + cos(beta) * X[1], 0);
    }
    bool whole = p->sectors == dea_fibre_disc_sectors(p);
    assert_true(frame || (!whole && (first || last)));
    open++;
  }
  assert_true(open > 2);
  free(faces);
}

/* ---- areas ---- */

static struct dea_hex_shape shape;
static struct dea_face_shape flat;
static struct dea_element_result result;

/* Volume of the elements of a ply whose region has all the bits; flat ones are as thick as the
 * film. */
static double volume(const struct dea_grid *grid, int ply, int bits)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0}, none[DEA_HEX_PRESSURES_MAX] = {0};
  const struct dea_part_material hard = dea_part_material_bonded((const double[]){5.2e5, 0.3});
  const struct dea_part_material film = {.law = dea_law_find("neo-hookean"),
                                         .param = {1e5},
                                         .pre_stretch = {1, 1, 1},
                                         .thickness_m = h};
  double X[DEA_HEX_DOFS_MAX], sum = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    for (int n = 0; n < dea_grid_nodes_of(grid, e); n++) {
      memcpy(X + 3 * n, grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n],
             3 * sizeof(double));
    }
    assert_ok(grid->levels[e] == 1
                  ? evaluate_membrane(&flat, &film, X, rest, 0, DEA_ENERGY, &result)
                  : evaluate_hex(&shape, &hard, X, rest, none, 0, DEA_ENERGY, &result));
    sum += grid->ply[e] == ply && (grid->region[e] & bits) == bits ? result.volume_m3 : 0;
  }
  return sum;
}

/* Half of what a fibre covers between two circles where its half width is y1 and y2: Green's
 * theorem along the axis, the outer arc, the straight edge and the inner arc. */
static double half_strip(double r1, double y1, double r2, double y2)
{
  double x1 = sqrt(r1 * r1 - y1 * y1), x2 = sqrt(r2 * r2 - y2 * y2);
  return 0.5 * (r2 * r2 * asin(y2 / r2) + x2 * y1 - y2 * x1 - r1 * r1 * asin(y1 / r1));
}

static void check_areas(const struct dea_fibre_disc *p, const struct dea_grid *grid,
                        double tolerance)
{
  double beta = dea_fibre_disc_angle(p), whole = 0.5 * beta * h;
  assert_int_equal(dea_hex_shape_create(p->order, p->order_z, &shape), DEA_OK);
  dea_face_shape_create((int[]){p->order, p->order}, DEA_FACE_ELEMENT, &flat);
  assert_close(volume(grid, DISC_FILM, 0), whole * b * b, tolerance, 0);
  assert_close(volume(grid, DISC_FILM, DEA_FIBRE_DISC_ELECTRODE), whole * a * a, tolerance, 0);
  if (p->fibres > 0) {
    double half =
        half_strip(p->tip_radius, 0.5 * p->tip_width, p->outer_radius, 0.5 * p->outer_width);
    double thickness = p->fibre_thickness * p->sectors;
    assert_close(volume(grid, DISC_FIBRES, DEA_FIBRE_DISC_FIBRE), thickness * half, tolerance, 0);
    assert_close(volume(grid, DISC_GLUE, 0), p->glue_thickness * p->sectors * half, tolerance, 0);
  }
}

/* ---- supports ---- */

/* What the sides of a sector hold follows from the place alone; each node that is held is on a
 * side, and each on a side is held across it. */
static void check_held(const struct dea_fibre_disc *p, const struct dea_grid *grid)
{
  double beta = dea_fibre_disc_angle(p);
  bool whole = p->sectors == dea_fibre_disc_sectors(p);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    double Q[9];
    int bits = dea_layout_sector_holds(&mesh.sector, X, mesh.near_m, Q);
    bool first = !whole && is_close(X[1], 0) && X[0] > -1e-9;
    bool last = !whole && is_close(-sin(beta) * X[0] + cos(beta) * X[1], 0) &&
                cos(beta) * X[0] + sin(beta) * X[1] > -1e-9;
    assert_true((bits & 4) == 0 && (first || last || bits == 0));
    // the held components span the normals
    const double normals[2][3] = {{0, 1, 0}, {-sin(beta), cos(beta), 0}};
    for (int k = 0; k < 2; k++) {
      double left[3] = {normals[k][0], normals[k][1], 0};
      for (int i = 0; i < 3; i++) {
        double along = Q[3 * i] * normals[k][0] + Q[3 * i + 1] * normals[k][1];
        for (int c = 0; c < 3 && (bits >> i) & 1; c++) {
          left[c] -= along * Q[3 * i + c];
        }
      }
      assert_true(!(k == 0 ? first : last) || hypot(left[0], left[1]) < 1e-9);
    }
    int held = (bits & 1) + ((bits >> 1) & 1);
    bool parallel = fabs(sin(beta)) < 1e-9;
    assert_int_equal(held, first && last && !parallel ? 2 : first || last ? 1 : 0);
  }
}

static void check(const struct dea_fibre_disc *p, double tolerance)
{
  struct dea_grid *grid;
  assert_int_equal(create(p, &grid), DEA_OK);
  assert_true(dea_grid_smallest_jacobian(grid) > 0.05);
  check_conforming(p, grid);
  check_areas(p, grid, tolerance);
  if (p->sectors == 1 || mesh.sector.fold == 0) {
    check_held(p, grid);
  }
  dea_layout_mesh_free(ctx, &mesh);
}

TEST(test_sectors_of_all_counts)
{
  static const int fibres[] = {0, 1, 2, 3, 4, 5, 6, 8, 12};
  static const double overlap[] = {-1e-3, 0, 0.75e-3};
  for (size_t i = 0; i < sizeof fibres / sizeof fibres[0]; i++) {
    for (size_t k = 0; k < (fibres[i] > 0 ? 3 : 1); k++) {
      struct dea_fibre_disc p = plate(fibres[i], overlap[k], 1e-3);
      check(&p, 1e-4);
      p.sectors = 2;
      check(&p, 1e-4);
    }
  }
}

TEST(test_whole_discs)
{
  static const int fibres[] = {0, 1, 3, 4, 6};
  for (size_t i = 0; i < sizeof fibres / sizeof fibres[0]; i++) {
    struct dea_fibre_disc p = plate(fibres[i], 0.5e-3, 2e-3);
    p.sectors = dea_fibre_disc_sectors(&p);
    check(&p, 1e-4);
  }
}

/* Taper, glue, electrode layers, free ends, hinges, finer meshes; order 3 is far more exact. */
TEST(test_all_that_a_design_can_ask_for)
{
  for (int bits = 0; bits < 64; bits++) {
    struct dea_fibre_disc p = plate(bits & 1 ? 4 : 3, bits & 2 ? 1e-3 : -0.5e-3, 2e-3);
    p.tip_width = bits & 4 ? 0.6e-3 : 2e-3;
    p.glue_thickness = bits & 8 ? 50e-6 : 0;
    p.electrode_thickness = bits & 16 ? 5e-6 : 0;
    p.outer_radius = bits & 32 ? b - 1e-3 : b;
    p.end = bits & 8 ? DEA_FIBRE_DISC_HINGED : DEA_FIBRE_DISC_CLAMPED;
    check(&p, 1e-4);
  }
  struct dea_fibre_disc p = plate(4, 1e-3, 2e-3);
  p.size /= 4;
  p.edge /= 4;
  check(&p, 1e-6);
}

/* ---- plies ---- */

static void heights(const struct dea_grid *grid, int ply, int bits, double *low, double *high)
{
  *low = INFINITY;
  *high = -INFINITY;
  for (size_t e = 0; e < grid->element_count; e++) {
    int nodes = grid->ply[e] == ply && grid->region[e] == bits ? 27 : 0;
    for (int n = 0; n < (nodes > 0 ? dea_grid_nodes_of(grid, e) : 0); n++) {
      double z = grid->X[3 * grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)n] + 2];
      *low = fmin(*low, z);
      *high = fmax(*high, z);
    }
  }
}

/* Over electrodes of 5 um a fibre with 50 um of glue lies on them, and on a filler beside them; a
 * fibre that ends before them lies on the film, and shares no node with the electrode's upper side.
 */
TEST(test_what_fibres_lie_on)
{
  for (int on = 0; on < 2; on++) {
    struct dea_fibre_disc p = plate(4, on ? 1e-3 : 0, 2e-3);
    struct dea_grid *grid;
    double low, high, below = 0.5 * h + (on ? 5e-6 : 0);
    p.glue_thickness = 50e-6;
    p.electrode_thickness = 5e-6;
    assert_int_equal(create(&p, &grid), DEA_OK);
    heights(grid, DISC_BOTTOM, DEA_FIBRE_DISC_ELECTRODE, &low, &high);
    assert_close(low, -0.5 * h - 5e-6, 0, 1e-12);
    assert_close(high, -0.5 * h, 0, 1e-12);
    heights(grid, DISC_TOP, DEA_FIBRE_DISC_ELECTRODE, &low, &high);
    assert_close(low, 0.5 * h, 0, 1e-12);
    assert_close(high, 0.5 * h + 5e-6, 0, 1e-12);
    heights(grid, DISC_TOP, DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_true(on ? low < high : low > high); // the filler
    heights(grid, DISC_GLUE, DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_close(low, below, 0, 1e-12);
    heights(grid, DISC_FIBRES, DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_close(low, below + 50e-6, 0, 1e-12);
    assert_close(high, below + 150e-6, 0, 1e-12);
    dea_layout_mesh_free(ctx, &mesh);
  }
}

/* Elements through the film: as thick as each other at the two faces, twice as thick as the one
 * before; what else a plate has is as it was. At the electrode's edge they are `fringe` wide. */
TEST(test_elements_through_the_film)
{
  for (int through = 1; through <= 5; through++) {
    struct dea_fibre_disc p = plate(4, 0, 2e-3);
    struct dea_grid *grid;
    double cuts[6];
    size_t rings = 0;
    p.through = through;
    p.fringe = through > 1 ? 1e-6 : 0;
    check(&p, 1e-4);
    dea_cuts_through((size_t)through, cuts);
    assert_close(cuts[through], 1, 0, 0);
    for (int k = 0; k < through; k++) {
      assert_close(cuts[k + 1] - cuts[k], cuts[through - k] - cuts[through - k - 1], 1e-12, 0);
      double more = k < (through - 1) / 2 ? 2 : 1; // in the lower half; an even middle repeats
      assert_true(k + 1 > through / 2 ||
                  fabs((cuts[k + 2] - cuts[k + 1]) / (cuts[k + 1] - cuts[k]) - more) < 1e-12);
    }
    assert_int_equal(create(&p, &grid), DEA_OK);
    double low, high;
    heights(grid, DISC_FILM, 0, &low, &high);
    assert_close(low, -0.5 * h, 0, 1e-12);
    assert_close(high, 0.5 * h, 0, 1e-12);
    for (size_t n = 0; n < grid->node_count; n++) { // lowest of the film, on the fibre's axis
      const double *X = grid->X + 3 * n;
      rings += fabs(X[1]) < 1e-9 && fabs(X[2] + 0.5 * h) < 1e-12 && fabs(X[0] - a) < 1.1e-6;
    }
    assert_true(through > 1 ? rings >= 5 : rings == 1); // ends and middle of the two beside it
    dea_layout_mesh_free(ctx, &mesh);
  }
  struct dea_fibre_disc p = plate(4, 0, 2e-3), like = p;
  struct dea_grid *grid;
  p.through = 3;
  like.through = 2;
  assert_int_equal(disc_mesh(ctx, &p, &like, &mesh), DEA_E_ARGUMENT);
  p.through = DEA_FIBRE_DISC_THROUGH_MAX + 1;
  assert_int_equal(create(&p, &grid), DEA_E_ARGUMENT);
}

/* Each bond has a film element as its lower face: the same nodes in the same order. */
static void check_bonds(const struct dea_grid *grid)
{
  size_t bonds = 0, joined = 0;
  for (size_t e = 0; e < grid->element_count; e++) {
    bool bond = grid->ply[e] == DISC_BOND;
    bonds += bond;
    for (size_t f = 0; f < grid->element_count && bond; f++) {
      joined += grid->ply[f] == DISC_FILM &&
                memcmp(grid->nodes + e * DEA_HEX_NODES_MAX, grid->nodes + f * DEA_HEX_NODES_MAX,
                       9 * sizeof(int)) == 0;
    }
  }
  assert_true(bonds > 0 && joined == bonds);
}

/* The film and both electrodes are surfaces at z = 0; the rest is where a solid film has it. */
TEST(test_membranes)
{
  for (int bits = 0; bits < 8; bits++) {
    bool on = bits & 1;
    double t = bits & 2 ? 5e-6 : 0, glue = bits & 4 ? 50e-6 : 0, low, high;
    struct dea_fibre_disc p = plate(bits & 4 ? 3 : 4, on ? 1e-3 : -0.5e-3, 2e-3);
    struct dea_grid *grid;
    p.membrane = true;
    p.electrode_thickness = t;
    p.glue_thickness = glue;
    check(&p, 1e-4);
    assert_int_equal(create(&p, &grid), DEA_OK);
    check_bonds(grid);
    double electrode = 0.5 * dea_fibre_disc_angle(&p) * a * a * h, below = 0.5 * h + (on ? t : 0);
    assert_close(volume(grid, DISC_BOTTOM, 0), t > 0 ? electrode : 0, 1e-4, 0);
    heights(grid, DISC_FILM, 0, &low, &high);
    assert_true(low == 0 && high == 0);
    heights(grid, DISC_BOND, DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_close(low, 0, 0, 0);
    assert_close(high, 0.5 * h, 0, 1e-12);
    heights(grid, DISC_BOND, 0, &low, &high);
    assert_true(low > high);
    heights(grid, DISC_TOP, DEA_FIBRE_DISC_ELECTRODE, &low, &high);
    assert_true(low > high);
    heights(grid, DISC_TOP, DEA_FIBRE_DISC_ELECTRODE | DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_true(on && t > 0 ? fabs(high - low - t) < 1e-12 : low > high);
    heights(grid, DISC_FIBRES, DEA_FIBRE_DISC_FIBRE, &low, &high);
    assert_close(low, below + glue, 0, 1e-12);
    assert_close(high, below + glue + 100e-6, 0, 1e-12);
    dea_layout_mesh_free(ctx, &mesh);
  }
}

/* ---- what cannot be ---- */

static void make_plate(struct dea_context *failing)
{
  struct dea_fibre_disc p = plate(4, 0, 2e-3);
  p.sectors = 8;
  failing_check(failing, disc_mesh(failing, &p, NULL, &mesh));
  dea_layout_mesh_free(failing, &mesh);
}

TEST(test_each_allocation)
{
  assert_true(failing_each(make_plate) > 8);
}

/* Nodes on the axis of a fibre, in the middle of the film, between two radii. */
static int nodes_between(const struct dea_fibre_disc *p, double from, double to)
{
  struct dea_grid *grid;
  int count = 0;
  assert_int_equal(create(p, &grid), DEA_OK);
  for (size_t n = 0; n < grid->node_count; n++) {
    const double *X = grid->X + 3 * n;
    count += fabs(X[1]) < 1e-12 && fabs(X[2]) < 1e-12 && X[0] > from && X[0] < to;
  }
  dea_layout_mesh_free(ctx, &mesh);
  return count;
}

/* Finer inside the circles of electrode and tips, whatever their order, and as before beyond. */
TEST(test_finer_at_tips)
{
  static const int fibres[] = {1, 3, 4, 8};
  static const double overlap[] = {-1e-3, 0, 0.75e-3};
  for (int i = 0; i < 12; i++) {
    struct dea_fibre_disc p = plate(fibres[i % 4], overlap[i / 4], 1e-3), finer = p;
    double edge = fmax(a, p.tip_radius);
    finer.finer_at_tips = 3;
    check(&finer, 1e-4);
    assert_true(nodes_between(&finer, 0.6 * a, edge) > 2 * nodes_between(&p, 0.6 * a, edge));
    assert_true(nodes_between(&finer, 2 * a, b) <= nodes_between(&p, 2 * a, b) + 2);
    finer.sectors = 2;
    check(&finer, 1e-4);
  }
}

TESTS(context_set_up, context_tear_down)
