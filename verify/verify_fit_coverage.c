/* How often the error bars of dea fit hold the truth: synthetic data sets of three materials, with
 * noise that is white or runs together, fitted as the command fits them. */
#include "identify/fit.h"
#include "verify.h"

#include <stdint.h>

enum { TESTS_MAX = 3, ROWS_MAX = 150 };

static struct dea_context *ctx;

/* ---- data ---- */

static double uniform(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return ((double)(*seed >> 11) + 0.5) / 9007199254740992.0;
}

static double normal(uint64_t *seed)
{
  const double r = sqrt(-2 * log(uniform(seed)));
  return r * cos(2 * 3.14159265358979323846 * uniform(seed));
}

/* A material and what it is tested by. */
struct subject {
  const char *title, *law;
  size_t params, tests, rows;
  double truth[8];            // of the law, then modulus and time of a branch
  double to[TESTS_MAX];       // stretches that the tests go to; a relaxation: held
  double from_s, last_s;      // of a relaxation: after its ramp, and its end
  const char *const *names;   // [params]
  const double *factors;      // [params] to the unit that is shown
  double smallest_std, share; // noise of a row: hypot(smallest_std, share * stress)
};

static const char *const yeoh_names[] = {"c1 (kPa)", "c2 (kPa)", "c3 (kPa)"};
static const char *const gent_names[] = {"mu (kPa)", "jm"};
static const char *const branch_names[] = {"mu (kPa)", "modulus 1 (kPa)", "time 1 (s)"};
static const double kilo[] = {1e-3, 1e-3, 1e-3}, kilo_one[] = {1e-3, 1},
                    kilo_second[] = {1e-3, 1e-3, 1};

static const struct subject subjects[] = {
    {"Yeoh, three tests of 50 rows",
     "yeoh",
     3,
     3,
     50,
     {178.4e3, -6e3, 4.2e3},
     {2.2, 2.0, 1.8},
     0,
     0,
     yeoh_names,
     kilo,
     1e3,
     0.01},
    {"Gent, one test of 100 rows",
     "gent",
     2,
     1,
     100,
     {100e3, 20},
     {3.5},
     0,
     0,
     gent_names,
     kilo_one,
     500,
     0.01},
    {"Neo-Hooke with a branch, one relaxation of 150 rows",
     "neo-hookean",
     3,
     1,
     150,
     {50e3, 30e3, 20},
     {2},
     1,
     200,
     branch_names,
     kilo_second,
     500,
     0.01},
};
enum { SUBJECTS = sizeof subjects / sizeof subjects[0] };

/* One data set, in memory of its own. */
struct data {
  struct dea_fit_file file;
  struct dea_fit_series series[TESTS_MAX];
  double clean[TESTS_MAX][ROWS_MAX], std[TESTS_MAX][ROWS_MAX];
  struct dea_arena memory;
};

static void make_rows(const struct subject *s, size_t t, struct data *d)
{
  struct dea_fit_series *series = &d->series[t];
  struct dea_fit_test *test = &d->file.tests[t];
  const bool held = s->last_s > 0;
  struct dea_material material = {.law = dea_law_find(s->law)};
  for (size_t j = 0; j < material.law->param_count; j++) {
    material.param[j] = s->truth[j];
  }
  test->kind.value = held ? (int)DEA_FIT_RELAXATION : (int)t;
  test->stretch.si = held ? s->to[t] : NAN;
  *series = (struct dea_fit_series){.test = test, .file = "none", .rows = s->rows};
  double *values = dea_arena_alloc(&d->memory, 4 * s->rows, sizeof *values);
  series->stretch = values;
  series->stress_Pa = values + s->rows;
  series->std_Pa = values + 2 * s->rows;
  series->time_s = held ? values + 3 * s->rows : NULL;
  for (size_t i = 0; i < s->rows; i++) {
    const double x = (double)(i + 1) / (double)s->rows;
    series->stretch[i] = held ? s->to[t] : 1 + (s->to[t] - 1) * x;
    if (held) {
      series->time_s[i] = s->from_s * pow(s->last_s / s->from_s, x - 1.0 / (double)s->rows);
    }
  }
  series->coupon = (struct dea_coupon){.mode = held ? DEA_UNIAXIAL : (enum dea_coupon_mode)t,
                                       .rows = s->rows,
                                       .stretch = series->stretch};
  struct dea_coupon_shares shares = {.share = NULL};
  if (held) {
    material.branch_count = 1;
    material.branches[0] = (struct dea_branch){s->truth[1], s->truth[2]};
    verify_ok(ctx, dea_coupon_follow(&d->memory, series->time_s, s->from_s, &series->coupon));
    verify_ok(ctx, dea_coupon_shares_build(&d->memory, &series->coupon, 1, &shares));
  }
  verify_ok(ctx, dea_coupon_stress(&material, &series->coupon, held ? &shares : NULL, d->clean[t]));
  for (size_t i = 0; i < s->rows; i++) {
    d->std[t][i] = hypot(s->smallest_std, s->share * d->clean[t][i]);
  }
}

static void make_data(const struct subject *s, struct data *d)
{
  memset(d, 0, sizeof *d);
  d->memory.ctx = ctx;
  snprintf(d->file.branches.text, sizeof d->file.branches.text, s->last_s > 0 ? "1" : "none");
  snprintf(d->file.laws[0].text, sizeof d->file.laws[0].text, "%s", s->law);
  d->file.law_count = 1;
  d->file.test_count = s->tests;
  for (size_t t = 0; t < s->tests; t++) {
    make_rows(s, t, d);
  }
  verify_ok(ctx, dea_arena_status(&d->memory));
}

/* Noise of the correlation rho from row to row; known: the fit is told its size. */
static void add_noise(const struct subject *s, double rho, bool known, uint64_t *seed,
                      struct data *d)
{
  for (size_t t = 0; t < s->tests; t++) {
    double noise = normal(seed);
    for (size_t i = 0; i < s->rows; i++) {
      // where its size is not told it is the same in all rows, as the fit then takes it
      const double std = known ? d->std[t][i] : d->std[0][s->rows / 2];
      d->series[t].stress_Pa[i] = d->clean[t][i] + std * noise;
      d->series[t].std_Pa[i] = known ? std : NAN;
      noise = rho * noise + sqrt(1 - rho * rho) * normal(seed);
    }
  }
}

/* ---- counting ---- */

struct count {
  size_t within_1, within_2, profile; // intervals that hold the truth
  double sum, squares, std;           // of the values found, and of the standard uncertainties
};

static struct data data; // large

/* Profiles, which take most of the time, of the first quarter of the sets. */
static void try_sets(const struct subject *s, double rho, bool known, size_t sets,
                     struct count counts[8])
{
  uint64_t seed = 7;
  make_data(s, &data);
  for (size_t k = 0; k < sets; k++) {
    const bool profiles = 4 * k < sets;
    struct dea_fit fit;
    add_noise(s, rho, known, &seed, &data);
    verify_ok(ctx, dea_fit_run(ctx, &data.file, data.series, s->tests, profiles, &fit));
    for (size_t j = 0; j < s->params; j++) {
      const struct dea_fit_value *v = &fit.core.values[j];
      struct count *c = &counts[j];
      const double off = fabs(v->value - s->truth[j]);
      c->within_1 += off <= v->std ? 1U : 0U;
      c->within_2 += off <= 1.96 * v->std ? 1U : 0U;
      c->profile += s->truth[j] >= v->low && s->truth[j] <= v->high ? 1U : 0U;
      c->sum += v->value - s->truth[j];
      c->squares += off * off;
      c->std += v->std;
    }
    dea_fit_free(&fit);
  }
  dea_arena_free(&data.memory);
}

static void print_case(const struct subject *s, double rho, bool known, size_t sets, bool small)
{
  struct count counts[8] = {{0}};
  // three and more standard deviations of the count
  const double n = (double)sets, tolerance = small ? 0.13 : 0.03, rough = small ? 0.26 : 0.065;
  try_sets(s, rho, known, sets, counts);
  for (size_t j = 0; j < s->params; j++) {
    const struct count *c = &counts[j];
    const double mean = c->sum / n, scatter = sqrt(c->squares / n - mean * mean);
    if (known == (rho <= 0)) { // the simplest and the hardest case
      printf("| %g | %s | %s | %.1f | %.1f | %.1f | %.4g | %.4g |\n", rho, known ? "yes" : "no",
             s->names[j], 100 * (double)c->within_1 / n, 400 * (double)c->profile / n,
             100 * (double)c->within_2 / n, s->factors[j] * scatter, s->factors[j] * c->std / n);
    }
    verify_absolute(s->names[j], (double)c->within_1 / n, 0.683, tolerance);
    verify_absolute(s->names[j], 4 * (double)c->profile / n, 0.683, rough);
  }
}

int main(int argc, char **argv)
{
  const bool small = verify_is_small(argc, argv);
  const size_t sets = small ? 120 : 2000;
  const double rhos[] = {0, 0.6};
  verify_ok(NULL, dea_context_create(NULL, &ctx));
  printf(
      "# Coverage of the error bars of `dea fit`\n\n"
      "Made by `scripts/verify fit-coverage`; not to be edited. %zu synthetic data sets a line, "
      "fitted as\nthe command does. Noise of a row: 1 %% of its stress and 0.5 or 1 kPa, squares "
      "added; it is white, or\na row has the correlation ρ with the next. Where its size is not "
      "told to the fit it is the same in\nall rows. Truth within one standard uncertainty "
      "(tolerance: 68.3 ± %g %%), of a quarter of the sets within\nthe 68 %% interval of the "
      "profile (± %g %%), within 1.96 standard uncertainties (95 %%); beside them the\nscatter of "
      "the values found and the mean of the uncertainties that were given for it. Of the four "
      "cases "
      "of noise the\nsimplest and the hardest are shown.\n",
      sets, small ? 13.0 : 3.0, small ? 26.0 : 6.5);
  for (size_t k = 0; k < SUBJECTS; k++) {
    printf(
        "\n## %s\n\n"
        "| ρ | size told | parameter | ± 1 std (%%) | 68 %% profile (%%) | 95 %% (%%) | scatter | "
        "std |\n|---|---|---|---|---|---|---|---|\n",
        subjects[k].title);
    for (size_t r = 0; r < 2; r++) {
      print_case(&subjects[k], rhos[r], true, sets, small);
      print_case(&subjects[k], rhos[r], false, sets, small);
    }
  }
  dea_context_destroy(ctx);
  return verify_end();
}
