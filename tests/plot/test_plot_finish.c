/* What is added to gnuplot's pictures, what does not set an axis, and what stands in the key. */
#include "context_fixture.h"
#include "plot/finish.h"
#include "plot/plot.h"
#include "plot/script.h"
#include "result/columns.h"
#include "result/figure.h"
#include "testing.h"

#include <string.h>

/* An SVG as gnuplot 5.4 writes it, and what becomes of it. */
TEST(test_svg)
{
  static const char before[] =
      "<svg>\n<title>Gnuplot</title>\n<g id=\"gnuplot_plot_1\" ><title>gnuplot_plot_1</title>\n"
      "\t<g stroke='none' shape-rendering='crispEdges'>\n"
      "\t\t<polygon fill = 'rgb(  2, 106, 168)' points = '1,2 3,4 5,6 '/>\n"
      "\t\t<polygon fill = 'rgb(1,2,3)' fill-opacity = '0.5' points = '1,2 3,4 5,6 '/>\n\t</g>\n"
      "<text font-family=\"DejaVu Sans\" >of</text><text font-family=\"Times\">f</text></g>\n";
  static const char after[] =
      "<svg>\n<title>1 &lt; 2 &amp; 3</title>\n<g id=\"gnuplot_plot_1\" >\n"
      "\t<g stroke='none' stroke-width='0.8' stroke-linejoin='round'>\n"
      "\t\t<polygon fill='rgb(  2, 106, 168)' stroke='rgb(  2, 106, 168)' points='1,2 3,4 5,6 '/>\n"
      "\t\t<polygon fill = 'rgb(1,2,3)' fill-opacity = '0.5' points = '1,2 3,4 5,6 '/>\n\t</g>\n"
      "<text font-family=\"DejaVu Sans, Verdana, sans-serif\" >of</text>"
      "<text font-family=\"Times\">f</text></g>\n";
  char *out;
  assert_int_equal(dea_svg_finish(ctx, before, "1 < 2 & 3", &out), DEA_OK);
  assert_string_equal(out, after);
  dea_free(ctx, out);
  assert_int_equal(dea_svg_finish(ctx, "", "", &out), DEA_OK);
  assert_string_equal(out, "");
  dea_free(ctx, out);
}

/* The chunk of 300 dots an inch, its check as other programs write it. */
TEST(test_png)
{
  static const unsigned char chunk[21] = {0,    0, 0, 9,    'p',  'H', 'Y',  's',  0,    0,   0x2e,
                                          0x23, 0, 0, 0x2e, 0x23, 1,   0x78, 0xa5, 0x3f, 0x76};
  char png[60] = "\211PNG\r\n\032\n", *out, *again;
  size_t length, same;
  for (size_t i = 8; i < sizeof png; i++) {
    png[i] = (char)i;
  }
  assert_int_equal(dea_png_finish(ctx, png, sizeof png, &out, &length), DEA_OK);
  assert_int_equal(length, sizeof png + sizeof chunk);
  assert_memory_equal(out, png, 33);
  assert_memory_equal(out + 33, chunk, sizeof chunk);
  assert_memory_equal(out + 33 + sizeof chunk, png + 33, sizeof png - 33);
  assert_int_equal(dea_png_finish(ctx, out, length, &again, &same), DEA_OK);
  assert_int_equal(same, length); // it has one
  assert_memory_equal(again, out, length);
  dea_free(ctx, again);
  dea_free(ctx, out);
  assert_int_equal(dea_png_finish(ctx, "text", 4, &out, &length), DEA_OK);
  assert_int_equal(length, 4);
  dea_free(ctx, out);
}

static void add(struct dea_panel *panel, double from, double to, bool secondary)
{
  struct dea_series *series;
  assert_int_equal(dea_panel_add(ctx, panel, 2, DEA_LINE, DEA_BLUE, "", &series), DEA_OK);
  memcpy(series->values, (const double[4]){0, 8, from, to}, 4 * sizeof(double));
  series->secondary = secondary;
}

/* Slack points reach to -1766 N/m and are not to be trusted: the axis is that of the others. */
TEST(test_what_is_aside_does_not_set_the_axis)
{
  struct dea_plot *plot;
  double low, high;
  assert_int_equal(dea_plot_create(ctx, "tension", "", &plot), DEA_OK);
  struct dea_panel *panel = &plot->panels[0];
  assert_false(dea_panel_range(panel, &low, &high));
  add(panel, 35, 20, false);
  add(panel, 20, -1766, true);
  assert_true(dea_panel_range(panel, &low, &high));
  assert_close(low, 12.5, 1e-12, 0);
  assert_close(high, 35, 1e-12, 0);
  dea_panel_voltage_axis(panel);
  assert_close(panel->y_min, 10, 1e-12, 0);
  assert_true(isnan(panel->y_max)); // left to gnuplot
  add(panel, 36, 38, true);         // little more than the others
  assert_true(dea_panel_range(panel, &low, &high));
  assert_close(high, 38, 1e-12, 0);
  dea_panel_clear(ctx, panel);
  add(panel, 20, -1766, true); // nothing else is there
  assert_true(dea_panel_range(panel, &low, &high));
  assert_close(low, -1766, 1e-12, 0);
  dea_plot_destroy(ctx, plot);
}

/* How many series of the panel that show something carry that title. */
static int titled(const struct dea_panel *panel, const char *title)
{
  int count = 0;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    count += strcmp(series->title, title) == 0 && dea_series_shows(series);
  }
  return count;
}

/* A preview is wholly doubtful: its curve is dashed and still has its name in the key, once. */
TEST(test_a_doubtful_curve_keeps_its_name)
{
  enum { POINTS = 81 };
  struct dea_load_point points[POINTS];
  const struct dea_curve curve = {.points = points, .count = POINTS};
  const struct dea_series look = {.style = DEA_LINE_MARKED, .title = "3d"};
  const int column = dea_point_column_find("centre_z_m");
  struct dea_plot *plot;
  for (int first = 0; first < 2; first++) { // all points doubtful, all but the first
    for (size_t i = 0; i < POINTS; i++) {
      points[i] = dea_load_point_empty();
      points[i].voltage_V = 100.0 * (double)i;
      points[i].centre_z_m = 1e-6 * (double)i;
      points[i].own_flags = i >= (size_t)first ? 1u << DEA_FLAG_PREVIEW : 0;
    }
    assert_int_equal(dea_plot_create(ctx, "z", "", &plot), DEA_OK);
    struct dea_panel *panel = &plot->panels[0];
    assert_int_equal(dea_figure_add(ctx, panel, &curve, column, 1e6, 0, &look), DEA_OK);
    assert_int_equal(titled(panel, "3d"), 1);
    assert_string_equal(panel->dashed, "not to be trusted");
    assert_int_equal(panel->series_count, first == 0 ? 3 : 2);
    dea_plot_destroy(ctx, plot);
  }
}

TESTS(context_set_up, context_tear_down)
