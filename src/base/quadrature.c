#include "base/quadrature.h"

#include "base/context.h"

#include <math.h>

/* P_n and P_n' at x, by the three-term recurrence (n + 1) P_{n+1} = (2n + 1) x P_n - n P_{n-1}. */
static void legendre(size_t n, double x, double *p, double *dp)
{
  double before = 1, now = x;
  for (size_t k = 1; k < n; k++) {
    double kk = (double)k, next = ((2 * kk + 1) * x * now - kk * before) / (kk + 1);
    before = now;
    now = next;
  }
  *p = now;
  *dp = (double)n * (before - x * now) / (1 - x * x);
}

void dea_gauss_rule(size_t count, double *x, double *w)
{
  double n = (double)count;
  for (size_t i = 0; i < count; i++) {
    double at = -cos(DEA_PI * ((double)i + 0.75) / (n + 0.5)), p, dp;
    for (int k = 0; k < 8; k++) { // quadratic from a good start: 4 would do
      legendre(count, at, &p, &dp);
      at -= p / dp;
    }
    legendre(count, at, &p, &dp);
    x[i] = at;
    w[i] = 2 / ((1 - at * at) * dp * dp);
  }
}

void dea_lobatto_nodes(size_t order, double *x)
{
  double n = (double)order;
  x[0] = -1;
  x[order] = 1;
  for (size_t i = 1; i < order; i++) {
    double at = -cos(DEA_PI * (double)i / n);
    for (int k = 0; k < 10; k++) { // Newton on P', with (1 - x^2) P'' = 2 x P' - n (n + 1) P
      double p, dp, before = at;
      legendre(order, at, &p, &dp);
      at -= dp * (1 - at * at) / (2 * at * dp - n * (n + 1) * p);
      if (at == before) {
        break;
      }
    }
    x[i] = at;
  }
}

void dea_lagrange(size_t count, const double *nodes, double at, double *value, double *slope)
{
  for (size_t j = 0; j < count; j++) {
    double v = 1, s = 0;
    for (size_t k = 0; k < count; k++) { // product rule, one factor at a time
      if (k != j) {
        double scale = 1 / (nodes[j] - nodes[k]), factor = (at - nodes[k]) * scale;
        s = s * factor + v * scale;
        v *= factor;
      }
    }
    value[j] = v;
    slope[j] = s;
  }
}
