#include "base/dense.h"

#include <lapacke.h>

dea_status dea_dense_solve(size_t n, double *A, double *b)
{
  lapack_int pivot[DEA_DENSE_MAX];
  if (n > DEA_DENSE_MAX) {
    return DEA_E_ARGUMENT;
  }
  lapack_int m = (lapack_int)n;
  lapack_int info = LAPACKE_dgesv_work(LAPACK_COL_MAJOR, m, 1, A, m, pivot, b, m);
  return info == 0 ? DEA_OK : DEA_E_NOT_CONVERGED;
}

dea_status dea_dense_least_squares(size_t m, size_t n, double *A, double *b, double *singular)
{
  static const double smallest = 1e-13; // singular value that counts, over the largest
  lapack_int rank, most = (lapack_int)(m < n ? n : m);
  lapack_int info = LAPACKE_dgelsd(LAPACK_COL_MAJOR, (lapack_int)m, (lapack_int)n, 1, A,
                                   (lapack_int)m, b, most, singular, smallest, &rank);
  return info == 0 ? DEA_OK : info == LAPACK_WORK_MEMORY_ERROR ? DEA_E_MEMORY : DEA_E_NOT_CONVERGED;
}

dea_status dea_dense_negative(size_t n, double *A, int *negative)
{
  lapack_int pivot[DEA_DENSE_MAX];
  double work[64 * DEA_DENSE_MAX];
  if (n > DEA_DENSE_MAX) {
    return DEA_E_ARGUMENT;
  }
  lapack_int m = (lapack_int)n;
  lapack_int info = LAPACKE_dsytrf_work(LAPACK_COL_MAJOR, 'L', m, A, m, pivot, work,
                                        (lapack_int)(sizeof work / sizeof work[0]));
  if (info < 0) {
    return DEA_E_NOT_CONVERGED;
  }
  *negative = 0;
  for (size_t i = 0; i < n; i++) {
    if (pivot[i] < 0) { // a 2 x 2 pivot has one of each sign
      *negative += 1;
      i++;
    } else {
      *negative += A[i * n + i] < 0;
    }
  }
  return DEA_OK;
}
