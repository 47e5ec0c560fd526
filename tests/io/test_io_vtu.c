/* VTU and PVD files, read by a small reader of their own. */
#include "failing_allocator.h"
#include "io/vtu.h"
#include "testing.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct dea_context *ctx;
static char folder[512], path[600];

static int set_up(void **state)
{
  char here[400];
  if (getcwd(here, sizeof here) == NULL) {
    return -1;
  }
  snprintf(folder, sizeof folder, "%s/dea-vtu-XXXXXX", here);
  if (mkdtemp(folder) == NULL) {
    return -1;
  }
  snprintf(path, sizeof path, "%s/a.vtu", folder);
  return dea_context_create(NULL, &ctx) == DEA_OK ? 0 : -1;
}

static int tear_down(void **state)
{
  dea_context_destroy(ctx);
  unlink(path);
  return rmdir(folder);
}

/* ---- reader ---- */

static char *file_text;
static size_t file_length;

static void load(const char *name)
{
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  fseek(file, 0, SEEK_END);
  file_length = (size_t)ftell(file);
  rewind(file);
  free(file_text);
  file_text = calloc(file_length + 1, 1);
  assert_int_equal(fread(file_text, 1, file_length, file), file_length);
  fclose(file);
}

/* Number after `key="` behind a place in the header. */
static size_t attribute(const char *from, const char *key)
{
  char text[64];
  snprintf(text, sizeof text, "%s=\"", key);
  const char *at = strstr(from, text);
  assert_non_null(at);
  return (size_t)strtoull(at + strlen(text), NULL, 10);
}

struct array {
  const unsigned char *data;
  size_t size; // bytes
  int components;
  char type[16];
};

static struct array array_of(const char *name)
{
  struct array array = {0};
  char text[64];
  snprintf(text, sizeof text, " Name=\"%s\"", name);
  const char *at = strstr(file_text, text);
  if (at == NULL) {
    fail_msg("there is no array %s", name);
  }
  const char *type = at;
  while (strncmp(type, "type=\"", 6) != 0) {
    type--;
  }
  snprintf(array.type, sizeof array.type, "%.*s", (int)strcspn(type + 6, "\""), type + 6);
  array.components = (int)attribute(at, "NumberOfComponents");
  const char *raw = strstr(file_text, "encoding=\"raw\">");
  raw = strchr(raw, '_') + 1;
  const unsigned char *block = (const unsigned char *)raw + attribute(at, "offset");
  for (int i = 7; i >= 0; i--) {
    array.size = array.size << 8 | block[i];
  }
  array.data = block + 8;
  assert_true((const char *)array.data + array.size < file_text + file_length);
  return array;
}

static uint64_t word_at(const struct array *array, size_t index, size_t size)
{
  uint64_t word = 0;
  assert_true((index + 1) * size <= array->size);
  for (size_t i = size; i-- > 0;) {
    word = word << 8 | array->data[index * size + i];
  }
  return word;
}

static double value_at(const struct array *array, size_t index)
{
  if (strcmp(array->type, "Float64") == 0) {
    uint64_t word = word_at(array, index, 8);
    double value;
    memcpy(&value, &word, sizeof value);
    return value;
  }
  assert_string_equal(array->type, "Float32");
  uint32_t word = (uint32_t)word_at(array, index, 4);
  float value;
  memcpy(&value, &word, sizeof value);
  return (double)value;
}

static size_t size_of(const struct array *array)
{
  return strcmp(array->type, "Float64") == 0 ? 8 : strcmp(array->type, "UInt8") == 0 ? 1 : 4;
}

/* ---- a part of a disc, in layers ---- */

enum { FOLD = 3 };
static const double from_angle = 0.2, pi = 3.14159265358979324;

/* Two elements along the radius of a wedge of order x order_z, the point's place as displacement
 * and as axis, its height as value, the element's number as value of the cell. */
static struct dea_field_mesh *wedge(struct dea_context *c, int order, int order_z)
{
  static const struct dea_mesh_field displacement = {.name = "displacement_m",
                                                     .kind = DEA_MESH_VECTOR,
                                                     .components = 3},
                                     axis = {.name = "axis",
                                             .kind = DEA_MESH_AXIS,
                                             .components = 3},
                                     height = {.name = "height", .components = 2},
                                     number = {.name = "number", .components = 1, .of_cells = true};
  int n = order + 1, nz = order_z + 1, row = 2 * order + 1, *nodes = NULL;
  struct dea_field_mesh *mesh;
  double *u = NULL, *a = NULL, *z = NULL, *e = NULL;
  if (dea_field_mesh_create(c, (size_t)(row * n * nz), &mesh) != DEA_OK) {
    return NULL;
  }
  mesh->fold = FOLD;
  mesh->symmetry_angle = from_angle;
  if (dea_field_mesh_add_block(c, mesh, order, order_z, 2, &nodes) != DEA_OK ||
      dea_field_mesh_add(c, mesh, &displacement, &u) != DEA_OK ||
      dea_field_mesh_add(c, mesh, &axis, &a) != DEA_OK ||
      dea_field_mesh_add(c, mesh, &height, &z) != DEA_OK ||
      dea_field_mesh_add(c, mesh, &number, &e) != DEA_OK) {
    dea_field_mesh_destroy(c, mesh);
    return NULL;
  }
  for (int p = 0; p < row * n * nz; p++) {
    int i = p % row, j = p / row % n, k = p / (row * n);
    double r = 1 + (double)i / order, angle = from_angle + pi / FOLD * j / order;
    double *X = mesh->X + 3 * p;
    X[0] = r * cos(angle);
    X[1] = r * sin(angle);
    X[2] = 0.1 * k;
    memcpy(u + 3 * p, (double[3]){0.1 * X[0], 0.1 * X[1], -0.5 * X[2]}, 3 * sizeof *u);
    memcpy(a + 3 * p, (double[3]){-X[1] / r, X[0] / r, 0}, 3 * sizeof *a);
    z[2 * p] = X[2];
    z[2 * p + 1] = -X[2];
  }
  for (int element = 0; element < 2; element++) {
    e[element] = element + 5;
    for (int k = 0; k < n * n * nz; k++) {
      *nodes++ = k / (n * n) * row * n + k / n % n * row + element * order + k % n;
    }
  }
  return mesh;
}

/* ---- tests ---- */

/* Volume of a hexahedron, or area of a quadrilateral, of given corners, by its mapping's Jacobian
 * in the middle. */
static double content(const struct array *points, const struct array *connectivity, size_t first,
                      int corners)
{
  static const int at[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  double map[3][3] = {{0}};
  for (int n = 0; n < corners; n++) {
    size_t p = (size_t)word_at(connectivity, first + (size_t)n, 4);
    for (int i = 0; i < 3; i++) {
      for (int d = 0; d < 3; d++) {
        map[i][d] += (at[n][d] ? 2.0 : -2.0) / corners * value_at(points, 3 * p + (size_t)i);
      }
    }
  }
  double plane = map[0][0] * map[1][1] - map[0][1] * map[1][0];
  return corners == 4 ? plane : plane * map[2][2];
}

static void check(int order, int order_z, bool whole)
{
  struct dea_field_mesh *mesh = wedge(ctx, order, order_z);
  assert_non_null(mesh);
  assert_int_equal(dea_vtu_write(ctx, mesh, 4321.5, whole, path), DEA_OK);
  load(path);
  bool one = (order == 2 && (order_z == 2 || order_z == 0)) || (order == 1 && order_z < 2);
  size_t copies = whole ? 2 * FOLD : 1, corners = order_z == 0 ? 4 : 8;
  size_t per = one ? 1 : (size_t)(order * order * (order_z == 0 ? 1 : order_z));
  size_t cells = attribute(file_text, "NumberOfCells");
  size_t points = attribute(file_text, "NumberOfPoints");
  assert_int_equal(points, copies * mesh->point_count);
  assert_int_equal(cells, copies * 2 * per);
  assert_non_null(strstr(file_text, "Name=\"voltage_V\""));
  assert_non_null(strstr(file_text, ">4321.5<"));
  assert_non_null(strstr(file_text, "header_type=\"UInt64\""));
  static const struct {
    const char *name;
    int components;
    bool of_cells;
  } arrays[] = {{"Points", 3, false}, {"displacement_m", 3, false},
                {"axis", 3, false},   {"height", 2, false},
                {"number", 1, true},  {"copy", 1, true},
                {"offsets", 1, true}, {"types", 1, true}};
  size_t end = 0;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
    struct array array = array_of(arrays[i].name);
    assert_int_equal(array.components, arrays[i].components);
    assert_int_equal(array.size, (arrays[i].of_cells ? cells : points) *
                                     (size_t)arrays[i].components * size_of(&array));
    end = end > (size_t)((const char *)array.data - file_text) + array.size
              ? end
              : (size_t)((const char *)array.data - file_text) + array.size;
  }
  assert_string_equal(file_text + end, "\n</AppendedData>\n</VTKFile>\n"); // types come last
  struct array X = array_of("Points"), u = array_of("displacement_m"), axis = array_of("axis");
  struct array height = array_of("height"), connectivity = array_of("connectivity");
  struct array offsets = array_of("offsets"), types = array_of("types"), copy = array_of("copy");
  struct array number = array_of("number");
  for (size_t p = 0; p < points; p++) { // the fields are those of the place, in all copies
    double x = value_at(&X, 3 * p), y = value_at(&X, 3 * p + 1), z = value_at(&X, 3 * p + 2);
    double r = hypot(x, y);
    assert_close(value_at(&u, 3 * p), 0.1 * x, 0, 1e-15);
    assert_close(value_at(&u, 3 * p + 1), 0.1 * y, 0, 1e-15);
    assert_close(value_at(&u, 3 * p + 2), -0.5 * z, 0, 1e-15);
    assert_close(fabs(value_at(&axis, 3 * p) * -y + value_at(&axis, 3 * p + 1) * x) / r, 1, 0,
                 1e-6);
    assert_close(value_at(&height, 2 * p), z, 0, 1e-6);
    assert_close(value_at(&height, 2 * p + 1), -z, 0, 1e-6);
  }
  double sum = 0;
  size_t before = 0;
  for (size_t c = 0; c < cells; c++) {
    size_t after = (size_t)word_at(&offsets, c, 4), nodes = after - before;
    unsigned type = (unsigned)word_at(&types, c, 1);
    assert_int_equal(nodes, type == 9 ? 4 : type == 28 ? 9 : type == 12 ? 8 : 27);
    assert_int_equal(type,
                     order_z == 0 ? (one && order == 2 ? 28 : 9) : (one && order == 2 ? 29 : 12));
    double part = content(&X, &connectivity, before, (int)corners);
    assert_true(part > 0); // not inside out
    sum += part;
    assert_int_equal(word_at(&copy, c, 4), c / (2 * per));
    assert_close(value_at(&number, c), 5 + (double)(c / per % 2), 0, 0);
    for (size_t n = before; n < after; n++) {
      assert_true(word_at(&connectivity, n, 4) / mesh->point_count == c / (2 * per));
    }
    before = after;
  }
  assert_int_equal(before * 4, connectivity.size);
  // chords instead of arcs, between cuts of the order or of the whole wedge
  double cuts = one && order == 2 ? 1 : order, chord = pi / FOLD / cuts;
  double area = 0.5 * (3.0 * 3.0 - 1.0) * sin(chord) * cuts; // r from 1 to 3
  assert_close(sum, area * (order_z == 0 ? 1 : 0.1 * order_z) * (double)copies, 1e-9, 0);
  dea_field_mesh_destroy(ctx, mesh);
}

TEST(test_all_kinds_of_elements)
{
  for (int order = 1; order <= 3; order++) {
    for (int order_z = 0; order_z <= 3; order_z++) {
      check(order, order_z, false);
      check(order, order_z, true);
    }
  }
}

/* The nodes between the corners of quadratic cells, as VTK's documentation has them: middles of
 * edges, of faces, of the cell. The wedge is so narrow that arcs are chords. */
TEST(test_order_of_nodes)
{
  static const int parents[27][8] = {{0},          {1},          {2},
                                     {3},          {4},          {5},
                                     {6},          {7},          {0, 1},
                                     {1, 2},       {2, 3},       {3, 0},
                                     {4, 5},       {5, 6},       {6, 7},
                                     {7, 4},       {0, 4},       {1, 5},
                                     {2, 6},       {3, 7},       {0, 3, 7, 4},
                                     {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 2, 6, 7},
                                     {0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 2, 3, 4, 5, 6, 7}};
  static const int counts[27] = {1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2,
                                 2, 2, 2, 2, 2, 2, 4, 4, 4, 4, 4, 4, 8};
  static const int flat[9] = {0, 1, 2, 3, 8, 9, 10, 11, 24}; // of those, the ones of a flat cell
  for (int order_z = 0; order_z <= 2; order_z += 2) {
    struct dea_field_mesh *mesh = wedge(ctx, 2, order_z);
    for (size_t p = 0; p < mesh->point_count; p++) { // straight edges
      double *x = mesh->X + 3 * p;
      double r = hypot(x[0], x[1]), angle = atan2(x[1], x[0]);
      x[0] = r;
      x[1] = angle;
    }
    assert_int_equal(dea_vtu_write(ctx, mesh, 0, true, path), DEA_OK);
    load(path);
    struct array X = array_of("Points"), connectivity = array_of("connectivity");
    size_t nodes = order_z == 0 ? 9 : 27, cells = connectivity.size / 4 / nodes;
    assert_int_equal(cells, 2 * 2 * FOLD);
    for (size_t c = 0; c < cells; c++) {
      for (size_t n = 0; n < nodes; n++) {
        size_t which = order_z == 0 ? (size_t)flat[n] : n;
        for (size_t i = 0; i < 3; i++) {
          double mean = 0;
          for (int k = 0; k < counts[which]; k++) {
            size_t corner = c * nodes + (size_t)parents[which][k];
            mean += value_at(&X, 3 * word_at(&connectivity, corner, 4) + i) / counts[which];
          }
          double x = value_at(&X, 3 * word_at(&connectivity, c * nodes + n, 4) + i);
          assert_close(x, mean, 0, 1e-12);
        }
      }
    }
    dea_field_mesh_destroy(ctx, mesh);
  }
}

TEST(test_pvd)
{
  struct dea_pvd_entry entries[3] = {{0, "fields/a.vtu"}, {2e3, "fields/b.vtu"}, {1e3, "c.vtu"}};
  assert_int_equal(dea_pvd_write(ctx, entries, 2, path), DEA_OK);
  load(path);
  assert_non_null(strstr(file_text, "<DataSet timestep=\"2000\" group=\"\" part=\"0\" "
                                    "file=\"fields/b.vtu\"/>"));
  assert_int_equal(dea_pvd_write(ctx, entries, 3, path), DEA_OK); // up and down: by number
  load(path);
  assert_non_null(strstr(file_text, "timestep=\"2\" group=\"\" part=\"0\" file=\"c.vtu\""));
  assert_int_equal(dea_pvd_write(ctx, NULL, 0, path), DEA_OK);
}

static void write_one(struct dea_context *failing)
{
  struct dea_field_mesh *mesh = wedge(failing, 2, 2);
  if (mesh != NULL) {
    failing_check(failing, dea_vtu_write(failing, mesh, 1, true, path));
    struct dea_pvd_entry entry = {0, "a.vtu"};
    failing_check(failing, dea_pvd_write(failing, &entry, 1, path));
    dea_field_mesh_destroy(failing, mesh);
  }
}

TEST(test_each_allocation)
{
  assert_true(failing_each(write_one) > 10);
}

int main(void)
{
  int code = run_all(set_up, tear_down);
  free(file_text);
  return code;
}
