/* Where the key of a panel stands: in a corner that no curve crosses, or else above all curves. */
#include "plot/axis.h"
#include "plot/plot.h"

#include <math.h>

/* Share of the panel that the key takes, a little more than it needs at 85 mm. */
static const double key_width = 0.48, key_line_height = 0.075;
enum { PIECES = 8 }; // of a line between two points

static double share(const struct dea_range *range, double value)
{
  return range->high > range->low ? (value - range->low) / (range->high - range->low) : 0.5;
}

/* Box of the key in shares of the panel. */
struct box {
  double width, height;
  bool left, top;
};

/* Whether the line through the points of a series comes into the box. */
static bool crosses(const struct dea_series *series, const struct dea_range *x,
                    const struct dea_range *y, const struct box *box)
{
  size_t n = series->count;
  for (size_t i = 0; i + 1 < n; i++) {
    for (int k = 0; k <= PIECES; k++) {
      double t = (double)k / PIECES;
      double at_x = share(x, (1 - t) * series->values[i] + t * series->values[i + 1]);
      double at_y = share(y, (1 - t) * series->values[n + i] + t * series->values[n + i + 1]);
      bool beside = box->left ? at_x < box->width : at_x > 1 - box->width;
      bool level = box->top ? at_y > 1 - box->height : at_y < box->height;
      if (beside && level) { // never for what is not a number
        return true;
      }
    }
  }
  return false;
}

void dea_panel_key_above(struct dea_panel *panel, size_t rows)
{
#define KEY(rows) "above horizontal maxrows " rows " samplen 1 width key_width"
  static const char *const keys[] = {KEY("1"), KEY("2"), KEY("3"), KEY("4"), KEY("5"),
                                     KEY("6"), KEY("7"), KEY("8"), KEY("9")};
#undef KEY
  size_t most = sizeof keys / sizeof keys[0];
  panel->key = keys[rows < 1 ? 0 : rows > most ? most - 1 : rows - 1];
}

void dea_panel_place_key(struct dea_panel *panel)
{
  static const struct {
    const char *name;
    bool left, top;
  } corners[] = {{"top left", true, true},
                 {"bottom right", false, false},
                 {"bottom left", true, false},
                 {"top right", false, true}};
  struct dea_range x = DEA_RANGE_EMPTY, y;
  double lines = (panel->dashed != NULL) ? 1.6 : 0.6;
  for (size_t s = 0; s < panel->series_count; s++) {
    const struct dea_series *series = &panel->series[s];
    bool shown = false;
    for (size_t i = 0; i < series->count; i++) {
      shown = shown || isfinite(series->values[series->count + i]);
      bool inside = !(series->values[i] < panel->x_min) && !(series->values[i] > panel->x_max);
      dea_range_widen(&x, inside ? series->values[i] : NAN);
    }
    lines += shown && series->title[0] != '\0';
  }
  dea_panel_range(panel, &y.low, &y.high);
  dea_range_widen(&y, panel->y_min);
  dea_range_widen(&y, panel->y_max);
  struct box box = {key_width, fmin(lines * key_line_height, 0.6), true, true};
  for (size_t c = 0; c < sizeof corners / sizeof corners[0]; c++) {
    bool crossed = false;
    box.left = corners[c].left;
    box.top = corners[c].top;
    for (size_t s = 0; s < panel->series_count && !crossed; s++) {
      crossed = crosses(&panel->series[s], &x, &y, &box);
    }
    for (size_t m = 0; m < panel->mark_count && !crossed; m++) {
      double at = share(&y, panel->marks[m].at);
      crossed = box.top ? at > 1 - box.height : at < box.height;
    }
    if (!crossed) {
      panel->key = corners[c].name;
      return;
    }
  }
  panel->key = "top left";
  panel->y_max = y.low + (y.high - y.low) / (1 - box.height);
}
