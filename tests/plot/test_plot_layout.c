/* Room that a figure leaves for what stands beside its panel. */
#include "own_folder.h"
#include "plot/plot.h"
#include "testing.h"

#include <string.h>

/* Millimetres from the left edge to the panel, for a curve from y = from to y = to. */
static double left_mm(double from, double to)
{
  static const struct dea_plot_format format = {.svg = true, .width_m = 0.085};
  struct dea_plot *plot;
  struct dea_series *series;
  char line[400];
  double share = NAN;
  assert_int_equal(dea_plot_create(ctx, "curve", "a curve", &plot), DEA_OK);
  assert_int_equal(dea_panel_add(ctx, &plot->panels[0], 2, DEA_LINE, DEA_BLUE, "", &series),
                   DEA_OK);
  memcpy(series->values, (const double[4]){0, 1, from, to}, 4 * sizeof(double));
  assert_int_equal(dea_plot_write(ctx, plot, &format, folder), DEA_OK);
  dea_plot_destroy(ctx, plot);
  FILE *script = fopen(in_folder("curve.gp"), "r");
  assert_non_null(script);
  while (fgets(line, sizeof line, script) != NULL && isnan(share)) {
    sscanf(line, "set lmargin at screen %lf", &share);
  }
  fclose(script);
  return 85 * share;
}

/* Tics of a curve that is far from 0 and hardly moves have many digits: "-2.018" is 10 mm wide in
 * the figures' type, and the axis' words need 4 mm more. */
TEST(test_room_for_the_tics)
{
  double usual = left_mm(0, 8);
  assert_close(usual, 14, 1e-3, 0);
  assert_close(left_mm(0, 0.35), usual, 1e-12, 0);
  assert_close(left_mm(1, 1.1), usual, 1e-12, 0);
  assert_true(left_mm(0, 0.05) > usual);
  assert_true(left_mm(-2.019, -2.010) > usual + 2.5);
  assert_true(left_mm(-120, -20) >= usual);
  assert_true(left_mm(-1e300, 1e300) > usual);
}

TESTS(set_up, tear_down)
