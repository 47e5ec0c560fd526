/* Products and sums of vectors. */
#pragma once

#include <math.h>
#include <stddef.h>

/* a x b; out is neither of them. */
static inline void dea_cross(const double a[3], const double b[3], double out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double dea_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Largest size of a component. */
static inline double dea_largest(size_t count, const double *v)
{
  double largest = 0;
  for (size_t i = 0; i < count; i++) {
    largest = fmax(largest, fabs(v[i]));
  }
  return largest;
}

/* One vector in the place of the other. */
static inline void dea_swap(double **a, double **b)
{
  double *first = *a;
  *a = *b;
  *b = first;
}

/* to += times from. */
static inline void dea_add(size_t count, double times, const double *from, double *to)
{
  for (size_t i = 0; i < count; i++) {
    to[i] += times * from[i];
  }
}
