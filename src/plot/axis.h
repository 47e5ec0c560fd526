/* An axis of a drawing: what range it shows, where its tics are. */
#pragma once

#include <math.h>
#include <stdbool.h>

struct dea_range {
  double low, high;
};

#define DEA_RANGE_EMPTY ((struct dea_range){INFINITY, -INFINITY})
/* Takes a value in, where it is finite. */
void dea_range_widen(struct dea_range *range, double value);

struct dea_axis {
  double low, high; // of the values; low < high
  double step;      // between tics
  bool logarithmic;
  double at_low, at_high; // places of low and high in the drawing
};

/* An axis for values from low to high, widened to whole tics where a limit is NAN in fixed[2]. */
struct dea_axis dea_axis_create(double low, double high, const double fixed[2], bool logarithmic,
                                int most_tics);
/* Place of a value in the drawing. */
double dea_axis_place(const struct dea_axis *axis, double value);
/* Value of the i-th tic from 0; false beyond the last. */
bool dea_axis_tic(const struct dea_axis *axis, int i, double *value);
