/* A device fitted to its curves: closed form, coverage, what cannot be told apart, slack. */
// ctest: quick, heavy
#include "design_text.h"
#include "job/device_fit_run.h"
#include "model/model.h"

#include <stdint.h>

#include "own_folder.h" // after: its context shadows no name of the headers above

enum { CAPACITIES = 5, STOPS = 9, SETS = 40 };

static void write_file(const char *name, const char *text)
{
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  fputs(text, file);
  fclose(file);
}

/* Fits; the parameters and curves are those of a fit file. */
static dea_status fit(const char *model, const char *parameters, const char *curves,
                      struct dea_device_file **file, struct dea_device_fit **out)
{
  static char text[4096];
  snprintf(text, sizeof text,
           "dea_fit: 1\nname: mine\ndesign: design.yaml\nmodel: %s\nparameters:\n%scurves:\n%s",
           model, parameters, curves);
  write_file("fit.yaml", text);
  write_file("design.yaml", GOOD_DESIGN);
  static struct dea_device_fit found;
  *out = &found;
  void *read;
  assert_int_equal(dea_fit_head_read(ctx, in_folder("fit.yaml"), &dea_device_form, &read), DEA_OK);
  *file = read;
  return dea_device_fit_run(ctx, *file, false, *out);
}

static void end(struct dea_device_file *file, struct dea_device_fit *found)
{
  dea_device_fit_free(found);
  dea_fit_head_destroy(ctx, file);
}

/* Capacitances at voltages that stretch nothing (1e-12 of the capacitance): C = k eps. */
static void write_capacitances(double *k, double *C, double *std)
{
  static char text[1024];
  const double radius_m = 3.75e-3, film_m = 100e-6 / 2.25;
  *k = DEA_EPSILON_0 * 3.14159265358979323846 * radius_m * radius_m / film_m;
  size_t used =
      (size_t)snprintf(text, sizeof text, "V (V),capacitance (pF),capacitance std (pF)\n");
  for (int i = 0; i < CAPACITIES; i++) {
    std[i] = 1e-12 * (0.1 + 0.05 * i);
    C[i] = *k * 2.9 + 0.7 * std[i] * (i % 2 == 0 ? 1 : -1);
    used += (size_t)snprintf(text + used, sizeof text - used, "%g,%.15g,%.15g\n", 1e-3 * i,
                             1e12 * C[i], 1e12 * std[i]);
  }
  write_file("capacitance.csv", text);
}

/* One parameter that the curve is linear in, with a Gaussian prior: the posterior in closed form.
 */
TEST(test_closed_form)
{
  double k, C[CAPACITIES], std[CAPACITIES], information = 1 / (0.05 * 0.05),
                                            sum = 2.88 * information;
  struct dea_device_file *file;
  struct dea_device_fit *found;
  write_capacitances(&k, C, std);
  for (int i = 0; i < CAPACITIES; i++) {
    information += k * k / (std[i] * std[i]);
    sum += k * C[i] / (std[i] * std[i]);
  }
  assert_int_equal(fit("lumped",
                       "  - {name: film.permittivity.at_rest, prior: 2.88, prior_std: 0.05}\n",
                       "  - {name: c, file: capacitance.csv}\n", &file, &found),
                   DEA_OK);
  assert_close(found->core.values[0].value, sum / information, 1e-7, 0);
  assert_close(found->core.values[0].std, 1 / sqrt(information), 1e-6, 0);
  assert_close(found->curves[0].model_std[0], k / sqrt(information), 1e-6, 0);
  assert_false(found->core.values[0].bends);
  end(file, found);
}

/* The same without uncertainties: s of the rows is that of their residuals, sum r^2 = s^2 (m - m
 * k^2 std^2/s^2), and the prior weighs against it with its own uncertainty. */
TEST(test_prior_without_uncertainty)
{
  static const double prior = 2.901, prior_std = 7e-4;
  char text[512] = "V (V),capacitance (pF)\n";
  double k, C[CAPACITIES], unused[CAPACITIES], squares = 0, mean = 0;
  struct dea_device_file *file;
  struct dea_device_fit *found;
  write_capacitances(&k, C, unused);
  for (int i = 0; i < CAPACITIES; i++) {
    C[i] = k * 2.9 + 0.02e-12 * (i % 2 == 0 ? 1 : -1);
    snprintf(text + strlen(text), sizeof text - strlen(text), "%g,%.15g\n", 1e-3 * i, 1e12 * C[i]);
    mean += C[i] / k / CAPACITIES;
  }
  write_file("capacitance.csv", text);
  assert_int_equal(fit("lumped",
                       "  - {name: film.permittivity.at_rest, prior: 2.901, prior_std: 7e-4}\n",
                       "  - {name: c, file: capacitance.csv}\n", &file, &found),
                   DEA_OK);
  const double eps = found->core.values[0].value, std = found->core.values[0].std;
  const double information = 1 / (std * std) - 1 / (prior_std * prior_std); // m k^2/s^2
  for (int i = 0; i < CAPACITIES; i++) {
    squares += (C[i] - k * eps) * (C[i] - k * eps);
  }
  const double s2 = CAPACITIES * k * k / information;
  assert_close(squares / s2, CAPACITIES - information * std * std, 1e-2, 0);
  assert_close(eps, std * std * (prior / (prior_std * prior_std) + information * mean), 1e-6, 0);
  assert_close(found->core.scatter, sqrt(squares / CAPACITIES), 1e-4, 0);
  end(file, found);
}

/* At rest the capacitance tells eps/h only. */
TEST(test_not_told_apart)
{
  double k, C[CAPACITIES], std[CAPACITIES];
  struct dea_device_file *file;
  struct dea_device_fit *found;
  write_capacitances(&k, C, std);
  assert_int_equal(fit("lumped",
                       "  - {name: film.permittivity.at_rest, fixed: no}\n"
                       "  - {name: film.thickness}\n",
                       "  - {name: c, file: capacitance.csv}\n", &file, &found),
                   DEA_OK);
  assert_close(found->core.values[0].value / found->core.values[1].value * 100e-6, 2.9, 0.01, 0);
  assert_true(isinf(found->core.values[0].std) || found->core.values[0].std > 1);
  assert_int_equal(found->pair_count, 1);
  assert_int_equal(found->pairs[0].first, 0);
  assert_int_equal(found->pairs[0].second, 1);
  assert_non_null(strstr(found->pairs[0].next, "by itself"));
  end(file, found);
}

// A sweep with noise -----------------------------------------------------------------------------

/* Normal numbers by Box and Muller from a congruential generator. */
static double noise(uint64_t *seed)
{
  double u[2];
  for (int i = 0; i < 2; i++) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    u[i] = ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
  }
  return sqrt(-2 * log(u[0])) * cos(6.28318530717958648 * u[1]);
}

/* Points of a model with 94 um and 1.42 in place of 100 um and 1.5. */
static void truth(const char *model, struct dea_load_point points[STOPS])
{
  const struct dea_override overrides[] = {{"film.thickness", "94 um"}, {"pre_stretch", "1.42"}};
  struct dea_design *design;
  struct dea_device *device;
  struct dea_model *m;
  const struct dea_model_type *type = dea_model_find(model);
  assert_int_equal(read_and_build(ctx, GOOD_DESIGN, overrides, 2, &design, &device), DEA_OK);
  assert_int_equal(type->create(ctx, device, NULL, &m), DEA_OK);
  for (int i = 0; i < STOPS; i++) {
    assert_int_equal(type->solve(ctx, m, 750.0 * i, &points[i]), DEA_OK);
  }
  type->destroy(ctx, m);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
}

static void write_sweep(const struct dea_load_point *points, uint64_t *seed)
{
  static char text[2048];
  size_t used = (size_t)snprintf(text, sizeof text,
                                 "V (kV);u electrode edge (um);capacitance (pF);"
                                 "u electrode edge std (um);capacitance std (pF)\n");
  for (int i = STOPS; i-- > 0;) { // down: the order is not that of the model
    used += (size_t)snprintf(text + used, sizeof text - used, "%.3f;%.6f;%.6f;4;0.2\n",
                             1e-3 * points[i].voltage_V,
                             1e6 * points[i].electrode_edge_u_m + 4 * noise(seed),
                             1e12 * points[i].capacitance_F + 0.2 * noise(seed));
  }
  write_file("sweep.csv", text);
}

static const char two[] = "  - {name: film.thickness, low: 60 um, high: 140 um}\n"
                          "  - {name: pre_stretch, low: 1.1, high: 1.9}\n";

/* Of 80 intervals of one standard uncertainty 68 % hold the truth: 55 +- 4. */
TEST(test_coverage)
{
  skip_sanitized();
  struct dea_load_point points[STOPS];
  uint64_t seed = 7;
  int held = 0;
  double squares = 0;
  truth("lumped", points);
  for (int k = 0; k < SETS; k++) {
    struct dea_device_file *file;
    struct dea_device_fit *found;
    write_sweep(points, &seed);
    assert_int_equal(fit("lumped", two, "  - {name: s, file: sweep.csv}\n", &file, &found), DEA_OK);
    const double off[2] = {(found->core.values[0].value - 94e-6) / found->core.values[0].std,
                           (found->core.values[1].value - 1.42) / found->core.values[1].std};
    for (int j = 0; j < 2; j++) {
      held += fabs(off[j]) < 1;
      squares += off[j] * off[j] / (2 * SETS);
      assert_true(fabs(off[j]) < 5);
    }
    end(file, found);
  }
  assert_true(held >= 46 && held <= 64);
  assert_close(squares, 1, 0, 0.45);
}

/* The written design gives the fitted curve, and slack rows are cut and counted. */
TEST(test_design_and_slack)
{
  struct dea_load_point points[STOPS];
  struct dea_device_file *file;
  struct dea_device_fit *found;
  struct dea_design *design;
  struct dea_device *device;
  uint64_t seed = 1;
  truth("axisymmetric", points);
  write_sweep(points, &seed);
  assert_int_equal(fit("axisymmetric",
                       "  - {name: pre_stretch, low: 1.05, high: 1.9}\n"
                       "  - {name: film.permittivity.at_rest, prior: 2.8, prior_std: 0.2}\n"
                       "  - {name: film.law.c1, start: 180 kPa, fixed: yes}\n",
                       "  - {name: s, file: sweep.csv, quantities: [electrode_edge_u_m]}\n"
                       "  - {name: c, file: sweep.csv, quantities: [capacitance_F], use: check}\n",
                       &file, &found),
                   DEA_OK);
  assert_int_equal(found->curve_count, 2);
  assert_true(isnan(found->curves[1].lag) && !isnan(found->curves[1].rms));
  const char *text = dea_text_get(&found->design);
  assert_non_null(strstr(text, "#   pre_stretch = 1."));
  assert_int_equal(dea_design_read_memory(ctx, "fitted", text, strlen(text), NULL, 0, &design),
                   DEA_OK);
  assert_int_equal(dea_device_build(ctx, design, &device), DEA_OK);
  assert_close(device->pre_stretch, found->core.values[0].value, 1e-9, 0);
  assert_close(device->film.permittivity.at_rest, found->core.values[1].value, 1e-9, 0);
  assert_close(device->film.param[0], 180e3, 1e-9, 0);
  assert_close(device->film.breakdown.exponent, 1.5, 1e-9, 0);
  dea_device_destroy(ctx, device);
  dea_design_destroy(ctx, design);
  assert_int_equal(found->curves[0].slack, 0);
  end(file, found);
  // with less pre-stretch the film goes slack on the way
  assert_int_equal(fit("axisymmetric",
                       "  - {name: film.thickness, low: 60 um, high: 140 um}\n"
                       "  - {name: pre_stretch, start: 1.1, fixed: yes}\n",
                       "  - {name: s, file: sweep.csv, quantities: [electrode_edge_u_m]}\n", &file,
                       &found),
                   DEA_OK);
  assert_true(found->curves[0].slack > 0 && found->curves[0].slack < STOPS);
  assert_false(found->curves[0].used[0]); // the highest voltage stands first
  assert_true(found->curves[0].used[STOPS - 1]);
  end(file, found);
}

/* From a start where the film goes slack on the way: the rows cut there come back. */
TEST(test_rows_come_back)
{
  static const char *const models[] = {"lumped", "axisymmetric"};
  struct dea_load_point points[STOPS];
  struct dea_device_file *file;
  struct dea_device_fit *found;
  for (int m = 0; m < 2; m++) {
    uint64_t seed = 3;
    truth(models[m], points);
    write_sweep(points, &seed);
    assert_int_equal(fit(models[m],
                         "  - {name: pre_stretch, start: 1.1, low: 1.05, high: 1.9}\n"
                         "  - {name: film.thickness, start: 62 um, low: 50 um, high: 140 um}\n",
                         "  - {name: s, file: sweep.csv}\n", &file, &found),
                     DEA_OK);
    assert_int_equal(found->curves[0].slack, 0);
    assert_true(found->curves[0].used[0]);
    assert_close(found->core.values[0].value, 1.42, 0, 5 * found->core.values[0].std);
    end(file, found);
  }
}

TESTS(set_up, tear_down)
