/* The solver of solids on a square film of two layers, each of quadratic hexahedra: assembly and
 * factorisation of K, memory, and how they grow with the unknowns; two ranks against one.
 *
 *   bench_solid_solve [UNKNOWNS...]     default: 10000 30000 100000
 *
 * Each size is a process of its own, so that its memory is its own: the program runs itself as
 * "bench_solid_solve one UNKNOWNS", also under mpirun. DEA_BENCH_LARGE adds 300000. */
#include "model/solid/assembly/assemble.h"
#include "model/solid/assembly/matrix.h"
#include "timing.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>

static const double side_m = 20e-3, thickness_m = 44e-6;

static void map_square(const void *self, double s, double t, double x[2])
{
  (void)self;
  x[0] = side_m * s;
  x[1] = side_m * t;
}

static bool under_voltage(const void *self, int region, int ply)
{
  (void)self;
  (void)region;
  return ply == 0;
}

static int edges(const void *self, const double X[3])
{
  double close = 1e-9 * side_m;
  (void)self;
  return X[0] < close || X[1] < close || X[0] > side_m - close || X[1] > side_m - close ? 1 | 2 | 4
                                                                                        : 0;
}

/* What is measured, in this order; memory in bytes over all ranks. */
enum { UNKNOWNS, CREATE, ASSEMBLE, ENERGY, FIRST, FACTOR, SOLVE, MEMORY, FIGURES };

struct sample {
  double of[FIGURES];
};

static void measure(struct dea_context *ctx, struct dea_solid *s, struct sample *out)
{
  double energy, start;
  int negative;
  for (int i = 0; i < 3; i++) {
    start = bench_now_s();
    bench_need(dea_solid_assemble(ctx, s, 2e3, DEA_TANGENT, &energy), ctx);
    out->of[ASSEMBLE] = fmin(out->of[ASSEMBLE], bench_now_s() - start);
    start = bench_now_s();
    bench_need(dea_solid_energy(s, s->state.u, 2e3, &energy), ctx);
    out->of[ENERGY] = fmin(out->of[ENERGY], bench_now_s() - start);
  }
  for (int i = 0; i < 3; i++) { // the first one with the analysis
    start = bench_now_s();
    bench_need(dea_solid_factorise(ctx, s, DEA_FACTOR_EXACT, &negative), ctx);
    double time = bench_now_s() - start;
    out->of[i == 0 ? FIRST : FACTOR] = fmin(out->of[i == 0 ? FIRST : FACTOR], time);
    start = bench_now_s();
    bench_need(dea_solid_solve_linear(ctx, s, s->work.g, s->work.step), ctx);
    out->of[SOLVE] = fmin(out->of[SOLVE], bench_now_s() - start);
  }
}

/* One size; the first rank prints the figures. */
static int run_one(double unknowns)
{
  enum { CUTS_MAX = 400 };
  static double cuts[CUTS_MAX + 1];
  size_t count = (size_t)lround(0.5 * (sqrt(unknowns / 15) - 1)); // (2 count + 1)^2 columns of five
  struct dea_part_material layer = {.law = dea_law_find("yeoh"),
                                    .param = {178.4e3, -6e3, 4.2e3},
                                    .pre_stretch = {1.5, 1.5, 1 / 2.25},
                                    .kappa_Pa = 4e7,
                                    .permittivity_F_per_m = 2.5e-11,
                                    .thickness_m = thickness_m};
  const struct dea_block block = {map_square, NULL, cuts, cuts, count, count, 0};
  const struct dea_ply plies[] = {{thickness_m, 1, 2}, {thickness_m, 1, 2}};
  const struct dea_solid_options options = {.order_z = 2,
                                            .part_material_count = 1,
                                            .part_materials = &layer,
                                            .active = under_voltage,
                                            .held = edges};
  struct dea_context *ctx = NULL;
  struct dea_grid *grid;
  struct dea_solid *solid;
  struct sample sample;
  if (count < 1 || count > CUTS_MAX || dea_context_create(NULL, &ctx) != DEA_OK) {
    return 1;
  }
  for (size_t i = 0; i <= count; i++) {
    cuts[i] = (double)i / (double)count;
  }
  for (int i = 0; i < FIGURES; i++) {
    sample.of[i] = INFINITY;
  }
  bench_need(dea_part_material_relax(&layer), ctx);
  bench_need(dea_solid_start(ctx), ctx);
  double start = bench_now_s();
  bench_need(dea_grid_create(ctx, 2, &block, 1, plies, 2, NULL, 0, side_m, &grid), ctx);
  bench_need(dea_solid_create(ctx, grid, &options, &solid), ctx);
  sample.of[CREATE] = bench_now_s() - start;
  measure(ctx, solid, &sample);
  sample.of[UNKNOWNS] = (double)solid->problem.dofs;
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  sample.of[MEMORY] = 1024.0 * (double)usage.ru_maxrss;
  dea_solid_sum(&sample.of[MEMORY], 1);
  for (int i = 0; i < FIGURES && dea_solid_rank() == 0; i++) {
    printf("%.17g\n", sample.of[i]);
  }
  dea_solid_destroy(ctx, solid);
  dea_grid_destroy(ctx, grid);
  dea_solid_stop();
  dea_context_destroy(ctx);
  return 0;
}

/* Runs this program for one size, on `ranks` processes; false: it could not be run. */
static bool run_size(const char *program, double unknowns, int ranks, struct sample *out)
{
  char line[1200];
  int length = ranks == 1 ? 0
                          : snprintf(line, sizeof line,
                                     "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
                                     "mpirun --oversubscribe --bind-to none -n %d ",
                                     ranks);
  snprintf(line + length, sizeof line - (size_t)length, "'%s' one %.0f", program, unknowns);
  FILE *pipe = popen(line, "r");
  bool read = pipe != NULL;
  for (int i = 0; i < FIGURES && read; i++) {
    read = fscanf(pipe, "%lf", &out->of[i]) == 1;
  }
  return pipe != NULL && pclose(pipe) == 0 && read;
}

/* Slope of log y over log x through all sizes. */
static double exponent(const struct sample *samples, size_t count, int figure)
{
  double x = 0, y = 0, xx = 0, xy = 0, n = (double)count;
  for (size_t i = 0; i < count; i++) {
    double a = log(samples[i].of[UNKNOWNS]), b = log(samples[i].of[figure]);
    x += a / n;
    y += b / n;
    xx += a * a / n;
    xy += a * b / n;
  }
  return (xy - x * y) / (xx - x * x);
}

static void print_size(const struct sample *s)
{
  static const struct {
    int figure;
    double factor;
    const char *name, *unit;
  } rows[] = {{CREATE, 1, "create", "s"},    {ASSEMBLE, 1, "assemble", "s"},
              {ENERGY, 1, "energy", "s"},    {FIRST, 1, "factor_first", "s"},
              {FACTOR, 1, "factor", "s"},    {SOLVE, 1, "solve", "s"},
              {MEMORY, 1e-9, "memory", "GB"}};
  char name[80];
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    snprintf(name, sizeof name, "solid_solve.%.0fk.%s", 1e-3 * s->of[UNKNOWNS], rows[i].name);
    bench_print(name, rows[i].factor * s->of[rows[i].figure], rows[i].unit);
  }
  snprintf(name, sizeof name, "solid_solve.%.0fk.assemble_over_factor", 1e-3 * s->of[UNKNOWNS]);
  bench_print(name, s->of[ASSEMBLE] / s->of[FACTOR], "1");
}

int main(int argc, char **argv)
{
  enum { SIZES_MAX = 16 };
  double sizes[SIZES_MAX] = {10e3, 30e3, 100e3, 300e3};
  size_t count = getenv("DEA_BENCH_LARGE") != NULL ? 4 : 3;
  struct sample samples[SIZES_MAX], two;
  if (argc == 3 && strcmp(argv[1], "one") == 0) {
    return run_one(strtod(argv[2], NULL));
  }
  for (int i = 1; i < argc && i <= SIZES_MAX; i++) {
    sizes[i - 1] = strtod(argv[i], NULL);
    count = (size_t)i;
  }
  for (size_t i = 0; i < count; i++) {
    if (!run_size(argv[0], sizes[i], 1, &samples[i])) {
      return 1;
    }
    print_size(&samples[i]);
  }
  if (count > 1) {
    bench_print("solid_solve.exponent.assemble", exponent(samples, count, ASSEMBLE), "1");
    bench_print("solid_solve.exponent.factor", exponent(samples, count, FACTOR), "1");
    bench_print("solid_solve.exponent.memory", exponent(samples, count, MEMORY), "1");
  }
  if (run_size(argv[0], sizes[count - 1], 2, &two)) { // where there is an mpirun
    const struct sample *one = &samples[count - 1];
    bench_print("solid_solve.two_ranks.assemble", two.of[ASSEMBLE] / one->of[ASSEMBLE], "of one");
    bench_print("solid_solve.two_ranks.factor", two.of[FACTOR] / one->of[FACTOR], "of one");
    bench_print("solid_solve.two_ranks.memory", two.of[MEMORY] / one->of[MEMORY], "of one");
  }
  return 0;
}
