#include "result/compare.h"

#include "result/observation.h"

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

double dea_interpolate_slope(const double *x, const double *y, size_t count, size_t i)
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

/* Last i with x[i] <= at and i < last, for x[0] <= at. */
static size_t find_piece(const double *x, size_t last, double at)
{
  size_t low = 0, high = last;
  while (high - low > 1) {
    size_t middle = low + (high - low) / 2;
    if (x[middle] <= at) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

double dea_interpolate(const double *x, const double *y, size_t count, double at)
{
  if (count == 0 || !(at >= x[0]) || !(at <= x[count - 1])) {
    return NAN;
  }
  size_t low = count > 1 ? find_piece(x, count - 1, at) : 0, high = low + 1;
  if (at == x[low] || high == count) {
    return y[low]; // so that a common voltage gives the very value
  }
  if (at == x[high]) {
    return y[high];
  }
  double h = x[high] - x[low], t = (at - x[low]) / h;
  double m0 = dea_interpolate_slope(x, y, count, low),
         m1 = dea_interpolate_slope(x, y, count, high);
  double s = 1.0 - t;
  return s * s * (1.0 + 2.0 * t) * y[low] + t * t * (1.0 + 2.0 * s) * y[high] +
         h * t * s * (s * m0 - t * m1);
}

double dea_interpolate_linear(const double *x, const double *y, size_t count, double at)
{
  if (count == 0 || !(at >= x[0]) || !(at <= x[count - 1])) {
    return NAN;
  }
  size_t low = find_piece(x, count, at);
  if (low + 1 == count || x[low] == at) {
    return y[low];
  }
  double t = (at - x[low]) / (x[low + 1] - x[low]);
  return (1.0 - t) * y[low] + t * y[low + 1];
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

dea_status dea_misfit_make(struct dea_context *ctx, int column, size_t capacity,
                           struct dea_misfit *out)
{
  *out = (struct dea_misfit){
      .column = column, .quantity = dea_column_at(ctx, column), .memory = {.ctx = ctx}};
  out->at = dea_arena_alloc(&out->memory, capacity, sizeof *out->at);
  out->a = dea_arena_alloc(&out->memory, capacity, sizeof *out->a);
  out->b = dea_arena_alloc(&out->memory, capacity, sizeof *out->b);
  out->a_std = dea_arena_alloc(&out->memory, capacity, sizeof *out->a_std);
  out->b_std = dea_arena_alloc(&out->memory, capacity, sizeof *out->b_std);
  return dea_arena_status(&out->memory);
}

void dea_misfit_add(struct dea_misfit *misfit, double at, double a, double b, double std)
{
  if (!isnan(a) && !isnan(b)) {
    size_t n = misfit->count++;
    misfit->at[n] = at;
    misfit->a[n] = a;
    misfit->b[n] = b;
    misfit->a_std[n] = NAN;
    misfit->b_std[n] = std;
  }
}

/* How the differences are against the standard uncertainties. */
static void summarise_std(struct dea_misfit *m)
{
  size_t one = 0, two = 0;
  double squares = 0.0;
  for (size_t i = 0; i < m->count; i++) {
    if (m->b_std[i] > 0.0) {
      double of_a = isnan(m->a_std[i]) ? 0 : m->a_std[i];
      double ratio = fabs(m->a[i] - m->b[i]) / hypot(of_a, m->b_std[i]);
      m->std_count++;
      squares += ratio * ratio;
      one += ratio <= 1.0;
      two += ratio <= 2.0;
    }
  }
  double n = m->std_count > 0 ? (double)m->std_count : NAN;
  m->chi_square = squares / n;
  m->within_1_std = (double)one / n;
  m->within_2_std = (double)two / n;
}

void dea_misfit_summarise(struct dea_misfit *m)
{
  double squares = 0.0, sum = 0.0, low = INFINITY, high = -INFINITY, magnitude = 0.0;
  for (size_t i = 0; i < m->count; i++) {
    double difference = m->a[i] - m->b[i];
    squares += difference * difference;
    sum += difference;
    if (fabs(difference) > fabs(m->largest) || i == 0) {
      m->largest = fabs(difference);
      m->largest_at = m->at[i];
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
  summarise_std(m);
}

double dea_misfit_a_std_rms(const struct dea_misfit *misfit)
{
  double squares = 0;
  size_t count = 0;
  for (size_t i = 0; i < misfit->count; i++) {
    if (!isnan(misfit->a_std[i])) {
      squares += misfit->a_std[i] * misfit->a_std[i];
      count++;
    }
  }
  return count > 0 ? sqrt(squares / (double)count) : NAN;
}

void dea_misfit_free(struct dea_misfit *misfit)
{
  dea_arena_free(&misfit->memory);
  misfit->at = misfit->a = misfit->b = misfit->a_std = misfit->b_std = NULL;
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

/* A measured voltage that is beyond the table's ends by the noise of its meter only is at the end.
 */
static double within(double v, const double *x, size_t n)
{
  static const double noise = 0.005; // of the table's range
  double margin = n > 1 ? noise * fabs(x[n - 1] - x[0]) : 0.0;
  double low = n > 0 ? fmin(x[0], x[n - 1]) : v, high = n > 0 ? fmax(x[0], x[n - 1]) : v;
  return v < low && v >= low - margin ? low : v > high && v <= high + margin ? high : v;
}

/* Standard uncertainty of a at the i-th of the points, at voltage v: between two points of a's
 * table the straight piece. */
static double std_of_a(const struct pairing *p, int column, double v, size_t i)
{
  const struct dea_curve *a = p->a;
  if (a->std == NULL) {
    return NAN;
  }
  if (p->point_by_point || !p->at_b) {
    return dea_point_get(&a->std[i], column);
  }
  for (size_t k = 1; k < p->leg; k++) {
    double from = a->points[k - 1].voltage_V, to = a->points[k].voltage_V;
    if (fmin(from, to) <= v && v <= fmax(from, to) && from != to) {
      double t = (v - from) / (to - from);
      return (1 - t) * dea_point_get(&a->std[k - 1], column) +
             t * dea_point_get(&a->std[k], column);
    }
  }
  return NAN;
}

static void fill(const struct pairing *p, double *x, double *y, struct dea_misfit *m)
{
  const struct dea_curve *table = p->at_b ? p->a : p->b, *points = p->at_b ? p->b : p->a;
  size_t n = p->point_by_point ? 0 : tabulate(table, p->leg, m->column, x, y);
  for (size_t i = 0; i < points->count; i++) {
    double v = points->points[i].voltage_V, own = dea_point_get(&points->points[i], m->column);
    double other = p->point_by_point
                       ? dea_point_get(&table->points[i], m->column)
                       : dea_interpolate(x, y, n, p->b_std != NULL ? within(v, x, n) : v);
    double std = p->b_std != NULL && p->at_b ? dea_point_get(&p->b_std[i], m->column) : NAN;
    size_t before = m->count;
    dea_misfit_add(m, v, p->at_b ? other : own, p->at_b ? own : other, std);
    if (m->count > before) {
      m->a_std[before] = std_of_a(p, m->column, v, i);
    }
  }
}

static dea_status compare_column(struct dea_context *ctx, const struct pairing *p, int column,
                                 struct dea_comparison *comparison)
{
  struct dea_misfit *m = &comparison->misfits[comparison->misfit_count];
  size_t points = p->at_b ? p->b->count : p->a->count;
  dea_status status = dea_misfit_make(ctx, column, points, m);
  double *xy = status == DEA_OK ? dea_alloc(ctx, p->leg, 2 * sizeof *xy) : NULL;
  if (xy != NULL) {
    fill(p, xy, xy + p->leg, m);
  }
  if (xy != NULL && m->count > 0) {
    dea_misfit_summarise(m);
    comparison->misfit_count++;
  } else {
    dea_misfit_free(m);
  }
  status = xy != NULL ? DEA_OK : DEA_E_MEMORY;
  dea_free(ctx, xy);
  return status;
}

static dea_status nothing_common(struct dea_context *ctx, const struct dea_curve *a,
                                 const struct dea_curve *b, int column)
{
  if (column >= 0) {
    const char *key = dea_column_at(ctx, column)->key;
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

/* The largest size of a column in both curves. */
static double largest_of(const struct dea_curve *a, const struct dea_curve *b, int column)
{
  double size = 0;
  for (size_t i = 0; i < a->count + b->count; i++) {
    const struct dea_load_point *p = i < a->count ? &a->points[i] : &b->points[i - a->count];
    size = fmax(size, fabs(dea_point_get(p, column))); // not of NAN
  }
  return size;
}

/* Whether a column of monitors says nothing that was not asked for: an estimated error, or a motion
 * or force that is rounding beside those of its unit, as of a centre that a mirror holds. Of
 * numbers around 1 none is. */
static bool says_nothing(const struct dea_context *ctx, const struct dea_curve *a,
                         const struct dea_curve *b, int column)
{
  static const double share = 1e-6, least_si = 1e-12;
  const struct dea_column *of = dea_column_at(ctx, column);
  double all = 0;
  if (column < DEA_LOAD_POINT_COLUMNS) {
    return false;
  }
  for (int c = DEA_LOAD_POINT_COLUMNS; c < dea_column_count(ctx); c++) {
    if (strcmp(dea_column_at(ctx, c)->si_unit, of->si_unit) == 0) {
      all = fmax(all, largest_of(a, b, c));
    }
  }
  return !dea_observed_is(of, NULL) ||
         (strcmp(of->si_unit, "1") != 0 && largest_of(a, b, column) <= fmax(least_si, share * all));
}

dea_status dea_compare_curves(struct dea_context *ctx, const struct dea_curve *a,
                              const struct dea_curve *b, const struct dea_load_point *b_std,
                              int column, struct dea_comparison **out)
{
  const int count = dea_column_count(ctx);
  *out = dea_alloc(ctx, 1, sizeof **out);
  if (*out == NULL) {
    return DEA_E_MEMORY;
  }
  (*out)->misfits = dea_alloc(ctx, (size_t)count, sizeof *(*out)->misfits);
  struct pairing p = pair(a, b, b_std);
  (*out)->part_only = !p.point_by_point && p.leg < (p.at_b ? a : b)->count;
  dea_status status = (*out)->misfits != NULL ? DEA_OK : DEA_E_MEMORY;
  int voltage = dea_point_column_find("voltage_V");
  for (int c = 0; c < count && status == DEA_OK; c++) {
    if (c != voltage && (column < 0 ? !says_nothing(ctx, a, b, c) : column == c)) {
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
    dea_misfit_free(&comparison->misfits[i]);
  }
  dea_free(ctx, comparison->misfits);
  dea_free(ctx, comparison);
}

size_t dea_comparison_keep(struct dea_comparison *comparison, const int *columns, size_t count)
{
  size_t found = 0;
  for (size_t i = 0; i < comparison->misfit_count; i++) {
    bool wanted = count == 0;
    for (size_t q = 0; q < count; q++) {
      wanted = wanted || comparison->misfits[i].column == columns[q];
    }
    if (wanted) {
      struct dea_misfit kept = comparison->misfits[i]; // swapped, so that all are still freed
      comparison->misfits[i] = comparison->misfits[found];
      comparison->misfits[found++] = kept;
    }
  }
  while (comparison->misfit_count > found) {
    dea_misfit_free(&comparison->misfits[--comparison->misfit_count]);
  }
  return found;
}
