/* Cubics through computed points of a line, and what they leave of points that are held back
 * (docs/theory/loads.md, "Voltages between computed ones"):
 *
 *   V, Q      voltage, a number of the points                            V, its own
 *   p         cubic through two computed points on either side           as Q
 *   e_j       |Q(V_j) - p(V_j)|, p without the computed point j          as Q
 *   R         what Q changes by on the line                              as Q
 *   error     9/4 max(e_a, e_b) in the gap between the points a and b    as Q
 *   D         energy that a gap has lost beyond the work of the supply   J
 */
#include "study/sampled_line.h"

#include "result/columns.h"

#include <math.h>

enum { STENCIL = 4, LEAST_POINTS = STENCIL + 1 };
static const double of_held_back = 9.0 / 4; // estimated error over e: as large as that of a kink
static const double of_others = 10;         // tolerance of what is not the force, over its own
static const double least_change = 1e-3;    // of |Q|: R is at least that
static const double energy_noise = 1e-9;    // of R: errors of computed energies

/* What is done with a column. */
enum treatment { LEFT, CUBIC, LARGER };

static void treat(enum treatment out[DEA_LOAD_POINT_COLUMNS])
{
  const int own[] = {dea_point_column_find("voltage_V"),
                     dea_point_column_find("force_interpolation_error_N"),
                     dea_point_column_find("interpolation_error")};
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    out[c] = c == own[0] || c == own[1] || c == own[2] ? LEFT : CUBIC;
  }
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    int error = dea_point_error_column(NULL, c);
    if (error >= 0 && out[error] == CUBIC) {
      out[error] = LARGER;
    }
  }
}

/* The nearest computed points beside the k-th, which is none of them: two on either side, at an end
 * more on the other. Returns their number. */
static size_t find_stencil(const struct dea_sampled_line *line, size_t k, size_t out[STENCIL])
{
  size_t below[STENCIL], above[STENCIL], lower = 0, upper = 0, n = 0;
  for (size_t i = k; i > 0 && lower < STENCIL; i--) {
    if (line->computed[i - 1]) {
      below[lower++] = i - 1;
    }
  }
  for (size_t i = k + 1; i < line->count && upper < STENCIL; i++) {
    if (line->computed[i]) {
      above[upper++] = i;
    }
  }
  size_t half = STENCIL / 2;
  size_t from_above = upper < half ? upper : lower < half ? STENCIL - lower : half;
  for (size_t i = 0; i < lower && i < STENCIL - from_above; i++) {
    out[n++] = below[i];
  }
  for (size_t i = 0; i < upper && i < from_above; i++) {
    out[n++] = above[i];
  }
  return n;
}

/* p of the k-th point at a voltage (Lagrange), exact for what is constant: a depth that is held
 * stays it. */
static double cubic_at(const struct dea_sampled_line *line, int column, size_t k, double voltage_V)
{
  const double *V = line->voltages_V;
  size_t at[STENCIL] = {0}, n = find_stencil(line, k, at);
  double first = dea_point_get(&line->points[at[0]], column), sum = first;
  for (size_t i = 0; i < n; i++) {
    double share = 1;
    for (size_t j = 0; j < n; j++) {
      share *= j == i ? 1 : (voltage_V - V[at[j]]) / (V[at[i]] - V[at[j]]);
    }
    sum += share * (dea_point_get(&line->points[at[i]], column) - first);
  }
  return sum;
}

static double cubic(const struct dea_sampled_line *line, int column, size_t k)
{
  return cubic_at(line, column, k, line->voltages_V[k]);
}

/* e of a computed point; 0 at an end, which has none. */
static double held_back(const struct dea_sampled_line *line, int column, size_t k)
{
  bool end = k == 0 || k + 1 == line->count;
  return end ? 0 : fabs(dea_point_get(&line->points[k], column) - cubic(line, column, k));
}

/* Estimated error between the computed points a and b; NAN where a number is missing. */
static double gap_error(const struct dea_sampled_line *line, int column, size_t a, size_t b)
{
  double left = held_back(line, column, a), right = held_back(line, column, b);
  return of_held_back * (left > right || isnan(left) ? left : right);
}

/* R. */
static double change(const struct dea_sampled_line *line, int column)
{
  double least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < line->count; k++) {
    double value = line->computed[k] ? dea_point_get(&line->points[k], column) : NAN;
    least = fmin(least, value);
    most = fmax(most, value);
  }
  return fmax(most - least, least_change * fmax(fabs(most), fabs(least)));
}

/* Whether the points are of one smooth line by what is no number of theirs. */
static bool is_alike(const struct dea_load_point *a, const struct dea_load_point *b,
                     const enum treatment treatment[DEA_LOAD_POINT_COLUMNS])
{
  bool alike =
      dea_load_point_flags(a) == dea_load_point_flags(b) && (a->force_N == 0) == (b->force_N == 0);
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    bool same = isnan(dea_point_get(a, c)) == isnan(dea_point_get(b, c));
    alike = alike && (treatment[c] != CUBIC || same);
  }
  return alike;
}

/* The computed point after the k-th; count: none. */
static size_t next_computed(const struct dea_sampled_line *line, size_t k)
{
  do {
    k++;
  } while (k < line->count && !line->computed[k]);
  return k;
}

/* Whether the energy of a gap's ends is what the interpolated charge between them says, dE = -C V
 * dV, to what that may be off by; a jump from state to state between them has released some,
 * whatever the line is like beside it. Where there is no energy nothing is said. */
static bool is_balanced(const struct dea_sampled_line *line, size_t a, size_t b,
                        const double changes[DEA_LOAD_POINT_COLUMNS])
{
  static const double at[] = {-0.7745966692414834, 0, 0.7745966692414834}; // Gauss
  static const double weight[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
  const int E = dea_point_column_find("energy_J"), C = dea_point_column_find("capacitance_F");
  const double *V = line->voltages_V, middle = 0.5 * (V[a] + V[b]), half = 0.5 * (V[b] - V[a]);
  double D = dea_point_get(&line->points[b], E) - dea_point_get(&line->points[a], E);
  for (int i = 0; i < 3; i++) {
    double here_V = middle + at[i] * half;
    D += half * weight[i] * cubic_at(line, C, a + 1, here_V) * here_V;
  }
  return !(fabs(D) > gap_error(line, C, a, b) * 2 * half * middle + energy_noise * changes[E]);
}

/* The largest error of what monitors show in a gap, over what it changes by. */
static double error_of_monitors(const struct dea_sampled_line *line, size_t a, size_t b)
{
  const struct dea_monitor_values *monitors = line->points[a].monitors;
  double most = 0;
  for (size_t i = 0; monitors != NULL && i < monitors->count; i++) {
    const double whole = change(line, monitors->at[i].column);
    most = whole > 0 ? fmax(most, gap_error(line, monitors->at[i].column, a, b) / whole) : most;
  }
  return most;
}

/* Whether a gap may be interpolated. changes: R of each column. */
static bool is_good(const struct dea_sampled_line *line, size_t a, size_t b, double tolerance,
                    const enum treatment treatment[DEA_LOAD_POINT_COLUMNS],
                    const double changes[DEA_LOAD_POINT_COLUMNS])
{
  const int force = dea_point_column_find("force_N");
  const struct dea_load_point *p = line->points;
  bool good = is_alike(&p[a], &p[b], treatment);
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS && good; c++) {
    double most = (c == force ? 1 : of_others) * tolerance * changes[c];
    bool there = treatment[c] == CUBIC && !isnan(dea_point_get(&p[a], c));
    good = !there || gap_error(line, c, a, b) <= most;
  }
  return good && error_of_monitors(line, a, b) <= of_others * tolerance &&
         is_balanced(line, a, b, changes);
}

size_t dea_sampled_line_halve(const struct dea_sampled_line *line, double tolerance, bool *wanted)
{
  enum treatment treatment[DEA_LOAD_POINT_COLUMNS];
  double changes[DEA_LOAD_POINT_COLUMNS];
  size_t points = 0, count = 0;
  treat(treatment);
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    changes[c] = change(line, c);
  }
  for (size_t k = 0; k < line->count; k++) {
    points += line->computed[k] ? 1 : 0;
    wanted[k] = false;
  }
  for (size_t a = 0, b; a + 1 < line->count; a = b) {
    b = next_computed(line, a);
    if (b > a + 1 && b < line->count &&
        (points < LEAST_POINTS || !is_good(line, a, b, tolerance, treatment, changes))) {
      wanted[a + (b - a) / 2] = true;
      count++;
    }
  }
  return count;
}

/* The point k of the gap between a and b. */
static void interpolate(const struct dea_sampled_line *line, size_t a, size_t b, size_t k,
                        const enum treatment treatment[DEA_LOAD_POINT_COLUMNS])
{
  struct dea_load_point *p = &line->points[k];
  const struct dea_load_point *left = &line->points[a], *right = &line->points[b];
  struct dea_monitor_values *monitors = p->monitors;
  *p = dea_load_point_empty();
  p->monitors = monitors;
  p->voltage_V = line->voltages_V[k];
  p->stable = left->stable;
  p->unstable_modes = left->unstable_modes;
  p->own_flags = left->own_flags | 1u << DEA_FLAG_INTERPOLATED;
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    if (treatment[c] == LARGER) {
      dea_point_set(p, c, fmax(dea_point_get(left, c), dea_point_get(right, c)));
    } else if (treatment[c] == CUBIC) {
      dea_point_set(p, c, cubic(line, c, k));
    }
  }
  for (size_t i = 0; monitors != NULL && i < monitors->count; i++) {
    monitors->at[i].value = cubic(line, monitors->at[i].column, k);
  }
}

/* The estimated errors of all points of a gap: that of the force, and the largest of all others. */
static void report_errors(const struct dea_sampled_line *line, size_t a, size_t b,
                          const enum treatment treatment[DEA_LOAD_POINT_COLUMNS])
{
  const int force = dea_point_column_find("force_N");
  double others = error_of_monitors(line, a, b);
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    double whole = treatment[c] == CUBIC && c != force ? change(line, c) : 0;
    others = whole > 0 ? fmax(others, gap_error(line, c, a, b) / whole) : others;
  }
  for (size_t k = a + 1; k < b; k++) {
    line->points[k].force_interpolation_error_N = gap_error(line, force, a, b);
    line->points[k].interpolation_error = others;
  }
}

void dea_sampled_line_fill(const struct dea_sampled_line *line)
{
  enum treatment treatment[DEA_LOAD_POINT_COLUMNS];
  treat(treatment);
  for (size_t a = 0, b; a + 1 < line->count; a = b) {
    b = next_computed(line, a);
    for (size_t k = a + 1; k < b; k++) {
      interpolate(line, a, b, k, treatment);
    }
    report_errors(line, a, b, treatment);
  }
}
