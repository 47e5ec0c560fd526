/* What an element can do, whatever its kind: the solver, the loads and the recovery speak to this
 * only. A kind is a table of functions, struct dea_element_type, and a line in element_list.h.
 *
 * Symbol   meaning                                                        unit
 * X, u     place in the stretched flat film, displacement; [nodes][3]     m
 * psi      potential over its scale c; [nodes]                            m
 * N_a      basis function of node a                                       1 */
#pragma once

#include "base/arena.h"
#include "model/solid/element/element_list.h"
#include "model/solid/point/part_material.h"

#include <stddef.h>
#include <string.h>

enum {
  DEA_HEX_ORDER_MAX = 3,
  DEA_HEX_LINE_MAX = 4,       // nodes on a line: order + 1
  DEA_HEX_NODES_MAX = 64,     // of an element
  DEA_HEX_GAUSS_MAX = 64,     // the same rule in each direction
  DEA_HEX_PRESSURES_MAX = 10, // polynomials of total degree order - 1
  DEA_HEX_DOFS_MAX = 3 * DEA_HEX_NODES_MAX,
  DEA_ELEMENT_DOFS_MAX = 4 * DEA_HEX_NODES_MAX,                // with a potential
  DEA_ELEMENT_LEVEL_MAX = DEA_HEX_LINE_MAX * DEA_HEX_LINE_MAX, // nodes of one level in the plane
};

/* A kind at its orders: the same for all elements of a mesh. */
struct dea_element {
  const struct dea_element_type *type;
  int nodes;           // of one level (order + 1)^2, times the levels through the thickness
  int points;          // Gauss points
  int pressures;       // multipliers and values of theta; 0: none
  void *basis;         // of the kind, owned by the set
  const double *value; // N_a of it at the Gauss points, [points][value_width], lent
  int value_width;
};

/* All kinds at the orders of a mesh. */
struct dea_element_set {
  struct dea_element of[DEA_ELEMENT_COUNT];
  int pressures;          // most of any kind
  size_t predicted_count; // numbers that predict fills, most of any kind
};

/* One element, as it is asked for something. All is lent. */
struct dea_element_input {
  const struct dea_part_material *part_material;
  const double *X, *u;      // [nodes][3]
  const double *multiplier; // [pressures] p_k [Pa]
  const double *potential;  // [nodes] psi; of a kind with a potential
  double potential_V_per_m; // c, which psi counts in; of a kind with a potential
  double voltage_V;         // 0 where there is no electrode; of a kind without a potential
  const double *predicted;  // what predict filled, to stand in K; NULL: the stresses that there are
};

/* g: [dofs], K: [dofs][dofs] row by row, the unknowns of a node one after the other; theta:
 * projection of J - 1, 0 for what takes no pressure. */
struct dea_element_result {
  double energy_J;
  double g[DEA_ELEMENT_DOFS_MAX];
  double K[DEA_ELEMENT_DOFS_MAX * DEA_ELEMENT_DOFS_MAX];
  double theta[DEA_HEX_PRESSURES_MAX];
  double volume_m3;
};

/* The film as a surface at the points in its plane, means through the thickness. */
struct dea_membrane_state {
  int count;
  double area[DEA_HEX_GAUSS_MAX];     // |F_1 x F_2|, current over reference area
  double tension[DEA_HEX_GAUSS_MAX];  // smaller principal force per current length [N/m]
  double force[DEA_HEX_GAUSS_MAX][3]; // all of it, 11 22 12 as dea_membrane_force has it
};

/* At the Gauss points: C = F^T F and its inverse (11 22 33 23 13 12), and reference volume. */
struct dea_element_strains {
  double C[DEA_HEX_GAUSS_MAX][6], inverse[DEA_HEX_GAUSS_MAX][6], volume_m3[DEA_HEX_GAUSS_MAX];
};

/* At the Gauss points, as many as the element has. */
struct dea_element_state {
  double volume_m3[DEA_HEX_GAUSS_MAX];                  // of each, in the stretched flat film
  double F[DEA_HEX_GAUSS_MAX][9], J[DEA_HEX_GAUSS_MAX]; // dx/dX, det F
  double pressure[DEA_HEX_GAUSS_MAX]; // that holds the volume, 0 of what takes none [Pa]
  double P[DEA_HEX_GAUSS_MAX][9];     // first Piola-Kirchhoff stress, all of it [Pa]
};

/* A small motion of an element, as modes have it. All is lent. */
struct dea_element_motion {
  const double *v;         // [nodes][3]
  const double *potential; // [nodes] psi; of a kind with a potential
  const double *pressure;  // [pressures] q
};

/* What an element tells of itself at its nodes after a solve (docs/theory/recovery.md). Plane nodes
 * are those of one level through the thickness. */
struct dea_recovered {
  int nodes, plane_nodes;
  double volume_m3;                       // in the stretched flat film
  double volume_error;                    // largest |J - 1| at the Gauss points
  double F[DEA_HEX_NODES_MAX][9];         // dx/dX
  double stress[DEA_HEX_NODES_MAX][6];    // xx yy zz xy yz zx [Pa]
  double energy[DEA_HEX_NODES_MAX];       // elastic, per volume of the stretched flat film [J/m^3]
  double field[DEA_HEX_NODES_MAX];        // true field [V/m]
  double force[DEA_ELEMENT_LEVEL_MAX][6]; // P_iJ through the thickness of the element, i1 then i2
                                          // for each i [N/m of the stretched flat film]
};

/* All functions return DEA_E_DOMAIN for an element that is inverted or beyond its law's domain. */
struct dea_element_type {
  const char *name;                     // in messages
  int per_node;                         // unknowns of a node: 3 displacements, 4 with a potential
  enum dea_element_kind with_potential; // the same with a potential; itself if it has none
  size_t basis_size;
  dea_status (*create)(int order, int order_z, struct dea_element *out); // all but type and basis
  /* Whether it can be of that: DEA_OK, or DEA_E_UNSUPPORTED and `takes` says what it can be of.
   * NULL for a kind that can be of anything. */
  dea_status (*check)(const struct dea_part_material *part_material);
  const char *takes;
  /* Energy and, up to the order, g and K; theta and volume always. */
  dea_status (*evaluate)(const struct dea_element *e, const struct dea_element_input *in,
                         enum dea_eval_order order, struct dea_element_result *out);
  /* Stresses that a linear step leads to: those at u + fraction step, from the tangent at u, for a
   * tangent at the end of the step (docs/theory/branches.md). predicted: [pressures] pressures,
   * then [points][6] second Piola-Kirchhoff stresses; stresses: false for the pressures only. NULL
   * for a kind that has no pressures and keeps the tangent that it has. */
  dea_status (*predict)(const struct dea_element *e, const struct dea_element_input *in,
                        const double *step, double fraction, bool stresses, double *predicted);
  /* The slope of theta by u at u: b [pressures][dofs] and a lower triangle L
   * [pressures][pressures], all 0 of what takes no pressure. Pressures q push with b^T L^T q; theta
   * grows by L^-T b du; the integral of a product of two pressures is q L L^T q'. NULL for a kind
   * without pressures. */
  dea_status (*constraint)(const struct dea_element *e, const struct dea_element_input *in,
                           double *b, double *L);
  /* Mass at the Gauss points [kg], [points]. */
  dea_status (*masses)(const struct dea_element *e, const struct dea_part_material *part_material,
                       const double *X, double *kilograms);
  /* v A v + 2 q . B^T v - q . M q / kappa of a small motion with its potentials and pressures, A at
   * the pressures p_k alone, without kappa; and v . mass v [kg of v's unit squared]
   * (docs/theory/gradients.md, "Frequencies"). */
  dea_status (*motion)(const struct dea_element *e, const struct dea_element_input *in,
                       const struct dea_element_motion *motion, double *stiffness, double *mass);
  /* What a shift of K and a norm of displacements are made of: int grad N_a . grad N_b [m],
   * [nodes][nodes], NULL where it is not wanted; and the volume lumped to the nodes [m^3], all
   * positive. */
  dea_status (*metric)(const struct dea_element *e, const struct dea_part_material *part_material,
                       const double *X, double *laplace, double *volume);
  /* A stiffness [N/m] of each node, whatever the state, for modes that have none of their own
   * (docs/theory/membrane.md). NULL for a kind without such modes. */
  dea_status (*neutral_stiffness)(const struct dea_element *e,
                                  const struct dea_part_material *part_material, const double *X,
                                  double *out);
  dea_status (*strains)(const struct dea_element *e, const struct dea_element_input *in,
                        struct dea_element_strains *out);
  dea_status (*membrane_state)(const struct dea_element *e, const struct dea_element_input *in,
                               struct dea_membrane_state *out);
  dea_status (*recover)(const struct dea_element *e, const struct dea_element_input *in,
                        struct dea_recovered *out);
  /* stress: false leaves P untouched. */
  dea_status (*state)(const struct dea_element *e, const struct dea_element_input *in, bool stress,
                      struct dea_element_state *out);
  /* Electric stiffness L [nodes][nodes] [F]: the energy at potentials phi [V] is -(1/2) phi L phi.
   * NULL for a kind without a potential. */
  dea_status (*capacity)(const struct dea_element *e, const struct dea_element_input *in,
                         double *L);
};

/* All kinds by their number. */
extern const struct dea_element_type *const dea_element_types[DEA_ELEMENT_COUNT];

/* All kinds at orders in the plane and through the thickness, each 1 to DEA_HEX_ORDER_MAX
 * (DEA_E_ARGUMENT otherwise). memory: of their bases. */
dea_status dea_element_set_create(struct dea_context *ctx, int order, int order_z,
                                  struct dea_arena *memory, struct dea_element_set *out);

/* Consistent mass between nodes int rho N_a N_b [kg], the same for each component of the
 * displacement (docs/theory/vibration.md). [nodes][nodes] */
dea_status dea_element_mass(const struct dea_element *e,
                            const struct dea_part_material *part_material, const double *X,
                            double *mass);
/* That matrix times motions v [nodes][3], without making it; out: [nodes][3]. */
dea_status dea_element_mass_times(const struct dea_element *e,
                                  const struct dea_part_material *part_material, const double *X,
                                  const double *v, double *out);

/* v [nodes][3] at a Gauss point, value being those of the shape functions there. */
static inline void dea_element_at(int nodes, const double *value, const double *v, double out[3])
{
  memset(out, 0, 3 * sizeof *out);
  for (int a = 0; a < nodes; a++) {
    for (int i = 0; i < 3; i++) {
      out[i] += value[a] * v[3 * a + i];
    }
  }
}

/* Forces g3 [nodes][3] and, unless NULL, tangent K3 of what has no potential, as [nodes][4] with
 * zeros. In place (g4 = g3, K4 = K3) where there is room. */
static inline void dea_element_spread(int nodes, const double *g3, const double *K3, double *g4,
                                      double *K4)
{
  for (int n = nodes - 1; n >= 0; n--) { // from the end: nothing is written before it is read
    for (int i = 3; i >= 0; i--) {
      g4[4 * n + i] = i < 3 ? g3[3 * n + i] : 0;
    }
  }
  for (int row = 4 * nodes - 1; row >= 0 && K3 != NULL; row--) {
    const double *from = K3 + 3 * nodes * (3 * (row / 4) + row % 4);
    double *to = K4 + 4 * nodes * row;
    for (int column = 4 * nodes - 1; column >= 0; column--) {
      to[column] = row % 4 < 3 && column % 4 < 3 ? from[3 * (column / 4) + column % 4] : 0;
    }
  }
}
