/* The exact axisymmetric disc: a film clamped in a ring, electrodes on its inner part, in plane
 * stress (docs/theory/axisymmetric.md). Fibres are not part of it.
 *
 * Unknowns: the current radius r(R) at the nodes of high-order elements, as u = (r - R)/a, with
 * R the radius in the stretched flat film and a the electrode radius. One element inside, where the
 * solution of an isotropic film is linear, and graded ones outside, where it is analytic: the error
 * falls exponentially with their order. */
#pragma once

#include "model/film.h"

enum {
  DEA_DISC_ELEMENTS = 4,
  DEA_DISC_ORDER_MAX = 20,
  DEA_DISC_GAUSS_MAX = DEA_DISC_ORDER_MAX + 4,
};

struct dea_disc_element {
  size_t order, gauss_count, first_node;
  bool active;
  double node_R[DEA_DISC_ORDER_MAX + 1]; // [order + 1] [m]
  double weight[DEA_DISC_GAUSS_MAX];     // w R dR at the Gauss points [m^2]
  // at Gauss point q and node j: a N_j' and a N_j/R
  double slope[DEA_DISC_GAUSS_MAX][DEA_DISC_ORDER_MAX + 1];
  double hoop[DEA_DISC_GAUSS_MAX][DEA_DISC_ORDER_MAX + 1];
};

struct dea_disc {
  struct dea_film film;
  double pre_stretch, electrode_radius_m, frame_radius_m;
  size_t element_count, node_count; // all nodes; unknowns are nodes 1 to node_count - 2
  struct dea_disc_element element[DEA_DISC_ELEMENTS];
};

/* DEA_E_DESIGN for a film that pulls harder in one direction than in the other. device: of a disc.
 */
dea_status dea_disc_check(struct dea_context *ctx, const struct dea_device *device);

/* order_outer: of the elements outside the electrode, 2 to DEA_DISC_ORDER_MAX. device: lent.
 * DEA_E_DESIGN for a film with a direction (docs/theory/axisymmetric.md). */
dea_status dea_disc_create(struct dea_context *ctx, const struct dea_device *device,
                           size_t order_outer, struct dea_disc *out);

/* Number of unknowns. */
size_t dea_disc_unknowns(const struct dea_disc *disc);
/* Index of the unknown that is the electrode edge. */
size_t dea_disc_edge(const struct dea_disc *disc);

/* Pi/(2 pi h a^2 mu) and its derivatives by u and V (see dea_path_system): g, gV [unknowns], K
 * [unknowns x unknowns], full. DEA_E_DOMAIN outside the law's domain. */
dea_status dea_disc_evaluate(const struct dea_disc *disc, const double *u, double voltage_V,
                             double *g, double *K, double *gV);

/* Stretches from the unstretched film at a place inside element e, R between its ends; at R = 0
 * both are the radial one. displacement_m: r - R. */
void dea_disc_stretch(const struct dea_disc *disc, const double *u, size_t e, double R,
                      double *stretch_r, double *stretch_t, double *displacement_m);

/* Energy [in the unit 2 pi h a^2 mu] and capacitance [F], without the cost of a tangent. */
dea_status dea_disc_totals(const struct dea_disc *disc, const double *u, double voltage_V,
                           double *energy, double *capacitance_F);
