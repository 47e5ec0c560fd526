/* Small dense systems, of at most DEA_DENSE_MAX unknowns, by LAPACK. */
#pragma once

#include "base/status.h"

#include <stddef.h>

enum { DEA_DENSE_MAX = 128 };

/* Solves A x = b in place: A [n x n] by columns is destroyed, b [n] becomes x. DEA_E_NOT_CONVERGED
 * when A is singular to the bit, DEA_E_ARGUMENT for more than DEA_DENSE_MAX unknowns. */
dea_status dea_dense_solve(size_t n, double *A, double *b);
/* The x of smallest norm that minimises |A x - b|: A [n][m], m rows by columns, is destroyed, b
 * [the larger of m and n] becomes x; singular: room for the smaller of them. Of any size.
 * DEA_E_NOT_CONVERGED, DEA_E_MEMORY. */
dea_status dea_dense_least_squares(size_t m, size_t n, double *A, double *b, double *singular);
/* Number of negative eigenvalues of a symmetric A [n x n], which is destroyed: those of D in its
 * LDL^T with pivots (Sylvester). Errors as above; a singular matrix is none. */
dea_status dea_dense_negative(size_t n, double *A, int *negative);
