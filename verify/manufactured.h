/* Manufactured solutions on the unit cube: exact states, the sources that make them solutions, and
 * norms of what a solid gets wrong.
 *
 * Of a state only x(X), the pressure and the potential are written down. F and Grad phi are their
 * complex steps; the elastic stress is that of the layer (dea_part_material_point), the electric
 * stress and the displacement D are complex steps of the energy -(eps/2) |cof(F) E|^2; Div P and
 * Div D are central differences of order 8 of P(F(X)) and D(F(X), E(X)). Body forces b = -Div P,
 * tractions P N, charges rho = Div D and -D N come in as integrals with the shape functions over
 * elements and free faces. */
#pragma once

#include "verify.h"

#include "base/quadrature.h"
#include "model/solid/assembly/solid.h"

#include <complex.h>

typedef double _Complex number;

/* An exact state. Dirichlet: u on x = 0 and z = 0 (on all of the cube with held_all), phi on z = 0
 * and z = 1. */
struct exact {
  const char *name;
  void (*place)(const number X[3], number x[3]);
  double (*pressure)(const double X[3]);  // NULL: compressible
  number (*potential)(const number X[3]); // NULL: no field
  bool held_all;
  struct dea_part_material layer;
};

static const double tiny = 1e-30; // of a complex step

static void exact_place(const struct exact *exact, const double X[3], double x[3], double F[9])
{
  for (int J = 0; J < 3; J++) {
    number at[3] = {X[0], X[1], X[2]}, to[3];
    at[J] += tiny * (number)_Complex_I;
    exact->place(at, to);
    for (int i = 0; i < 3; i++) {
      x[i] = creal(to[i]);
      F[3 * i + J] = cimag(to[i]) / tiny;
    }
  }
}

static double exact_potential(const struct exact *exact, const double X[3], double gradient[3])
{
  double value = 0;
  for (int J = 0; J < 3; J++) {
    number at[3] = {X[0], X[1], X[2]};
    at[J] += tiny * (number)_Complex_I;
    number phi = exact->potential == NULL ? 0 : exact->potential(at);
    value = creal(phi);
    gradient[J] = cimag(phi) / tiny;
  }
  return value;
}

/* -(eps/2) |cof(F) E|^2. */
static number electric_energy(double eps, const number F[9], const number E[3])
{
  number sum = 0;
  for (int i = 0; i < 3; i++) {
    int a = 3 * ((i + 1) % 3), b = 3 * ((i + 2) % 3);
    number w = 0;
    for (int J = 0; J < 3; J++) {
      int K = (J + 1) % 3, L = (J + 2) % 3;
      w += (F[a + K] * F[b + L] - F[a + L] * F[b + K]) * E[J];
    }
    sum += w * w;
  }
  return -0.5 * eps * sum;
}

/* P and D at a place. */
static void exact_stress(const struct exact *exact, const double X[3], double P[9], double D[3])
{
  double x[3], F[9], cof[9], gradient[3];
  struct dea_point point;
  exact_place(exact, X, x, F);
  double J = dea_cofactors(F, cof), p = exact->pressure == NULL ? 0 : exact->pressure(X);
  if (dea_part_material_point(&exact->layer, F, cof, J, p, 0, true, &point) != DEA_OK) {
    fprintf(stderr, "%s: the law has no stress there\n", exact->name);
    exit(1);
  }
  memcpy(P, point.P, 9 * sizeof *P);
  exact_potential(exact, X, gradient);
  for (int a = 0; a < 12; a++) {
    number Fa[9], Ea[3];
    for (int b = 0; b < 9; b++) {
      Fa[b] = F[b] + (a == b ? tiny * (number)_Complex_I : 0);
    }
    for (int b = 0; b < 3; b++) {
      Ea[b] = -gradient[b] + (a == 9 + b ? tiny * (number)_Complex_I : 0);
    }
    double slope = cimag(electric_energy(exact->layer.permittivity_F_per_m, Fa, Ea)) / tiny;
    *(a < 9 ? &P[a] : &D[a - 9]) = a < 9 ? P[a] + slope : -slope;
  }
}

/* Body force [3] and charge density there: -Div P and Div D. */
static void exact_source(const struct exact *exact, const double X[3], double source[4])
{
  static const double weight[4] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280}, step = 0.02;
  memset(source, 0, 4 * sizeof *source);
  for (int J = 0; J < 3; J++) {
    for (int k = 1; k <= 4; k++) {
      for (int sign = -1; sign <= 1; sign += 2) {
        double at[3] = {X[0], X[1], X[2]}, P[9], D[3], f = sign * weight[k - 1] / step;
        at[J] += sign * k * step;
        exact_stress(exact, at, P, D);
        for (int i = 0; i < 3; i++) {
          source[i] -= f * P[3 * i + J];
        }
        source[3] += f * D[J];
      }
    }
  }
}

/* ---- elements at any local place ---- */

struct local {
  int nodes;
  double value[DEA_HEX_NODES_MAX], slope[3][DEA_HEX_NODES_MAX]; // slope: local, then by X
  double X[3], map[9], volume;                                  // map: dX/dxi
};

static void local_at(const struct dea_grid *grid, size_t e, const double xi[3], struct local *out)
{
  size_t n = (size_t)grid->order + 1;
  double nodes[DEA_HEX_ORDER_MAX + 1], v[3][DEA_HEX_ORDER_MAX + 1], d[3][DEA_HEX_ORDER_MAX + 1];
  dea_lobatto_nodes((size_t)grid->order, nodes);
  for (int a = 0; a < 3; a++) {
    dea_lagrange(n, nodes, xi[a], v[a], d[a]);
  }
  memset(out, 0, sizeof *out);
  for (size_t k = 0; k < n * n * n; k++) {
    size_t i[3] = {k % n, k / n % n, k / (n * n)};
    const double *X = grid->X + 3 * grid->nodes[e * DEA_HEX_NODES_MAX + k];
    out->value[k] = v[0][i[0]] * v[1][i[1]] * v[2][i[2]];
    for (int a = 0; a < 3; a++) {
      int b = (a + 1) % 3, c = (a + 2) % 3;
      out->slope[a][k] = d[a][i[a]] * v[b][i[b]] * v[c][i[c]];
      out->X[a] += X[a] * out->value[k];
    }
    for (int m = 0; m < 9; m++) {
      out->map[m] += X[m / 3] * out->slope[m % 3][k];
    }
  }
  out->nodes = (int)(n * n * n);
}

/* Turns the slopes of a place into those by X. */
static void local_by_X(struct local *at)
{
  double cof[9];
  at->volume = dea_cofactors(at->map, cof);
  for (int k = 0; k < at->nodes; k++) {
    double s[3] = {at->slope[0][k], at->slope[1][k], at->slope[2][k]};
    for (int J = 0; J < 3; J++) {
      at->slope[J][k] =
          (cof[3 * J] * s[0] + cof[3 * J + 1] * s[1] + cof[3 * J + 2] * s[2]) / at->volume;
    }
  }
}

/* ---- sources ---- */

/* What adds to the nodes: f [nodes][3], q [nodes]. */
struct sources {
  double *f, *q;
};

static void add_source(const struct dea_grid *grid, size_t e, const struct local *at,
                       const double source[4], double weight, const struct sources *to)
{
  for (int k = 0; k < at->nodes; k++) {
    size_t node = (size_t)grid->nodes[e * DEA_HEX_NODES_MAX + (size_t)k];
    for (size_t i = 0; i < 3; i++) {
      to->f[3 * node + i] += weight * at->value[k] * source[i];
    }
    to->q[node] += weight * at->value[k] * source[3];
  }
}

static bool on_cube(const double X[3])
{
  bool on = false;
  for (int i = 0; i < 3; i++) {
    on = on || fabs(X[i]) < 1e-9 || fabs(X[i] - 1) < 1e-9;
  }
  return on;
}

/* Tractions and charges of the faces of an element that are faces of the cube; those on held nodes
 * do no harm. */
static void add_faces(const struct exact *exact, const struct dea_grid *grid, size_t e,
                      size_t count, const double *x, const double *w, const struct sources *to)
{
  for (int face = 0; face < 6; face++) {
    int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
    double side = face % 2 == 0 ? -1 : 1;
    for (size_t q = 0; q < count * count; q++) {
      double xi[3], P[9], D[3], source[4], N[3];
      struct local at;
      xi[a] = side;
      xi[b] = x[q % count];
      xi[c] = x[q / count];
      local_at(grid, e, xi, &at);
      if (!on_cube(at.X)) { // Gauss points of inner faces are not
        break;
      }
      for (int i = 0; i < 3; i++) { // side dX/dxi_b x dX/dxi_c
        int j = (i + 1) % 3, k = (i + 2) % 3;
        N[i] =
            side * (at.map[3 * j + b] * at.map[3 * k + c] - at.map[3 * k + b] * at.map[3 * j + c]);
      }
      exact_stress(exact, at.X, P, D);
      for (int i = 0; i < 3; i++) {
        source[i] = P[3 * i] * N[0] + P[3 * i + 1] * N[1] + P[3 * i + 2] * N[2];
      }
      source[3] = -(D[0] * N[0] + D[1] * N[1] + D[2] * N[2]);
      add_source(grid, e, &at, source, w[q % count] * w[q / count], to);
    }
  }
}

static void add_sources(const struct exact *exact, const struct dea_grid *grid,
                        const struct sources *to)
{
  double x[DEA_QUADRATURE_MAX], w[DEA_QUADRATURE_MAX];
  size_t count = (size_t)grid->order + 2;
  dea_gauss_rule(count, x, w);
  for (size_t e = 0; e < grid->element_count; e++) {
    for (size_t q = 0; q < count * count * count; q++) {
      size_t i = q % count, j = q / count % count, k = q / (count * count);
      const double xi[3] = {x[i], x[j], x[k]};
      double source[4];
      struct local at;
      local_at(grid, e, xi, &at);
      local_by_X(&at);
      exact_source(exact, at.X, source);
      add_source(grid, e, &at, source, at.volume * w[i] * w[j] * w[k], to);
    }
    add_faces(exact, grid, e, count, x, w, to);
  }
}

/* ---- errors ---- */

/* Norms over the cube, of errors and of the exact state. */
enum norm { NORM_U, NORM_GRAD_U, NORM_PHI, NORM_GRAD_PHI, NORM_PRESSURE, NORMS };

struct found {
  const double *u, *phi, *pressure; // [nodes][3], [nodes], [elements][pressures], NULL: none
  size_t pressures;
};

/* The polynomials of the pressure at a local place (hex.h: total degree order - 1). */
static double pressure_at(int order, const double xi[3], const double *coefficient)
{
  double sum = 0;
  for (int c = 0, m = 0; c < order; c++) {
    for (int b = 0; b + c < order; b++) {
      for (int a = 0; a + b + c < order; a++, m++) {
        sum += coefficient[m] * pow(xi[0], a) * pow(xi[1], b) * pow(xi[2], c);
      }
    }
  }
  return sum;
}

/* Adds the squares of one place. */
static void add_errors(const struct exact *exact, const struct dea_grid *grid, size_t e,
                       const double xi[3], double weight, const struct found *found,
                       double error[NORMS], double whole[NORMS])
{
  struct local at;
  double x[3], F[9], gradient[3];
  local_at(grid, e, xi, &at);
  local_by_X(&at);
  exact_place(exact, at.X, x, F);
  double phi = exact_potential(exact, at.X, gradient), w = weight * at.volume;
  const int *nodes = grid->nodes + e * DEA_HEX_NODES_MAX;
  for (int i = 0; i < 4; i++) { // u_x, u_y, u_z, phi
    double wanted = i < 3 ? x[i] - at.X[i] : phi, got = 0, got_slope[3] = {0, 0, 0};
    for (int k = 0; k < at.nodes; k++) {
      double value = i < 3                ? found->u[3 * nodes[k] + i]
                     : found->phi != NULL ? found->phi[nodes[k]]
                                          : 0;
      got += value * at.value[k];
      for (int J = 0; J < 3; J++) {
        got_slope[J] += value * at.slope[J][k];
      }
    }
    int norm = i < 3 ? NORM_U : NORM_PHI;
    error[norm] += w * (got - wanted) * (got - wanted);
    whole[norm] += w * wanted * wanted;
    for (int J = 0; J < 3; J++) {
      double slope = i < 3 ? F[3 * i + J] - (i == J) : gradient[J];
      error[norm + 1] += w * (got_slope[J] - slope) * (got_slope[J] - slope);
      whole[norm + 1] += w * slope * slope;
    }
  }
  if (exact->pressure != NULL) {
    double wanted = exact->pressure(at.X);
    double got = pressure_at(grid->order, xi, found->pressure + e * found->pressures);
    error[NORM_PRESSURE] += w * (got - wanted) * (got - wanted);
    whole[NORM_PRESSURE] += w * wanted * wanted;
  }
}

/* Relative errors; NAN for what the state does not have. */
static void errors_of(const struct exact *exact, const struct dea_grid *grid,
                      const struct found *found, double error[NORMS])
{
  double x[DEA_QUADRATURE_MAX], w[DEA_QUADRATURE_MAX], whole[NORMS] = {0};
  size_t count = (size_t)grid->order + 2;
  memset(error, 0, NORMS * sizeof *error);
  dea_gauss_rule(count, x, w);
  for (size_t e = 0; e < grid->element_count; e++) {
    for (size_t q = 0; q < count * count * count; q++) {
      size_t i = q % count, j = q / count % count, k = q / (count * count);
      const double xi[3] = {x[i], x[j], x[k]};
      add_errors(exact, grid, e, xi, w[i] * w[j] * w[k], found, error, whole);
    }
  }
  for (int norm = 0; norm < NORMS; norm++) {
    error[norm] = whole[norm] > 0 ? sqrt(error[norm] / whole[norm]) : NAN;
  }
}
