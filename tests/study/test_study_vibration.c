/* Studies "modal" and "frequency" with a model of one mass on a spring that the voltage softens:
 * what they ask for, and what of it arrives in files and figures. */
#include "design_text.h"
#include "fake_surface.h"
#include "io/results_h5.h"
#include "job/run_folder.h"
#include "own_folder.h"
#include "study/design_file.h"
#include "study/study.h"

struct dea_model {
  double voltage_V;
};

static const double pi = 3.14159265358979323846, rest_Hz = 100, slack_V = 4e3, push = 1e-9;

static dea_status create(struct dea_context *context, const struct dea_device *device,
                         const struct dea_model_settings *settings, struct dea_model **out)
{
  *out = dea_alloc(context, 1, sizeof **out);
  return *out != NULL ? DEA_OK : DEA_E_MEMORY;
}

static void destroy(struct dea_context *context, struct dea_model *model)
{
  dea_free(context, model);
}

static dea_status solve(struct dea_context *context, struct dea_model *model, double voltage_V,
                        struct dea_load_point *out)
{
  *out = dea_load_point_empty();
  out->voltage_V = model->voltage_V = voltage_V;
  return DEA_OK;
}

/* Square of the first frequency, negative beyond slack_V. */
static double square_Hz2(double voltage_V)
{
  return rest_Hz * rest_Hz * (1 - voltage_V * voltage_V / (slack_V * slack_V));
}

static dea_status modes(struct dea_context *context, struct dea_model *model,
                        const struct dea_load_point *at, size_t count,
                        struct dea_load_point *points, struct dea_field_mesh **shapes)
{
  *shapes = fake_surface(context, model->voltage_V);
  if (*shapes == NULL) {
    return DEA_E_MEMORY;
  }
  for (size_t k = 0; k < count; k++) {
    double square = (double)(k + 1) * square_Hz2(at->voltage_V), *values;
    struct dea_mesh_field field = {.unit = "1", .kind = DEA_MESH_VECTOR, .components = 3};
    points[k] = *at;
    points[k].mode = (double)(k + 1);
    points[k].frequency_Hz = copysign(sqrt(fabs(square)), square);
    points[k].mode_out_of_plane = k % 2 == 0 ? 1 : 0;
    snprintf(field.name, sizeof field.name, DEA_SHAPE_FIELD, (int)k + 1);
    dea_status status = dea_field_mesh_add(context, *shapes, &field, &values);
    if (status != DEA_OK) {
      return dea_field_mesh_finish(context, status, shapes);
    }
    for (size_t i = 2; i < 3 * (*shapes)->point_count; i += 3) {
      values[i] = k % 2 == 0 ? 1 : 0;
    }
  }
  return DEA_OK;
}

static dea_status respond(struct dea_context *context, struct dea_model *model,
                          const struct dea_load_point *at,
                          const struct dea_ac_excitation *excitation, const double *frequency_Hz,
                          size_t count, struct dea_load_point *points)
{
  double square = square_Hz2(model->voltage_V);
  for (size_t i = 0; i < count; i++) {
    double f = frequency_Hz[i], gap = 1 - f * f / square;
    double loss = 2 * excitation->damping_ratio * f / sqrt(square);
    points[i] = *at;
    points[i].frequency_Hz = f;
    points[i].ripple_V = excitation->amplitude_V;
    points[i].centre_amplitude_m = push * excitation->amplitude_V / hypot(gap, loss);
    points[i].centre_phase_rad = pi - atan2(loss, gap);
    points[i].fibre_tip_amplitude_m = points[i].centre_amplitude_m;
    points[i].fibre_tip_phase_rad = -atan2(loss, gap); // just below 0 at first
  }
  return DEA_OK;
}

static const struct dea_model_type spring = {.name = "spring",
                                             .long_name = "mass on a spring",
                                             .create = create,
                                             .destroy = destroy,
                                             .solve = solve,
                                             .modes = modes,
                                             .respond = respond};

#include "study_result.h" // after the model: its names shadow none of the arguments above

static const struct dea_override sets[] = {
    {"compute.voltage", "{from: 0 kV, to: 8 kV, step: 2 kV}"},
    {"compute.modal", "{count: 3}"},
    {"compute.frequency",
     "{bias: [1 kV, 2 kV], ripple: 10 V, from: 1 Hz, to: 1 kHz, points: 31, damping: 0.1}"}};

static void compute(void)
{
  set_up_result(GOOD_DESIGN, sets, 3);
  assert_int_equal(dea_study_run(ctx, &spring, NULL, 0, result), DEA_OK);
}

TEST(test_points)
{
  compute();
  const struct dea_curve *curve = dea_result_find(result, "spring", "modal");
  assert_non_null(curve);
  assert_true(curve->complete);
  assert_int_equal(curve->count, 15); // 0 V and the quarters of 8 kV, three modes each
  for (size_t i = 0; i < 15; i++) {
    const struct dea_load_point *p = &curve->points[i];
    assert_close(p->voltage_V, 2e3 * (double)(i / 3), 0, 0);
    assert_close(p->mode, (double)(i % 3 + 1), 0, 0);
  }
  assert_close(curve->points[0].frequency_Hz, rest_Hz, 1e-12, 0);
  assert_true(curve->points[14].frequency_Hz < 0);           // beyond slack_V
  const struct dea_result_table *table = &result->tables[0]; // what the terminal shows
  assert_string_equal(table->type.title, "modes in vacuo");
  assert_int_equal(table->row_count, 15);
  assert_close(dea_result_table_number(table, 14, "voltage_V", 0), 8e3, 0, 0);
  assert_close(dea_result_table_number(table, 14, "mode", 0), 3, 0, 0);
  assert_close(dea_result_table_number(table, 0, "frequency_Hz", 0), rest_Hz, 1e-12, 0);
  curve = dea_result_find(result, "spring", "frequency");
  assert_non_null(curve);
  assert_int_equal(curve->count, 62);
  assert_close(curve->points[0].frequency_Hz, 1, 1e-12, 0);
  assert_close(curve->points[15].frequency_Hz, sqrt(1e3), 1e-12, 0); // evenly by its logarithm
  assert_close(curve->points[61].frequency_Hz, 1e3, 1e-12, 0);
  assert_close(curve->points[61].voltage_V, 2e3, 0, 0);
  assert_close(curve->points[0].centre_amplitude_m, 10 * push, 1e-3, 0);
  tear_down_result();
}

/* The terminal shows what moves at the lowest frequency and at the peak of a mass on a spring,
 * which is at f^2 = (1 - 2 D^2) f0^2 and 1 / (2 D sqrt(1 - D^2)) times as high: D = 0.1. */
TEST(test_peaks)
{
  compute();
  const struct dea_result_table *table =
      dea_result_find_table(result, "spring", "frequency", "peaks");
  assert_non_null(table);
  assert_true((table->type.where & DEA_IN_SCREEN) != 0);
  assert_int_equal(table->row_count, 8); // two biases, centre and fibre tip, lowest and peak
  for (size_t row = 0; row < 8; row += 2) {
    double bias_V = row < 4 ? 1e3 : 2e3;
    assert_close(dea_result_table_number(table, row, "voltage_V", 0), bias_V, 0, 0);
    assert_string_equal(dea_result_table_cell(table, row, 1)->text,
                        row % 4 == 0 ? "centre" : "fibre tip");
    assert_string_equal(dea_result_table_cell(table, row, 2)->text, "lowest frequency");
    assert_close(dea_result_table_number(table, row, "frequency_Hz", 0), 1, 1e-12, 0);
    assert_close(dea_result_table_number(table, row, "gain", 0), 1, 0, 0);
    assert_string_equal(dea_result_table_cell(table, row + 1, 2)->text, "peak");
    assert_close(dea_result_table_number(table, row + 1, "frequency_Hz", 0),
                 sqrt(0.98 * square_Hz2(bias_V)), 0.13, 0); // half a step of the frequencies
    assert_close(dea_result_table_number(table, row + 1, "gain", 0), 5.025, 0.25, 0);
  }
  tear_down_result();
}

/* Phases of the figure go on from where they begin, near 180 and near 0 degrees. */
static void check_phases(void)
{
  char name[600], row[200];
  snprintf(name, sizeof name, "%s/figures/bode.dat", folder);
  FILE *file = fopen(name, "rb");
  assert_non_null(file);
  bool phases = false, begins = false;
  int lines = 0;
  while (fgets(row, sizeof row, file) != NULL) {
    double frequency_Hz, value;
    begins = row[0] == '#' || begins;
    phases = row[0] == '#' ? strstr(row, "Phase") != NULL : phases;
    if (phases && sscanf(row, "%lf %lf", &frequency_Hz, &value) == 2) {
      lines += begins ? 1 : 0;
      begins = false;
      double start = lines % 2 == 1 ? 180 : 0; // centre and tip in turn
      assert_true(value <= start && value >= start - 180);
    }
  }
  fclose(file);
  assert_true(lines >= 2);
}

/* Curves, shapes and figures of a run folder, there and back; and gone when it is cleared. */
TEST(test_files)
{
  static const char *const names[] = {"spring_modal.csv",
                                      "spring_frequency.csv",
                                      "fields/spring_modal_0000.vtu",
                                      "fields/spring_modal_0004.vtu",
                                      "figures/modes.gp",
                                      "figures/mode_shapes.gp",
                                      "figures/bode.gp"};
  struct dea_run *run;
  compute();
  design->report.svg = design->report.pdf = design->report.png = false;
  const struct dea_run_folder_options options = {.force = true};
  assert_int_equal(dea_run_folder_write(ctx, result, folder, &options), DEA_OK);
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    if (!there(names[i])) {
      fail_msg("%s is missing", names[i]);
    }
  }
  assert_int_equal(dea_run_read(ctx, folder, &run), DEA_OK);
  const struct dea_curve *curve = dea_result_find(run->result, "spring", "modal");
  assert_non_null(curve);
  assert_close(curve->points[4].frequency_Hz,
               dea_result_find(result, "spring", "modal")->points[4].frequency_Hz, 0, 0);
  assert_int_equal(run->result->surface_count, 5);
  assert_non_null(dea_field_mesh_find(run->result->surfaces[0].mesh, "mode_3"));
  dea_run_destroy(ctx, run);
  check_phases();
  dea_run_folder_clear(ctx, folder);
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    assert_false(there(names[i]));
  }
  tear_down_result();
}

TEST(test_wrong_range)
{
  static const struct dea_override wrong = {"compute.frequency",
                                            "{bias: [1 kV], from: 1 kHz, to: 10 Hz}"};
  struct dea_design *bad;
  assert_int_equal(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), &wrong, 1, &bad),
      DEA_E_DESIGN);
  dea_finding_clear(ctx);
  static const struct dea_override idle = {"compute.frequency", "{points: 10}"};
  assert_int_equal(
      dea_design_read_memory(ctx, "test.yaml", GOOD_DESIGN, strlen(GOOD_DESIGN), &idle, 1, &bad),
      DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1); // without a bias
  dea_design_destroy(ctx, bad);
  dea_finding_clear(ctx);
}

TESTS(set_up, tear_down)
