/* results.h5 as Octave's load takes it, under the names of docs/formats.md. */
#include "fake_result.h"
#include "fake_surface.h"
#include "io/results_h5.h"
#include "octave.h"

/* A result with a group of each kind that a file can have. */
static void write_all(const struct dea_design *design)
{
  struct dea_result *result = NULL;
  assert_int_equal(fake_result(ctx, design, 1.0, &result), DEA_OK);
  for (size_t i = 0; i < 2; i++) {
    double voltage_V = 1e3 * (double)i;
    struct dea_field_mesh *mesh = fake_surface(ctx, voltage_V);
    assert_non_null(mesh);
    assert_int_equal(dea_result_add_surface(ctx, result, "3d", i, voltage_V, mesh), DEA_OK);
  }
  struct dea_variant *variant;
  struct dea_load_point point = fake_point(1.25, 1.0, true);
  assert_int_equal(dea_result_add_variant(ctx, result, "3d", "convergence", "coarse", &variant),
                   DEA_OK);
  assert_int_equal(dea_curve_add_point(ctx, &variant->curve, &point), DEA_OK);
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("results.h5")), DEA_OK);
  dea_result_destroy(ctx, result);
}

/* Octave only warns of what it could not load, and leaves it out. */
#define LOAD "x = load('results.h5'); assert(isempty(lastwarn()), lastwarn());"
#define RAW(values) "f = fopen('raw', 'w'); fwrite(f, " values ", 'double'); fclose(f);"

TEST(test_numbers)
{
  enum { POINTS = 41, ALL = 3 * POINTS + 9 };
  const struct dea_design design = fake_design();
  double got[ALL + 1];
  write_all(&design);
  octave(LOAD "s = x.curves.lumped.sweep; p = x.curves.axisymmetric.path.events;" //
         RAW("[s.voltage_V s.fibre_tip_z_m double(s.stable) p.voltage_V double(p.unstable_modes)"
             " x.variants._3d._0000.force_N x.profiles.axisymmetric._0005.displacement_m(11)"
             " x.surfaces._3d._0001.fields.displacement_m(3)]"));
  assert_int_equal(read_raw("raw", got, ALL + 1), ALL);
  for (int i = 0; i < POINTS; i++) {
    struct dea_load_point p = fake_point(1.0 + 0.0064 * i * i / 40.0, 1.0, true);
    assert_true(got[i] == p.voltage_V && got[POINTS + i] == p.fibre_tip_z_m &&
                got[2 * POINTS + i] == p.stable);
  }
  const double *rest = got + 3 * POINTS, at[] = {1.22, 4.0 / 3.0, 1.45};
  for (int i = 0; i < 3; i++) {
    struct dea_load_point p = fake_point(at[i], 1.09, false);
    assert_true(rest[i] == p.voltage_V && rest[3 + i] == p.unstable_modes);
  }
  assert_true(rest[6] == fake_point(1.25, 1.0, true).force_N);
  assert_close(rest[7], 1e-9 * 25e6 * 5e-3, 1e-15, 0); // r = 5 mm at 5 kV
  assert_true(rest[8] == fake_height_m(0, 0, 1e3));
}

/* The design's text, with what is not ASCII. */
TEST(test_texts)
{
  static const char text[] = "title: 80 \302\265m\nfilm: {thickness: 80 um}\n";
  const struct dea_design design = fake_design();
  struct dea_result *result = NULL;
  assert_int_equal(dea_result_create(ctx, &design, NULL, &result), DEA_OK);
  assert_int_equal(dea_provenance_fill(ctx, text, sizeof text - 1, NULL, 0, "dea run it.yaml",
                                       &result->provenance),
                   DEA_OK);
  assert_int_equal(dea_results_h5_write(ctx, result, in_folder("results.h5")), DEA_OK);
  dea_result_destroy(ctx, result);
  octave(LOAD "f = fopen('text', 'w'); fputs(f, x.design.text); fclose(f);"
              "assert(~isfield(x.design, 'overrides'));"
              "assert(x.provenance.command, 'dea run it.yaml')");
  char got[sizeof text] = "";
  FILE *file = fopen(in_folder("text"), "rb");
  assert_non_null(file);
  assert_int_equal(fread(got, 1, sizeof got, file), sizeof text - 1);
  fclose(file);
  assert_string_equal(got, text);
}

TESTS(set_up, tear_down)
