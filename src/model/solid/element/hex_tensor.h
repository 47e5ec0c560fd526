/* Sums over the Gauss points of a hexahedron, one axis after the other.
 *
 * Its basis and its points are products of lines of points, so that a sum over all points and nodes
 * splits into sums along lines: a tangent of order 2 takes a third of the multiplications of the
 * plain triple product, one of order 3 a sixth (docs/performance.md).
 *
 * xi_a: local axes; nodes and Gauss points with the first axis fastest. */
#pragma once

#include "model/solid/element/hex_shape.h"

enum {
  DEA_HEX_COLUMNS_MAX = 3 + 3 * DEA_HEX_PRESSURES_MAX, // of the values that are summed at once
  DEA_HEX_PAIRS = 6,                                   // of components i <= k: 00 01 02 11 12 22
};

/* out[r][x] = sum_k table[r][k] in[k][x]. table: [rows][table_width], of which `terms` are used;
 * in: [terms][width]; out: [rows][width], apart from in. */
void dea_hex_combine(size_t rows, size_t terms, const double *table, size_t table_width,
                     size_t width, const double *restrict in, double *restrict out);

/* slopes[a][q][c] = sum_n dN_n/dxi_a(q) values[n][c]: slopes of `columns` fields, by the local
 * axes. values: [nodes][columns], slopes: [3][gauss][columns]. */
void dea_hex_slopes(const struct dea_hex_shape *shape, int columns, const double *values,
                    double *slopes);

/* sums[n][c] = sum_q sum_a dN_n/dxi_a(q) flux[a][q][c]: the transpose of dea_hex_slopes. */
void dea_hex_sum_flux(const struct dea_hex_shape *shape, int columns, const double *flux,
                      double *sums);

/* K_(n,i)(m,k) = sum_q sum_ab dN_n/dxi_a(q) A_(i,a)(k,b)(q) dN_m/dxi_b(q) with the six pairs of
 * components i <= k of A[gauss][3 a + b][pair]; for the other ones K is symmetric. K: [3 nodes][3
 * nodes], to which it is added. */
void dea_hex_add_tangent(const struct dea_hex_shape *shape, double (*A)[9][DEA_HEX_PAIRS],
                         double *K);
