/* How many lumped equilibria a second, on one core, through the batch interface. */
#include "bench.h"
#include "model/lumped/lumped.h"

#include <stdlib.h>
#include <string.h>

enum { COUNT = 200000 };

static double columns[5][COUNT];

static void solve(void *user)
{
  struct dea_lumped_batch batch = {COUNT,      columns[0], columns[1], columns[2],
                                   columns[3], 6,          columns[4]};
  if (dea_lumped_batch_solve(user, &batch) != DEA_OK) {
    abort();
  }
}

int main(void)
{
  static const struct {
    const char *law, *name;
    double p[3];
  } laws[] = {{"yeoh", "lumped.batch_yeoh", {178.4e3, -6e3, 4.2e3}},
              {"gent", "lumped.batch_gent", {3.57e5, 60, 0}},
              {"ogden", "lumped.batch_ogden", {2.4e5, 3, 0}}};
  for (int i = 0; i < COUNT;
       i++) { // 100 and 200 um, pre-stretch 1.2 to 1.8, R 0.1 to 0.4, 0 to 8 kV
    columns[0][i] = i % 2 == 0 ? 100e-6 : 200e-6;
    columns[1][i] = 1.2 + 0.6 * (i % 97) / 96;
    columns[2][i] = 0.1 + 0.3 * (i % 89) / 88;
    columns[3][i] = 8e3 * (i % 1009) / 1008;
  }
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
    struct dea_material m = {.law = dea_law_find(laws[k].law), .permittivity.at_rest = 2.8};
    memcpy(m.param, laws[k].p, sizeof laws[k].p);
    bench_print(laws[k].name, COUNT / bench_best_s(solve, &m, 5), "equilibria/s");
  }
  return 0;
}
