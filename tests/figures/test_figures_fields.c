/* What a run with fields leaves: surfaces in results.h5, and drawings of them. */
// ctest: slow, heavy
#include "design_text.h"
#include "failing_allocator.h"
#include "fake_result.h"
#include "fake_surface.h"
#include "figures/run_figures.h"
#include "figures/surface_lattice.h"
#include "io/results_h5.h"

#include "own_folder.h" // after: its context shadows no name of the headers above

/* ---- drawings ---- */

/* Lengths of all outlines of a kind. */
static double length_of(const struct dea_outline *lines, size_t count, enum dea_outline_kind kind)
{
  double length = 0;
  for (size_t i = 0; i < count; i++) {
    for (int k = 1; k < lines[i].count && lines[i].kind == kind; k++) {
      length += hypot(lines[i].at[k][DEA_LATTICE_X] - lines[i].at[k - 1][DEA_LATTICE_X],
                      lines[i].at[k][DEA_LATTICE_Y] - lines[i].at[k - 1][DEA_LATTICE_Y]);
    }
  }
  return length;
}

TEST(test_outlines)
{
  const double pi = 3.14159265358979324;
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_outline *lines;
  size_t count;
  assert_int_equal(dea_surface_lattice_outlines(ctx, mesh, &lines, &count), DEA_OK);
  assert_close(length_of(lines, count, DEA_OUTLINE_FRAME), 2 * pi * fake_radius_m, 1e-3, 0);
  assert_close(length_of(lines, count, DEA_OUTLINE_ELECTRODE), 2 * pi * fake_electrode_m, 1e-3, 0);
  // the fibre's two sides each, from the electrode to the frame; not its middle, a plane of
  // symmetry
  assert_close(length_of(lines, count, DEA_OUTLINE_FIBRE),
               2 * FAKE_FOLD * (fake_radius_m - fake_electrode_m), 1e-9, 0);
  dea_free(ctx, lines);
  dea_field_mesh_destroy(ctx, mesh);
}

/* All of the disc once, at the height that the surface has there. */
TEST(test_patches)
{
  const double pi = 3.14159265358979324;
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_surface_lattice drawing;
  assert_int_equal(dea_surface_lattice_create(ctx, mesh, 4000, &drawing), DEA_OK);
  assert_int_equal(drawing.patch_count, 2 * FAKE_FOLD * FAKE_RINGS * FAKE_TURNS);
  assert_close(drawing.radius_m, fake_radius_m, 1e-9, 0);
  assert_close(drawing.z_max_m, 1e-6, 1e-9, 0);
  double area = 0;
  int pieces = 0;
  for (size_t i = 0; i < drawing.patch_count; i++) {
    const struct dea_patch *patch = &drawing.patches[i];
    int row = patch->n + 1;
    pieces += patch->n * patch->m;
    for (int k = 0; k < row * (patch->m + 1); k++) {
      const double *p = patch->at[k];
      double height = fake_height_m(p[DEA_LATTICE_X], p[DEA_LATTICE_Y], 1e3);
      assert_close(p[DEA_LATTICE_UZ], height, 0, 0.01e-6); // quadratic elements
      assert_close(p[DEA_LATTICE_UX], 1e-3 * p[DEA_LATTICE_X], 0, 1e-15);
      if (k % row < patch->n && k / row < patch->m) {
        const double *q = patch->at[k + row + 1], *a = patch->at[k + 1], *b = patch->at[k + row];
        area += 0.5 * fabs((q[0] - p[0]) * (b[1] - a[1]) - (q[1] - p[1]) * (b[0] - a[0]));
      }
    }
  }
  assert_true(pieces > 3000 && pieces < 12000);
  assert_close(area, pi * fake_radius_m * fake_radius_m, 2e-3, 0);
  dea_surface_lattice_free(ctx, &drawing);
  dea_field_mesh_destroy(ctx, mesh);
}

TEST(test_section)
{
  struct dea_field_mesh *mesh = fake_surface(ctx, 1e3);
  struct dea_surface_lattice drawing;
  assert_int_equal(dea_surface_lattice_create(ctx, mesh, 20000, &drawing), DEA_OK);
  for (int way = 0; way < 3; way++) { // a plane of symmetry, another, none
    double angle = way == 0 ? 0 : way == 1 ? 1.04719755119659775 : 0.37, *found;
    size_t count;
    assert_int_equal(dea_surface_lattice_section(ctx, &drawing, angle, &found, &count), DEA_OK);
    assert_true(count > 50);
    assert_close(found[0], -fake_radius_m, 2e-3, 0);
    assert_close(found[count - 1], fake_radius_m, 2e-3, 0);
    for (size_t i = 0; i < count; i++) {
      double height = fake_height_m(found[i] * cos(angle), found[i] * sin(angle), 1e3);
      assert_true(i == 0 || found[i] > found[i - 1]);
      assert_close(found[count + i], height, 0, 0.02e-6);
    }
    dea_free(ctx, found);
  }
  dea_surface_lattice_free(ctx, &drawing);
  dea_field_mesh_destroy(ctx, mesh);
}

/* ---- results.h5 and figures ---- */

static struct dea_design design;

static dea_status make_result(struct dea_context *c, struct dea_result **out)
{
  design = fake_design();
  DEA_TRY(c, dea_result_create(c, &design, NULL, out));
  for (int k = 0; k < 3; k++) {
    struct dea_field_mesh *mesh = fake_surface(c, 1e3 * k);
    if (mesh == NULL) {
      return DEA_E_MEMORY;
    }
    mesh->X[0] += k == 2 ? 1e-9 : 0; // another mesh
    DEA_TRY(c, dea_result_add_surface(c, *out, "fake", (size_t)k, 1e3 * k, mesh));
  }
  return DEA_OK;
}

/* A long sweep keeps a few surfaces, evenly spread, the first and the last among them. */
TEST(test_surfaces_are_bounded)
{
  enum { POINTS = 101, ROOM = 10 };
  struct dea_result *result;
  assert_int_equal(dea_result_create(ctx, NULL, NULL, &result), DEA_OK);
  struct dea_field_mesh *mesh = fake_surface(ctx, 0);
  size_t cells = FAKE_RINGS * FAKE_TURNS; // 8 bytes: place, displacement, tension; two of cells
  size_t bytes = sizeof *mesh + cells * (9 * (3 + 3 + 2) * 8 + 9 * sizeof(int) + 2 * 8);
  result->surface_bytes_max = ROOM * bytes;
  dea_field_mesh_destroy(ctx, mesh);
  for (size_t k = 0; k < POINTS; k++) {
    for (int model = 0; model < 2; model++) {
      assert_int_equal(dea_result_add_surface(ctx, result, model == 0 ? "a" : "b", k,
                                              1e2 * (double)k, fake_surface(ctx, 1e2 * (double)k)),
                       DEA_OK);
    }
    const struct dea_surface_record *last = &result->surfaces[result->surface_count - 1];
    assert_true(result->surface_count <= 2 * ROOM);
    assert_true(k < 4 || result->surface_count >= ROOM - 2);
    assert_int_equal(last->point, k);
    assert_close(last->voltage_V, 1e2 * (double)k, 1e-12, 0);
  }
  size_t n = result->surface_count / 2;
  for (size_t i = 0; i + 1 < n; i++) { // one of sixteen
    assert_int_equal(result->surfaces[2 * i].point, 16 * i);
    assert_string_equal(result->surfaces[2 * i].model, "a");
    assert_string_equal(result->surfaces[2 * i + 1].model, "b");
  }
  assert_int_equal(n, 8);
  dea_result_destroy(ctx, result);
}

static void check_same(const struct dea_field_mesh *a, const struct dea_field_mesh *b)
{
  assert_int_equal(a->point_count, b->point_count);
  assert_int_equal(a->cell_count, b->cell_count);
  assert_int_equal(a->block_count, b->block_count);
  assert_int_equal(a->field_count, b->field_count);
  assert_int_equal(a->fold, b->fold);
  assert_int_equal(a->fibres, b->fibres);
  assert_memory_equal(a->X, b->X, 3 * a->point_count * sizeof *a->X);
  assert_memory_equal(a->blocks[0].nodes, b->blocks[0].nodes, 9 * a->cell_count * sizeof(int));
  for (size_t i = 0; i < a->field_count; i++) {
    const struct dea_mesh_field *f = &a->fields[i], *g = dea_field_mesh_find(b, f->name);
    assert_non_null(g);
    assert_string_equal(f->unit, g->unit);
    assert_string_equal(f->meaning, g->meaning);
    assert_int_equal(f->kind, g->kind);
    assert_int_equal(f->of_cells, g->of_cells);
    assert_int_equal(f->components, g->components);
    assert_memory_equal(f->values, g->values,
                        dea_mesh_field_count(a, f) * (size_t)f->components * sizeof(double));
  }
}

TEST(test_store)
{
  struct dea_result *result;
  struct dea_run *run;
  assert_int_equal(make_result(ctx, &result), DEA_OK);
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("a.h5")), DEA_OK);
  assert_int_equal(dea_run_read(ctx, in_folder("a.h5"), &run), DEA_OK);
  assert_int_equal(run->result->surface_count, 3);
  for (size_t k = 0; k < 3; k++) {
    assert_string_equal(run->result->surfaces[k].model, "fake");
    assert_close(run->result->surfaces[k].voltage_V, 1e3 * (double)k, 0, 0);
    check_same(result->surfaces[k].mesh, run->result->surfaces[k].mesh);
  }
  dea_run_destroy(ctx, run);
  dea_result_destroy(ctx, result);
}

TEST(test_figures)
{
  struct dea_result *result;
  assert_int_equal(make_result(ctx, &result), DEA_OK);
  result->surfaces[2].mesh->X[0] -= 1e-9;
  const struct dea_figure_options options = {
      .format = {.svg = true, .pdf = true, .png = true, .width_m = 0.085}, .voltage_V = 1.1e3};
  static const char *const names[] = {"map", "surface", "section", "animation"};
  struct dea_figure_options animation = options;
  animation.names = &names[3];
  animation.name_count = 1;
  assert_int_equal(dea_figures_write(ctx, result, in_folder("figures"), &options, NULL), DEA_OK);
  assert_false(there("figures/animation.gp")); // on request only
  assert_int_equal(dea_figures_write(ctx, result, in_folder("figures"), &animation, NULL), DEA_OK);
  static const char *const outcomes[] = {"gp", "dat", "svg", "pdf", "png", "gif"};
  for (size_t i = 0; i < 4; i++) {
    for (size_t k = 0; k < 6; k++) {
      char name[64];
      snprintf(name, sizeof name, "figures/%s.%s", names[i], outcomes[k]);
      bool wanted = k < 2 || (i == 3) == (k == 5);
      if (there(name) != wanted || (wanted && size_of(name) < 500)) {
        fail_msg("%s %s", name, wanted ? "is missing or empty" : "should not be there");
      }
    }
  }
  char text[200] = "";
  FILE *script = fopen(in_folder("figures/surface.gp"), "rb");
  assert_non_null(script);
  assert_non_null(fgets(text, sizeof text, script)); // the nearest voltage, and how much z is drawn
  assert_non_null(strstr(text, "at 1 kV, z drawn 2000 times larger"));
  fclose(script);
  assert_non_null(find_finding(ctx, DEA_NOTE, "figure 'surface' shows 1 kV"));
  dea_result_destroy(ctx, result);
}

/* What stays flat shows how far it moves in its plane. */
TEST(test_figures_in_the_plane)
{
  static const char *const names[] = {"map", "surface"};
  const struct dea_figure_options options = {
      .names = names, .name_count = 2, .format = {.svg = true, .width_m = 0.085}, .voltage_V = NAN};
  struct dea_result *result;
  design = fake_design();
  assert_int_equal(dea_result_create(ctx, &design, NULL, &result), DEA_OK);
  struct dea_field_mesh *mesh = fake_surface(ctx, 0);
  const struct dea_mesh_field *moved = dea_field_mesh_find(mesh, "displacement_m");
  double most_um = 0;
  for (size_t i = 0; i < mesh->point_count; i++) {
    moved->values[3 * i] = 2e-3 * mesh->X[3 * i];
    moved->values[3 * i + 1] = moved->values[3 * i + 2] = 0;
    most_um = fmax(most_um, 1e6 * fabs(moved->values[3 * i]));
  }
  assert_int_equal(dea_result_add_surface(ctx, result, "fake", 1, 0, mesh), DEA_OK);
  assert_int_equal(dea_figures_write(ctx, result, in_folder("plane"), &options, NULL), DEA_OK);
  for (size_t k = 0; k < 2; k++) {
    char name[64], text[8192];
    snprintf(name, sizeof name, "plane/%s.gp", names[k]);
    FILE *script = fopen(in_folder(name), "rb");
    assert_non_null(script);
    text[fread(text, 1, sizeof text - 1, script)] = '\0';
    fclose(script);
    const char *range = strstr(text, "set cbrange [0:");
    assert_non_null(range);
    assert_close(strtod(range + strlen("set cbrange [0:"), NULL), most_um, 1e-5, 0);
    assert_non_null(strstr(text, "Displacement in the plane"));
  }
  dea_result_destroy(ctx, result);
}

static void store_and_read(struct dea_context *failing)
{
  struct dea_result *result = NULL;
  struct dea_run *run = NULL;
  dea_status status = make_result(failing, &result);
  status = status == DEA_OK ? dea_results_h5_write(failing, result, in_folder("m.h5")) : status;
  status = status == DEA_OK ? dea_run_read(failing, in_folder("m.h5"), &run) : status;
  failing_check(failing, status);
  dea_run_destroy(failing, run);
  dea_result_destroy(failing, result);
}

static void draw(struct dea_context *failing)
{
  static const char *const names[] = {"map", "surface", "section", "animation"};
  const struct dea_figure_options options = {
      .names = names, .name_count = 4, .format = {.width_m = 0.085}, .voltage_V = NAN};
  struct dea_result *result = NULL;
  dea_status status = make_result(failing, &result);
  if (status == DEA_OK) {
    status = dea_figures_write(failing, result, in_folder("memory"), &options, NULL);
  }
  failing_check(failing, status);
  dea_result_destroy(failing, result);
}

TEST(test_each_allocation)
{
  assert_true(failing_each(store_and_read) > 40);
  assert_true(failing_each(draw) > 60);
}

TESTS(set_up, tear_down)
