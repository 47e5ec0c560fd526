/* Widths w, 2 w, 4 w, ... begin at x_k = (2^k - 1) w: elements are 1 wide in the measure
 * dn = dx / h with h(x) = ln 2 (x + w), and a line has as many of them as it is long in that
 * measure. h is the least of that from either end and of the widest. */
#include "model/solid/mesh/cuts.h"

#include <math.h>

static double width_at(double x, double length, double first, double last, double widest)
{
  static const double ln2 = 0.69314718055994531;
  return fmin(widest, ln2 * fmin(x + first, length - x + last));
}

/* Goes along the line in parts of `part` of an element by the midpoint rule, and returns its length
 * in elements. With cuts the line is cut at each whole number of elements of `unit`. */
static double walk(double length, double first, double last, double widest, double unit,
                   size_t count, double *cuts)
{
  static const double part = 0.01;
  double x = 0, n = 0;
  size_t next = 1;
  while (x < length * (1 - 1e-12)) {
    double step = part * width_at(x, length, first, last, widest);
    step = fmin(part * width_at(x + 0.5 * step, length, first, last, widest), length - x);
    double gain = step / width_at(x + 0.5 * step, length, first, last, widest);
    for (; cuts != NULL && next < count && n + gain >= (double)next * unit; next++) {
      cuts[next] = (x + step * ((double)next * unit - n) / gain) / length;
    }
    x += step;
    n += gain;
  }
  return n;
}

size_t dea_cuts_graded(double length, double first, double last, double widest, size_t max,
                       double *cuts)
{
  if (!(length / widest < (double)max && first > 0 && last > 0)) {
    return 0;
  }
  double elements = walk(length, first, last, widest, 1, 0, NULL);
  if (!(elements < (double)max)) {
    return 0;
  }
  size_t count = elements > 1 ? (size_t)ceil(elements - 0.05) : 1;
  cuts[0] = 0;
  walk(length, first, last, widest, elements / (double)count, count, cuts);
  cuts[count] = 1;
  return count;
}

void dea_cuts_through(size_t count, double *cuts)
{
  cuts[0] = 0;
  for (size_t k = 0; k < count; k++) {
    size_t from_face = k < count - 1 - k ? k : count - 1 - k;
    cuts[k + 1] = cuts[k] + (double)(1 << (from_face < 3 ? from_face : 3));
  }
  for (size_t k = 0; k < count; k++) {
    cuts[k] /= cuts[count];
  }
  cuts[count] = 1;
}
