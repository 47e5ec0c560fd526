#include "model/axisymmetric/disc.h"

#include "base/quadrature.h"

#include <math.h>
#include <string.h>

static void element_create(const struct dea_disc *disc, double R0, double R1, size_t order,
                           struct dea_disc_element *out)
{
  double a = disc->electrode_radius_m, half = 0.5 * (R1 - R0), middle = 0.5 * (R0 + R1);
  double xi[DEA_DISC_ORDER_MAX + 1], at[DEA_DISC_GAUSS_MAX], w[DEA_DISC_GAUSS_MAX];
  out->order = order;
  out->gauss_count = order + 4;
  dea_lobatto_nodes(order, xi);
  dea_gauss_rule(out->gauss_count, at, w);
  for (size_t j = 0; j <= order; j++) {
    out->node_R[j] = middle + half * xi[j];
  }
  out->node_R[0] = R0; // the ends to the bit
  out->node_R[order] = R1;
  for (size_t q = 0; q < out->gauss_count; q++) {
    double R = middle + half * at[q];
    out->weight[q] = w[q] * half * R;
    dea_lagrange(order + 1, xi, at[q], out->hoop[q], out->slope[q]);
    for (size_t j = 0; j <= order; j++) {
      out->slope[q][j] *= a / half;
      out->hoop[q][j] *= a / R;
    }
  }
}

/* The flat film is at rest, and its centre regular, only where an equibiaxial stretch gives the
 * same stress along the radius and around it. */
static dea_status check_directions(struct dea_context *ctx, const struct dea_film *film,
                                   double pre_stretch)
{
  static const double beyond[] = {1, 1.1}; // fibres may begin to carry only when stretched
  for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) {
    double l = beyond[i] * pre_stretch;
    struct dea_plane plane;
    if (dea_film_eval(film, true, 0, l, l, &plane) == DEA_OK &&
        fabs(plane.s1 - plane.s2) > 1e-9 * (fabs(plane.s1) + fabs(plane.s2))) {
      return dea_fail(ctx, DEA_E_DESIGN,
                      "material '%s' pulls harder in one direction of the plane than in the other, "
                      "so that a disc of it does not stay round and homogeneous; the model "
                      "axisymmetric takes films without a direction",
                      film->material->name);
    }
  }
  return DEA_OK;
}

dea_status dea_disc_check(struct dea_context *ctx, const struct dea_device *device)
{
  struct dea_film film;
  DEA_TRY(ctx, dea_film_create(ctx, device, &film));
  return DEA_CHAIN(ctx, check_directions(ctx, &film, device->pre_stretch));
}

dea_status dea_disc_create(struct dea_context *ctx, const struct dea_device *device,
                           size_t order_outer, struct dea_disc *out)
{
  enum { ORDER_INNER = 4 };
  memset(out, 0, sizeof *out);
  if (order_outer < 2 || order_outer > DEA_DISC_ORDER_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "element order %zu is not in 2 to %d", order_outer,
                    DEA_DISC_ORDER_MAX);
  }
  DEA_TRY(ctx, dea_film_create(ctx, device, &out->film));
  DEA_TRY(ctx, check_directions(ctx, &out->film, device->pre_stretch));
  out->pre_stretch = device->pre_stretch;
  out->electrode_radius_m = device->electrode_radius_m;
  out->frame_radius_m = device->frame_radius_m;
  double R = 0, next = out->electrode_radius_m;
  // grading: elements outside grow by the same factor, at most 4 each
  double ratio = out->frame_radius_m / out->electrode_radius_m;
  size_t outer = ratio <= 4 ? 1 : ratio <= 16 ? 2 : DEA_DISC_ELEMENTS - 1;
  double growth = pow(ratio, 1 / (double)outer);
  out->element_count = 1 + outer;
  for (size_t e = 0; e < out->element_count; e++) {
    struct dea_disc_element *element = &out->element[e];
    element->active = e == 0;
    element->first_node = out->node_count;
    element_create(out, R, next, e == 0 ? ORDER_INNER : order_outer, element);
    out->node_count += element->order;
    R = next;
    next = e + 2 == out->element_count ? out->frame_radius_m : R * growth;
  }
  out->node_count += 1;
  return DEA_OK;
}

size_t dea_disc_unknowns(const struct dea_disc *disc)
{
  return disc->node_count - 2; // the centre stays and the frame holds
}

size_t dea_disc_edge(const struct dea_disc *disc)
{
  return disc->element[1].first_node - 1;
}

/* Value at node `node` of the whole disc. */
static double node_value(const struct dea_disc *disc, const double *u, size_t node)
{
  return node == 0 || node + 1 == disc->node_count ? 0 : u[node - 1];
}

static void gather(const struct dea_disc *disc, const double *u,
                   const struct dea_disc_element *element, double *local)
{
  for (size_t j = 0; j <= element->order; j++) {
    local[j] = node_value(disc, u, element->first_node + j);
  }
}

/* Sums of one Gauss point into element arrays. */
struct element_sums {
  double g[DEA_DISC_ORDER_MAX + 1], gV[DEA_DISC_ORDER_MAX + 1];
  double K[DEA_DISC_ORDER_MAX + 1][DEA_DISC_ORDER_MAX + 1];
};

/* Stretches l_pre dr/dR and l_pre r/R from the unstretched film at a Gauss point. */
static void gauss_stretch(const struct dea_disc *disc, const struct dea_disc_element *element,
                          size_t q, const double *local, double *l_r, double *l_t)
{
  double u_slope = 0, u_hoop = 0;
  for (size_t j = 0; j <= element->order; j++) {
    u_slope += element->slope[q][j] * local[j];
    u_hoop += element->hoop[q][j] * local[j];
  }
  *l_r = disc->pre_stretch * (1 + u_slope);
  *l_t = disc->pre_stretch * (1 + u_hoop);
}

static dea_status gauss_point(const struct dea_disc *disc, const struct dea_disc_element *element,
                              size_t q, const double *local, double voltage_V,
                              struct element_sums *sums)
{
  const double *slope = element->slope[q], *hoop = element->hoop[q];
  double l_pre = disc->pre_stretch, H0 = disc->film.thickness_m, l_r, l_t;
  gauss_stretch(disc, element, q, local, &l_r, &l_t);
  struct dea_plane plane, unit = {0};
  DEA_TRY_STATUS(dea_film_eval(&disc->film, element->active, voltage_V / H0, l_r, l_t, &plane));
  if (element->active) {
    dea_plane_electric(disc->film.material, 1, l_r, l_t, &unit);
  }
  double weight = element->weight[q], w1 = weight * l_pre, w2 = w1 * l_pre;
  double per_volt = 2 * voltage_V / (H0 * H0);
  for (size_t i = 0; i <= element->order; i++) {
    sums->g[i] += w1 * (plane.s1 * slope[i] + plane.s2 * hoop[i]);
    sums->gV[i] += w1 * per_volt * (unit.s1 * slope[i] + unit.s2 * hoop[i]);
    double a = w2 * (plane.k11 * slope[i] + plane.k12 * hoop[i]);
    double b = w2 * (plane.k12 * slope[i] + plane.k22 * hoop[i]);
    for (size_t j = 0; j <= i; j++) {
      sums->K[i][j] += a * slope[j] + b * hoop[j];
    }
  }
  return DEA_OK;
}

/* Adds element sums to the unknowns, with the scale 1/(a^2 mu). */
static void scatter(const struct dea_disc *disc, const struct dea_disc_element *element,
                    const struct element_sums *sums, double scale, double *g, double *K, double *gV)
{
  size_t n = dea_disc_unknowns(disc);
  for (size_t i = 0; i <= element->order; i++) {
    size_t row = element->first_node + i;
    if (row == 0 || row > n) {
      continue;
    }
    g[row - 1] += scale * sums->g[i];
    gV[row - 1] += scale * sums->gV[i];
    for (size_t j = 0; j <= i; j++) {
      size_t column = element->first_node + j;
      if (column > 0) {
        K[(column - 1) * n + row - 1] += scale * sums->K[i][j];
      }
    }
  }
}

dea_status dea_disc_evaluate(const struct dea_disc *disc, const double *u, double voltage_V,
                             double *g, double *K, double *gV)
{
  size_t n = dea_disc_unknowns(disc);
  double a = disc->electrode_radius_m, scale = 1 / (a * a * dea_film_modulus(&disc->film));
  memset(g, 0, n * sizeof *g);
  memset(gV, 0, n * sizeof *gV);
  memset(K, 0, n * n * sizeof *K);
  for (size_t e = 0; e < disc->element_count; e++) {
    const struct dea_disc_element *element = &disc->element[e];
    struct element_sums sums = {0};
    double local[DEA_DISC_ORDER_MAX + 1];
    gather(disc, u, element, local);
    for (size_t q = 0; q < element->gauss_count; q++) {
      DEA_TRY_STATUS(gauss_point(disc, element, q, local, voltage_V, &sums));
    }
    scatter(disc, element, &sums, scale, g, K, gV);
  }
  for (size_t j = 0; j < n; j++) {
    for (size_t i = 0; i < j; i++) {
      K[j * n + i] = K[i * n + j];
    }
  }
  return DEA_OK;
}

void dea_disc_stretch(const struct dea_disc *disc, const double *u, size_t e, double R,
                      double *stretch_r, double *stretch_t, double *displacement_m)
{
  const struct dea_disc_element *element = &disc->element[e];
  size_t count = element->order + 1;
  double value[DEA_DISC_ORDER_MAX + 1], slope[DEA_DISC_ORDER_MAX + 1], at = 0, rise = 0;
  dea_lagrange(count, element->node_R, R, value, slope);
  for (size_t j = 0; j < count; j++) {
    double uj = node_value(disc, u, element->first_node + j);
    at += value[j] * uj;
    rise += slope[j] * uj;
  }
  double a = disc->electrode_radius_m;
  *displacement_m = a * at;
  *stretch_r = disc->pre_stretch * (1 + a * rise);
  *stretch_t = R > 0 ? disc->pre_stretch * (1 + a * at / R) : *stretch_r;
}

dea_status dea_disc_totals(const struct dea_disc *disc, const double *u, double voltage_V,
                           double *energy, double *capacitance_F)
{
  double a = disc->electrode_radius_m, l_pre = disc->pre_stretch, H0 = disc->film.thickness_m;
  double h = H0 / (l_pre * l_pre), scale = 1 / (a * a * dea_film_modulus(&disc->film));
  *energy = *capacitance_F = 0;
  for (size_t e = 0; e < disc->element_count; e++) {
    const struct dea_disc_element *element = &disc->element[e];
    double local[DEA_DISC_ORDER_MAX + 1];
    gather(disc, u, element, local);
    for (size_t q = 0; q < element->gauss_count; q++) {
      double l_r, l_t, weight = element->weight[q];
      struct dea_plane plane;
      gauss_stretch(disc, element, q, local, &l_r, &l_t);
      DEA_TRY_STATUS(dea_film_eval(&disc->film, element->active, voltage_V / H0, l_r, l_t, &plane));
      *energy += scale * weight * plane.W;
      if (element->active) {
        *capacitance_F += dea_film_capacitance(&disc->film, 2 * DEA_PI * h * weight, l_r, l_t);
      }
    }
  }
  return DEA_OK;
}
