/* Stress of a piece of material that is stretched the same everywhere.
 *
 * l1 is the stretch that the machine gives. The other direction of the plane follows from the test:
 * uniaxial l2 = l1^-1/2 (free; exact for a law without direction), planar l2 = 1 (clamped wide),
 * equibiaxial l2 = l1. The third is free, and the material keeps its volume. */
#pragma once

#include "base/arena.h"
#include "material/material.h"

enum dea_coupon_mode { DEA_UNIAXIAL, DEA_PLANAR, DEA_EQUIBIAXIAL, DEA_COUPON_MODES };
extern const char *const dea_coupon_mode_names[DEA_COUPON_MODES + 1]; // ended by NULL

/* Stretches at which the stress is asked for, and the way there. */
struct dea_coupon {
  enum dea_coupon_mode mode;
  size_t rows;
  const double *stretch; // [rows]
  /* Every stretch from rest (node 0: stretch 1) in time, straight in between; 0 nodes: the test is
   * slow, branches have relaxed. */
  size_t node_count;
  double *node_s, *node_stretch; // [node_count]
  size_t *node_of_row;           // [rows]
};

/* Second stretch in the plane. */
double dea_coupon_across(enum dea_coupon_mode mode, double stretch);
/* l1^2 + l2^2 + l3^2 there. */
double dea_coupon_I1(enum dea_coupon_mode mode, double stretch);
/* What branches add to the stress, over their moduli: kept as long as their times stay, since a
 * search asks for the same ones again and again. */
struct dea_coupon_shares {
  double time_s[DEA_BRANCHES_MAX]; // that they belong to, 0: none yet
  double *share;                   // [branches x rows]
};
/* Room for them, in memory of the arena. */
dea_status dea_coupon_shares_build(struct dea_arena *arena, const struct dea_coupon *coupon,
                                   size_t branch_count, struct dea_coupon_shares *out);

/* Nominal stresses [Pa] at all rows: dW/dl1, of the law and of its branches. shares: of this coupon
 * and so many branches; NULL for a material without. DEA_E_DOMAIN beyond the law's domain,
 * DEA_E_ARGUMENT for a law with a direction or a compressible one. */
dea_status dea_coupon_stress(const struct dea_material *material, const struct dea_coupon *coupon,
                             struct dea_coupon_shares *shares, double *stress_Pa);
/* Makes the nodes: rest at the time 0, then straight from row to row at time_s[rows] >= 0, which
 * never falls, with steps of at most 1 % of stretch. ramp_s: from then on the stretch is held,
 * which rows before it do not have yet; 0: there is no hold. Memory of the arena. */
dea_status dea_coupon_follow(struct dea_arena *arena, const double *time_s, double ramp_s,
                             struct dea_coupon *coupon);

/* Drucker's stability in log strain: whether the derivatives of the Kirchhoff stresses by the
 * logarithms of the two stretches are a positive matrix at (l1, l2). */
bool dea_coupon_is_stable(const struct dea_material *material, double l1, double l2);
