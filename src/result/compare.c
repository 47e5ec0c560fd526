#include "result/compare.h"

#include <math.h>
#include <string.h>

/* Slope at an inner point: weighted harmonic mean of the neighbouring secants, 0 at an extreme. */
static double inner_slope(double h0, double h1, double d0, double d1)
{
  if (d0 * d1 <= 0.0) {
    return 0.0;
  }
  double w0 = 2.0 * h1 + h0, w1 = h1 + 2.0 * h0;
  return (w0 + w1) / (w0 / d0 + w1 / d1);
}

/* Slope at an end from the parabola through three points, limited so that no extreme appears. */
static double end_slope(double h0, double h1, double d0, double d1)
{
  double slope = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (slope * d0 <= 0.0) {
    return 0.0;
  }
  if (d0 * d1 <= 0.0 && fabs(slope) > 3.0 * fabs(d0)) {
    return 3.0 * d0;
  }
  return slope;
}

static double slope_at(const double *x, const double *y, size_t count, size_t i)
{
  if (count == 2) {
    return (y[1] - y[0]) / (x[1] - x[0]);
  }
  if (i == 0) {
    return end_slope(x[1] - x[0], x[2] - x[1], (y[1] - y[0]) / (x[1] - x[0]),
                     (y[2] - y[1]) / (x[2] - x[1]));
  }
  if (i == count - 1) {
    size_t n = count - 1;
    return end_slope(x[n] - x[n - 1], x[n - 1] - x[n - 2], (y[n] - y[n - 1]) / (x[n] - x[n - 1]),
                     (y[n - 1] - y[n - 2]) / (x[n - 1] - x[n - 2]));
  }
  return inner_slope(x[i] - x[i - 1], x[i + 1] - x[i], (y[i] - y[i - 1]) / (x[i] - x[i - 1]),
                     (y[i + 1] - y[i]) / (x[i + 1] - x[i]));
}

double dea_interpolate(const double *x, const double *y, size_t count, double at)
{
  if (count == 0 || !(at >= x[0]) || !(at <= x[count - 1])) {
    return NAN;
  }
  size_t low = 0, high = count - 1;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (x[middle] <= at) {
      low = middle;
    } else {
      high = middle;
    }
  }
  if (at == x[low] || high == low) {
    return y[low]; // so that a common voltage gives the very value
  }
  if (at == x[high]) {
    return y[high];
  }
  double h = x[high] - x[low], t = (at - x[low]) / h;
  double m0 = slope_at(x, y, count, low), m1 = slope_at(x, y, count, high);
  double s = 1.0 - t;
  return s * s * (1.0 + 2.0 * t) * y[low] + t * t * (1.0 + 2.0 * s) * y[high] +
         h * t * s * (s * m0 - t * m1);
}

/* Points of a curve up to where it turns back in voltage. */
static size_t first_leg(const struct dea_curve *curve)
{
  double direction = 0.0;
  for (size_t i = 1; i < curve->count; i++) {
    double step = curve->points[i].voltage_V - curve->points[i - 1].voltage_V;
    if (step * direction < 0.0) {
      return i;
    }
    direction = step != 0.0 ? step : direction;
  }
  return curve->count;
}

/* Table of one quantity along the first leg, voltages rising, without gaps; [leg] each. */
static size_t tabulate(const struct dea_curve *curve, size_t leg, int column, double *x, double *y)
{
  size_t n = 0;
  bool falls = leg > 1 && curve->points[leg - 1].voltage_V < curve->points[0].voltage_V;
  for (size_t k = 0; k < leg; k++) {
    const struct dea_load_point *p = &curve->points[falls ? leg - 1 - k : k];
    double value = dea_point_get(p, column);
    if (!isnan(value) && !isnan(p->voltage_V) && (n == 0 || p->voltage_V > x[n - 1])) {
      x[n] = p->voltage_V;
      y[n++] = value;
    }
  }
  return n;
}

static bool same_voltages(const struct dea_curve *a, const struct dea_curve *b)
{
  for (size_t i = 0; i < a->count && i < b->count; i++) {
    if (a->points[i].voltage_V != b->points[i].voltage_V) {
      return false;
    }
  }
  return a->count == b->count;
}

static void add_point(struct dea_misfit *misfit, double voltage_V, double a, double b, double std)
{
  if (!isnan(a) && !isnan(b)) {
    size_t n = misfit->count++;
    misfit->voltage_V[n] = voltage_V;
    misfit->a[n] = a;
    misfit->b[n] = b;
    misfit->b_std[n] = std;
  }
}

static void summarise(struct dea_misfit *m)
{
  double squares = 0.0, sum = 0.0, low = INFINITY, high = -INFINITY, magnitude = 0.0;
  for (size_t i = 0; i < m->count; i++) {
    double difference = m->a[i] - m->b[i];
    squares += difference * difference;
    sum += difference;
    if (fabs(difference) > fabs(m->largest) || i == 0) {
      m->largest = fabs(difference);
      m->largest_at_V = m->voltage_V[i];
    }
    low = fmin(low, m->b[i]);
    high = fmax(high, m->b[i]);
    magnitude = fmax(magnitude, fabs(m->b[i]));
  }
  m->rms = sqrt(squares / (double)m->count);
  m->bias = sum / (double)m->count;
  m->range = high > low ? high - low : magnitude;
  m->relative_rms = m->rms == 0.0 ? 0.0 : m->rms / m->range;
  m->relative_largest = m->largest == 0.0 ? 0.0 : m->largest / m->range;
}

static void misfit_free(struct dea_context *ctx, struct dea_misfit *misfit)
{
  dea_free(ctx, misfit->voltage_V);
  dea_free(ctx, misfit->a);
  dea_free(ctx, misfit->b);
  dea_free(ctx, misfit->b_std);
}

/* How two curves are brought to common voltages. */
struct pairing {
  const struct dea_curve *a, *b;
  const struct dea_load_point *b_std;
  bool point_by_point;
  bool at_b; // a is interpolated at the voltages of b, else b at those of a
  size_t leg;
};

static struct pairing pair(const struct dea_curve *a, const struct dea_curve *b,
                           const struct dea_load_point *b_std)
{
  struct pairing p = {.a = a, .b = b, .b_std = b_std, .point_by_point = same_voltages(a, b)};
  p.at_b = b_std != NULL || b->count <= a->count;
  p.leg = first_leg(p.at_b ? a : b);
  return p;
}

static void fill(const struct pairing *p, double *x, double *y, struct dea_misfit *m)
{
  const struct dea_curve *table = p->at_b ? p->a : p->b, *points = p->at_b ? p->b : p->a;
  size_t n = p->point_by_point ? 0 : tabulate(table, p->leg, m->column, x, y);
  for (size_t i = 0; i < points->count; i++) {
    double v = points->points[i].voltage_V, own = dea_point_get(&points->points[i], m->column);
    double other = p->point_by_point ? dea_point_get(&table->points[i], m->column)
                                     : dea_interpolate(x, y, n, v);
    double std = p->b_std != NULL && p->at_b ? dea_point_get(&p->b_std[i], m->column) : NAN;
    add_point(m, v, p->at_b ? other : own, p->at_b ? own : other, std);
  }
}

static dea_status compare_column(struct dea_context *ctx, const struct pairing *p, int column,
                                 struct dea_comparison *comparison)
{
  struct dea_misfit *m = &comparison->misfits[comparison->misfit_count];
  size_t points = p->at_b ? p->b->count : p->a->count;
  *m = (struct dea_misfit){.column = column};
  double *x = dea_alloc(ctx, p->leg, sizeof *x), *y = dea_alloc(ctx, p->leg, sizeof *y);
  m->voltage_V = dea_alloc(ctx, points, sizeof *m->voltage_V);
  m->a = dea_alloc(ctx, points, sizeof *m->a);
  m->b = dea_alloc(ctx, points, sizeof *m->b);
  m->b_std = dea_alloc(ctx, points, sizeof *m->b_std);
  bool good = x != NULL && y != NULL && m->voltage_V != NULL && m->a != NULL && m->b != NULL &&
              m->b_std != NULL;
  if (good) {
    fill(p, x, y, m);
  }
  dea_free(ctx, x);
  dea_free(ctx, y);
  if (good && m->count > 0) {
    summarise(m);
    comparison->misfit_count++;
  } else {
    misfit_free(ctx, m);
  }
  return good ? DEA_OK : DEA_E_MEMORY;
}

static dea_status nothing_common(struct dea_context *ctx, const struct dea_curve *a,
                                 const struct dea_curve *b, int column)
{
  if (column >= 0) {
    const char *key = dea_point_columns[column].key;
    bool in_a = dea_points_have(a->points, a->count, column);
    bool in_b = dea_points_have(b->points, b->count, column);
    if (!in_a || !in_b) {
      return dea_fail(ctx, DEA_E_ARGUMENT, "%s of the two has %s",
                      !in_a && !in_b ? "neither"
                      : in_a         ? "only the first"
                                     : "only the second",
                      key);
    }
  }
  return dea_fail(ctx, DEA_E_ARGUMENT,
                  "'%s' and '%s' have no quantity at common voltages: nothing to compare", a->model,
                  b->model);
}

dea_status dea_compare_curves(struct dea_context *ctx, const struct dea_curve *a,
                              const struct dea_curve *b, const struct dea_load_point *b_std,
                              int column, struct dea_comparison **out)
{
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  struct pairing p = pair(a, b, b_std);
  (*out)->part_only = !p.point_by_point && p.leg < (p.at_b ? a : b)->count;
  dea_status status = DEA_OK;
  int voltage = dea_point_column_find("voltage_V");
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS && status == DEA_OK; c++) {
    if (c != voltage && (column < 0 || column == c)) {
      status = compare_column(ctx, &p, c, *out);
    }
  }
  if (status == DEA_OK && (*out)->misfit_count == 0) {
    status = nothing_common(ctx, a, b, column);
  }
  if (status != DEA_OK) {
    dea_comparison_destroy(ctx, *out);
    *out = NULL;
  }
  return status;
}

void dea_comparison_destroy(struct dea_context *ctx, struct dea_comparison *comparison)
{
  if (comparison == NULL) {
    return;
  }
  for (size_t i = 0; i < comparison->misfit_count; i++) {
    misfit_free(ctx, &comparison->misfits[i]);
  }
  dea_free(ctx, comparison);
}
