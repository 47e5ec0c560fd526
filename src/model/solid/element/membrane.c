/* The film as a surface. Energy of an element: thickness_m times the integral of that of its points
 * (membrane_point.h) over its area. */
#include "model/solid/element/membrane.h"

#include "base/quadrature.h"
#include "model/solid/element/gauss_to_nodes.h"
#include "model/solid/point/viscous.h"

#include <math.h>
#include <string.h>

/* Points and weights of a rule along one axis of a face; returns their number. */
static size_t line_rule(int order, enum dea_face_rule rule, double *x, double *w)
{
  size_t count = (size_t)order + 1;
  size_t gauss = rule == DEA_FACE_ELEMENT ? count : (3 * (size_t)order + 1) / 2;
  double at[DEA_HEX_ORDER_MAX + 2], weight[DEA_HEX_ORDER_MAX + 2];
  double value[DEA_HEX_ORDER_MAX + 1], slope[DEA_HEX_ORDER_MAX + 1];
  dea_gauss_rule(gauss, at, weight);
  if (rule != DEA_FACE_AT_NODES) {
    memcpy(x, at, gauss * sizeof *x);
    memcpy(w, weight, gauss * sizeof *w);
    return gauss;
  }
  dea_lobatto_nodes((size_t)order, x);
  memset(w, 0, count * sizeof *w);
  for (size_t q = 0; q < gauss; q++) { // integrals of the nodes' polynomials
    dea_lagrange(count, x, at[q], value, slope);
    for (size_t i = 0; i < count; i++) {
      w[i] += weight[q] * value[i];
    }
  }
  return count;
}

void dea_face_basis(const int order[2], const double at[2], double value[DEA_FACE_NODES_MAX],
                    double slope[2][DEA_FACE_NODES_MAX])
{
  double nodes[DEA_HEX_LINE_MAX], v[2][DEA_HEX_LINE_MAX], d[2][DEA_HEX_LINE_MAX];
  for (int a = 0; a < 2; a++) {
    dea_lobatto_nodes((size_t)order[a], nodes);
    dea_lagrange((size_t)order[a] + 1, nodes, at[a], v[a], d[a]);
  }
  for (int n = 0; n < (order[0] + 1) * (order[1] + 1); n++) {
    const int i = n % (order[0] + 1), j = n / (order[0] + 1);
    value[n] = v[0][i] * v[1][j];
    slope[0][n] = d[0][i] * v[1][j];
    slope[1][n] = v[0][i] * d[1][j];
  }
}

void dea_face_shape_create(const int order[2], enum dea_face_rule rule, struct dea_face_shape *out)
{
  double x[2][DEA_HEX_ORDER_MAX + 2], w[2][DEA_HEX_ORDER_MAX + 2];
  size_t count[2];
  for (int a = 0; a < 2; a++) {
    count[a] = line_rule(order[a], rule, x[a], w[a]);
  }
  memcpy(out->order, order, sizeof out->order);
  out->nodes = (order[0] + 1) * (order[1] + 1);
  out->points = (int)(count[0] * count[1]);
  for (size_t p = 0; p < count[0] * count[1]; p++) {
    const size_t i = p % count[0], j = p / count[0];
    dea_face_basis(order, (const double[2]){x[0][i], x[1][j]}, out->value[p], out->slope[p]);
    out->weight[p] = w[0][i] * w[1][j];
  }
}

/* Gradients [2][node] by X at a Gauss point and its reference area; 0 for an inverted element. */
static double gradients_at(const struct dea_face_shape *s, int q, const double *X,
                           double gradient[2][DEA_FACE_NODES_MAX])
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

static void in_plane_columns(int nodes, const double *u, double gradient[2][DEA_FACE_NODES_MAX],
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

/* In-plane columns of F at a Gauss point; returns its reference area, 0 for an inverted element, of
 * which F is not set. */
static double columns_at(const struct dea_face_shape *shape, int q, const double *X,
                         const double *u, double F[6])
{
  double gradient[2][DEA_FACE_NODES_MAX], area = gradients_at(shape, q, X, gradient);
  if (area > 0) {
    in_plane_columns(shape->nodes, u, gradient, F);
  }
  return area;
}

static void add_force(int nodes, double weight, const double P[6],
                      double gradient[2][DEA_FACE_NODES_MAX], double *g)
{
  for (int n = 0; n < nodes; n++) {
    for (int i = 0; i < 3; i++) {
      g[3 * n + i] += weight * (P[2 * i] * gradient[0][n] + P[2 * i + 1] * gradient[1][n]);
    }
  }
}

/* Upper part of K += weight grad A grad. */
static void add_tangent(int nodes, double weight, const double A[36],
                        double gradient[2][DEA_FACE_NODES_MAX], double *K)
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

/* Where the film has no tension its place has no stiffness across: the tangent gets a little of it,
 * so that what moves there moves evenly. It belongs to no force. */
static dea_status point_at(const struct dea_part_material *part_material, int q, const double F[6],
                           double field_V_per_m, struct dea_membrane_point *out)
{
  static const double little = 1e-6; // of the modulus
  const double *B = part_material->viscous != NULL ? part_material->viscous + 6 * q : NULL;
  DEA_TRY_STATUS(dea_membrane_point(part_material, B, F, field_V_per_m, out));
  for (int a = 0; a < 6 && out->state != DEA_TAUT; a++) {
    out->A[7 * a] += little * dea_part_material_modulus(part_material);
  }
  return DEA_OK;
}

static dea_status evaluate(const struct dea_element *element, const struct dea_element_input *in,
                           enum dea_eval_order order, struct dea_element_result *out)
{
  const struct dea_face_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  double gradient[2][DEA_FACE_NODES_MAX], F[6];
  double field = dea_part_material_field(part_material, in->voltage_V);
  size_t dofs = 3 * (size_t)shape->nodes;
  struct dea_membrane_point point;
  memset(out->g, 0, dofs * sizeof *out->g);
  memset(out->theta, 0, sizeof out->theta);
  memset(out->K, 0, order >= DEA_TANGENT ? dofs * dofs * sizeof *out->K : 0);
  out->energy_J = out->volume_m3 = 0;
  for (int q = 0; q < shape->points; q++) {
    double weight = part_material->thickness_m * gradients_at(shape, q, in->X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    in_plane_columns(shape->nodes, in->u, gradient, F);
    DEA_TRY_STATUS(point_at(part_material, q, F, field, &point));
    out->energy_J += weight * point.W;
    out->volume_m3 += weight;
    if (order >= DEA_FORCE) {
      add_force(shape->nodes, weight, point.P, gradient, out->g);
    }
    if (order >= DEA_TANGENT) {
      add_tangent(shape->nodes, weight, point.A, gradient, out->K);
    }
  }
  for (size_t i = 0; i < dofs && order >= DEA_TANGENT; i++) {
    for (size_t j = 0; j < i; j++) {
      out->K[i * dofs + j] = out->K[j * dofs + i];
    }
  }
  return DEA_OK;
}

static dea_status membrane_state(const struct dea_element *element,
                                 const struct dea_element_input *in, struct dea_membrane_state *out)
{
  const struct dea_face_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  double F[6], field = dea_part_material_field(part_material, in->voltage_V);
  out->count = shape->points;
  for (int q = 0; q < shape->points; q++) {
    struct dea_membrane_point point;
    if (!(columns_at(shape, q, in->X, in->u, F) > 0)) {
      return DEA_E_DOMAIN;
    }
    DEA_TRY_STATUS(point_at(part_material, q, F, field, &point));
    out->area[q] = point.area;
    out->tension[q] = part_material->thickness_m * point.tension_Pa[1];
    dea_membrane_force(point.P, F, point.area, out->force[q]);
    for (int i = 0; i < 3; i++) {
      out->force[q][i] *= part_material->thickness_m;
    }
  }
  return DEA_OK;
}

static dea_status neutral_stiffness(const struct dea_element *element,
                                    const struct dea_part_material *part_material, const double *X,
                                    double *out)
{
  const struct dea_face_shape *shape = element->basis;
  double gradient[2][DEA_FACE_NODES_MAX];
  double modulus =
      4 * part_material->law->shear_modulus(part_material->param) * part_material->thickness_m;
  memset(out, 0, (size_t)shape->nodes * sizeof *out);
  for (int q = 0; q < shape->points; q++) {
    double weight = modulus * gradients_at(shape, q, X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    for (int n = 0; n < shape->nodes; n++) {
      out[n] += weight * (gradient[0][n] * gradient[0][n] + gradient[1][n] * gradient[1][n]);
    }
  }
  return DEA_OK;
}

static dea_status metric(const struct dea_element *element,
                         const struct dea_part_material *part_material, const double *X,
                         double *laplace, double *volume)
{
  const struct dea_face_shape *shape = element->basis;
  double gradient[2][DEA_FACE_NODES_MAX], whole = 0;
  size_t nodes = (size_t)shape->nodes;
  for (size_t i = 0; i < nodes * nodes && laplace != NULL; i++) {
    laplace[i] = 0;
  }
  for (int q = 0; q < shape->points; q++) {
    double weight = part_material->thickness_m * gradients_at(shape, q, X, gradient);
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    whole += weight;
    for (size_t a = 0; a < nodes && laplace != NULL; a++) {
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

static dea_status masses(const struct dea_element *element,
                         const struct dea_part_material *part_material, const double *X,
                         double *kilograms)
{
  double gradient[2][DEA_FACE_NODES_MAX];
  for (int q = 0; q < element->points; q++) {
    const double area = gradients_at(element->basis, q, X, gradient);
    kilograms[q] = part_material->density_kg_per_m3 * part_material->thickness_m * area;
    if (!(area > 0)) {
      return DEA_E_DOMAIN;
    }
  }
  return DEA_OK;
}

static dea_status motion(const struct dea_element *element, const struct dea_element_input *in,
                         const struct dea_element_motion *motion, double *stiffness, double *mass)
{
  const struct dea_face_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  const double field = dea_part_material_field(part_material, in->voltage_V);
  *stiffness = *mass = 0;
  for (int q = 0; q < shape->points; q++) {
    double gradient[2][DEA_FACE_NODES_MAX], F[6], H[6] = {0}, here[3];
    double weight = part_material->thickness_m * gradients_at(shape, q, in->X, gradient);
    struct dea_membrane_point point;
    if (!(weight > 0)) {
      return DEA_E_DOMAIN;
    }
    in_plane_columns(shape->nodes, in->u, gradient, F);
    for (int n = 0; n < shape->nodes; n++) {
      for (int a = 0; a < 6; a++) {
        H[a] += motion->v[3 * n + a / 2] * gradient[a % 2][n];
      }
    }
    dea_element_at(shape->nodes, shape->value[q], motion->v, here);
    DEA_TRY_STATUS(point_at(part_material, q, F, field, &point));
    for (int a = 0; a < 36; a++) {
      *stiffness += weight * H[a / 6] * point.A[a] * H[a % 6];
    }
    *mass += part_material->density_kg_per_m3 * weight * dea_dot(here, here);
  }
  return DEA_OK;
}

/* Of the film itself, which is larger than its place where it wrinkles; beyond its law of the
 * place.
 */
static dea_status strains(const struct dea_element *element, const struct dea_element_input *in,
                          struct dea_element_strains *out)
{
  const double field = dea_part_material_field(in->part_material, in->voltage_V);
  for (int q = 0; q < element->points; q++) {
    double F[6], area = columns_at(element->basis, q, in->X, in->u, F);
    struct dea_membrane_point point;
    if (!(area > 0)) {
      return DEA_E_DOMAIN;
    }
    const double c[3] = {F[0] * F[0] + F[2] * F[2] + F[4] * F[4],
                         F[1] * F[1] + F[3] * F[3] + F[5] * F[5],
                         F[0] * F[1] + F[2] * F[3] + F[4] * F[5]};
    const bool own =
        in->part_material->relaxed && point_at(in->part_material, q, F, field, &point) == DEA_OK;
    out->volume_m3[q] = in->part_material->thickness_m * area;
    dea_viscous_strain_flat(own ? point.own : c, out->C[q], out->inverse[q]);
  }
  return DEA_OK;
}

/* ---- recovery ---- */

/* F whole: its third column along the normal, such that J = 1; returns |F_1 x F_2|. */
static double complete(const double F[6], double out[9])
{
  // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): columns_at has set F
  const double normal[3] = {F[2] * F[5] - F[4] * F[3], F[4] * F[1] - F[0] * F[5],
                            F[0] * F[3] - F[2] * F[1]};
  double square = dea_dot(normal, normal);
  for (int i = 0; i < 3; i++) {
    out[3 * i] = F[2 * i];
    out[3 * i + 1] = F[2 * i + 1];
    out[3 * i + 2] = normal[i] / square;
  }
  return sqrt(square);
}

static dea_status recover_point(const struct dea_part_material *part_material, const double F[6],
                                double field_V_per_m, double values[DEA_FIT_VALUES], double P[6])
{
  static const int row[6] = {0, 1, 2, 0, 1, 2}, column[6] = {0, 1, 2, 1, 2, 0};
  struct dea_membrane_point point;
  DEA_TRY_STATUS(dea_membrane_point(part_material, NULL, F, field_V_per_m, &point));
  if (!(complete(F, values) > 0)) {
    return DEA_E_DOMAIN;
  }
  memcpy(P, point.P, sizeof point.P);
  for (int m = 0; m < 6; m++) { // P F^T, J = 1
    const double *p = point.P + 2 * row[m], *f = F + 2 * column[m];
    values[9 + m] = p[0] * f[0] + p[1] * f[1];
  }
  values[16] = fabs(field_V_per_m) * point.area;
  double eps = part_material->permittivity_F_per_m +
               part_material->permittivity_slope_F_per_m * (sqrt(point.area) - 1);
  values[15] = point.W + 0.5 * eps * values[16] * values[16];
  return DEA_OK;
}

/* J = 1 by construction. Where the film wrinkles stress and force are means over the wrinkles; the
 * field is that of the film itself. */
static dea_status recover(const struct dea_element *element, const struct dea_element_input *in,
                          struct dea_recovered *out)
{
  const struct dea_face_shape *shape = element->basis;
  const struct dea_part_material *part_material = in->part_material;
  double values[DEA_FACE_NODES_MAX][DEA_FIT_VALUES], P[DEA_FACE_NODES_MAX][6], F[6];
  double field = dea_part_material_field(part_material, in->voltage_V);
  struct dea_gauss_fit fit;
  out->volume_m3 = out->volume_error = 0;
  for (int q = 0; q < shape->points; q++) {
    double area = columns_at(shape, q, in->X, in->u, F);
    DEA_TRY_STATUS(area > 0 ? recover_point(part_material, F, field, values[q], P[q])
                            : DEA_E_DOMAIN);
    out->volume_m3 += part_material->thickness_m * area;
  }
  dea_fit_create(shape->order[0], 0, false, &fit);
  dea_recovered_set(&fit, values, part_material->thickness_m, P[0], 2, out);
  return DEA_OK;
}

static dea_status state(const struct dea_element *element, const struct dea_element_input *in,
                        bool stress, struct dea_element_state *out)
{
  const struct dea_face_shape *shape = element->basis;
  double field = dea_part_material_field(in->part_material, in->voltage_V);
  double F[6];
  struct dea_membrane_point point;
  for (int q = 0; q < shape->points; q++) {
    double area = columns_at(shape, q, in->X, in->u, F);
    if (!(area > 0 && complete(F, out->F[q]) > 0)) {
      return DEA_E_DOMAIN;
    }
    DEA_TRY_STATUS(stress ? dea_membrane_point(in->part_material, NULL, F, field, &point) : DEA_OK);
    out->volume_m3[q] = in->part_material->thickness_m * area;
    out->J[q] = 1;
    out->pressure[q] = 0;
    for (int i = 0; stress && i < 9; i++) {
      out->P[q][i] = i % 3 < 2 ? point.P[2 * (i / 3) + i % 3] : 0;
    }
  }
  return DEA_OK;
}

/* ---- the kind ---- */

static dea_status create(int order, int order_z, struct dea_element *out)
{
  struct dea_face_shape *shape = out->basis;
  (void)order_z;
  dea_face_shape_create((const int[2]){order, order}, DEA_FACE_ELEMENT, shape);
  out->nodes = shape->nodes;
  out->points = shape->points;
  out->pressures = 0;
  out->value = shape->value[0];
  out->value_width = DEA_FACE_NODES_MAX;
  return DEA_OK;
}

const struct dea_element_type dea_element_membrane = {
    .name = "membrane",
    .per_node = 3,
    .with_potential = DEA_ELEMENT_MEMBRANE,
    .basis_size = sizeof(struct dea_face_shape),
    .create = create,
    .check = dea_membrane_check,
    .takes = "isotropic hyperelastic laws only",
    .evaluate = evaluate,
    .masses = masses,
    .motion = motion,
    .metric = metric,
    .neutral_stiffness = neutral_stiffness,
    .strains = strains,
    .membrane_state = membrane_state,
    .recover = recover,
    .state = state,
};
