/* Free plane meshes: files of Gmsh read, what is wrong with them said, and extruded. */
#include "failing_allocator.h"
#include "message_fixture.h"
#include "model/solid/mesh/grid.h"
#include "model/solid/mesh/msh_read.h"

#include <stdio.h>
#include <stdlib.h>

#define CASES DEA_SOURCE_DIR "/tests/cases/drawings/msh/"
#define SEEDS DEA_SOURCE_DIR "/tests/fuzz/seeds/msh/"

/* Two squares of 1 mm side by side, the second one written clockwise. */
static struct dea_plane_mesh *two_squares(const char *file)
{
  struct dea_plane_mesh *mesh;
  dea_status status = dea_msh_read(ctx, file, 1e-3, &mesh);
  assert_ok(status);
  return mesh;
}

static void check_squares(const struct dea_plane_mesh *mesh)
{
  static const double side[3] = {0, 0.5e-3, 1e-3};
  assert_int_equal(mesh->order, 2);
  assert_int_equal(mesh->quad_count, 2);
  assert_int_equal(mesh->node_count, 15);
  assert_close(dea_plane_mesh_smallest_jacobian(mesh, NULL), 1, 1e-12, 0);
  for (size_t e = 0; e < 2; e++) { // each node at its place, in tensor order, counter-clockwise
    const int *quad = mesh->quads + 9 * e;
    const double *low = mesh->x + 2 * quad[0], *next = mesh->x + 2 * quad[1];
    bool swapped = next[0] - low[0] < 1e-9; // its first axis is y, then the second is -x
    double sign = swapped ? -1 : 1;
    for (int n = 0; n < 9; n++) {
      const double *x = mesh->x + 2 * quad[n];
      assert_close(x[0] - low[0], swapped ? sign * side[n / 3] : side[n % 3], 0, 1e-15);
      assert_close(x[1] - low[1], swapped ? side[n % 3] : side[n / 3], 0, 1e-15);
    }
  }
}

static void names_of(const struct dea_plane_mesh *mesh)
{
  size_t film = dea_plane_mesh_group(mesh, "film"), rim = dea_plane_mesh_curve(mesh, "rim");
  size_t electrode = dea_plane_mesh_group(mesh, "electrode");
  size_t left = dea_plane_mesh_curve(mesh, "left"), on_rim = 0, on_left = 0;
  assert_int_equal(mesh->group_count, 2);
  assert_int_equal(mesh->curve_count, 2);
  assert_int_equal(dea_plane_mesh_group(mesh, "rim"), SIZE_MAX);
  for (size_t e = 0; e < 2; e++) {
    const unsigned char *within = mesh->within + 2 * (size_t)mesh->region[e];
    const double *middle = mesh->x + 2 * mesh->quads[9 * e + 4];
    assert_int_equal(within[film], 1);
    assert_int_equal(within[electrode], middle[0] < 1e-3);
  }
  for (size_t i = 0; i < mesh->edge_count; i++) {
    const int *edge = mesh->edges + 3 * i;
    bool is_left = (size_t)mesh->edge_curve[i] == left;
    on_rim += (size_t)mesh->edge_curve[i] == rim;
    for (int c = 0; c < 2; c++) { // the middle node is in the middle
      assert_close(mesh->x[2 * edge[1] + c],
                   0.5 * (mesh->x[2 * edge[0] + c] + mesh->x[2 * edge[2] + c]), 0, 1e-15);
    }
    const double *from = mesh->x + 2 * edge[0], *to = mesh->x + 2 * edge[2];
    on_left += is_left;
    assert_true((from[0] == 0 && to[0] == 0) || (!is_left && from[1] == 0 && to[1] == 0));
  }
  assert_int_equal(on_rim, 3); // the left side is on both
  assert_int_equal(on_left, 1);
}

/* The same mesh in both formats; 2.2 says twice what is in two groups, and has an element of 8
 * nodes. */
TEST(test_both_formats)
{
  static const char *const files[] = {SEEDS "two-squares-41.msh", SEEDS "two-squares-22.msh"};
  for (int i = 0; i < 2; i++) {
    struct dea_plane_mesh *mesh = two_squares(files[i]);
    check_squares(mesh);
    names_of(mesh);
    dea_plane_mesh_destroy(ctx, mesh);
  }
}

/* Nodes on a curve. */
static size_t nodes_on(const struct dea_plane_mesh *mesh, const char *name)
{
  size_t curve = dea_plane_mesh_curve(mesh, name), per = (size_t)mesh->order + 1, count = 0;
  bool *on = calloc(mesh->node_count, sizeof *on);
  assert_non_null(on);
  for (size_t i = 0; i < mesh->edge_count * per; i++) {
    bool *node = &on[mesh->edges[i]];
    bool here = (size_t)mesh->edge_curve[i / per] == curve;
    count += here && !*node;
    *node |= here;
  }
  free(on);
  return count;
}

/* A name that three numbers have is one curve: three sides of 4 x 4 nodes, which are 10. */
TEST(test_one_name_of_several_curves)
{
  struct dea_plane_mesh *mesh = two_squares(CASES "dupnames.msh");
  assert_int_equal(mesh->curve_count, 2);
  assert_int_equal(nodes_on(mesh, "frame"), 10);
  assert_int_equal(nodes_on(mesh, "right"), 4);
  dea_plane_mesh_destroy(ctx, mesh);
  // an entity that is in two curves and two surfaces of one name is in each once
  static const char text[] =
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n1 1 \"rim\"\n1 2 \"rim\"\n"
      "2 3 \"film\"\n2 4 \"film\"\n$EndPhysicalNames\n$Entities\n0 1 1 0\n"
      "1 0 0 0 1 0 0 2 1 2 0\n1 0 0 0 1 1 0 2 3 4 0\n$EndEntities\n$Nodes\n1 4 1 4\n"
      "2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n"
      "$Elements\n2 2 1 2\n1 1 1 1\n1 1 2\n2 1 3 1\n2 1 2 3 4\n$EndElements\n";
  assert_int_equal(dea_msh_parse(ctx, text, "a.msh", 1e-3, &mesh), DEA_OK);
  assert_int_equal(mesh->group_count, 1);
  assert_int_equal(mesh->edge_count, 1);
  dea_plane_mesh_destroy(ctx, mesh);
}

/* Files as others write them: read, or refused with what is wrong. */
TEST(test_files_of_others)
{
  static const struct {
    const char *file, *fault; // NULL: it is read
    size_t quads;
  } cases[] = {
      {"ok22.msh", NULL, 9},
      {"clockwise.msh", NULL, 9},
      {"comments.msh", NULL, 9},
      {"mixedturn.msh", NULL, 9},
      {"nocurve.msh", NULL, 9},
      {"nonames.msh", NULL, 9},
      {"z5.msh", NULL, 9},
      {"g.msh", "229 triangles, the first at", 0},
      {"onetri.msh", "2 triangles, the first at (8, 7) mm", 0},
      {"triangles.msh", "triangles, the first at", 0},
      {"lfs.msh", "this is no .msh file", 0},
      {"v20.msh", "format 2 is not known: 4.1 and 2.2 are", 0},
      {"noentities41.msh", "quadrilaterals are in no physical surface", 0},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    char file[400];
    struct dea_plane_mesh *mesh;
    snprintf(file, sizeof file, "%s%s", CASES, cases[i].file);
    dea_status status = dea_msh_read(ctx, file, 1e-3, &mesh);
    if (cases[i].fault != NULL) {
      assert_message(status, DEA_E_DESIGN, cases[i].fault);
    } else {
      assert_int_equal(status, DEA_OK);
      assert_int_equal(mesh->quad_count, cases[i].quads);
      assert_close(dea_plane_mesh_smallest_jacobian(mesh, NULL), 1, 1e-12, 0);
    }
    dea_plane_mesh_destroy(ctx, mesh);
    dea_finding_clear(ctx);
  }
}

// Extrusion --------------------------------------------------------------------------------------

static bool electrode_on_film(const void *self, int region, int ply)
{
  const struct dea_plane_mesh *mesh = self;
  const unsigned char *within = mesh->within + mesh->group_count * (size_t)region;
  return within[dea_plane_mesh_group(mesh, ply == 0 ? "film" : "electrode")] != 0;
}

TEST(test_extruded_by_groups)
{
  struct dea_plane_mesh *mesh = two_squares(SEEDS "two-squares-41.msh");
  const struct dea_ply plies[] = {{1e-4, 2, 2}, {1e-5, 1, 2}};
  const struct dea_stack stack = {
      .plies = plies, .count = 2, .present = electrode_on_film, .self = mesh};
  struct dea_grid *grid;
  assert_int_equal(dea_grid_extrude(ctx, mesh, &stack, &grid), DEA_OK);
  assert_int_equal(grid->element_count, 5); // two squares of two elements, one electrode
  assert_int_equal(grid->node_count, 15 * 5 + 9 * 2);
  for (size_t e = 0; e < grid->element_count; e++) {
    assert_int_equal(grid->ply[e], e < 4 ? 0 : 1);
  }
  const int *top = grid->nodes + 4 * DEA_HEX_NODES_MAX;
  assert_close(grid->X[3 * top[26] + 2], 1.1e-4, 1e-12, 0);
  assert_true(grid->X[3 * top[13]] < 1e-3);
  dea_grid_destroy(ctx, grid);
  dea_plane_mesh_destroy(ctx, mesh);
}

// What is wrong ----------------------------------------------------------------------------------

static char *text_of(const char *file)
{
  FILE *in = fopen(file, "rb");
  static char text[4096];
  assert_non_null(in);
  text[fread(text, 1, sizeof text - 1, in)] = '\0';
  fclose(in);
  return text;
}

/* The good file with `what` replaced must fail with that message. */
static void expect(const char *what, const char *by, const char *message)
{
  char *good = text_of(SEEDS "two-squares-22.msh"), *at = strstr(good, what), bad[5000];
  struct dea_plane_mesh *mesh;
  assert_non_null(at);
  snprintf(bad, sizeof bad, "%.*s%s%s", (int)(at - good), good, by, at + strlen(what));
  assert_message(dea_msh_parse(ctx, bad, "bad.msh", 1e-3, &mesh), DEA_E_DESIGN, message);
  assert_null(mesh);
  size_t count;
  const struct dea_finding *finding = dea_finding_get(ctx, &count);
  assert_int_equal(count, 1);
  assert_string_equal(finding[0].location.file, "bad.msh");
  dea_finding_clear(ctx);
}

TEST(test_faults_have_a_place)
{
  expect("$MeshFormat\n2.2", "hello", "bad.msh:1: this is no .msh file");
  expect("2.2 0", "2.2 1", "bad.msh:2: the file is binary");
  expect("2.2 0", "3 0", "bad.msh:2: format 3 is not known");
  expect("\"film\"", "film", "'film' in $PhysicalNames is not a name in quotes");
  expect("1 2 \"left\"", "1 1 \"left\"", "group 1 of dimension 1 is there twice");
  expect("3 1 1 0\n", "3 1 one 0\n", "bad.msh:15: 'one' in $Nodes is not a number");
  expect("3 1 1 0\n", "2 1 1 0\n", "node 2 is there twice");
  expect("3 1 1 0\n", "3 1 1 0.1\n", "the mesh is not plane: z is from 0 to 0.1 mm");
  expect("4 7 8 9 10 11\n6", "99 7 8 9 10 11\n6", "bad.msh:35: there is no node 99");
  expect("5 10 2 3 1 1", "5 36 2 3 1 1", "bad.msh:35: elements of Gmsh's type 36");
  expect("7 16 2 3 2 2 3 6 5 8 14 13 12", "7 2 2 3 2 2 3 6",
         "bad.msh:37: 1 triangle, the first at (1.333, 0.6667) mm: only quadrilaterals");
  expect("7 16 2 3 2 2 3 6 5 8 14 13 12", "7 3 2 3 2 2 3 6 5", "of first and of second order");
  expect("7 16 2 3 2", "7 16 2 0 2",
         "1 quadrilaterals are in no physical surface, the first at (1.5, 0.5) mm");
  expect("6 2 1 0\n", "6 0.9 0.9 0\n", "the quadrilateral at (1.");
  expect("1 8 2 1 1 1 2 7", "1 1 2 1 1 1 2", "bad.msh:31: a line of another order");
  expect("$Elements\n7", "$Elements\n6", "bad.msh:37: '7' in $Elements is not its end");
  expect("$EndElements\n", "", "the file ends in $Elements");
}

static dea_status read_squares(struct dea_context *own)
{
  struct dea_plane_mesh *mesh;
  dea_status status = dea_msh_read(own, SEEDS "two-squares-41.msh", 1e-3, &mesh);
  failing_check(own, status);
  dea_plane_mesh_destroy(own, mesh);
  return status;
}

TEST(test_memory)
{
  assert_true(failing_ends(read_squares, DEA_OK) > 10);
}

TESTS(context_set_up, context_tear_down)
