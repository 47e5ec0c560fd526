#include "model/solid/element/hex_points.h"
#include "model/solid/element/hex_tensor.h"
#include "model/solid/point/viscous.h"

#include <string.h>

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
static double pressure_at(const struct dea_hex_shape *s, const struct dea_constituent *layer, int q,
                          const double *multiplier, const double *theta)
{
  double pressure = 0;
  for (int m = 0; m < s->pressures; m++) {
    pressure += s->pressure[q][m] * (multiplier[m] + layer->kappa_Pa * theta[m]);
  }
  return pressure;
}

/* One Gauss point: its energy, and what the sums over the points take. predicted: NULL without. */
static dea_status evaluate_point(const struct dea_hex_shape *s, const struct dea_constituent *layer,
                                 int q, double pressure, double field, enum dea_eval_order level,
                                 const double *predicted, struct hex_work *work, double *energy)
{
  const struct dea_hex_point *at = &work->points[q];
  struct dea_point point;
  dea_status status =
      level >= DEA_TANGENT
          ? dea_constituent_point(layer, at->F, at->cof, at->J, pressure, field, &point)
          : dea_constituent_stress(layer, at->F, at->cof, at->J, pressure, field, &point);
  if (status != DEA_OK) {
    return status;
  }
  dea_viscous_add(layer, q, at->F, at->cof, at->J, level >= DEA_TANGENT, &point);
  *energy += at->weight * point.W;
  if (level >= DEA_FORCE) {
    set_flux(s, q, at->weight, point.P, 0, work);
  }
  if (level >= DEA_TANGENT && predicted != NULL) {
    double other = 0;
    for (int m = 0; m < s->pressures && layer->law != NULL; m++) {
      other += s->pressure[q][m] * predicted[m];
    }
    dea_constituent_restress(at->F, at->cof, at->J, layer->law != NULL ? other - pressure : 0,
                             predicted + s->pressures + 6 * q, &point);
  }
  if (level >= DEA_TANGENT) {
    set_tangent(q, point.A, work);
    for (int m = 0; 3 * m + 3 < work->columns; m++) {
      set_flux(s, q, at->weight * s->pressure[q][m], at->cof, 3 * m + 3, work);
    }
  }
  return DEA_OK;
}

/* K = kappa b^T M^-1 b with M = L L^T, b_m = int phi_m dJ/du. */
static void set_projected(const struct dea_hex_shape *s, double kappa, struct hex_work *work,
                          double *K)
{
  int dofs = 3 * s->nodes, pressures = work->columns / 3 - 1;
  for (int m = 0; m < pressures; m++) {
    double *b = work->b + m * dofs, inverse = 1 / work->factor[m][m]; // b = L^-1 b row by row
    for (int j = 0; j < dofs; j++) {
      b[j] = work->sums[j / 3 * work->columns + 3 * m + 3 + j % 3];
    }
    for (int c = 0; c < m; c++) {
      for (int j = 0; j < dofs; j++) {
        b[j] -= work->factor[m][c] * work->b[c * dofs + j];
      }
    }
    for (int j = 0; j < dofs; j++) {
      b[j] *= inverse;
      work->kappa_b[j * pressures + m] = kappa * b[j];
    }
  }
  if (pressures == 0) {
    memset(K, 0, (size_t)(dofs * dofs) * sizeof *K);
    return;
  }
  dea_hex_combine((size_t)dofs, (size_t)pressures, work->kappa_b, (size_t)pressures, (size_t)dofs,
                  work->b, K);
}

static dea_status evaluate(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                           const double *X, const double *u, const double *multiplier,
                           double voltage_V, enum dea_eval_order level, const double *predicted,
                           struct dea_element_result *out)
{
  struct hex_work work;
  bool projected = layer->law != NULL;
  double field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  dea_status status = dea_hex_find_points(shape, X, u, work.points);
  if (status == DEA_OK && projected) {
    status = dea_hex_project(shape, work.points, work.factor, work.moment, out->theta);
  }
  out->energy_J = out->volume_m3 = 0;
  for (int m = 0; status == DEA_OK && m < shape->pressures && projected; m++) {
    out->energy_J += (multiplier[m] + 0.5 * layer->kappa_Pa * out->theta[m]) * work.moment[m];
  }
  work.columns = level >= DEA_TANGENT && projected ? 3 + 3 * shape->pressures : 3;
  for (int q = 0; status == DEA_OK && q < shape->gauss; q++) {
    double pressure = projected ? pressure_at(shape, layer, q, multiplier, out->theta) : 0;
    out->volume_m3 += work.points[q].weight;
    status =
        evaluate_point(shape, layer, q, pressure, field, level, predicted, &work, &out->energy_J);
  }
  if (status != DEA_OK || level < DEA_FORCE) {
    return status;
  }
  dea_hex_sum_flux(shape, work.columns, work.flux, work.sums);
  for (int i = 0; i < 3 * shape->nodes; i++) {
    out->g[i] = work.sums[i / 3 * work.columns + i % 3];
  }
  if (level >= DEA_TANGENT) {
    set_projected(shape, layer->kappa_Pa, &work, out->K);
    dea_hex_add_tangent(shape, work.A, out->K);
  }
  return DEA_OK;
}

dea_status dea_hex_evaluate(const struct dea_hex_shape *shape, const struct dea_constituent *layer,
                            const double *X, const double *u, const double *multiplier,
                            double voltage_V, enum dea_eval_order level,
                            struct dea_element_result *out)
{
  return evaluate(shape, layer, X, u, multiplier, voltage_V, level, NULL, out);
}

dea_status dea_hex_evaluate_predicted(const struct dea_hex_shape *shape,
                                      const struct dea_constituent *layer, const double *X,
                                      const double *u, const double *multiplier, double voltage_V,
                                      const double *predicted, struct dea_element_result *out)
{
  return evaluate(shape, layer, X, u, multiplier, voltage_V, DEA_TANGENT, predicted, out);
}
