/* Free meshes by gmsh: a film with an electrode and stiff strips; what is said when gmsh is
 * missing, fails, crashes, hangs, or writes something else. The first are skipped where gmsh is
 * not installed. */
// ctest: slow, heavy
#include "testing.h"

#include "model/solid/mesh/gmsh.h"

#include "own_folder.h"

#include <string.h>

static const double frame = 15e-3, a = 3.75e-3, w = 0.5e-3, pi = 3.14159265358979323846;

static bool has_gmsh(void)
{
  return system("gmsh --version >/dev/null 2>&1") == 0;
}

/* A disc with a hole, an electrode, and strips across, two of one shape; they end beyond the film,
 * where they are film no more. */
static const struct dea_vertex film_vertex[] = {{.x_m = -15e-3, .bulge = 1},
                                                {.x_m = 15e-3, .bulge = 1}};
static const struct dea_vertex hole_vertex[] = {{.x_m = -10e-3, .y_m = 9e-3, .bulge = -1},
                                                {.x_m = -8e-3, .y_m = 9e-3, .bulge = -1}};
static const struct dea_contour film_contours[] = {{film_vertex, 2, true}, {hole_vertex, 2, true}};
static const struct dea_vertex electrode_vertex[] = {{.x_m = -3.75e-3, .bulge = 1},
                                                     {.x_m = 3.75e-3, .bulge = 1}};
static const struct dea_contour electrode = {electrode_vertex, 2, true};
static const struct dea_vertex strip_vertex[] = {
    {.x_m = 3e-3, .y_m = -.25e-3}, {.x_m = 17e-3, .y_m = -.25e-3},  {.x_m = 17e-3, .y_m = .25e-3},
    {.x_m = 3e-3, .y_m = .25e-3},  {.x_m = -17e-3, .y_m = -.25e-3}, {.x_m = -3e-3, .y_m = -.25e-3},
    {.x_m = -3e-3, .y_m = .25e-3}, {.x_m = -17e-3, .y_m = .25e-3}};
static const struct dea_contour strip_contours[] = {{strip_vertex, 4, true},
                                                    {strip_vertex + 4, 4, true}};
static const struct dea_vertex quarter_vertex[] = {{.y_m = -15e-3, .bulge = 0.41421356237309503},
                                                   {.x_m = 15e-3}};
static const struct dea_contour quarter_contour = {quarter_vertex, 2, false};

static const struct dea_gmsh_shape shapes[] = {{"film", film_contours, 2, 0, 0, false},
                                               {"electrode", &electrode, 1, 2e-4, 0, false},
                                               {"strips", strip_contours, 2, 2e-4, 0, false}};
static const struct dea_gmsh_shape quarter = {"quarter", &quarter_contour, 1, 5e-4, 0, false};

static const struct dea_gmsh_plan plan = {.shapes = shapes,
                                          .shape_count = 3,
                                          .curves = &quarter,
                                          .curve_count = 1,
                                          .order = 2,
                                          .size_m = 1.5e-3};

/* Area of a quadrilateral of second order by 3 x 3 Gauss points. */
static double area_of(const struct dea_plane_mesh *mesh, size_t e)
{
  static const double at[3] = {-0.77459666924148338, 0, 0.77459666924148338};
  static const double weight[3] = {5. / 9, 8. / 9, 5. / 9};
  double area = 0;
  for (int q = 0; q < 9; q++) {
    double value[2][3], slope[2][3], map[2][2] = {{0, 0}, {0, 0}};
    for (int i = 0; i < 2; i++) {
      double s = at[i == 0 ? q % 3 : q / 3];
      value[i][0] = 0.5 * s * (s - 1), value[i][1] = 1 - s * s, value[i][2] = 0.5 * s * (s + 1);
      slope[i][0] = s - 0.5, slope[i][1] = -2 * s, slope[i][2] = s + 0.5;
    }
    for (int n = 0; n < 9; n++) {
      const double *x = mesh->x + 2 * mesh->quads[9 * e + (size_t)n];
      for (int c = 0; c < 2; c++) {
        map[0][c] += slope[0][n % 3] * value[1][n / 3] * x[c];
        map[1][c] += value[0][n % 3] * slope[1][n / 3] * x[c];
      }
    }
    area += weight[q % 3] * weight[q / 3] * (map[0][0] * map[1][1] - map[0][1] * map[1][0]);
  }
  return area;
}

static double area_within(const struct dea_plane_mesh *mesh, const char *name)
{
  size_t group = dea_plane_mesh_group(mesh, name);
  double area = 0;
  assert_true(group < mesh->group_count);
  for (size_t e = 0; e < mesh->quad_count; e++) {
    bool in = mesh->within[(size_t)mesh->region[e] * mesh->group_count + group] != 0;
    area += in ? area_of(mesh, e) : 0;
  }
  return area;
}

/* Length by the chords of half sides. */
static double length_of(const struct dea_plane_mesh *mesh, const char *name)
{
  size_t curve = dea_plane_mesh_curve(mesh, name);
  double length = 0;
  assert_true(curve < mesh->curve_count);
  for (size_t i = 0; i < mesh->edge_count; i++) {
    for (size_t k = 0; k < 2 && (size_t)mesh->edge_curve[i] == curve; k++) {
      const double *p = mesh->x + 2 * mesh->edges[3 * i + k];
      const double *q = mesh->x + 2 * mesh->edges[3 * i + k + 1];
      length += hypot(q[0] - p[0], q[1] - p[1]);
    }
  }
  return length;
}

TEST(test_shapes)
{
  if (!has_gmsh()) {
    print_message("gmsh is not installed: skipped\n");
    skip();
  }
  struct dea_plane_mesh *mesh;
  dea_status status = dea_gmsh_mesh(ctx, &plan, &mesh);
  if (status != DEA_OK) {
    fail_msg("%s", dea_context_message(ctx));
  }
  assert_true(dea_plane_mesh_smallest_jacobian(mesh, NULL) > 0.2);
  assert_close(area_within(mesh, "film"), pi * (frame * frame - 1e-6), 2e-4, 0);
  assert_close(area_within(mesh, "electrode"), pi * a * a, 2e-5, 0);
  assert_close(area_within(mesh, "strips"), 2 * 14e-3 * w, 1e-5, 0);
  assert_close(length_of(mesh, "film"), 2 * pi * (frame + 1e-3), 3e-3, 0);
  assert_close(length_of(mesh, "electrode"), 2 * pi * a, 1e-3, 0);
  assert_close(length_of(mesh, "strips"), 4 * (14e-3 + w), 1e-9, 0);
  assert_close(length_of(mesh, "quarter"), 0.5 * pi * frame, 1e-3, 0);
  size_t fine = 0; // sides along the electrode are as fine as they should be
  for (size_t i = 0; i < mesh->edge_count; i++) {
    fine += mesh->edge_curve[i] == 1;
  }
  assert_in_range(fine, (size_t)(0.8 * 2 * pi * a / 2e-4), (size_t)(1.6 * 2 * pi * a / 2e-4));
  dea_plane_mesh_destroy(ctx, mesh);
}

/* Rows on both sides of an electrode's edge and of strips that cross it, none inside the strips:
 * areas and edges stay, and the nodes next to an edge are as far from it as the first row is wide.
 */
TEST(test_rows)
{
  if (!has_gmsh()) {
    skip();
  }
  struct dea_plane_mesh *bare, *mesh;
  struct dea_gmsh_shape layered[] = {shapes[0], shapes[1], shapes[2]};
  struct dea_gmsh_plan other = plan;
  other.shapes = layered;
  layered[1].edge_size_m = layered[2].edge_size_m = 5e-4;
  assert_int_equal(dea_gmsh_mesh(ctx, &other, &bare), DEA_OK);
  layered[1].layer_m = layered[2].layer_m = 6e-5;
  layered[2].rigid = true;
  other.layer_rows = 2;
  assert_int_equal(dea_gmsh_mesh(ctx, &other, &mesh), DEA_OK);
  assert_true(mesh->quad_count > bare->quad_count && mesh->node_count > bare->node_count);
  assert_true(dea_plane_mesh_smallest_jacobian(mesh, NULL) >= 0.1);
  assert_int_equal(mesh->edge_count, bare->edge_count);
  static const char *const names[] = {"film", "electrode", "strips"};
  for (size_t i = 0; i < 3; i++) {
    assert_close(area_within(mesh, names[i]), area_within(bare, names[i]), 1e-5, 0);
    assert_close(length_of(mesh, names[i]), length_of(bare, names[i]), i > 0 ? 1e-9 : 3e-3, 0);
  }
  size_t off = 0, inside[2] = {0};
  for (int rows = 0; rows < 2; rows++) {
    const struct dea_plane_mesh *it = rows ? mesh : bare;
    for (size_t n = 0; n < it->node_count; n++) {
      const double x = fabs(it->x[2 * n]), y = fabs(it->x[2 * n + 1]);
      const bool beside = x > 6e-3 && x < 16e-3;
      off += rows && beside && fabs(y - 0.5 * w - 2e-5) < 1e-9; // a third of the width
      inside[rows] += beside && y < 0.5 * w;
    }
  }
  assert_true(off > 80); // 4 sides of 10 mm by 0.5 mm
  assert_int_equal(inside[0], inside[1]);
  dea_plane_mesh_destroy(ctx, bare);
  dea_plane_mesh_destroy(ctx, mesh);
}

// Faults -----------------------------------------------------------------------------------------

/* A gmsh that is a shell script. */
static void expect(const char *script, const char *message)
{
  struct dea_gmsh_plan other = plan;
  struct dea_plane_mesh *mesh;
  char name[700];
  snprintf(name, sizeof name, "%s", in_folder("fake"));
  FILE *out = fopen(name, "w");
  assert_non_null(out);
  fprintf(out, "#!/bin/sh\n%s\n", script);
  fclose(out);
  assert_int_equal(chmod(name, 0700), 0);
  other.program = name;
  other.time_limit_s = 0.2;
  assert_int_equal(mkdir(in_folder("work"), 0700), 0);
  assert_int_equal(setenv("TMPDIR", in_folder("work"), 1), 0);
  assert_int_equal(dea_gmsh_mesh(ctx, &other, &mesh), DEA_E_TOOL);
  assert_null(mesh);
  assert_int_equal(rmdir(in_folder("work")), 0); // nothing is left in it
  if (strstr(dea_context_message(ctx), message) == NULL) {
    fail_msg("'%s' should hold '%s'", dea_context_message(ctx), message);
  }
  assert_int_equal(dea_finding_count(ctx, DEA_ERROR), 0);
}

TEST(test_faults_of_gmsh)
{
  struct dea_gmsh_plan other = plan;
  struct dea_plane_mesh *mesh;
  other.program = "no-such-gmsh";
  assert_int_equal(dea_gmsh_mesh(ctx, &other, &mesh), DEA_E_TOOL);
  assert_non_null(strstr(dea_context_message(ctx), "apt install gmsh"));
  expect("echo 'Error : Self intersecting surface mesh'; exit 1",
         "gmsh failed (exit code 1); it said last:\nError : Self intersecting surface mesh");
  expect("kill -SEGV $$", "gmsh crashed (signal 11); it said nothing");
  expect("echo meshing; exec sleep 60",
         "gmsh took more than 0.2 s of processor time (or ten times that by the clock) and was "
         "ended; it said last:\nmeshing");
  expect("echo done; echo something >other.tmp", "gmsh wrote no mesh; it said last:\ndone");
  expect("echo hello >mesh.msh", "gmsh made a mesh that cannot be used: this is no .msh file");
  other.size_m = 0;
  assert_int_equal(dea_gmsh_mesh(ctx, &other, &mesh), DEA_E_ARGUMENT);
}

TESTS(set_up, tear_down)
