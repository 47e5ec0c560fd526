/* output: CSV tables, written and read; tables of measurements and what is wrong with them. */
#include "base/file.h"
#include "base/write_file.h"
#include "failing_allocator.h"
#include "fake_result.h"
#include "io/csv.h"
#include "testing.h"

#include <locale.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char path[512]; // of the table
static char folder[400];
static struct dea_context *ctx;

static int setup(void **state)
{
  const char *base = getenv("TMPDIR");
  snprintf(folder, sizeof folder, "%s/dea-test-XXXXXX", base != NULL ? base : P_tmpdir);
  if (mkdtemp(folder) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
    return -1;
  }
  snprintf(path, sizeof path, "%s/table.csv", folder);
  return 0;
}

static int teardown(void **state)
{
  dea_context_destroy(ctx);
  unlink(path);
  return rmdir(folder);
}

static struct dea_measurement *read_good(const char *text)
{
  struct dea_measurement *m;
  assert_int_equal(dea_file_write(ctx, path, text, strlen(text)), DEA_OK);
  dea_status status = dea_measurement_read(ctx, path, &m);
  if (status != DEA_OK) {
    size_t count;
    const struct dea_finding *found = dea_finding_get(ctx, &count);
    fail_msg("%s; %s", dea_context_message(ctx), count > 0 ? found[0].text : "");
  }
  return m;
}

/* Reads a table with one error and compares its place and text. */
static void assert_error(const char *text, size_t line, size_t column, const char *part)
{
  struct dea_measurement *m;
  size_t count;
  dea_finding_clear(ctx);
  assert_int_equal(dea_file_write(ctx, path, text, strlen(text)), DEA_OK);
  assert_int_equal(dea_measurement_read(ctx, path, &m), DEA_E_IO);
  assert_null(m);
  const struct dea_finding *found = dea_finding_get(ctx, &count);
  assert_int_equal(count, 1);
  assert_string_equal(found[0].location.file, path);
  if (found[0].location.line != line || found[0].location.column != column ||
      strstr(found[0].text, part) == NULL) {
    fail_msg("%zu:%zu: %s", found[0].location.line, found[0].location.column, found[0].text);
  }
}

TEST(test_units_names_and_uncertainties)
{
  struct dea_measurement *m = read_good("# tip, laser\n"
                                        "voltage (V),z centre (mm),z centre std (um),stretch\n"
                                        "\n"
                                        "1000,-0.012,3,1.004\n"
                                        "2e3,,4,1.02\n");
  assert_int_equal(m->curve.count, 2);
  assert_close(m->curve.points[0].voltage_V, 1000.0, 1e-15, 0);
  assert_close(m->curve.points[0].centre_z_m, -12e-6, 1e-12, 0);
  assert_close(m->std[0].centre_z_m, 3e-6, 1e-12, 0);
  assert_close(m->curve.points[1].electrode_stretch, 1.02, 1e-15, 0);
  assert_true(isnan(m->curve.points[1].centre_z_m));
  assert_true(isnan(m->curve.points[0].force_N));
  dea_measurement_destroy(ctx, m);
}

/* As people title them: an uncertainty without a quantity is that of the column before it. */
TEST(test_titles_of_spreadsheets)
{
  struct dea_measurement *m =
      read_good("Voltage (V),Displacement (mm),err (um),force (mN),Force uncertainty (uN)\n"
                "1000,-0.012,3,5,20\n");
  assert_close(m->curve.points[0].centre_z_m, -12e-6, 1e-12, 0);
  assert_close(m->std[0].centre_z_m, 3e-6, 1e-12, 0);
  assert_close(m->curve.points[0].force_N, 5e-3, 1e-12, 0);
  assert_close(m->std[0].force_N, 20e-6, 1e-12, 0);
  dea_measurement_destroy(ctx, m);
}

/* As programs export them: lines above the titles, units in a line below, a column that nobody
 * asked for would have a name that is not known. */
TEST(test_preamble_and_row_of_units)
{
  struct dea_measurement *m = read_good("Bench 3;;\nOperator;A. B.;\n;;\n"
                                        "Voltage;z centre;err\n(kV);(um);(um)\n"
                                        "0,5;-12,5;3\n1,0;n/a;4\n");
  assert_int_equal(m->curve.count, 2);
  assert_close(m->curve.points[0].voltage_V, 500, 1e-15, 0);
  assert_close(m->curve.points[0].centre_z_m, -12.5e-6, 1e-12, 0);
  assert_close(m->std[0].centre_z_m, 3e-6, 1e-12, 0);
  assert_true(isnan(m->curve.points[1].centre_z_m));
  assert_int_equal(m->line[1], 7);
  dea_measurement_destroy(ctx, m);
  assert_error("V (V),force (mN)\n900,2\n\"1,000\",3\n\"1,500\",4\n", 3, 1, "between thousands");
}

TEST(test_keys_carry_their_unit)
{
  struct dea_measurement *m =
      read_good("voltage_V\tfibre_tip_z_m\tforce_N std\n500\t1e-5\t0.001\n");
  assert_close(m->curve.points[0].voltage_V, 500.0, 0, 0);
  assert_close(m->curve.points[0].fibre_tip_z_m, 1e-5, 0, 0);
  assert_close(m->std[0].force_N, 1e-3, 0, 0);
  dea_measurement_destroy(ctx, m);
}

TEST(test_decimal_comma_quotes_and_windows_lines)
{
  struct dea_measurement *m = read_good("\xef\xbb\xbf\"V [kV]\";\"z fibre tip (\302\265m)\"\r\n"
                                        "1,5;\"2,25\"\r\n2,5;3.5\r\n");
  assert_int_equal(m->curve.count, 2);
  assert_close(m->curve.points[0].voltage_V, 1500.0, 1e-15, 0);
  assert_close(m->curve.points[0].fibre_tip_z_m, 2.25e-6, 1e-12, 0);
  assert_close(m->curve.points[1].fibre_tip_z_m, 3.5e-6, 1e-12, 0);
  dea_measurement_destroy(ctx, m);
}

TEST(test_errors_have_places)
{
  assert_error("V (kV),z centr (um)\n1,2\n", 1, 8, "did you mean 'z centre (um)'");
  assert_error("V (kV),colour\n1,2\n", 1, 8, "not a known quantity");
  assert_error("V (kV),z centre\n1,2\n", 1, 8, "needs a unit");
  assert_error("V (kV),z centre (kV)\n1,2\n", 1, 8, "a length is due");
  assert_error("V (kV),z centre (furlongz)\n1,2\n", 1, 8, "not a known unit");
  assert_error("# c\nV (kV),force (mN)\n1,2\n2,x1\n", 4, 3, "'x1' is not a number");
  assert_error("V (kV),force (mN)\n1,2,3\n", 2, 5, "more fields");
  assert_error("V (kV),force (mN)\n1\n", 2, 1, "fewer fields");
  assert_error("V (kV),force (mN)\n,3\n", 2, 1, "a row without 'V (kV)'");
  assert_error("force (mN)\n3\n", 1, 1, "no column such as 'V (kV)'");
  assert_error("V (kV),voltage (V)\n1,2\n", 1, 8, "there twice");
  assert_error("V (kV),force (mN)\n", 1, 1, "no rows");
  assert_error("V (kV),force (mN)\n1,inf\n", 2, 3, "not a number");
}

TEST(test_curve_survives_the_round_trip)
{
  struct dea_design design = fake_design();
  struct dea_result *result = NULL;
  assert_int_equal(fake_result(ctx, &design, 1.0, &result), DEA_OK);
  setlocale(LC_ALL, "de_DE.UTF-8"); // where it is installed, its comma must not get in
  const struct dea_curve *curve = dea_result_find(result, "lumped", "path");
  assert_int_equal(dea_csv_write_curve(ctx, curve, folder), DEA_OK);
  setlocale(LC_ALL, "C");
  char name[512];
  snprintf(name, sizeof name, "%s/lumped_path.csv", folder);
  struct dea_measurement *m;
  assert_int_equal(dea_measurement_read(ctx, name, &m), DEA_OK);
  assert_int_equal(m->curve.count, curve->count);
  for (size_t i = 0; i < curve->count; i++) {
    for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
      double wrote = dea_point_get(&curve->points[i], c);
      double read = dea_point_get(&m->curve.points[i], c);
      if (isnan(wrote)) {
        assert_true(isnan(read));
      } else {
        assert_close(read, wrote, 1e-11, 1e-20);
      }
    }
    assert_int_equal(m->curve.points[i].stable, curve->points[i].stable);
    assert_int_equal(m->curve.points[i].unstable_modes, curve->points[i].unstable_modes);
    assert_int_equal(dea_load_point_flags(&m->curve.points[i]),
                     dea_load_point_flags(&curve->points[i]));
  }
  dea_measurement_destroy(ctx, m);
  unlink(name);
  dea_result_destroy(ctx, result);
}

TEST(test_columns_without_numbers_are_left_out)
{
  struct dea_load_point points[2] = {dea_load_point_empty(), dea_load_point_empty()};
  points[0].voltage_V = 1500.0;
  points[1].voltage_V = 2000.0;
  points[1].centre_z_m = -30e-6;
  points[1].stable = false;
  points[1].unstable_modes = 2;
  struct dea_curve curve = {.model = "m", .kind = "k", .points = points, .count = 2};
  assert_int_equal(dea_csv_write_curve(ctx, &curve, folder), DEA_OK);
  char name[512], *text;
  size_t length;
  snprintf(name, sizeof name, "%s/m_k.csv", folder);
  assert_int_equal(dea_file_read(ctx, name, 10000, &text, &length), DEA_OK);
  assert_string_equal(text, "V (kV),z centre (um),stable,unstable_modes,trusted,flags\n"
                            "1.5,,1,0,1,\n2,-30,0,2,0,unstable\n");
  dea_free(ctx, text);
  unlink(name);
}

static void read_once(struct dea_context *own)
{
  struct dea_measurement *m;
  dea_status status = dea_measurement_read(own, path, &m);
  assert_true((status == DEA_OK) == (m != NULL));
  if (status != DEA_E_IO) {
    failing_check(own, status);
  }
  dea_measurement_destroy(own, m);
}

TEST(test_every_allocation_may_fail)
{
  const char *good = "V (kV),force (mN)\n1,2\n3,4\n", *bad = "V (kV),forse (mN)\n1,2\n";
  assert_int_equal(dea_file_write(ctx, path, good, strlen(good)), DEA_OK);
  assert_true(failing_each(read_once) > 4);
  assert_int_equal(dea_file_write(ctx, path, bad, strlen(bad)), DEA_OK);
  assert_true(failing_each(read_once) > 3);
}

TESTS_EACH(NULL, NULL, setup, teardown)
