/* Widths w, q w, q^2 w, ... begin at x_k = (q^k - 1) w / (q - 1): elements are 1 wide in the
 * measure dn = dx / h with h(x) = ln q (x + w / (q - 1)), and a line has as many of them as it is
 * long in that measure. h is the least of that from either end and of the widest. */
#include "model/solid/mesh/cuts.h"

#include <math.h>

struct grading {
  double length, first, last, growth, widest;
};

static double width_at(const struct grading *g, double x)
{
  double from_first = x + g->first / (g->growth - 1);
  double from_last = g->length - x + g->last / (g->growth - 1);
  return fmin(g->widest, log(g->growth) * fmin(from_first, from_last));
}

/* Goes along the line in parts of `part` of an element by the midpoint rule, and returns its length
 * in elements. With cuts the line is cut at each whole number of elements of `unit`. */
static double walk(const struct grading *g, double unit, size_t count, double *cuts)
{
  static const double part = 0.01;
  double x = 0, n = 0, length = g->length;
  size_t next = 1;
  while (x < length * (1 - 1e-12)) {
    double step = part * width_at(g, x);
    step = fmin(part * width_at(g, x + 0.5 * step), length - x);
    double gain = step / width_at(g, x + 0.5 * step);
    for (; cuts != NULL && next < count && n + gain >= (double)next * unit; next++) {
      cuts[next] = (x + step * ((double)next * unit - n) / gain) / length;
    }
    x += step;
    n += gain;
  }
  return n;
}

size_t dea_cuts_graded(double length, double first, double last, double growth, double widest,
                       size_t max, double *cuts)
{
  const struct grading grading = {length, first, last, growth, widest};
  if (!(length / widest < (double)max && first > 0 && last > 0 && growth > 1)) {
    return 0;
  }
  double elements = walk(&grading, 1, 0, NULL);
  if (!(elements < (double)max)) {
    return 0;
  }
  size_t count = elements > 1 ? (size_t)ceil(elements - 0.05) : 1;
  cuts[0] = 0;
  walk(&grading, elements / (double)count, count, cuts);
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
