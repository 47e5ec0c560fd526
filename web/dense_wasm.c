/* base/dense.h without LAPACK, for WebAssembly: elimination with row pivots, and LDL^T with the
 * complete pivots of Bunch and Parlett (SIAM J. Numer. Anal. 8, 1971). For some thirty unknowns. */
#include "base/dense.h"

#include <math.h>

static void swap(double *a, double *b)
{
  double kept = *a;
  *a = *b;
  *b = kept;
}

dea_status dea_dense_solve(size_t n, double *A, double *b)
{
  if (n > DEA_DENSE_MAX) {
    return DEA_E_ARGUMENT;
  }
  for (size_t k = 0; k < n; k++) {
    size_t p = k;
    for (size_t i = k + 1; i < n; i++) {
      p = fabs(A[k * n + i]) > fabs(A[k * n + p]) ? i : p;
    }
    if (!(fabs(A[k * n + p]) > 0)) { // also when it is not a number
      return DEA_E_NOT_CONVERGED;
    }
    for (size_t j = k; j < n && p != k; j++) {
      swap(&A[j * n + k], &A[j * n + p]);
    }
    swap(&b[k], &b[p]);
    for (size_t i = k + 1; i < n; i++) {
      double factor = A[k * n + i] / A[k * n + k];
      for (size_t j = k + 1; j < n; j++) {
        A[j * n + i] -= factor * A[j * n + k];
      }
      b[i] -= factor * b[k];
    }
  }
  for (size_t k = n; k-- > 0;) {
    for (size_t j = k + 1; j < n; j++) {
      b[k] -= A[j * n + k] * b[j];
    }
    b[k] /= A[k * n + k];
  }
  return DEA_OK;
}

/* Exchanges rows and columns p and q of a symmetric matrix that is stored in full. */
static void exchange(size_t n, double *A, size_t p, size_t q)
{
  for (size_t j = 0; j < n && p != q; j++) {
    swap(&A[j * n + p], &A[j * n + q]);
  }
  for (size_t i = 0; i < n && p != q; i++) {
    swap(&A[p * n + i], &A[q * n + i]);
  }
}

/* What remains of the matrix after the pivot of `size` rows at k. */
static void eliminate(size_t n, double *A, size_t k, size_t size)
{
  double a = A[k * n + k], b = size == 2 ? A[k * n + k + 1] : 0;
  double c = size == 2 ? A[(k + 1) * n + k + 1] : 1, det = a * c - b * b;
  for (size_t j = k + size; j < n; j++) {
    double u = A[j * n + k], v = size == 2 ? A[j * n + k + 1] : 0;
    double x = (c * u - b * v) / det, y = (a * v - b * u) / det;
    for (size_t i = k + size; i < n; i++) {
      A[j * n + i] -= A[k * n + i] * x + (size == 2 ? A[(k + 1) * n + i] * y : 0);
    }
  }
}

dea_status dea_dense_negative(size_t n, double *A, int *negative)
{
  static const double alpha = 0.6403882032022076; // (1 + sqrt 17)/8 bounds the growth
  *negative = 0;
  if (n > DEA_DENSE_MAX) {
    return DEA_E_ARGUMENT;
  }
  for (size_t j = 0; j < n; j++) { // only the lower half is given its meaning by the caller
    for (size_t i = 0; i < j; i++) {
      A[j * n + i] = A[i * n + j];
    }
  }
  for (size_t k = 0; k < n;) {
    size_t d = k, p = k, q = k;
    for (size_t j = k; j < n; j++) {
      d = fabs(A[j * n + j]) > fabs(A[d * n + d]) ? j : d;
      for (size_t i = j + 1; i < n; i++) {
        if (fabs(A[j * n + i]) > fabs(A[q * n + p]) || p == q) {
          p = i;
          q = j;
        }
      }
    }
    double largest = p != q ? fabs(A[q * n + p]) : 0;
    if (!(fmax(largest, fabs(A[d * n + d])) > 0)) {
      break; // the rest is zero
    }
    size_t size = fabs(A[d * n + d]) >= alpha * largest ? 1 : 2;
    if (size == 1) {
      exchange(n, A, k, d);
      *negative += A[k * n + k] < 0;
    } else {
      exchange(n, A, k, q);
      exchange(n, A, k + 1, p);
      *negative += 1; // |b| > |a|, |c|: one of each sign
    }
    eliminate(n, A, k, size);
    k += size;
  }
  return DEA_OK;
}
