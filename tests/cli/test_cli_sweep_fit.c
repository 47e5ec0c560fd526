/* What a fit knows of a device, as variables of dea sweep and dea optimise (key from_fit). */
// ctest: quick, heavy
#include "command.h"

#include <math.h>

static const double thickness_m = 94e-6, thickness_std_m = 1e-7, pre_stretch = 1.42,
                    pre_stretch_std = 1e-3, correlation = -0.6;

/* fit.json in a folder, of parameters and the rows of their correlations. law: "" of a device. */
static void write_fit(const char *folder, const char *law, const char *parameters,
                      const char *correlations)
{
  char name[64], text[2000];
  snprintf(name, sizeof name, "%s/fit.json", folder);
  snprintf(text, sizeof text,
           "{\"program\": \"dea\"%s%s%s, \"parameters\": [%s], \"correlations\": [%s]}",
           law[0] != '\0' ? ", \"law\": \"" : "", law, law[0] != '\0' ? "\"" : "", parameters,
           correlations);
  command_write(name, text);
}

static const char both[] =
    "{\"name\": \"film.thickness\", \"unit\": \"m\", \"film\": \"\", \"value\": 94e-6, "
    "\"standard_uncertainty\": 1e-7, \"fixed\": false, \"at_bound\": false}, "
    "{\"name\": \"fibres.overlap\", \"unit\": \"m\", \"film\": \"stretched\", \"value\": 1.1e-3, "
    "\"standard_uncertainty\": 0, \"fixed\": true, \"at_bound\": false}, "
    "{\"name\": \"pre_stretch\", \"unit\": \"1\", \"film\": \"\", \"value\": 1.42, "
    "\"standard_uncertainty\": 1e-3, \"fixed\": false, \"at_bound\": false}";
static const char both_correlations[] = "[1, 0, -0.6], [0, 0, 0], [-0.6, 0, 1]";

static void write_file(const char *more)
{
  char text[2000];
  snprintf(text, sizeof text,
           "dea_explore: 1\nname: mine\ndesign: " DEA_SOURCE_DIR "/examples/frdea-4.yaml\n"
           "model: lumped\nquantities: [electrode_edge_u_m]\nvoltages: [3 kV]\n%s\n",
           more);
  command_write("mine.yaml", text);
}

static void expect(const char *more, const char *message)
{
  write_file(more);
  command_expect("sweep mine.yaml --force", 3, message);
}

/* Standard deviation of the edge's displacement at 3 kV of statistics.csv. */
static double sampled_std(void)
{
  static char text[COMMAND_TEXT_MAX];
  double mean, std;
  command_read("mine.sweep/statistics.csv", text);
  const char *at = strstr(text, "electrode_edge_u_m,m,3,");
  assert_non_null(at);
  assert_int_equal(sscanf(at, "electrode_edge_u_m,m,3,%*d,%lf,%lf", &mean, &std), 2);
  return std;
}

/* Standard uncertainty of the edge at 3 kV from the bands of dea run, of the design that dea fit
 * would have written. */
static double banded_std(void)
{
  static char text[COMMAND_TEXT_MAX];
  static const char key[] = "\"electrode_edge_u_m\": ";
  const char *last = NULL;
  assert_int_equal(
      command_run("run @/examples/frdea-4.yaml -m lumped --study sweep --study uncertainty --set "
                  "film.thickness='94 um' --set pre_stretch=1.42 --set "
                  "fibres.overlap='1.1 mm stretched' --set compute.voltage.to='3 kV' "
                  "--set compute.uncertainty='{parameters: [{name: film.thickness, "
                  "std: 0.1 um}, {name: pre_stretch, std: 0.001}], correlations: "
                  "[-0.6]}' -o bands --force"),
      0);
  command_read("bands/summary.json", text);
  for (const char *at = strstr(text, key); at != NULL; at = strstr(at + 1, key)) {
    last = at; // of the highest voltage, behind the value
  }
  assert_non_null(last);
  return strtod(last + strlen(key), NULL);
}

/* Samples have the fit's values, standard uncertainties and correlation, to what the sampling
 * leaves (no more than plain random samples: 1 / sqrt(N)); what was held keeps its value. The
 * spread of the answer is the band that dea run makes of the same. */
TEST(test_samples)
{
  static char text[COMMAND_TEXT_MAX];
  const int N = 1024;
  double mean[2] = {0}, product[3] = {0};
  int count = 0;
  command_folder_make("device.fit");
  write_fit("device.fit", "", both, both_correlations);
  write_file("from_fit: device.fit\nplan: sobol\nsamples: 1024");
  command_expect("sweep mine.yaml -j 1", 0, "");
  command_read("mine.sweep/cases.csv", text);
  assert_contains(text, "case,id,film.thickness (m),fibres.overlap (m),pre_stretch (1),");
  for (const char *at = strchr(text, '\n'); at != NULL && at[1] != '\0';
       at = strchr(at + 1, '\n')) {
    double t, width, s;
    assert_int_equal(sscanf(at + 1, "%*d,%*[^,],%lf,%lf,%lf", &t, &width, &s), 3);
    assert_close(width, 1.1e-3, 1e-12, 0);
    t = (t - thickness_m) / thickness_std_m;
    s = (s - pre_stretch) / pre_stretch_std;
    mean[0] += t / N;
    mean[1] += s / N;
    product[0] += t * t / N;
    product[1] += s * s / N;
    product[2] += t * s / N;
    count++;
  }
  assert_int_equal(count, N);
  const double random = 1 / sqrt(N);
  assert_close(mean[0], 0, 0, random);
  assert_close(mean[1], 0, 0, random);
  assert_close(product[0], 1, 0, random);
  assert_close(product[1], 1, 0, random);
  assert_close(product[2], correlation, 0, random);
  assert_close(sampled_std(), banded_std(), random, 0);
}

/* A search stands for each design by the fit's values, scattered, and one of them as they are. */
TEST(test_search)
{
  static char text[COMMAND_TEXT_MAX];
  double t, s, product = 0;
  int count = 0, centre = 0;
  write_file("objectives: [{quantity: electrode_edge_u_m}]\nfrom_fit: device.fit/fit.json\n"
             "robust: {samples: 256}");
  command_expect("optimise mine.yaml -j 1", 0, "");
  command_read("mine.optimise/cases.csv", text);
  for (const char *at = strchr(text, '\n'); at != NULL && at[1] != '\0';
       at = strchr(at + 1, '\n')) {
    assert_int_equal(sscanf(at + 1, "%*d,%*[^,],%lf,%*f,%lf", &t, &s), 2);
    t = (t - thickness_m) / thickness_std_m;
    s = (s - pre_stretch) / pre_stretch_std;
    centre += fabs(t) < 1e-6 && fabs(s) < 1e-6 ? 1 : 0;
    product += t * s / 256;
    count++;
  }
  assert_int_equal(count, 256);
  assert_int_equal(centre, 1);
  assert_close(product, correlation, 0, 1 / sqrt(256));
}

/* Of a material: parameters of the film's law. */
TEST(test_material)
{
  static const char c1[] = "{\"name\": \"c1\", \"unit\": \"Pa\", \"value\": 178e3, "
                           "\"standard_uncertainty\": 500}";
  static char text[COMMAND_TEXT_MAX];
  command_folder_make("film.fit");
  write_fit("film.fit", "yeoh", c1, "[1]");
  write_file("from_fit: film.fit\nplan: sobol\nsamples: 4");
  command_expect("sweep mine.yaml -j 1 --force", 0, "");
  command_read("mine.sweep/cases.csv", text);
  assert_contains(text, "case,id,film.law.c1 (Pa),");
  // branches, of which the first is none that the written material has (its modulus is 0)
  write_fit("film.fit", "yeoh",
            "{\"name\": \"c1\", \"unit\": \"Pa\", \"value\": 178e3, "
            "\"standard_uncertainty\": 500}, "
            "{\"name\": \"modulus 1\", \"unit\": \"Pa\", \"value\": 0, \"at_bound\": true}, "
            "{\"name\": \"time 1\", \"unit\": \"s\", \"value\": 1}, "
            "{\"name\": \"modulus 2\", \"unit\": \"Pa\", \"value\": 5e3, "
            "\"standard_uncertainty\": 50}, "
            "{\"name\": \"time 2\", \"unit\": \"s\", \"value\": 3, \"standard_uncertainty\": 0.1}",
            "[1, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0.1, 0, 0, 1, 0.5], "
            "[0.2, 0, 0, 0.5, 1]");
  write_file("from_fit: film.fit\nplan: sobol\nsamples: 4");
  command_expect("sweep mine.yaml -j 1 --force", 0, "");
  command_read("mine.sweep/cases.csv", text);
  assert_contains(text, "id,film.law.c1 (Pa),film.branch.1.modulus (Pa),film.branch.1.time (s),");
  write_fit("film.fit", "gent", c1, "[1]");
  expect("from_fit: film.fit", "mine.yaml:7:11: error: 'film.fit' is a fit of the law gent; the "
                               "film has yeoh");
}

TEST(test_errors)
{
  static const char one[] = "{\"name\": \"%s\", \"unit\": \"%s\", \"film\": \"%s\", "
                            "\"value\": 1e-4, \"standard_uncertainty\": 0.1, \"at_bound\": %s}";
  static const struct {
    const char *name, *unit, *film, *at_bound, *correlations, *more, *message;
  } cases[] = {
      {"film.thicknes", "m", "", "false", "[1]", "plan: sobol",
       "mine.yaml:7:11: error: 'film.thicknes', which 'odd.fit' has fitted, is no number of the "
       "design"},
      {"fibres.overlap", "m", "unstretched", "false", "[1]", "plan: sobol",
       "mine.yaml:7:11: error: fibres.overlap is a length stretched in the design"},
      {"film.thickness", "V", "", "false", "[1]", "plan: sobol", "mine.yaml:7:11: error: "},
      {"film.thickness", "m", "", "false", "[1]", "", "a grid needs values, or steps"},
      {"film.thickness", "m", "", "false", "[1]", "plan: sobol\ncorrelations: [0.5]",
       "mine.yaml:9:16: error: correlations are those of from_fit"},
      {"film.thickness", "m", "", "false", "[1]",
       "plan: sobol\nvariables: [{name: film.thickness, mean: 1 mm, std: 1 um}]",
       "mine.yaml:9:20: error: film.thickness: how it is spread says 'odd.fit'"},
      {"", "m", "", "false", "[1]", "", "has no name or value"},
  };
  command_folder_make("odd.fit");
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char text[400], more[200];
    snprintf(text, sizeof text, one, cases[i].name, cases[i].unit, cases[i].film,
             cases[i].at_bound);
    snprintf(more, sizeof more, "from_fit: odd.fit\n%s", cases[i].more);
    write_fit("odd.fit", "", text, cases[i].correlations);
    expect(more, cases[i].message);
  }
  write_fit("odd.fit", "",
            "{\"name\": \"pre_stretch\", \"unit\": \"1\", \"value\": 1.5, \"at_bound\": true}",
            "[1]");
  write_file("from_fit: odd.fit\nplan: sobol\nsamples: 2");
  command_expect("sweep mine.yaml --force", 0,
                 "mine.yaml:7:11: warning: 'odd.fit' does not know how well pre_stretch is known");
  write_fit("odd.fit", "", both, "[1]");
  expect("from_fit: odd.fit\nplan: sobol", "correlations are missing");
  write_fit("odd.fit", "", both, "[1, 0, 2], [0, 0, 0], [2, 0, 1]");
  expect("from_fit: odd.fit\nplan: sobol", "no numbers have these correlations");
  write_fit("odd.fit", "", both, both_correlations);
  expect("from_fit: odd.fit\nplan: indices", "mine.yaml:7:11: error: correlations are of samples");
  expect("from_fit: none.fit", "mine.yaml:7:11: error: from_fit: ");
  command_write("odd.fit/fit.json", "{\"parameters\": 1");
  expect("from_fit: odd.fit", "mine.yaml:7:11: error: 'odd.fit' is no result of dea fit");
  expect("", "variables: say what changes (or from_fit)");
}

TESTS(command_set_up, command_tear_down)
