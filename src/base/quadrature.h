/* Nodes, weights and nodal bases on [-1, 1]. */
#pragma once

#include <stddef.h>

enum { DEA_QUADRATURE_MAX = 32 };

/* Gauss-Legendre rule of `count` points (1 to DEA_QUADRATURE_MAX), exact to degree 2 count - 1.
 * x, w: [count], ascending. */
void dea_gauss_rule(size_t count, double *x, double *w);

/* Gauss-Lobatto nodes of a polynomial of degree `order` (1 to DEA_QUADRATURE_MAX - 1): the ends and
 * the zeros of P'_order. x: [order + 1], ascending. */
void dea_lobatto_nodes(size_t order, double *x);

/* Lagrange basis on given nodes at one place: value[j] = l_j(at), slope[j] = l_j'(at).
 * nodes, value, slope: [count]. */
void dea_lagrange(size_t count, const double *nodes, double at, double *value, double *slope);
