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

// Series ------------------------------------------------------------------------------------------

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

dea_status dea_samples_of_curve(struct dea_arena *memory, const struct dea_curve *curve,
                                const struct dea_load_point *std, int column, enum dea_abscissa by,
                                struct dea_samples *out)
{
  const size_t count = by == DEA_BY_RISING_VOLTAGE ? first_leg(curve) : curve->count;
  const bool falls = by == DEA_BY_RISING_VOLTAGE && count > 1 &&
                     curve->points[count - 1].voltage_V < curve->points[0].voltage_V;
  double *at = dea_arena_alloc(memory, count, sizeof *at);
  double *value = dea_arena_alloc(memory, count, sizeof *value);
  double *own = dea_arena_alloc(memory, count, sizeof *own);
  size_t n = 0;
  for (size_t k = 0; own != NULL && k < count; k++) {
    const size_t i = falls ? count - 1 - k : k;
    const struct dea_load_point *p = &curve->points[i];
    const double x = by == DEA_BY_TIME ? p->time_s : p->voltage_V, y = dea_point_get(p, column);
    const bool follows =
        by == DEA_BY_VOLTAGE || n == 0 || x > at[n - 1] || (by == DEA_BY_TIME && x == at[n - 1]);
    if (!isnan(x) && !isnan(y) && follows) {
      at[n] = x;
      value[n] = y;
      own[n++] = std != NULL ? dea_point_get(&std[i], column) : NAN;
    }
  }
  *out = (struct dea_samples){n, at, value, own};
  return dea_arena_status(memory);
}

bool dea_samples_have_std(const struct dea_samples *samples)
{
  for (size_t i = 0; samples->std != NULL && i < samples->count; i++) {
    if (!isnan(samples->std[i])) {
      return true;
    }
  }
  return false;
}

// Misfits -----------------------------------------------------------------------------------------

/* A misfit with room for that many points, all in memory. */
static dea_status build_misfit(struct dea_arena *memory, int column, size_t capacity,
                               struct dea_misfit *out)
{
  *out = (struct dea_misfit){.column = column, .quantity = dea_column_at(memory->ctx, column)};
  double **arrays[] = {&out->at, &out->a, &out->b, &out->a_std, &out->b_std};
  for (size_t k = 0; k < sizeof arrays / sizeof arrays[0]; k++) {
    *arrays[k] = dea_arena_alloc(memory, capacity, sizeof(double));
  }
  return dea_arena_status(memory);
}

/* Adds a point, but not one where a or b is NAN. */
static void add_point(struct dea_misfit *misfit, double at, double a, double a_std, double b,
                      double b_std)
{
  if (!isnan(a) && !isnan(b)) {
    size_t n = misfit->count++;
    misfit->at[n] = at;
    misfit->a[n] = a;
    misfit->b[n] = b;
    misfit->a_std[n] = a_std;
    misfit->b_std[n] = b_std;
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

/* Fills what follows from the points, where there are any. */
static void summarise(struct dea_misfit *m)
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

/* Whether two samples of one place lie within `near` of a place. */
static bool is_near_jump(const struct dea_samples *s, double at, double near)
{
  size_t low = 0, high = s->count;
  while (low < high) { // first sample that is not too early
    size_t middle = low + (high - low) / 2;
    if (s->at[middle] < at - near) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  for (size_t i = low; i + 1 < s->count && s->at[i + 1] <= at + near; i++) {
    if (s->at[i] == s->at[i + 1]) {
      return true;
    }
  }
  return false;
}

/* A place beyond the ends by no more than a margin is at the end. */
static double within(double at, const struct dea_samples *s, double margin)
{
  const double low = s->count > 0 ? s->at[0] : at, high = s->count > 0 ? s->at[s->count - 1] : at;
  return at < low && at >= low - margin ? low : at > high && at <= high + margin ? high : at;
}

dea_status dea_misfit_compute(struct dea_arena *memory, int column, const struct dea_samples *a,
                              const struct dea_samples *b, const struct dea_reading *reading,
                              struct dea_misfit *out)
{
  DEA_TRY(memory->ctx, build_misfit(memory, column, b->count, out));
  for (size_t i = 0; i < b->count; i++) {
    const double at = within(b->at[i], a, reading->margin);
    if (!is_near_jump(a, b->at[i], reading->jump)) {
      const double value = reading->smooth ? dea_interpolate(a->at, a->value, a->count, at)
                                           : dea_interpolate_linear(a->at, a->value, a->count, at);
      const double std = a->std != NULL ? dea_interpolate_linear(a->at, a->std, a->count, at) : NAN;
      add_point(out, b->at[i], value, std, b->value[i], b->std != NULL ? b->std[i] : NAN);
    }
  }
  summarise(out);
  return DEA_OK;
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

// Curves against the voltage ----------------------------------------------------------------------

static bool same_voltages(const struct dea_curve *a, const struct dea_curve *b)
{
  for (size_t i = 0; i < a->count && i < b->count; i++) {
    if (a->points[i].voltage_V != b->points[i].voltage_V) {
      return false;
    }
  }
  return a->count == b->count;
}

/* Two curves of the same voltages. */
static dea_status compare_points(struct dea_arena *memory, const struct dea_curve *a,
                                 const struct dea_curve *b, const struct dea_load_point *b_std,
                                 int column, struct dea_misfit *out)
{
  DEA_TRY(memory->ctx, build_misfit(memory, column, a->count, out));
  for (size_t i = 0; i < a->count; i++) {
    add_point(out, a->points[i].voltage_V, dea_point_get(&a->points[i], column),
              a->std != NULL ? dea_point_get(&a->std[i], column) : NAN,
              dea_point_get(&b->points[i], column),
              b_std != NULL ? dea_point_get(&b_std[i], column) : NAN);
  }
  summarise(out);
  return DEA_OK;
}

/* a at the voltages of b. A voltage that is beyond the ends by the noise of its meter is there. */
static dea_status compare_interpolated(struct dea_arena *memory, const struct dea_curve *a,
                                       const struct dea_load_point *a_std,
                                       const struct dea_curve *b,
                                       const struct dea_load_point *b_std, bool measured,
                                       int column, struct dea_misfit *out)
{
  static const double noise = 0.005; // of the range of a
  struct dea_samples table, points;
  DEA_TRY(memory->ctx,
          dea_samples_of_curve(memory, a, a_std, column, DEA_BY_RISING_VOLTAGE, &table));
  DEA_TRY(memory->ctx, dea_samples_of_curve(memory, b, b_std, column, DEA_BY_VOLTAGE, &points));
  const double range = table.count > 1 ? table.at[table.count - 1] - table.at[0] : 0.0;
  const struct dea_reading reading = {.smooth = true, .margin = measured ? noise * range : 0.0};
  return dea_misfit_compute(memory, column, &table, &points, &reading, out);
}

static dea_status compare_column(struct dea_arena *memory, const struct dea_curve *a,
                                 const struct dea_curve *b, const struct dea_load_point *b_std,
                                 int column, struct dea_misfit *out)
{
  if (same_voltages(a, b)) {
    return compare_points(memory, a, b, b_std, column, out);
  }
  if (b_std != NULL || b->count <= a->count) {
    return compare_interpolated(memory, a, a->std, b, b_std, b_std != NULL, column, out);
  }
  DEA_TRY(memory->ctx, compare_interpolated(memory, b, NULL, a, a->std, false, column, out));
  double *swapped[] = {out->a, out->a_std};
  out->a = out->b;
  out->a_std = out->b_std;
  out->b = swapped[0];
  out->b_std = swapped[1];
  summarise(out);
  return DEA_OK;
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

bool dea_column_is_wanted(int column, const int *columns, size_t count)
{
  for (size_t q = 0; q < count; q++) {
    if (columns[q] == column) {
      return true;
    }
  }
  return count == 0;
}

dea_status dea_compare_curves(struct dea_arena *memory, const struct dea_curve *a,
                              const struct dea_curve *b, const struct dea_load_point *b_std,
                              const int *columns, size_t count, struct dea_comparison *out)
{
  struct dea_context *ctx = memory->ctx;
  const bool a_table = b_std != NULL || b->count <= a->count;
  const struct dea_curve *table = a_table ? a : b;
  const int voltage = dea_point_column_find("voltage_V");
  *out = (struct dea_comparison){
      .misfits = dea_arena_alloc(memory, (size_t)dea_column_count(ctx), sizeof *out->misfits),
      .part_only = !same_voltages(a, b) && first_leg(table) < table->count};
  DEA_TRY(ctx, dea_arena_status(memory));
  for (int c = 0; c < dea_column_count(ctx); c++) {
    if (c == voltage || !dea_column_is_wanted(c, columns, count) ||
        (count == 0 && says_nothing(ctx, a, b, c))) {
      continue;
    }
    struct dea_misfit *misfit = &out->misfits[out->misfit_count];
    DEA_TRY(ctx, compare_column(memory, a, b, b_std, c, misfit));
    out->misfit_count += misfit->count > 0 ? 1U : 0U;
  }
  return out->misfit_count > 0 || count > 1
             ? DEA_OK
             : nothing_common(ctx, a, b, count == 1 ? columns[0] : -1);
}

// One clock for two histories --------------------------------------------------------------------

static const double pulse_begins = 0.05, pulse_ends = 0.03; // of the largest |V|
static const double same_height = 0.1;                      // share by which two pulses differ
static const double near_edge = 0.2; // of the shortest time between two edges: the same edge
static const double rounding_s = 1e-6;

struct edge {
  double time_s, height_V;
  double width_s; // between the samples that it lies between
};

struct edges {
  size_t count;
  struct edge edge[DEA_CLOCK_EDGES_MAX];
};

/* Where |V| first reaches half of the height of the pulse of the samples [from, to). */
static double half_way(const struct dea_samples *track, size_t from, size_t to, double height_V,
                       double *width_s)
{
  const double *v = track->value, *t = track->at;
  size_t i = from;
  while (i < to && !(fabs(v[i]) >= 0.5 * height_V)) {
    i++;
  }
  *width_s = i > 0 && i < track->count ? t[i] - t[i - 1] : 0.0;
  if (i == 0 || i == to || isnan(v[i - 1])) {
    return t[i < to ? i : from];
  }
  double low = fabs(v[i - 1]), high = fabs(v[i]);
  double share = high > low ? (0.5 * height_V - low) / (high - low) : 1.0;
  return t[i - 1] + fmin(fmax(share, 0.0), 1.0) * (t[i] - t[i - 1]);
}

static void add_pulse(const struct dea_samples *track, size_t from, size_t to, double height_V,
                      struct edges *out)
{
  if (out->count < DEA_CLOCK_EDGES_MAX) {
    struct edge *edge = &out->edge[out->count++];
    edge->height_V = height_V;
    edge->time_s = half_way(track, from, to, height_V, &edge->width_s);
  }
}

static void find_edges(const struct dea_samples *track, struct edges *out)
{
  double largest = 0.0, height = 0.0;
  size_t from = 0;
  bool inside = false;
  out->count = 0;
  for (size_t i = 0; i < track->count; i++) {
    largest = fmax(largest, fabs(track->value[i]));
  }
  for (size_t i = 0; i < track->count && largest > 0.0; i++) {
    double v = fabs(track->value[i]);
    if (!inside && v > pulse_begins * largest) {
      inside = true;
      from = i;
      height = v;
    } else if (inside && v < pulse_ends * largest) {
      inside = false;
      add_pulse(track, from, i, height, out);
    }
    height = inside ? fmax(height, v) : height;
  }
  if (inside) {
    add_pulse(track, from, track->count, height, out);
  }
}

static double shortest_between(const struct edges *edges)
{
  double shortest = INFINITY;
  for (size_t i = 1; i < edges->count; i++) {
    shortest = fmin(shortest, edges->edge[i].time_s - edges->edge[i - 1].time_s);
  }
  return shortest;
}

/* How far an edge may be from where it was seen, on average. */
static double mean_width(const struct edges *edges)
{
  double sum = 0.0;
  for (size_t i = 0; i < edges->count; i++) {
    sum += edges->edge[i].width_s;
  }
  return edges->count > 0 ? sum / (double)edges->count : 0.0;
}

/* Edges that lie on each other when those of a are moved by shift_s, and the shift that leaves no
 * mean difference of them. */
static struct dea_clock_shift match(const struct edges *a, const struct edges *b, double shift_s,
                                    double near_s)
{
  struct dea_clock_shift out = {.shift_s = shift_s};
  double sum = 0.0;
  for (size_t i = 0, k = 0; i < a->count; i++) {
    double at = a->edge[i].time_s + shift_s;
    while (k < b->count && b->edge[k].time_s < at - near_s) {
      k++;
    }
    if (k == b->count || b->edge[k].time_s > at + near_s) {
      continue;
    }
    double off = b->edge[k].time_s - at, height = fmax(a->edge[i].height_V, b->edge[k].height_V);
    if (fabs(a->edge[i].height_V - b->edge[k].height_V) <= same_height * height) {
      out.edges++;
      sum += off;
    }
  }
  out.shift_s += out.edges > 0 ? sum / (double)out.edges : 0.0;
  return out;
}

void dea_clock_shift_find(const struct dea_samples *a, const struct dea_samples *b,
                          struct dea_clock_shift *out)
{
  struct edges of_a, of_b;
  find_edges(a, &of_a);
  find_edges(b, &of_b);
  double apart = fmin(shortest_between(&of_a), shortest_between(&of_b));
  double near_s = isfinite(apart) ? near_edge * apart : rounding_s;
  *out = (struct dea_clock_shift){0};
  for (size_t i = 0; i < of_a.count; i++) {
    for (size_t k = 0; k < of_b.count; k++) {
      double shift_s = of_b.edge[k].time_s - of_a.edge[i].time_s;
      struct dea_clock_shift one = match(&of_a, &of_b, shift_s, near_s);
      bool nearer = one.edges == out->edges && fabs(one.shift_s) < fabs(out->shift_s);
      if (one.edges > out->edges || (one.edges > 0 && nearer)) {
        *out = one;
      }
    }
  }
  out->resolution_s = mean_width(&of_a) + mean_width(&of_b);
  if (fabs(out->shift_s) <= out->resolution_s) { // one clock, as far as is seen
    out->shift_s = 0;
  }
}

// Profiles across the film -----------------------------------------------------------------------

enum { RADIUS, DISPLACEMENT, HEIGHT = 6 }; // of dea_profile_columns

static const double same_voltage = 0.005; // share that counts as the same
static const double rounding = 1e-9;      // of places that passed through millimetres

/* A voltage as profiles of a model have it: `share` of the second, the rest of the first. */
struct blend {
  const struct dea_profile_record *first, *second;
  double share;
};

static bool same_places(const struct dea_profile_record *a, const struct dea_profile_record *b)
{
  return a->count == b->count && memcmp(a->columns, b->columns, a->count * sizeof *a->columns) == 0;
}

/* false when the model has no profile at that voltage. */
static bool find_blend(const struct dea_result *result, const char *model, double voltage_V,
                       struct blend *out)
{
  const struct dea_profile_record *nearest = NULL, *before = NULL;
  *out = (struct blend){0};
  for (size_t i = 0; i < result->profile_count; i++) {
    const struct dea_profile_record *r = &result->profiles[i];
    if (strcmp(r->model, model) != 0 || r->count == 0) {
      continue;
    }
    double off = fabs(r->voltage_V - voltage_V);
    if (off <= same_voltage * fabs(voltage_V) &&
        (nearest == NULL || off < fabs(nearest->voltage_V - voltage_V))) {
      nearest = r;
    }
    if (out->first == NULL && before != NULL && same_places(before, r) &&
        (before->voltage_V - voltage_V) * (r->voltage_V - voltage_V) < 0.0) {
      double share = (voltage_V - before->voltage_V) / (r->voltage_V - before->voltage_V);
      *out = (struct blend){before, r, share};
    }
    before = r;
  }
  if (nearest != NULL) {
    *out = (struct blend){nearest, nearest, 0.0};
  }
  return out->first != NULL;
}

static double blend_get(const struct blend *b, size_t column, size_t i)
{
  size_t at = column * b->first->count + i;
  return (1.0 - b->share) * b->first->columns[at] + b->share * b->second->columns[at];
}

/* Puts the places of a half, from the centre outwards, into x and z, and returns how many. */
static size_t fill_half(const struct blend *b, enum dea_half half, double *x, double *z)
{
  const size_t n = b->first->count;
  double largest = 0.0;
  size_t count = 0;
  for (size_t k = 0; k < n; k++) {
    const size_t i = half == DEA_HALF_FIBRE ? k : n - 1 - k;
    const double radius = b->first->columns[RADIUS * n + i], height = blend_get(b, HEIGHT, i);
    const bool outwards = half == DEA_HALF_FIBRE ? radius >= 0.0 : radius <= 0.0;
    // the centre has no direction to move in
    const double at = fabs(radius) > 0.0 ? fabs(radius) + blend_get(b, DISPLACEMENT, i) : 0.0;
    if (outwards && isfinite(at) && isfinite(height) && (count == 0 || at > x[count - 1])) {
      x[count] = at;
      z[count++] = height;
      largest = fmax(largest, fabs(height));
    }
  }
  return largest > 0.0 && count > 1 ? count : 0;
}

dea_status dea_film_line_build(struct dea_arena *memory, const struct dea_result *result,
                               const char *model, double voltage_V, enum dea_half half,
                               struct dea_film_line *out)
{
  struct blend b;
  *out = (struct dea_film_line){0};
  if (!find_blend(result, model, voltage_V, &b)) {
    return DEA_OK;
  }
  const size_t half_count = b.first->count;
  double *x = dea_arena_alloc(memory, 2 * half_count, sizeof *x);
  double *z = dea_arena_alloc(memory, 2 * half_count, sizeof *z);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  const size_t count = fill_half(&b, half, x + half_count, z + half_count);
  size_t first = half_count;
  for (size_t k = 0; k < count; k++) { // the other side, without a centre of its own
    if (x[half_count + k] > 0.0) {
      x[--first] = -x[half_count + k];
      z[first] = z[half_count + k];
    }
  }
  out->samples = (struct dea_samples){half_count + count - first, x + first, z + first, NULL};
  out->directed = b.first->columns[0] < 0.0; // radii rise from there
  out->between_records = b.first != b.second;
  return DEA_OK;
}

dea_status dea_film_line_compare(struct dea_arena *memory, const struct dea_film_line *line,
                                 const struct dea_samples *measured, struct dea_misfit *out)
{
  const size_t n = line->samples.count;
  const struct dea_reading reading = {.margin = n > 0 ? rounding * line->samples.at[n - 1] : 0.0};
  return dea_misfit_compute(memory, dea_point_column_find("centre_z_m"), &line->samples, measured,
                            &reading, out);
}
