/* The layered hexahedron: one kinematics for film, glue and fibre. See hex.h. */
#include "model/solid/element/hex.h"

#include "base/quadrature.h"
#include "model/solid/element/gauss_to_nodes.h"
#include "model/solid/element/hex_tensor.h"
#include "model/solid/point/membrane_point.h"
#include "model/solid/point/viscous.h"

#include <math.h>
#include <string.h>

/* ---- state at the Gauss points ---- */

/* From the slopes of X and u by the local axes, slope[a] = {dX/dxi_a, du/dxi_a}. */
static dea_status find_point(double weight, const double *slope[3], struct dea_hex_point *at)
{
  double map[9], cof[9];
  for (int a = 0; a < 3; a++) {
    for (int i = 0; i < 3; i++) {
      map[3 * i + a] = slope[a][i];
    }
  }
  double volume = dea_cofactors(map, cof);
  if (!(volume > 0)) {
    return DEA_E_DOMAIN;
  }
  for (int a = 0; a < 3; a++) {
    for (int J = 0; J < 3; J++) {
      at->local[3 * a + J] = cof[3 * J + a] / volume;
    }
  }
  for (int i = 0; i < 3; i++) {
    for (int J = 0; J < 3; J++) {
      at->F[3 * i + J] = (i == J ? 1 : 0) + slope[0][3 + i] * at->local[J] +
                         slope[1][3 + i] * at->local[3 + J] + slope[2][3 + i] * at->local[6 + J];
    }
  }
  at->J = dea_cofactors(at->F, at->cof);
  at->weight = weight * volume;
  return at->J > 0 ? DEA_OK : DEA_E_DOMAIN;
}

/* Of `count` fields [nodes][3]: X, u, and v where there are three, of which H then is the gradient
 * by X. */
static inline dea_status find(const struct dea_hex_shape *s, const double *const *fields, int count,
                              struct dea_hex_point *points, double (*H)[9])
{
  enum { MOST = 9 };
  const int width = 3 * count;
  double values[DEA_HEX_NODES_MAX * MOST], slopes[3 * DEA_HEX_GAUSS_MAX * MOST];
  for (int n = 0; n < s->nodes; n++) {
    for (int f = 0; f < count; f++) {
      memcpy(values + width * n + 3 * f, fields[f] + 3 * n, 3 * sizeof *values);
    }
  }
  dea_hex_slopes(s, width, values, slopes);
  for (int q = 0; q < s->gauss; q++) {
    const double *slope[3] = {slopes + width * q, slopes + width * (s->gauss + q),
                              slopes + width * (2 * s->gauss + q)};
    DEA_TRY_STATUS(find_point(s->weight[q], slope, &points[q]));
    for (int a = 0; a < 9 && count == 3; a++) {
      const double *local = points[q].local + a % 3;
      H[q][a] = slope[0][6 + a / 3] * local[0] + slope[1][6 + a / 3] * local[3] +
                slope[2][6 + a / 3] * local[6];
    }
  }
  return DEA_OK;
}

dea_status dea_hex_find_points(const struct dea_hex_shape *s, const double *X, const double *u,
                               struct dea_hex_point *points)
{
  return find(s, (const double *const[]){X, u}, 2, points, NULL);
}

dea_status dea_hex_find_motion(const struct dea_hex_shape *s, const double *X, const double *u,
                               const double *v, struct dea_hex_point *points, double (*H)[9])
{
  return find(s, (const double *const[]){X, u, v}, 3, points, H);
}

dea_status dea_hex_kinematics(const struct dea_hex_shape *s, const double *X, const double *u,
                              double (*gradient)[3][DEA_HEX_NODES_MAX],
                              struct dea_hex_point *points)
{
  DEA_TRY_STATUS(dea_hex_find_points(s, X, u, points));
  for (int q = 0; q < s->gauss; q++) {
    for (int J = 0; J < 3; J++) {
      const double *l = points[q].local + J;
      for (int n = 0; n < s->nodes; n++) {
        gradient[q][J][n] =
            l[0] * s->slope[q][0][n] + l[3] * s->slope[q][1][n] + l[6] * s->slope[q][2][n];
      }
    }
  }
  return DEA_OK;
}

/* M^-1 moment with M = L L^T. */
static void solve_moments(const struct dea_hex_shape *s,
                          double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                          double *moment)
{
  for (int a = 0; a < s->pressures; a++) {
    for (int b = 0; b < a; b++) {
      moment[a] -= factor[a][b] * moment[b];
    }
    moment[a] /= factor[a][a];
  }
  for (int a = s->pressures - 1; a >= 0; a--) {
    for (int b = a + 1; b < s->pressures; b++) {
      moment[a] -= factor[b][a] * moment[b];
    }
    moment[a] /= factor[a][a];
  }
}

dea_status dea_hex_project(const struct dea_hex_shape *s, const struct dea_hex_point *points,
                           double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX],
                           double *moment, double *theta)
{
  int m = s->pressures;
  memset(moment, 0, (size_t)m * sizeof *moment);
  for (int a = 0; a < m; a++) {
    memset(factor[a], 0, sizeof factor[a]);
  }
  for (int q = 0; q < s->gauss; q++) {
    for (int a = 0; a < m; a++) {
      double f = points[q].weight * s->pressure[q][a];
      moment[a] += f * (points[q].J - 1);
      for (int b = 0; b <= a; b++) {
        factor[a][b] += f * s->pressure[q][b];
      }
    }
  }
  for (int a = 0; a < m; a++) { // Cholesky of a matrix of at most ten rows
    for (int b = 0; b <= a; b++) {
      double sum = factor[a][b];
      for (int c = 0; c < b; c++) {
        sum -= factor[a][c] * factor[b][c];
      }
      if (a == b && !(sum > 0)) {
        return DEA_E_DOMAIN;
      }
      factor[a][b] = a == b ? sqrt(sum) : sum / factor[b][b];
    }
  }
  memcpy(theta, moment, (size_t)m * sizeof *theta);
  solve_moments(s, factor, theta);
  return DEA_OK;
}

/* ---- energy, force, tangent ---- */

/* Work space of one evaluation. flux: [3][gauss][columns] of the weighted stress by the local axes
 * (columns 0 to 2), and with a tangent of phi_m dJ/dF (three columns for each pressure). */
struct hex_work {
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  int columns;
  double flux[3 * DEA_HEX_GAUSS_MAX * DEA_HEX_COLUMNS_MAX];
  double sums[DEA_HEX_NODES_MAX * DEA_HEX_COLUMNS_MAX]; // [nodes][columns]
  double A[DEA_HEX_GAUSS_MAX][9][DEA_HEX_PAIRS];
  double b[DEA_HEX_PRESSURES_MAX * DEA_HEX_DOFS_MAX]; // [pressures][dofs], L^-1 int phi_m dJ/du
  double kappa_b[DEA_HEX_PRESSURES_MAX * DEA_HEX_DOFS_MAX]; // [dofs][pressures], kappa times it
};

/* weight T_iJ dxi_a/dX_J of one Gauss point, T in the columns from `column`. */
static void set_flux(const struct dea_hex_shape *s, int q, double weight, const double T[9],
                     int column, struct hex_work *work)
{
  const double *local = work->points[q].local;
  for (int a = 0; a < 3; a++) {
    double *to = work->flux + (a * s->gauss + q) * work->columns + column;
    for (int i = 0; i < 3; i++) {
      to[i] = weight * (T[3 * i] * local[3 * a] + T[3 * i + 1] * local[3 * a + 1] +
                        T[3 * i + 2] * local[3 * a + 2]);
    }
  }
}

/* weight dxi_a/dX_J A_iJkL dxi_b/dX_L of one Gauss point for i <= k. */
static void set_tangent(int q, const double A[81], struct hex_work *work)
{
  const struct dea_hex_point *at = &work->points[q];
  const double *local = at->local;
  for (int i = 0, pair = 0; i < 3; i++) {
    for (int k = i; k < 3; k++, pair++) {
      double half[9]; // A_iJkL dxi_b/dX_L as [3 J + b]
      for (int J = 0; J < 3; J++) {
        const double *row = A + 9 * (3 * i + J) + 3 * k;
        for (int b = 0; b < 3; b++) {
          half[3 * J + b] = at->weight * (row[0] * local[3 * b] + row[1] * local[3 * b + 1] +
                                          row[2] * local[3 * b + 2]);
        }
      }
      for (int a = 0; a < 3; a++) {
        const double *l = local + 3 * a;
        for (int b = 0; b < 3; b++) {
          work->A[q][3 * a + b][pair] = l[0] * half[b] + l[1] * half[3 + b] + l[2] * half[6 + b];
        }
      }
    }
  }
}

/* Pressure of the projected part at a Gauss point. */
static double pressure_at(const struct dea_hex_shape *s,
                          const struct dea_part_material *part_material, int q,
                          const double *multiplier, const double *theta)
{
  double pressure = 0;
  for (int m = 0; m < s->pressures; m++) {
    pressure += s->pressure[q][m] * (multiplier[m] + part_material->kappa_Pa * theta[m]);
  }
  return pressure;
}

/* Energy, stress and tangent of one Gauss point, with what its branches add. */
static dea_status point_of(const struct dea_part_material *part_material, int q,
                           const struct dea_hex_point *at, double pressure, double field,
                           bool tangent, struct dea_point *out)
{
  DEA_TRY_STATUS(
      dea_part_material_point(part_material, at->F, at->cof, at->J, pressure, field, tangent, out));
  dea_viscous_add(part_material, q, at->F, at->cof, at->J, tangent, out);
  return DEA_OK;
}

/* One Gauss point: its energy, and what the sums over the points take. predicted: NULL without. */
static dea_status evaluate_point(const struct dea_hex_shape *s,
                                 const struct dea_part_material *part_material, int q,
                                 double pressure, double field, enum dea_eval_order order,
                                 const double *predicted, struct hex_work *work, double *energy)
{
  const struct dea_hex_point *at = &work->points[q];
  struct dea_point point;
  DEA_TRY_STATUS(point_of(part_material, q, at, pressure, field, order >= DEA_TANGENT, &point));
  *energy += at->weight * point.W;
  if (order >= DEA_FORCE) {
    set_flux(s, q, at->weight, point.P, 0, work);
  }
  if (order >= DEA_TANGENT && predicted != NULL) {
    double other = -pressure;
    for (int m = 0; m < s->pressures; m++) { // 0 of what takes none
      other += s->pressure[q][m] * predicted[m];
    }
    dea_part_material_restress(at->F, at->cof, at->J, other, predicted + s->pressures + 6 * q,
                               &point);
  }
  if (order >= DEA_TANGENT) {
    set_tangent(q, point.A, work);
    for (int m = 0; 3 * m + 3 < work->columns; m++) {
      set_flux(s, q, at->weight * s->pressure[q][m], at->cof, 3 * m + 3, work);
    }
  }
  return DEA_OK;
}

/* b = L^-1 int phi_m dJ/du, row by row; the integrals are the columns of the sums from the third.
 */
static void set_constraint(const struct dea_hex_shape *s, int pressures,
                           const struct hex_work *work, double *all)
{
  int dofs = 3 * s->nodes;
  for (int m = 0; m < pressures; m++) {
    double *b = all + m * dofs, inverse = 1 / work->factor[m][m];
    for (int j = 0; j < dofs; j++) {
      b[j] = work->sums[j / 3 * work->columns + 3 * m + 3 + j % 3];
    }
    for (int c = 0; c < m; c++) {
      for (int j = 0; j < dofs; j++) {
        b[j] -= work->factor[m][c] * all[c * dofs + j];
      }
    }
    for (int j = 0; j < dofs; j++) {
      b[j] *= inverse;
    }
  }
}

/* K = kappa b^T M^-1 b with M = L L^T, b_m = int phi_m dJ/du. */
static void set_projected(const struct dea_hex_shape *s, double kappa, struct hex_work *work,
                          double *K)
{
  int dofs = 3 * s->nodes, pressures = work->columns / 3 - 1;
  set_constraint(s, pressures, work, work->b);
  for (int m = 0; m < pressures; m++) {
    for (int j = 0; j < dofs; j++) {
      work->kappa_b[j * pressures + m] = kappa * work->b[m * dofs + j];
    }
  }
  if (pressures == 0) {
    memset(K, 0, (size_t)(dofs * dofs) * sizeof *K);
    return;
  }
  dea_hex_combine((size_t)dofs, (size_t)pressures, work->kappa_b, (size_t)pressures, (size_t)dofs,
                  work->b, K);
}

dea_status dea_hex_evaluate(const struct dea_element *element, const struct dea_element_input *in,
                            enum dea_eval_order order, struct dea_element_result *out)
{
  struct hex_work work;
  const struct dea_hex_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  bool projected = dea_part_material_takes_pressure(part_material);
  double field = dea_part_material_field(part_material, in->voltage_V);
  const double *predicted = order >= DEA_TANGENT ? in->predicted : NULL;
  out->energy_J = out->volume_m3 = 0;
  memset(out->theta, 0, sizeof out->theta);
  DEA_TRY_STATUS(dea_hex_find_points(shape, in->X, in->u, work.points));
  if (projected) {
    DEA_TRY_STATUS(dea_hex_project(shape, work.points, work.factor, work.moment, out->theta));
  }
  for (int m = 0; m < shape->pressures && projected; m++) {
    out->energy_J +=
        (in->multiplier[m] + 0.5 * part_material->kappa_Pa * out->theta[m]) * work.moment[m];
  }
  work.columns = order >= DEA_TANGENT && projected ? 3 + 3 * shape->pressures : 3;
  for (int q = 0; q < shape->gauss; q++) {
    double pressure =
        projected ? pressure_at(shape, part_material, q, in->multiplier, out->theta) : 0;
    out->volume_m3 += work.points[q].weight;
    DEA_TRY_STATUS(evaluate_point(shape, part_material, q, pressure, field, order, predicted, &work,
                                  &out->energy_J));
  }
  if (order < DEA_FORCE) {
    return DEA_OK;
  }
  dea_hex_sum_flux(shape, work.columns, work.flux, work.sums);
  for (int i = 0; i < 3 * shape->nodes; i++) {
    out->g[i] = work.sums[i / 3 * work.columns + i % 3];
  }
  if (order >= DEA_TANGENT) {
    set_projected(shape, part_material->kappa_Pa, &work, out->K);
    dea_hex_add_tangent(shape, work.A, out->K);
  }
  return DEA_OK;
}

dea_status dea_hex_constraint(const struct dea_element *element, const struct dea_element_input *in,
                              double *b, double *L)
{
  struct hex_work work;
  double theta[DEA_HEX_PRESSURES_MAX];
  const struct dea_hex_shape *s = element->basis;
  size_t count = (size_t)s->pressures, dofs = 3 * (size_t)s->nodes;
  memset(b, 0, count * dofs * sizeof *b);
  memset(L, 0, count * count * sizeof *L);
  if (!dea_part_material_takes_pressure(in->part_material)) {
    return DEA_OK;
  }
  DEA_TRY_STATUS(dea_hex_find_points(s, in->X, in->u, work.points));
  DEA_TRY_STATUS(dea_hex_project(s, work.points, work.factor, work.moment, theta));
  work.columns = 3 + 3 * s->pressures;
  memset(work.flux, 0, (size_t)(3 * s->gauss * work.columns) * sizeof *work.flux);
  for (int q = 0; q < s->gauss; q++) {
    const struct dea_hex_point *at = &work.points[q];
    for (int m = 0; m < s->pressures; m++) {
      set_flux(s, q, at->weight * s->pressure[q][m], at->cof, 3 * m + 3, &work);
    }
  }
  dea_hex_sum_flux(s, work.columns, work.flux, work.sums);
  set_constraint(s, s->pressures, &work, b);
  for (size_t m = 0; m < count; m++) {
    memcpy(L + m * count, work.factor[m], (m + 1) * sizeof *L);
  }
  return DEA_OK;
}

/* ---- small motions ---- */

static double product(const double a[9], const double b[9])
{
  double sum = 0;
  for (int k = 0; k < 9; k++) {
    sum += a[k] * b[k];
  }
  return sum;
}

/* H A H of one Gauss point at a pressure, without weight. */
static dea_status bend_point(const struct dea_part_material *part_material, int q,
                             const struct dea_hex_point *at, double pressure, double field,
                             const double H[9], double *out)
{
  struct dea_point point;
  DEA_TRY_STATUS(point_of(part_material, q, at, pressure, field, true, &point));
  *out = 0;
  for (int a = 0; a < 9; a++) {
    *out += H[a] * product(point.A + 9 * a, H);
  }
  return DEA_OK;
}

dea_status dea_hex_motion_at(const struct dea_element *element, const struct dea_element_input *in,
                             const struct dea_element_motion *motion,
                             const struct dea_hex_point *points, double (*H)[9], double *stiffness,
                             double *mass)
{
  const struct dea_hex_shape *s = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  const bool projected = dea_part_material_takes_pressure(part_material);
  const double field = dea_part_material_field(part_material, in->voltage_V);
  *stiffness = *mass = 0;
  for (int q = 0; q < s->gauss; q++) {
    const double weight = points[q].weight;
    double pressure = 0, change = 0, bending = 0, here[3];
    for (int m = 0; m < s->pressures && projected; m++) {
      pressure += s->pressure[q][m] * in->multiplier[m];
      change += s->pressure[q][m] * motion->pressure[m];
    }
    DEA_TRY_STATUS(bend_point(part_material, q, &points[q], pressure, field, H[q], &bending));
    bending += 2 * change * product(points[q].cof, H[q]);
    bending -= change != 0 ? change * change / part_material->kappa_Pa : 0;
    *stiffness += weight * bending;
    dea_element_at(s->nodes, s->value[q], motion->v, here);
    *mass += part_material->density_kg_per_m3 * weight * dea_dot(here, here);
  }
  return DEA_OK;
}

static dea_status motion_of(const struct dea_element *element, const struct dea_element_input *in,
                            const struct dea_element_motion *motion, double *stiffness,
                            double *mass)
{
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double H[DEA_HEX_GAUSS_MAX][9];
  DEA_TRY_STATUS(dea_hex_find_motion(element->basis, in->X, in->u, motion->v, points, H));
  return dea_hex_motion_at(element, in, motion, points, H, stiffness, mass);
}

/* ---- stresses at the end of a linear step ---- */

/* H_iJ = sum_n step_ni dN_n/dX_J at a Gauss point. */
static void step_gradient(const struct dea_hex_shape *s, double gradient[3][DEA_HEX_NODES_MAX],
                          const double *step, double H[9])
{
  memset(H, 0, 9 * sizeof *H);
  for (int J = 0; J < 3; J++) {
    for (int n = 0; n < s->nodes; n++) {
      for (int i = 0; i < 3; i++) {
        H[3 * i + J] += step[3 * n + i] * gradient[J][n];
      }
    }
  }
}

/* S + fraction F^-1 (dP - H S) at a point: dS of dP = H S + F dS. */
static dea_status predict_point(const struct dea_part_material *part_material, int q,
                                const struct dea_hex_point *at, double pressure,
                                double pressure_change, double field, const double H[9],
                                double fraction, double out[6])
{
  struct dea_point point;
  double S[9], dP[9], dS[9];
  DEA_TRY_STATUS(point_of(part_material, q, at, pressure, field, true, &point));
  dea_part_material_second_stress(at->cof, at->J, point.P, S);
  for (int i = 0; i < 3; i++) {
    for (int B = 0; B < 3; B++) {
      int a = 3 * i + B;
      dP[a] = product(point.A + 9 * a, H) + pressure_change * at->cof[a];
      for (int A = 0; A < 3; A++) {
        dP[a] -= H[3 * i + A] * S[3 * A + B];
      }
    }
  }
  dea_part_material_second_stress(at->cof, at->J, dP, dS);
  for (int a = 0; a < 9; a++) {
    S[a] += fraction * dS[a];
  }
  const double ordered[6] = {
      S[0], S[4], S[8], 0.5 * (S[5] + S[7]), 0.5 * (S[2] + S[6]), 0.5 * (S[1] + S[3])};
  memcpy(out, ordered, sizeof ordered);
  return DEA_OK;
}

dea_status dea_hex_predict(const struct dea_element *element, const struct dea_element_input *in,
                           const double *step, double fraction, bool stresses, double *predicted)
{
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX], H[DEA_HEX_GAUSS_MAX][9];
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX] = {0}, change[DEA_HEX_PRESSURES_MAX] = {0};
  const struct dea_hex_shape *s = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  const double *multiplier = in->multiplier;
  double field = dea_part_material_field(part_material, in->voltage_V);
  bool projected = dea_part_material_takes_pressure(part_material);
  DEA_TRY_STATUS(dea_hex_kinematics(s, in->X, in->u, gradient, points));
  if (projected) {
    DEA_TRY_STATUS(dea_hex_project(s, points, factor, moment, theta));
  }
  for (int q = 0; q < s->gauss; q++) {
    step_gradient(s, gradient[q], step, H[q]);
    double squeeze = points[q].weight * product(points[q].cof, H[q]);
    for (int m = 0; m < s->pressures && projected; m++) {
      change[m] += s->pressure[q][m] * squeeze;
    }
  }
  if (projected) {
    solve_moments(s, factor, change);
  }
  double kappa = projected ? part_material->kappa_Pa : 0;
  for (int m = 0; m < s->pressures; m++) {
    predicted[m] = projected ? multiplier[m] + kappa * (theta[m] + fraction * change[m]) : 0;
  }
  for (int q = 0; q < s->gauss && stresses; q++) {
    double pressure = 0, pressure_change = 0;
    for (int m = 0; m < s->pressures && projected; m++) {
      pressure += s->pressure[q][m] * (multiplier[m] + kappa * theta[m]);
      pressure_change += s->pressure[q][m] * kappa * change[m];
    }
    DEA_TRY_STATUS(predict_point(part_material, q, &points[q], pressure, pressure_change, field,
                                 H[q], fraction, predicted + s->pressures + 6 * q));
  }
  return DEA_OK;
}

/* ---- mass and metric ---- */

dea_status dea_hex_masses(const struct dea_element *element,
                          const struct dea_part_material *part_material, const double *X,
                          double *kilograms)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0};
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  DEA_TRY_STATUS(dea_hex_find_points(element->basis, X, rest, points));
  for (int q = 0; q < element->points; q++) {
    kilograms[q] = part_material->density_kg_per_m3 * points[q].weight;
  }
  return DEA_OK;
}

dea_status dea_hex_metric(const struct dea_element *element,
                          const struct dea_part_material *part_material, const double *X,
                          double *laplace, double *volume)
{
  static const double rest[DEA_HEX_DOFS_MAX] = {0};
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX], whole = 0, sum = 0;
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  const struct dea_hex_shape *s = element->basis;
  (void)part_material;
  DEA_TRY_STATUS(dea_hex_kinematics(s, X, rest, gradient, points));
  size_t nodes = (size_t)s->nodes;
  memset(volume, 0, nodes * sizeof *volume);
  for (int q = 0; q < s->gauss; q++) {
    whole += points[q].weight;
    for (size_t a = 0; a < nodes; a++) { // the diagonal of the mass matrix
      volume[a] += points[q].weight * s->value[q][a] * s->value[q][a];
    }
  }
  for (size_t a = 0; a < nodes; a++) {
    sum += volume[a];
  }
  for (size_t a = 0; a < nodes; a++) {
    volume[a] *= whole / sum;
  }
  if (laplace == NULL) {
    return DEA_OK;
  }
  memset(laplace, 0, nodes * nodes * sizeof *laplace);
  for (int q = 0; q < s->gauss; q++) {
    const double *x = gradient[q][0], *y = gradient[q][1], *z = gradient[q][2];
    for (size_t a = 0; a < nodes; a++) {
      for (size_t b = 0; b < nodes; b++) {
        laplace[a * nodes + b] += points[q].weight * (x[a] * x[b] + y[a] * y[b] + z[a] * z[b]);
      }
    }
  }
  return DEA_OK;
}

/* ---- after a solve ---- */

dea_status dea_hex_membrane_state(const struct dea_element *element,
                                  const struct dea_element_input *in,
                                  struct dea_membrane_state *out)
{
  const struct dea_hex_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  struct dea_hex_point state[DEA_HEX_GAUSS_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX];
  DEA_TRY_STATUS(dea_hex_find_points(shape, in->X, in->u, state));
  DEA_TRY_STATUS(dea_hex_project(shape, state, factor, moment, theta));
  out->count = (shape->order + 1) * (shape->order + 1);
  for (int p = 0; p < out->count; p++) {
    double N[6] = {0}, F[9] = {0}, weights = 0;
    for (int q = p; q < shape->gauss; q += out->count) {
      struct dea_point point;
      const struct dea_hex_point *at = &state[q];
      double w = shape->weight[q];
      double pressure = pressure_at(shape, part_material, q, in->multiplier, theta);
      DEA_TRY_STATUS(point_of(part_material, q, at, pressure,
                              dea_part_material_field(part_material, in->voltage_V), false,
                              &point));
      for (int i = 0; i < 3; i++) {
        N[2 * i] += w * part_material->thickness_m * point.P[3 * i];
        N[2 * i + 1] += w * part_material->thickness_m * point.P[3 * i + 1];
      }
      for (int a = 0; a < 9; a++) {
        F[a] += w * at->F[a];
      }
      weights += w;
    }
    for (int a = 0; a < 9; a++) {
      F[a] /= weights;
    }
    for (int a = 0; a < 6; a++) {
      N[a] /= weights;
    }
    double normal[3] = {F[3] * F[7] - F[6] * F[4], F[6] * F[1] - F[0] * F[7],
                        F[0] * F[4] - F[3] * F[1]};
    out->area[p] = sqrt(dea_dot(normal, normal));
    const double plane[6] = {F[0], F[1], F[3], F[4], F[6], F[7]};
    double *T = out->force[p];
    dea_membrane_force(N, plane, out->area[p], T);
    out->tension[p] = 0.5 * (T[0] + T[1]) - hypot(0.5 * (T[0] - T[1]), T[2]);
  }
  return DEA_OK;
}

dea_status dea_hex_strains(const struct dea_element *element, const struct dea_element_input *in,
                           struct dea_element_strains *out)
{
  struct dea_hex_point points[DEA_HEX_GAUSS_MAX];
  DEA_TRY_STATUS(dea_hex_find_points(element->basis, in->X, in->u, points));
  for (int q = 0; q < element->points; q++) {
    const struct dea_hex_point *at = &points[q];
    dea_viscous_strain(at->F, at->cof, at->J, out->C[q], out->inverse[q]);
    out->volume_m3[q] = at->weight;
  }
  return DEA_OK;
}

/* ---- recovery ---- */

/* sigma = P F^T / J as xx yy zz xy yz zx. */
static void true_stress(const double P[9], const double F[9], double J, double out[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  for (int m = 0; m < 6; m++) {
    const double *p = P + 3 * row[m], *f = F + 3 * column[m];
    out[m] = (p[0] * f[0] + p[1] * f[1] + p[2] * f[2]) / J;
  }
}

void dea_hex_field_at(const struct dea_hex_shape *s, const struct dea_hex_point *at,
                      double gradient[3][DEA_HEX_NODES_MAX], const double *psi, double scale,
                      struct dea_hex_field *out)
{
  for (int J = 0; J < 3; J++) {
    out->E[J] = 0;
    for (int n = 0; n < s->nodes; n++) {
      // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): a field has psi
      out->E[J] -= scale * psi[n] * gradient[J][n];
    }
  }
  for (int i = 0; i < 3; i++) {
    out->w[i] = at->cof[3 * i] * out->E[0] + at->cof[3 * i + 1] * out->E[1] +
                at->cof[3 * i + 2] * out->E[2];
    dea_cross(at->F + 3 * i, out->E, out->H[i]);
  }
  for (int N = 0; N < 3; N++) {
    const double column[3] = {at->F[N], at->F[3 + N], at->F[6 + N]};
    double turned[3];
    dea_cross(column, out->w, turned);
    for (int k = 0; k < 3; k++) {
      out->A[k][N] = turned[k];
    }
  }
}

/* P -= d/dF of (eps/2) |w|^2 (docs/theory/coupled.md): with F_N the columns of F that is eps times
 * eps_JLN E_J (F_N x w), whose components are the columns of A. Returns |w|, the field at J = 1. */
static double add_electric(double eps, const struct dea_hex_field *field, double P[9])
{
  const double *E = field->E, *w = field->w;
  for (int L = 0; L < 3; L++) {
    int N = (L + 1) % 3, J = (L + 2) % 3; // even: J L N, odd: N L J
    for (int k = 0; k < 3; k++) {
      P[3 * k + L] -= eps * (E[J] * field->A[k][N] - E[N] * field->A[k][J]);
    }
  }
  return sqrt(dea_dot(w, w));
}

/* P, all of it, and the field at J = 1. coupled: the field, NULL for a thin film with
 * thin_V_per_m. */
static dea_status total_stress(const struct dea_part_material *part_material,
                               const struct dea_hex_point *at, double pressure, double thin_V_per_m,
                               const struct dea_hex_field *coupled, double P[9], double *field)
{
  struct dea_point point;
  DEA_TRY_STATUS(dea_part_material_point(part_material, at->F, at->cof, at->J, pressure,
                                         coupled == NULL ? thin_V_per_m : 0, false, &point));
  const double *c = at->cof;
  memcpy(P, point.P, 9 * sizeof *P);
  *field = coupled != NULL ? add_electric(part_material->permittivity_F_per_m, coupled, P)
                           : fabs(thin_V_per_m) * sqrt(c[2] * c[2] + c[5] * c[5] + c[8] * c[8]);
  return DEA_OK;
}

/* Values of one Gauss point, and P for the membrane force, as total_stress has it. */
static dea_status recover_point(const struct dea_part_material *part_material,
                                const struct dea_hex_point *at, double pressure,
                                double thin_V_per_m, const struct dea_hex_field *coupled,
                                double values[DEA_FIT_VALUES], double P[9])
{
  struct dea_point point;
  DEA_TRY_STATUS(
      dea_part_material_point(part_material, at->F, at->cof, at->J, pressure, 0, false, &point));
  values[15] = point.W; // elastic alone: without the terms of pressure
  double slope, curvature;
  values[15] -= part_material->p0_Pa * (at->J - 1) +
                dea_part_material_pointwise(part_material, at->J, &slope, &curvature);
  memcpy(P, point.P, sizeof point.P);
  values[16] = 0;
  if (coupled != NULL || thin_V_per_m != 0) {
    DEA_TRY_STATUS(
        total_stress(part_material, at, pressure, thin_V_per_m, coupled, P, &values[16]));
  }
  memcpy(values, at->F, sizeof at->F);
  true_stress(P, at->F, at->J, values + 9);
  return DEA_OK;
}

/* An element at its Gauss points. */
struct hex_points {
  struct dea_hex_point at[DEA_HEX_GAUSS_MAX];
  double pressure[DEA_HEX_GAUSS_MAX];
  double thin_V_per_m; // of a thin film
  bool coupled;
  struct dea_hex_field field[DEA_HEX_GAUSS_MAX]; // of a coupled field
};

static dea_status find_state(const struct dea_element *element, const struct dea_element_input *in,
                             struct hex_points *out)
{
  const struct dea_hex_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  double gradient[DEA_HEX_GAUSS_MAX][3][DEA_HEX_NODES_MAX];
  double factor[DEA_HEX_PRESSURES_MAX][DEA_HEX_PRESSURES_MAX], moment[DEA_HEX_PRESSURES_MAX];
  double theta[DEA_HEX_PRESSURES_MAX];
  out->coupled = element->type->per_node > 3;
  out->thin_V_per_m = out->coupled ? 0 : dea_part_material_field(part_material, in->voltage_V);
  DEA_TRY_STATUS(out->coupled ? dea_hex_kinematics(shape, in->X, in->u, gradient, out->at)
                              : dea_hex_find_points(shape, in->X, in->u, out->at));
  DEA_TRY_STATUS(dea_hex_project(shape, out->at, factor, moment, theta));
  for (int q = 0; q < shape->gauss; q++) {
    out->pressure[q] = pressure_at(shape, part_material, q, in->multiplier, theta);
    if (out->coupled) {
      dea_hex_field_at(shape, &out->at[q], gradient[q], in->potential, in->potential_V_per_m,
                       &out->field[q]);
    }
  }
  return DEA_OK;
}

dea_status dea_hex_recover(const struct dea_element *element, const struct dea_element_input *in,
                           struct dea_recovered *out)
{
  const struct dea_hex_shape *shape = element->basis;
  double values[DEA_HEX_GAUSS_MAX][DEA_FIT_VALUES], P[DEA_HEX_GAUSS_MAX][9];
  struct dea_gauss_fit fit;
  struct hex_points points;
  out->volume_m3 = out->volume_error = 0;
  DEA_TRY_STATUS(find_state(element, in, &points));
  for (int q = 0; q < shape->gauss; q++) {
    DEA_TRY_STATUS(recover_point(in->part_material, &points.at[q], points.pressure[q],
                                 points.thin_V_per_m, points.coupled ? &points.field[q] : NULL,
                                 values[q], P[q]));
    out->volume_m3 += points.at[q].weight;
    out->volume_error = fmax(out->volume_error, fabs(points.at[q].J - 1));
  }
  dea_fit_create(shape->order, shape->order_z, false, &fit);
  dea_recovered_set(&fit, values, in->X[3 * (shape->nodes - 1) + 2] - in->X[2], P[0], 3, out);
  return DEA_OK;
}

dea_status dea_hex_state(const struct dea_element *element, const struct dea_element_input *in,
                         bool stress, struct dea_element_state *out)
{
  struct hex_points points;
  DEA_TRY_STATUS(find_state(element, in, &points));
  for (int q = 0; q < element->points; q++) {
    const struct dea_hex_point *at = &points.at[q];
    double field;
    memcpy(out->F[q], at->F, sizeof at->F);
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): find_state has set it
    out->volume_m3[q] = at->weight;
    out->J[q] = at->J;
    out->pressure[q] = points.pressure[q];
    if (stress) {
      DEA_TRY_STATUS(total_stress(in->part_material, at, points.pressure[q], points.thin_V_per_m,
                                  points.coupled ? &points.field[q] : NULL, out->P[q], &field));
    }
  }
  return DEA_OK;
}

/* ---- the kind ---- */

dea_status dea_hex_create(int order, int order_z, struct dea_element *out)
{
  struct dea_hex_shape *shape = out->basis;
  dea_status status = dea_hex_shape_create(order, order_z, shape);
  out->nodes = shape->nodes;
  out->points = shape->gauss;
  out->pressures = shape->pressures;
  out->value = shape->value[0];
  out->value_width = DEA_HEX_NODES_MAX;
  return status;
}

const struct dea_element_type dea_element_hexahedron = {
    .name = "hexahedron",
    .per_node = 3,
    .evaluate = dea_hex_evaluate,
    DEA_HEX_MEMBERS,
    .motion = motion_of,
};
