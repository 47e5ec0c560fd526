/* The hexahedron with a potential: the energy of hex.h with a field that is free to spread
 * (docs/theory/coupled.md).
 *
 * Symbol   meaning                                                        unit
 * psi      potential over c                                               m
 * c        scale of the potential, about sqrt(shear modulus/permittivity) V/m
 * E        -c Grad psi, field in the stretched flat film                  V/m
 * w        cof(F) E                                                       V/m
 *
 * Energy of an element, per volume of the stretched flat film: that of hex.h without voltage, and
 * -(eps/2) |w|^2. It is to be minimal in u and maximal in psi. */
#include "model/solid/element/hex.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

enum { ROWS_MAX = 3 * DEA_HEX_GAUSS_MAX };

/* Work space of a tangent, rows (q, i) or (q, J). */
struct field_work {
  double B[ROWS_MAX][DEA_ELEMENT_DOFS_MAX];    // sqrt(weight) dw_i by the unknowns
  double turn[3][ROWS_MAX][DEA_HEX_NODES_MAX]; // -eps weight w_i (E x g_a)
  double mix[3][ROWS_MAX][DEA_HEX_NODES_MAX];  // eps weight c (g_a x A_k)
  double block[DEA_HEX_NODES_MAX * DEA_HEX_NODES_MAX];
};

/* Forces: -eps w . dw/du and -eps w . dw/dpsi. */
static void add_force(const struct dea_hex_shape *s, double eps, double scale,
                      const struct dea_hex_point *at, double gradient[3][DEA_HEX_NODES_MAX],
                      const struct dea_hex_field *field, double *g)
{
  double T[3][3], D[3]; // T_kL = w . dw/dF_kL; D_J = w . cof_J
  for (int L = 0; L < 3; L++) {
    const double column[3] = {field->H[0][L], field->H[1][L], field->H[2][L]};
    double turned[3];
    dea_cross(column, field->w, turned);
    for (int k = 0; k < 3; k++) {
      T[k][L] = turned[k];
    }
    D[L] = field->w[0] * at->cof[L] + field->w[1] * at->cof[3 + L] + field->w[2] * at->cof[6 + L];
  }
  double f = -eps * at->weight;
  for (int n = 0; n < s->nodes; n++) {
    double x = gradient[0][n], y = gradient[1][n], z = gradient[2][n];
    for (int k = 0; k < 3; k++) {
      g[4 * n + k] += f * (T[k][0] * x + T[k][1] * y + T[k][2] * z);
    }
    g[4 * n + 3] -= f * scale * (D[0] * x + D[1] * y + D[2] * z);
  }
}

/* Rows of the work space that belong to one Gauss point. */
static void tangent_point(const struct dea_hex_shape *s, int q, double eps, double scale,
                          const struct dea_hex_point *at, double gradient[3][DEA_HEX_NODES_MAX],
                          const struct dea_hex_field *field, struct field_work *work)
{
  double root = sqrt(at->weight), f = -eps * at->weight;
  double(*B)[DEA_ELEMENT_DOFS_MAX] = work->B + 3 * q;
  for (int n = 0; n < s->nodes; n++) {
    const double g[3] = {gradient[0][n], gradient[1][n], gradient[2][n]};
    double h[3], turned[3], mixed[3];
    dea_cross(field->E, g, turned);
    for (int m = 0; m < 3; m++) {
      const double *H = field->H[m], *c = at->cof + 3 * m;
      h[m] = root * (H[0] * g[0] + H[1] * g[1] + H[2] * g[2]);
      B[m][4 * n + m] = 0;
      B[m][4 * n + 3] = -root * scale * (c[0] * g[0] + c[1] * g[1] + c[2] * g[2]);
    }
    for (int i = 0; i < 3; i++) { // eps_ikm h_m
      int k = (i + 1) % 3, m = (i + 2) % 3;
      B[i][4 * n + k] = h[m];
      B[i][4 * n + m] = -h[k];
      dea_cross(g, field->A[i], mixed);
      for (int J = 0; J < 3; J++) {
        work->turn[i][3 * q + J][n] = f * field->w[i] * turned[J];
        work->mix[i][3 * q + J][n] = -f * scale * mixed[J];
      }
    }
  }
}

/* block = rows^T gradient, [nodes][nodes]. */
static void contract(const struct dea_hex_shape *s, double (*rows)[DEA_HEX_NODES_MAX],
                     double (*gradient)[3][DEA_HEX_NODES_MAX], double *block)
{
  cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, s->nodes, s->nodes, 3 * s->gauss, 1, rows[0],
              DEA_HEX_NODES_MAX, gradient[0][0], DEA_HEX_NODES_MAX, 0, block, s->nodes);
}

static void tangent_collect(const struct dea_hex_shape *s, double eps,
                            double (*gradient)[3][DEA_HEX_NODES_MAX], struct field_work *work,
                            double *K)
{
  int n = s->nodes, dofs = 4 * n;
  cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, dofs, dofs, 3 * s->gauss, -eps, work->B[0],
              DEA_ELEMENT_DOFS_MAX, work->B[0], DEA_ELEMENT_DOFS_MAX, 1, K, dofs);
  for (int i = 0; i < 3; i++) {
    int k = (i + 1) % 3, m = (i + 2) % 3;
    contract(s, work->turn[i], gradient, work->block);
    for (int a = 0; a < n; a++) {
      for (int b = 0; b < n; b++) {
        // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): cblas_dgemm has set it
        K[(4 * a + k) * dofs + 4 * b + m] += work->block[a * n + b];
        K[(4 * a + m) * dofs + 4 * b + k] -= work->block[a * n + b];
      }
    }
    contract(s, work->mix[i], gradient, work->block);
    for (int a = 0; a < n; a++) {
      for (int b = 0; b < n; b++) {
        K[(4 * a + i) * dofs + 4 * b + 3] += work->block[a * n + b];
        K[(4 * b + 3) * dofs + 4 * a + i] += work->block[a * n + b];
      }
    }
  }
}

static dea_status evaluate(const struct dea_element *element, const struct dea_element_input *in,
                           enum dea_eval_order order, struct dea_element_result *out)
{
  const struct dea_hex_shape *shape = element->basis;
  const double c = in->potential_V_per_m;
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  struct field_work work;
  double eps = in->part_material->permittivity_F_per_m;
  struct dea_element_input elastic = *in;
  elastic.voltage_V = 0;
  DEA_TRY_STATUS(dea_hex_evaluate(element, &elastic, order, out));
  DEA_TRY_STATUS(dea_hex_kinematics(shape, in->X, in->u, gradient, points));
  if (order >= DEA_FORCE) {
    dea_element_spread(shape->nodes, out->g, order >= DEA_TANGENT ? out->K : NULL, out->g, out->K);
  }
  for (int q = 0; q < shape->gauss; q++) {
    struct dea_hex_field field;
    dea_hex_field_at(shape, &points[q], gradient[q], in->potential, c, &field);
    const double *w = field.w;
    out->energy_J -= 0.5 * eps * points[q].weight * dea_dot(w, w);
    if (order >= DEA_FORCE) {
      add_force(shape, eps, c, &points[q], gradient[q], &field, out->g);
    }
    if (order >= DEA_TANGENT) {
      tangent_point(shape, q, eps, c, &points[q], gradient[q], &field, &work);
    }
  }
  if (order >= DEA_TANGENT) {
    tangent_collect(shape, eps, gradient, &work, out->K);
  }
  return DEA_OK;
}

/* dcof/dF : H. */
static void cofactors_along(const double F[9], const double H[9], double out[9])
{
  for (int i = 0; i < 3; i++) {
    const int k = 3 * ((i + 1) % 3), m = 3 * ((i + 2) % 3);
    for (int J = 0; J < 3; J++) {
      const int L = (J + 1) % 3, N = (J + 2) % 3;
      out[3 * i + J] =
          F[k + L] * H[m + N] + H[k + L] * F[m + N] - F[k + N] * H[m + L] - H[k + N] * F[m + L];
    }
  }
}

/* Second derivative of |w|^2/2 along H and D, the changes of F and E: of w = cof(F) E they are w' =
 * cof' E + cof D and w'' = 2 (cof(H) E + cof' D). */
static double bend_field(const struct dea_hex_point *at, const struct dea_hex_field *field,
                         const double H[9], const double D[3])
{
  double along[9], twice[9], sum = 0;
  cofactors_along(at->F, H, along);
  dea_cofactors(H, twice);
  for (int i = 0; i < 3; i++) {
    double first = 0, second = 0;
    for (int J = 0; J < 3; J++) {
      first += along[3 * i + J] * field->E[J] + at->cof[3 * i + J] * D[J];
      second += 2 * (twice[3 * i + J] * field->E[J] + along[3 * i + J] * D[J]);
    }
    sum += first * first + field->w[i] * second;
  }
  return sum;
}

static dea_status motion(const struct dea_element *element, const struct dea_element_input *in,
                         const struct dea_element_motion *motion, double *stiffness, double *mass)
{
  const struct dea_hex_shape *shape = element->basis;
  const double c = in->potential_V_per_m, eps = in->part_material->permittivity_F_per_m;
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX], H[DEA_HEX_GAUSS_MAX][9];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  struct dea_element_input elastic = *in;
  elastic.voltage_V = 0;
  DEA_TRY_STATUS(dea_hex_find_motion(shape, in->X, in->u, motion->v, points, H));
  DEA_TRY_STATUS(dea_hex_motion_at(element, &elastic, motion, points, H, stiffness, mass));
  DEA_TRY_STATUS(dea_hex_kinematics(shape, in->X, in->u, gradient, points));
  for (int q = 0; q < shape->gauss; q++) {
    struct dea_hex_field field, change;
    dea_hex_field_at(shape, &points[q], gradient[q], motion->potential, c, &change);
    dea_hex_field_at(shape, &points[q], gradient[q], in->potential, c, &field);
    *stiffness -= eps * points[q].weight * bend_field(&points[q], &field, H[q], change.E);
  }
  return DEA_OK;
}

static dea_status capacity(const struct dea_element *element, const struct dea_element_input *in,
                           double *L)
{
  const struct dea_hex_shape *shape = element->basis;
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  double B[ROWS_MAX][DEA_HEX_NODES_MAX]; // sqrt(weight) cof Grad N
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  DEA_TRY_STATUS(dea_hex_kinematics(shape, in->X, in->u, gradient, points));
  for (int q = 0; q < shape->gauss; q++) {
    double root = sqrt(points[q].weight);
    for (int i = 0; i < 3; i++) {
      const double *c = points[q].cof + 3 * i;
      for (int n = 0; n < shape->nodes; n++) {
        B[3 * q + i][n] =
            root * (c[0] * gradient[q][0][n] + c[1] * gradient[q][1][n] + c[2] * gradient[q][2][n]);
      }
    }
  }
  cblas_dgemm(CblasRowMajor, CblasTrans, CblasNoTrans, shape->nodes, shape->nodes, 3 * shape->gauss,
              in->part_material->permittivity_F_per_m, B[0], DEA_HEX_NODES_MAX, B[0],
              DEA_HEX_NODES_MAX, 0, L, shape->nodes);
  return DEA_OK;
}

const struct dea_element_type dea_element_potential_hexahedron = {
    .name = "hexahedron with a potential",
    .per_node = 4,
    .evaluate = evaluate,
    DEA_HEX_MEMBERS,
    .motion = motion,
    .capacity = capacity,
};
