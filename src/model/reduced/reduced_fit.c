#include "model/reduced/reduced_fit.h"

#include "base/dense.h"

#include <math.h>
#include <string.h>

enum { TERMS = DEA_REDUCED_TERMS, DEGREE = TERMS - 1, CELLS_MAX = 32 };

/* B-splines of one variable: cells + degree of them, of which degree + 1 are not 0 in a cell. */
struct basis {
  int degree, cells;
  const double *breaks; // [cells + 1]
};

static double knot(const struct basis *b, int i)
{
  const int k = i - b->degree;
  return b->breaks[k < 0 ? 0 : k > b->cells ? b->cells : k];
}

/* Adds (at + slope s) times a polynomial to another one. */
static void add_product(const double *from, double at, double slope, double *to)
{
  for (int i = 0; i < TERMS; i++) {
    to[i] += at * from[i];
    if (i > 0) {
      to[i] += slope * from[i - 1];
    }
  }
}

/* Those of a cell as polynomials of s, from 0 to 1 across it, by the recursion of de Boor and Cox:
 * out [degree + 1][TERMS], the first of them number `cell`. */
static void splines_of_cell(const struct basis *b, int cell, double out[TERMS][TERMS])
{
  const double low = b->breaks[cell], width = b->breaks[cell + 1] - low;
  double last[TERMS][TERMS];
  memset(out, 0, TERMS * sizeof *out);
  out[0][0] = 1;
  for (int k = 1; k <= b->degree; k++) { // of degree k, from number cell + degree - k on
    memcpy(last, out, sizeof last);
    memset(out, 0, TERMS * sizeof *out);
    for (int i = 0; i <= k; i++) {
      const int n = cell + b->degree - k + i;
      if (i > 0) {
        const double span = knot(b, n + k) - knot(b, n);
        add_product(last[i - 1], (low - knot(b, n)) / span, width / span, out[i]);
      }
      if (i < k) {
        const double span = knot(b, n + k + 1) - knot(b, n + 1);
        add_product(last[i], (knot(b, n + k + 1) - low) / span, -width / span, out[i]);
      }
    }
  }
}

/* Their slopes of order 0 to 2 at x: out [order][degree + 1]; returns the cell. */
static int splines_at(const struct basis *b, double x, double out[3][TERMS])
{
  double c[TERMS][TERMS];
  int cell = 0;
  while (cell + 1 < b->cells && x >= b->breaks[cell + 1]) {
    cell++;
  }
  const double width = b->breaks[cell + 1] - b->breaks[cell], s = (x - b->breaks[cell]) / width;
  splines_of_cell(b, cell, c);
  for (int k = 0; k <= b->degree; k++) {
    double f = 0, d = 0, dd = 0;
    for (int i = DEGREE; i >= 0; i--) {
      dd = dd * s + d;
      d = d * s + f;
      f = f * s + c[k][i];
    }
    out[0][k] = f;
    out[1][k] = d / width;
    out[2][k] = 2 * dd / (width * width);
  }
  return cell;
}

/* A system of rows of a sum over products of these splines. */
struct system {
  struct basis of[2];
  size_t rows, unknowns, row; // row: the next
  double *A, *b, *singular;   // [unknowns][rows], [rows], [unknowns]
};

static dea_status begin(struct dea_arena *memory, size_t rows, struct system *s)
{
  s->unknowns = (size_t)((s->of[0].cells + s->of[0].degree) * (s->of[1].cells + s->of[1].degree));
  s->rows = rows;
  s->A = dea_arena_alloc(memory, s->unknowns * rows, sizeof *s->A);
  s->b = dea_arena_alloc(memory, rows > s->unknowns ? rows : s->unknowns, sizeof *s->b);
  s->singular = dea_arena_alloc(memory, s->unknowns, sizeof *s->singular);
  return dea_arena_status(memory);
}

/* Adds `factor` times the slope of orders m, n at x, y to the next row. */
static void add_slope(struct system *s, int m, int n, double x, double y, double factor)
{
  double by_x[3][TERMS], by_y[3][TERMS];
  const int i = splines_at(&s->of[0], x, by_x), j = splines_at(&s->of[1], y, by_y);
  const int across = s->of[1].cells + s->of[1].degree;
  for (int k = 0; k <= s->of[0].degree; k++) {
    for (int l = 0; l <= s->of[1].degree; l++) {
      s->A[(size_t)((i + k) * across + j + l) * s->rows + s->row] +=
          factor * by_x[m][k] * by_y[n][l];
    }
  }
}

static void end_row(struct system *s, double value)
{
  s->b[s->row++] = value;
}

/* Solves it, and writes the sum cell by cell. */
static dea_status end(struct dea_arena *memory, struct system *s, struct dea_reduced_spline *out)
{
  const int across = s->of[1].cells + s->of[1].degree;
  double *c =
      dea_arena_alloc(memory, (size_t)(s->of[0].cells * s->of[1].cells * TERMS * TERMS), sizeof *c);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  if (dea_dense_least_squares(s->rows, s->unknowns, s->A, s->b, s->singular) != DEA_OK) {
    return dea_fail(memory->ctx, DEA_E_NOT_CONVERGED, "the least squares of a fit do not converge");
  }
  *out = (struct dea_reduced_spline){
      {s->of[0].cells, s->of[1].cells}, {s->of[0].breaks, s->of[1].breaks}, c};
  for (int cell = 0; cell < s->of[0].cells * s->of[1].cells; cell++, c += TERMS * TERMS) {
    const int i = cell / s->of[1].cells, j = cell % s->of[1].cells;
    double x[TERMS][TERMS], y[TERMS][TERMS];
    splines_of_cell(&s->of[0], i, x);
    splines_of_cell(&s->of[1], j, y);
    for (int kl = 0; kl < TERMS * TERMS; kl++) {
      const int k = kl / TERMS, l = kl % TERMS;
      const double weight =
          k > s->of[0].degree || l > s->of[1].degree ? 0 : s->b[(i + k) * across + j + l];
      for (int mn = 0; mn < TERMS * TERMS; mn++) {
        c[mn] += weight * x[k][mn / TERMS] * y[l][mn % TERMS];
      }
    }
  }
  return DEA_OK;
}

// Samples -----------------------------------------------------------------------------------------

static const struct dea_reduced_sample *sample(const struct dea_reduced_grid *grid, size_t force,
                                               size_t voltage)
{
  return &grid->samples[force * grid->voltages + voltage];
}

static double variable(const struct dea_reduced_grid *grid, size_t k, size_t i)
{
  const double V = sample(grid, 0, i)->voltage_V;
  return k == 0 ? sample(grid, i, 0)->at.force : grid->even ? V * V : V;
}

/* Breaks at each second of the samples that are used, or at the ends alone. Where Phi is even in V
 * its mixed slope has no row at V = 0, and along V one degree less is known. */
static dea_status set_basis(struct dea_arena *memory, const struct dea_reduced_grid *grid, size_t k,
                            size_t stride, struct basis *out)
{
  const size_t last = (k == 0 ? grid->forces : grid->voltages) - 1;
  const size_t step = last % (2 * stride) == 0 ? 2 * stride : last;
  double *breaks = dea_arena_alloc(memory, last / step + 1, sizeof *breaks);
  DEA_TRY(memory->ctx, dea_arena_status(memory));
  for (size_t i = 0; i <= last / step; i++) {
    breaks[i] = variable(grid, k, i * step);
  }
  const size_t known = 2 * (last / stride) + (k == 1 && grid->even ? 0 : 1);
  *out = (struct basis){known < DEGREE ? (int)known : DEGREE, (int)(last / step), breaks};
  return DEA_OK;
}

/* What the rows of a fit are relative to. */
struct scale {
  double q, charge_C, force, voltage_V; // ranges of q and Q; steps of the grid
};

static struct scale scale_of(const struct dea_reduced_grid *grid, size_t stride)
{
  double q[2] = {INFINITY, -INFINITY}, Q = 0;
  for (size_t i = 0; i < grid->forces * grid->voltages; i++) {
    q[0] = fmin(q[0], grid->samples[i].at.value);
    q[1] = fmax(q[1], grid->samples[i].at.value);
    Q = fmax(Q, fabs(grid->samples[i].at.charge_C));
  }
  return (struct scale){q[1] - q[0], Q,
                        sample(grid, stride, 0)->at.force - sample(grid, 0, 0)->at.force,
                        sample(grid, 0, stride)->voltage_V - sample(grid, 0, 0)->voltage_V};
}

/* Gradient and Hessian of Phi at a sample: -q, -Q; -dq/dF, -dq/dV, -dQ/dV. */
static void add_sample(struct system *s, const struct dea_reduced_grid *grid,
                       const struct scale *scale, const struct dea_reduced_sample *at)
{
  static const double curved = 0.3; // weight of second slopes over a step against first ones
  const double F = at->at.force, V = at->voltage_V, y = grid->even ? V * V : V;
  const double y_V = grid->even ? 2 * V : 1, y_VV = grid->even ? 2 : 0;
  double w = -1 / scale->q;
  add_slope(s, 1, 0, F, y, w);
  end_row(s, at->at.value / scale->q);
  w = -curved * scale->force / scale->q;
  add_slope(s, 2, 0, F, y, w);
  end_row(s, -w * at->at.by_force);
  w = -curved * scale->voltage_V / scale->q;
  add_slope(s, 1, 1, F, y, w * y_V);
  end_row(s, -w * at->at.by_voltage);
  w = -1 / scale->charge_C;
  add_slope(s, 0, 1, F, y, w * y_V);
  end_row(s, -w * at->at.charge_C);
  w = -curved * scale->voltage_V / scale->charge_C;
  add_slope(s, 0, 2, F, y, w * y_V * y_V);
  add_slope(s, 0, 1, F, y, w * y_VV);
  end_row(s, -w * at->at.charge_by_voltage);
}

dea_status dea_reduced_fit_energy(struct dea_arena *memory, const struct dea_reduced_grid *grid,
                                  size_t stride, struct dea_reduced_spline *out)
{
  enum { ROWS = 5 }; // of a sample
  const struct scale scale = scale_of(grid, stride);
  const size_t count = ((grid->forces - 1) / stride + 1) * ((grid->voltages - 1) / stride + 1);
  struct system s = {.row = 0};
  for (size_t k = 0; k < 2; k++) {
    DEA_TRY(memory->ctx, set_basis(memory, grid, k, stride, &s.of[k]));
  }
  DEA_TRY(memory->ctx, begin(memory, ROWS * count + 1, &s));
  for (size_t j = 0; j < grid->forces; j += stride) {
    for (size_t i = 0; i < grid->voltages; i += stride) {
      add_sample(&s, grid, &scale, sample(grid, j, i));
    }
  }
  // Phi counts from the middle force and the lowest voltage
  add_slope(&s, 0, 0, variable(grid, 0, grid->forces / 2), variable(grid, 1, 0),
            1 / (scale.q * scale.force));
  end_row(&s, 0);
  return DEA_CHAIN(memory->ctx, end(memory, &s, out));
}

dea_status dea_reduced_fit_values(struct dea_arena *memory, const struct dea_reduced_grid *grid,
                                  const double *values, struct dea_reduced_spline *out)
{
  struct system s = {.row = 0};
  for (size_t k = 0; k < 2; k++) {
    const size_t count = k == 0 ? grid->forces : grid->voltages;
    DEA_TRY(memory->ctx, set_basis(memory, grid, k, 1, &s.of[k]));
    const int fits = (int)count - s.of[k].cells; // so that there are as many splines as samples
    s.of[k].degree = fits < DEGREE ? fits : DEGREE;
  }
  DEA_TRY(memory->ctx, begin(memory, grid->forces * grid->voltages, &s));
  for (size_t j = 0; j < grid->forces; j++) {
    for (size_t i = 0; i < grid->voltages; i++) {
      add_slope(&s, 0, 0, variable(grid, 0, j), variable(grid, 1, i), 1);
      end_row(&s, values[j * grid->voltages + i]);
    }
  }
  return DEA_CHAIN(memory->ctx, end(memory, &s, out));
}

dea_status dea_reduced_fit_polynomial(struct dea_context *ctx, const double *x, const double *y,
                                      size_t count, double c[3])
{
  enum { POINTS_MAX = 64 };
  double A[3 * POINTS_MAX], b[POINTS_MAX], singular[3];
  if (count > POINTS_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "a fit of %zu points is too large", count);
  }
  for (size_t i = 0; i < count; i++) {
    A[i] = 1;
    A[count + i] = x[i];
    A[2 * count + i] = x[i] * x[i];
    b[i] = y[i];
  }
  const size_t terms = count < 3 ? count : 3;
  if (dea_dense_least_squares(count, terms, A, b, singular) != DEA_OK) {
    return dea_fail(ctx, DEA_E_NOT_CONVERGED, "a fit does not converge");
  }
  for (size_t i = 0; i < 3; i++) {
    c[i] = i < terms ? b[i] : 0;
  }
  return DEA_OK;
}
