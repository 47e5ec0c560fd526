#include "model/solid/element/membrane.h"

#include "base/quadrature.h"
#include "model/solid/point/viscous.h"

#include <math.h>
#include <string.h>

dea_status dea_flat_shape_create(int order, struct dea_flat_shape *out)
{
  memset(out, 0, sizeof *out);
  if (order < 1 || order > DEA_HEX_ORDER_MAX) {
    return DEA_E_ARGUMENT;
  }
  int n = order + 1;
  double nodes[DEA_HEX_ORDER_MAX + 1], x[DEA_HEX_ORDER_MAX + 1], w[DEA_HEX_ORDER_MAX + 1];
  double value[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1];
  double slope[DEA_HEX_ORDER_MAX + 1][DEA_HEX_ORDER_MAX + 1];
  out->order = order;
  out->nodes = out->gauss = n * n;
  dea_lobatto_nodes((size_t)order, nodes);
  dea_gauss_rule((size_t)n, x, w);
  for (int i = 0; i < n; i++) {
    dea_lagrange((size_t)n, nodes, x[i], value[i], slope[i]);
  }
  for (int q = 0; q < out->gauss; q++) {
    int i = q % n, j = q / n;
    out->weight[q] = w[i] * w[j];
    out->node_at[q][0] = nodes[i];
    out->node_at[q][1] = nodes[j];
    for (int m = 0; m < out->nodes; m++) {
      out->value[q][m] = value[i][m % n] * value[j][m / n];
      out->slope[q][0][m] = slope[i][m % n] * value[j][m / n];
      out->slope[q][1][m] = value[i][m % n] * slope[j][m / n];
    }
  }
  return DEA_OK;
}

dea_status dea_membrane_check(const struct dea_constituent *layer)
{
  return layer->law != NULL && !layer->law->anisotropic ? DEA_OK : DEA_E_UNSUPPORTED;
}

/* A load that comes in over the depth of the film in equal parts makes a shear stress that grows
 * linearly to the bonded face: the mean displacement is that of h/3 under all of it, so h/2 is
 * given 3/2 of the film's shear modulus. */
dea_status dea_membrane_bond(const struct dea_constituent *film, struct dea_constituent *bond)
{
  static const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  static const double poisson_ratio = 0.49;
  enum { XZ = 2, YZ = 5 }; // components of F
  struct dea_point point;
  dea_status status = dea_membrane_check(film);
  if (status == DEA_OK) {
    status = dea_constituent_point(film, one, one, 1, 0, 0, &point);
  }
  if (status == DEA_OK) {
    double across = 0.5 * (point.A[9 * XZ + XZ] + point.A[9 * YZ + YZ]), mu = 1.5 * across;
    *bond = (struct dea_constituent){
        .lame_mu_Pa = mu, .lame_lambda_Pa = 2 * mu * poisson_ratio / (1 - 2 * poisson_ratio)};
  }
  return status;
}

/* ---- material point ---- */

/* Principal stresses S_a = f_a/l_a, their derivatives D_ab = 2 dS_a/dx_b, and shear modulus m;
 * stretches of the film itself. */
struct principal {
  double W, S[2], D[2][2], m, natural[2];
};

static void referential(const struct dea_plane *f, double l1, double l2, struct principal *out)
{
  out->W = f->W;
  out->S[0] = f->s1 / l1;
  out->S[1] = f->s2 / l2;
  out->D[0][0] = (f->k11 - out->S[0]) / (l1 * l1);
  out->D[1][1] = (f->k22 - out->S[1]) / (l2 * l2);
  out->D[0][1] = out->D[1][0] = f->k12 / (l1 * l2);
}

/* m = (S_2 - S_1)/(x_2 - x_1) of the taut film. Where the difference would lose digits it is the
 * mean of (D_11 - 2 D_12 + D_22)/4 between the two, by three Gauss points on [-d, d]; two of them
 * are the same state. */
static dea_status taut_shear(const struct dea_tension *film, double mean, double d,
                             struct principal *out)
{
  static const double near = 0.01, node[2] = {0, 0.7745966692414834}, weight[2] = {4. / 9, 5. / 9};
  if (d > near * mean) {
    out->m = 0.5 * (out->S[0] - out->S[1]) / d;
    return DEA_OK;
  }
  out->m = 0;
  for (int i = 0; i < 2; i++) {
    struct dea_plane f;
    struct principal at;
    double l1 = sqrt(mean + node[i] * d), l2 = sqrt(mean - node[i] * d);
    dea_status status = dea_tension_taut(film, l1, l2, &f);
    if (status != DEA_OK) {
      return status;
    }
    referential(&f, l1, l2, &at);
    out->m += weight[i] * 0.25 * (at.D[0][0] - 2 * at.D[0][1] + at.D[1][1]);
  }
  return DEA_OK;
}

/* Response to stretches whose squares are mean + d and mean - d. */
static dea_status respond(const struct dea_tension *film, bool relaxed, double mean, double d,
                          struct principal *out, enum dea_tension_state *state)
{
  struct dea_plane f;
  double l1 = sqrt(mean + d), l2 = mean - d > 0 ? sqrt(mean - d) : 0;
  *out = (struct principal){.natural = {l1, l2}};
  *state = DEA_TAUT;
  dea_status status = relaxed ? dea_tension_relaxed(film, l1, l2, &f, out->natural, state)
                              : dea_tension_taut(film, l1, l2, &f);
  if (status != DEA_OK) {
    return status;
  }
  if (*state == DEA_TAUT) {
    referential(&f, l1, l2, out);
    return taut_shear(film, mean, d, out);
  }
  out->W = f.W;
  out->S[0] = f.s1 / l1;
  out->D[0][0] = (f.k11 - out->S[0]) / (l1 * l1);
  out->m = d > 0 ? 0.5 * out->S[0] / d : 0;
  return DEA_OK;
}

/* Tensors of the plane in the order 11 22 12. */
struct plane_tensors {
  double C[3], S[3], D[3][3];
};

/* S and D from principal values: N_1 N_1 = (1 + T)/2 and N_2 N_2 = (1 - T)/2 with T_11 = -T_22 =
 * cos and T_12 = sin of twice the angle of N_1. */
static void assemble_tensors(const struct principal *p, double cosine, double sine,
                             struct plane_tensors *t)
{
  const double N[2][3] = {{0.5 * (1 + cosine), 0.5 * (1 - cosine), 0.5 * sine},
                          {0.5 * (1 - cosine), 0.5 * (1 + cosine), -0.5 * sine}};
  const double G[3] = {-0.5 * sine, 0.5 * sine, 0.5 * cosine};
  for (int a = 0; a < 3; a++) {
    t->S[a] = p->S[0] * N[0][a] + p->S[1] * N[1][a];
    for (int b = 0; b < 3; b++) {
      t->D[a][b] = 4 * p->m * G[a] * G[b] + p->D[0][0] * N[0][a] * N[0][b] +
                   p->D[1][1] * N[1][a] * N[1][b] +
                   p->D[0][1] * (N[0][a] * N[1][b] + N[1][a] * N[0][b]);
    }
  }
}

/* eps = permittivity + slope (sqrt(a) - 1) of the layer by s = sqrt(a G1 G2), as a material has it.
 */
static void set_permittivity(const struct dea_constituent *layer, double G1_G2,
                             struct dea_permittivity *out)
{
  double slope = layer->permittivity_slope_F_per_m / sqrt(G1_G2);
  out->slope = slope / DEA_EPSILON_0;
  out->at_rest =
      (layer->permittivity_F_per_m - layer->permittivity_slope_F_per_m + slope) / DEA_EPSILON_0;
}

/* Everything by C of the pre-stretched film, then S and D by that of the flat one. */
static dea_status evaluate_point(const struct dea_constituent *layer, const double F[6],
                                 double field, struct plane_tensors *t,
                                 struct dea_membrane_point *out)
{
  const double *G = layer->pre_stretch, scale[3] = {G[0] * G[0], G[1] * G[1], G[0] * G[1]};
  double c[3] = {F[0] * F[0] + F[2] * F[2] + F[4] * F[4], F[1] * F[1] + F[3] * F[3] + F[5] * F[5],
                 F[0] * F[1] + F[2] * F[3] + F[4] * F[5]};
  struct dea_material material = {.law = layer->law};
  memcpy(material.param, layer->param, layer->law->param_count * sizeof(double));
  const struct dea_tension film = {&material, field / scale[2]};
  set_permittivity(layer, scale[2], &material.permittivity);
  for (int a = 0; a < 3; a++) {
    t->C[a] = scale[a] * c[a];
  }
  double mean = 0.5 * (t->C[0] + t->C[1]), half = 0.5 * (t->C[0] - t->C[1]);
  double d = hypot(half, t->C[2]);
  struct principal p;
  dea_status status = respond(&film, layer->relaxed, mean, d, &p, &out->state);
  if (status != DEA_OK) {
    return status;
  }
  assemble_tensors(&p, d > 0 ? half / d : 1, d > 0 ? t->C[2] / d : 0, t);
  for (int a = 0; a < 3; a++) {
    t->S[a] *= scale[a];
    for (int b = 0; b < 3; b++) {
      t->D[a][b] *= scale[a] * scale[b];
    }
  }
  out->W = p.W;
  out->area = p.natural[0] * p.natural[1] / scale[2];
  double first = p.S[0] * (mean + d) / out->area, second = p.S[1] * (mean - d) / out->area;
  out->tension_Pa[0] = fmax(first, second);
  out->tension_Pa[1] = fmin(first, second);
  return DEA_OK;
}

static const int pair_of[2][2] = {{0, 2}, {2, 1}};

dea_status dea_membrane_point(const struct dea_constituent *layer, const double F[6],
                              double field_V_per_m, struct dea_membrane_point *out)
{
  struct plane_tensors t;
  dea_status status = evaluate_point(layer, F, field_V_per_m, &t, out);
  if (status != DEA_OK) {
    return status;
  }
  for (int a = 0; a < 6; a++) { // A_iJkL = delta_ik S_JL + F_iM F_kN D_MJNL
    int i = a / 2, J = a % 2;
    out->P[a] = F[2 * i] * t.S[pair_of[0][J]] + F[2 * i + 1] * t.S[pair_of[1][J]];
    for (int b = 0; b < 6; b++) {
      int k = b / 2, L = b % 2;
      double sum = i == k ? t.S[pair_of[J][L]] : 0;
      for (int M = 0; M < 2; M++) {
        for (int N = 0; N < 2; N++) {
          sum += F[2 * i + M] * F[2 * k + N] * t.D[pair_of[M][J]][pair_of[N][L]];
        }
      }
      out->A[6 * a + b] = sum;
    }
  }
  return DEA_OK;
}

/* ---- element ---- */

double dea_flat_gradients(const struct dea_flat_shape *s, int q, const double *X,
                          double gradient[2][DEA_FLAT_NODES_MAX])
{
  double map[4] = {0}; // dX_J/dxi_a as map[2 J + a]
  for (int n = 0; n < s->nodes; n++) {
    for (int a = 0; a < 4; a++) {
      map[a] += X[3 * n + a / 2] * s->slope[q][a % 2][n];
    }
  }
  double area = map[0] * map[3] - map[1] * map[2];
  if (!(area > 0)) {
    return 0;
  }
  for (int n = 0; n < s->nodes; n++) {
    double a = s->slope[q][0][n], b = s->slope[q][1][n];
    gradient[0][n] = (map[3] * a - map[2] * b) / area;
    gradient[1][n] = (map[0] * b - map[1] * a) / area;
  }
  return s->weight[q] * area;
}

static void in_plane_columns(int nodes, const double *u, double gradient[2][DEA_FLAT_NODES_MAX],
                             double F[6])
{
  static const double flat[6] = {1, 0, 0, 1, 0, 0};
  memcpy(F, flat, sizeof flat);
  for (int n = 0; n < nodes; n++) {
    for (int a = 0; a < 6; a++) {
      F[a] += u[3 * n + a / 2] * gradient[a % 2][n];
    }
  }
}

double dea_flat_columns(const struct dea_flat_shape *shape, int q, const double *X, const double *u,
                        double F[6])
{
  double gradient[2][DEA_FLAT_NODES_MAX], area = dea_flat_gradients(shape, q, X, gradient);
  if (area > 0) {
    in_plane_columns(shape->nodes, u, gradient, F);
  }
  return area;
}

static void add_force(int nodes, double weight, const double P[6],
                      double gradient[2][DEA_FLAT_NODES_MAX], double *g)
{
  for (int n = 0; n < nodes; n++) {
    for (int i = 0; i < 3; i++) {
      g[3 * n + i] += weight * (P[2 * i] * gradient[0][n] + P[2 * i + 1] * gradient[1][n]);
    }
  }
}

/* Upper part of K += weight grad A grad. */
static void add_tangent(int nodes, double weight, const double A[36],
                        double gradient[2][DEA_FLAT_NODES_MAX], double *K)
{
  int dofs = 3 * nodes;
  for (int n = 0; n < nodes; n++) {
    double row[3][6]; // grad N . A for the components of node n
    for (int i = 0; i < 3; i++) {
      for (int b = 0; b < 6; b++) {
        row[i][b] = weight *
                    (gradient[0][n] * A[6 * (2 * i) + b] + gradient[1][n] * A[6 * (2 * i + 1) + b]);
      }
    }
    for (int m = n; m < nodes; m++) {
      for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
          K[(3 * n + i) * dofs + 3 * m + k] +=
              row[i][2 * k] * gradient[0][m] + row[i][2 * k + 1] * gradient[1][m];
        }
      }
    }
  }
}

dea_status dea_membrane_evaluate(const struct dea_flat_shape *shape,
                                 const struct dea_constituent *layer, const double *X,
                                 const double *u, double voltage_V, enum dea_eval_order level,
                                 struct dea_element_result *out)
{
  double gradient[2][DEA_FLAT_NODES_MAX], F[6];
  double field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  size_t dofs = 3 * (size_t)shape->nodes;
  struct dea_membrane_point point;
  memset(out->g, 0, dofs * sizeof *out->g);
  memset(out->theta, 0, sizeof out->theta);
  memset(out->K, 0, level >= DEA_TANGENT ? dofs * dofs * sizeof *out->K : 0);
  out->energy_J = out->volume_m3 = 0;
  for (int q = 0; q < shape->gauss; q++) {
    double weight = layer->thickness_m * dea_flat_gradients(shape, q, X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    in_plane_columns(shape->nodes, u, gradient, F);
    dea_status status = dea_membrane_point(layer, F, field, &point);
    if (status != DEA_OK) {
      return status;
    }
    dea_viscous_add_flat(layer, q, F, &point);
    out->energy_J += weight * point.W;
    out->volume_m3 += weight;
    if (level >= DEA_FORCE) {
      add_force(shape->nodes, weight, point.P, gradient, out->g);
    }
    if (level >= DEA_TANGENT) {
      add_tangent(shape->nodes, weight, point.A, gradient, out->K);
    }
  }
  for (size_t i = 0; i < dofs && level >= DEA_TANGENT; i++) {
    for (size_t j = 0; j < i; j++) {
      out->K[i * dofs + j] = out->K[j * dofs + i];
    }
  }
  return DEA_OK;
}

dea_status dea_membrane_state(const struct dea_flat_shape *shape,
                              const struct dea_constituent *layer, const double *X, const double *u,
                              double voltage_V, struct dea_hex_membrane *out)
{
  double F[6], field = voltage_V != 0 ? voltage_V / layer->thickness_m : 0;
  out->count = shape->gauss;
  for (int q = 0; q < shape->gauss; q++) {
    struct dea_membrane_point point;
    if (!(dea_flat_columns(shape, q, X, u, F) > 0)) {
      return DEA_E_DOMAIN;
    }
    dea_status status = dea_membrane_point(layer, F, field, &point);
    if (status != DEA_OK) {
      return status;
    }
    dea_viscous_add_flat(layer, q, F, &point);
    out->area[q] = point.area;
    out->tension[q] = layer->thickness_m * point.tension_Pa[1];
  }
  return DEA_OK;
}

dea_status dea_membrane_stiffness(const struct dea_flat_shape *shape,
                                  const struct dea_constituent *layer, const double *X, double *out)
{
  double gradient[2][DEA_FLAT_NODES_MAX];
  double modulus = 4 * layer->law->shear_modulus(layer->param) * layer->thickness_m;
  memset(out, 0, (size_t)shape->nodes * sizeof *out);
  for (int q = 0; q < shape->gauss; q++) {
    double weight = modulus * dea_flat_gradients(shape, q, X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    for (int n = 0; n < shape->nodes; n++) {
      out[n] += weight * (gradient[0][n] * gradient[0][n] + gradient[1][n] * gradient[1][n]);
    }
  }
  return DEA_OK;
}

dea_status dea_membrane_metric(const struct dea_flat_shape *shape,
                               const struct dea_constituent *layer, const double *X,
                               double *laplace, double *volume)
{
  double gradient[2][DEA_FLAT_NODES_MAX], whole = 0;
  size_t nodes = (size_t)shape->nodes;
  memset(laplace, 0, nodes * nodes * sizeof *laplace);
  for (int q = 0; q < shape->gauss; q++) {
    double weight = layer->thickness_m * dea_flat_gradients(shape, q, X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    whole += weight;
    for (size_t a = 0; a < nodes; a++) {
      for (size_t b = 0; b < nodes; b++) {
        laplace[a * nodes + b] +=
            weight * (gradient[0][a] * gradient[0][b] + gradient[1][a] * gradient[1][b]);
      }
    }
  }
  for (size_t a = 0; a < nodes; a++) {
    volume[a] = whole / (double)nodes;
  }
  return DEA_OK;
}
