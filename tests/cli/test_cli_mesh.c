/* dea mesh: the summary, and the file as Gmsh's documentation of its format 2.2 has it. */
#include "command.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>

enum { NODES_MAX = 20000, LINE3 = 8, QUAD9 = 10, HEX27 = 12, GROUPS_MAX = 16 };

static double X[NODES_MAX][3];
static char names[GROUPS_MAX][40];
static double volume[GROUPS_MAX]; // of corner boxes: chords instead of arcs
static size_t counts[GROUPS_MAX];
static size_t lines;            // of three nodes
static double area[GROUPS_MAX]; // of quadrilaterals whose z is 0, by their corners

/* Corners at the ends of the edges, in the order of Gmsh's documentation: their middles are the
 * nodes 8 to 19 of a hexahedron, and 4 to 7 of a quadrilateral. */
static const int hex_edge[12][2] = {{0, 1}, {0, 3}, {0, 4}, {1, 2}, {1, 5}, {2, 3},
                                    {2, 6}, {3, 7}, {4, 5}, {4, 7}, {5, 6}, {6, 7}};
static const int quad_edge[4][2] = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
static const int hex_face[6][4] = {{0, 3, 2, 1}, {0, 1, 5, 4}, {0, 4, 7, 3},
                                   {1, 2, 6, 5}, {2, 3, 7, 6}, {4, 5, 6, 7}};

static double distance(const double a[3], const double b[3])
{
  return sqrt(pow(a[0] - b[0], 2) + pow(a[1] - b[1], 2) + pow(a[2] - b[2], 2));
}

/* A node in the middle of others, but for the bulge of an arc, which is small beside the largest
 * distance of the others. */
static void check_middle(const int *nodes, int middle, const int *corners, int count)
{
  double mean[3] = {0, 0, 0}, size = 0;
  for (int k = 0; k < count; k++) {
    for (int i = 0; i < 3; i++) {
      mean[i] += X[nodes[corners[k]]][i] / count;
    }
    size = fmax(size, distance(X[nodes[corners[k]]], X[nodes[corners[0]]]));
  }
  assert_true(distance(X[nodes[middle]], mean) < 0.15 * size + 1e-9);
}

/* Six times the volume of the tetrahedron at a corner, along its edges to three others. */
static double corner_volume(const int *nodes, int at, int a, int b, int c)
{
  double e[3][3];
  for (int i = 0; i < 3; i++) {
    e[0][i] = X[nodes[a]][i] - X[nodes[at]][i];
    e[1][i] = X[nodes[b]][i] - X[nodes[at]][i];
    e[2][i] = X[nodes[c]][i] - X[nodes[at]][i];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static void check_hexahedron(const int *nodes, int group)
{
  static const int corner[8][4] = {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
                                   {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}};
  double sum = 0;
  for (int k = 0; k < 8; k++) {
    double part = corner_volume(nodes, corner[k][0], corner[k][1], corner[k][2], corner[k][3]);
    assert_true(part > 0);
    sum += part / 8;
  }
  volume[group] += sum;
  for (int k = 0; k < 12; k++) {
    check_middle(nodes, 8 + k, hex_edge[k], 2);
  }
  for (int k = 0; k < 6; k++) {
    check_middle(nodes, 20 + k, hex_face[k], 4);
  }
}

/* Corners around, seen from above; the middle node between them. */
static void check_quadrilateral(const int *nodes, int group)
{
  static const int all[4] = {0, 1, 2, 3};
  double twice = 0;
  bool flat = true;
  for (int k = 0; k < 4; k++) {
    const double *from = X[nodes[k]], *to = X[nodes[(k + 1) % 4]];
    check_middle(nodes, 4 + k, quad_edge[k], 2);
    twice += from[0] * to[1] - from[1] * to[0];
    flat = flat && from[2] == 0;
  }
  check_middle(nodes, 8, all, 4);
  assert_true(!flat || twice > 0);
  area[group] += flat ? 0.5 * twice : 0;
}

static void read_file(const char *name)
{
  char path[600], line[1024];
  snprintf(path, sizeof path, "%s/%s", command_folder, name);
  FILE *file = fopen(path, "r");
  size_t count, number;
  int dimension, group, type, tags, used = 0;
  assert_non_null(file);
  memset(names, 0, sizeof names);
  memset(counts, 0, sizeof counts);
  memset(volume, 0, sizeof volume);
  memset(area, 0, sizeof area);
  lines = 0;
  assert_int_equal(fscanf(file, "$MeshFormat 2.2 0 8 $EndMeshFormat $PhysicalNames %zu", &count),
                   1);
  for (size_t i = 0; i < count; i++) {
    assert_int_equal(fscanf(file, "%d %d \"%39[^\"]\"", &dimension, &group, line), 3);
    assert_true(group > 0 && group < GROUPS_MAX);
    snprintf(names[group], sizeof names[group], "%.39s", line);
  }
  assert_int_equal(fscanf(file, " $EndPhysicalNames $Nodes %zu", &count), 1);
  assert_true(count < NODES_MAX);
  for (size_t i = 1; i <= count; i++) {
    assert_int_equal(fscanf(file, "%zu %lf %lf %lf", &number, &X[i][0], &X[i][1], &X[i][2]), 4);
    assert_int_equal(number, i);
  }
  assert_int_equal(fscanf(file, " $EndNodes $Elements %zu", &count), 1);
  for (size_t i = 1; i <= count; i++) {
    int nodes[27];
    assert_int_equal(fscanf(file, "%zu %d %d %d %*d", &number, &type, &tags, &group), 4);
    assert_true(number == i && tags == 2 && (type == HEX27 || type == QUAD9 || type == LINE3));
    for (int n = 0; n < (type == HEX27 ? 27 : type == QUAD9 ? 9 : 3); n++) {
      assert_int_equal(fscanf(file, "%d", &nodes[n]), 1);
    }
    counts[group]++;
    if (type == HEX27) {
      check_hexahedron(nodes, group);
    }
    if (type == QUAD9) {
      check_quadrilateral(nodes, group);
    }
    if (type == LINE3) {
      check_middle(nodes, 2, quad_edge[0], 2);
      lines++;
    }
  }
  assert_int_equal(fscanf(file, " $EndElements%n", &used), 0);
  assert_true(used > 0);
  fclose(file);
}

static int group_of(const char *name)
{
  for (int g = 1; g < GROUPS_MAX; g++) {
    if (strcmp(names[g], name) == 0) {
      return g;
    }
  }
  fail_msg("no group '%s'", name);
  return 0;
}

TEST(test_file)
{
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml -o four.msh --json "
                               "--set compute.solid.refinement=2.5"),
                   0);
  json_t *root = json_loads(command_out, 0, NULL);
  assert_true(json_number_value(json_object_get(root, "smallest_jacobian")) > 0.3);
  assert_close(json_number_value(json_object_get(root, "angle_deg")), 45, 1e-9, 0);
  size_t elements = (size_t)json_integer_value(json_object_get(root, "elements"));
  read_file("four.msh");
  const double pi = acos(-1), a = 3.75e-3, b = 15e-3, h = 100e-6 / 2.25;
  int film = group_of("film"), active = group_of("film_active"), fibre = group_of("fibre");
  assert_int_equal(counts[film] + counts[active] + counts[fibre], elements);
  assert_close(volume[active], pi / 8 * a * a * h, 0.01, 0);
  assert_close(volume[film], pi / 8 * (b * b - a * a) * h, 0.01, 0);
  assert_close(volume[fibre], 1e-3 * (b - a) * 100e-6, 0.01, 0);
  assert_int_equal(counts[group_of("face_above")], counts[active]);
  assert_int_equal(counts[group_of("face_below")], counts[active]);
  assert_true(counts[group_of("frame")] > 4 && counts[group_of("mirror_first")] > 10);
  assert_true(counts[group_of("mirror_last")] > 10);
  json_decref(root);
}

/* A membrane is made of quadrilaterals, and its rims of lines. */
TEST(test_file_of_a_membrane)
{
  assert_int_equal(
      command_run("mesh @/examples/frdea-4.yaml -o flat.msh --json "
                  "--set compute.solid.film=membrane --set compute.solid.refinement=2"),
      0);
  json_t *root = json_loads(command_out, 0, NULL);
  size_t elements = (size_t)json_integer_value(json_object_get(root, "elements"));
  size_t flat = (size_t)json_integer_value(json_object_get(root, "flat_elements"));
  read_file("flat.msh");
  const double pi = acos(-1), a = 3.75e-3, b = 15e-3, h = 100e-6 / 2.25;
  int film = group_of("film"), active = group_of("film_active");
  int bond = group_of("bond"), fibre = group_of("fibre");
  assert_int_equal(counts[film] + counts[active], flat);
  assert_int_equal(counts[bond] + counts[fibre], elements - flat);
  assert_int_equal(counts[bond], counts[fibre]);
  assert_close(area[active], pi / 8 * a * a, 0.01, 0);
  assert_close(area[film], pi / 8 * (b * b - a * a), 0.01, 0);
  assert_close(volume[bond], 1e-3 * (b - a) * 0.5 * h, 0.01, 0);
  assert_close(volume[fibre], 1e-3 * (b - a) * 100e-6, 0.01, 0);
  assert_true(lines > 10);
  assert_true(counts[group_of("frame")] > 4 && counts[group_of("mirror_first")] > 10);
  json_decref(root);
}

TEST(test_summary)
{
  command_prints("mesh @/examples/plain-disc.yaml --set compute.solid.domain=disc", 0,
                 "360 degrees");
}

TEST(test_what_goes_wrong)
{
  assert_int_equal(command_run("mesh"), 2);
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml -o"), 2);
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml --st x=1"), 2);
  assert_int_equal(command_run("mesh a b"), 2);
  command_write("mine.msh", "my own\n");
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml -o mine.msh"), 5);
  assert_non_null(strstr(command_err, "'mine.msh' already exists"));
  command_read("mine.msh", command_out);
  assert_string_equal(command_out, "my own\n");
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml -o mine.msh --force"), 0);
  command_write("own.yaml", "dea: 1\n");
  assert_int_equal(command_run("mesh own.yaml -o own.yaml --force"), 5);
  command_read("own.yaml", command_out);
  assert_string_equal(command_out, "dea: 1\n");
  assert_int_equal(command_run("mesh no-such-file.yaml"), 5);
  assert_int_equal(command_run("mesh @/examples/frdea-4.yaml -o no/such/folder.msh"), 5);
  command_expect("mesh @/examples/frdea-4.yaml --set fibres.width=6mm", 3, "overlap each other");
}

TESTS(command_set_up, command_tear_down)
