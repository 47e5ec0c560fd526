/* Where the key of a figure stands. */
#include "plot/plot.h"
#include "testing.h"

enum { POINTS = 41 };

/* Key of a panel with one curve y(x), x from 0 to 1; *top is the panel's upper limit. */
static const char *key_of(double (*y)(double x), double *top)
{
  static struct dea_panel panel;
  static double values[3 * POINTS];
  panel = (struct dea_panel){
      .key = "", .x_min = NAN, .x_max = NAN, .y_min = NAN, .y_max = NAN, .series_count = 1};
  panel.series[0] = (struct dea_series){.title = "curve", .count = POINTS, .values = values};
  for (size_t i = 0; i < POINTS; i++) {
    values[i] = (double)i / (POINTS - 1);
    values[POINTS + i] = y(values[i]);
  }
  dea_panel_place_key(&panel);
  *top = panel.y_max;
  return panel.key;
}

static double rising(double x)
{
  return x * x;
}

static double saturating(double x)
{
  return pow(x, 0.05);
}

static double falling(double x)
{
  return 1 - x * x;
}

static double waving(double x)
{
  return 0.5 + 0.5 * sin(50 * x);
}

TEST(test_key_stands_where_no_curve_is)
{
  double top;
  assert_string_equal(key_of(rising, &top), "top left");
  assert_string_equal(key_of(saturating, &top), "bottom right");
  assert_string_equal(key_of(falling, &top), "bottom left");
  assert_true(isnan(top)); // left to gnuplot
}

TEST(test_key_above_curves_that_fill_the_panel)
{
  double top;
  assert_string_equal(key_of(waving, &top), "top left");
  assert_true(top > 1.05 && top < 1.3);
}

TESTS(NULL, NULL)
