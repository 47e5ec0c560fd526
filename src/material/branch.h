/* Maxwell branches beside a law: what a step in time needs of them (docs/theory/time.md, section
 * 1).
 *
 * Symbol   meaning                                                              unit
 * A_i      internal variable of branch i, a symmetric tensor                    1
 * C        right Cauchy-Green tensor, counted from the unstretched film         1
 * B        sum of G_i (e_i A_i + w_0i C_n^-1): the branches in the step's energy Pa
 *
 *   A_n+1 = e A_n + w_0 C_n^-1 + w_1 C_n+1^-1 */
#pragma once

#include "material/material.h"

struct dea_branch_weights {
  double e, w0, w1; // all >= 0, their sum is 1
};

/* Weights of a step of length_s >= 0; accurate for any ratio to the relaxation time. */
struct dea_branch_weights dea_branch_weights(double length_s, double relaxation_time_s);

/* Factor a of all relaxation times at off_K from the reference temperature, by Williams, Landel and
 * Ferry (1955): log10 a = -c1 off/(c2 + off); off_K > -c2_K. */
double dea_branch_shift(double c1, double c2_K, double off_K);

/* The film under equal stretches l in its plane: tensors have two numbers, in the plane (p) and
 * across (z). C^-1 = (l^-2, l^4). */
struct dea_equal_tensor {
  double p, z;
};

/* C^-1 of the film at the stretch l. */
struct dea_equal_tensor dea_equal_inverse(double stretch);
/* B of a step from A[branch_count] and the stretch at its start. */
struct dea_equal_tensor dea_equal_known(const struct dea_material *material,
                                        const struct dea_equal_tensor *A, double length_s,
                                        double stretch);
/* Energy B : C/2 [Pa], the nominal stress of one direction (its derivative by l over 2) and the
 * derivative of that stress by l. */
void dea_equal_stress(const struct dea_equal_tensor *B, double stretch, double *W, double *s,
                      double *k);
/* A at the end of the step; A_new may be A. */
void dea_equal_update(const struct dea_material *material, const struct dea_equal_tensor *A,
                      double length_s, double stretch, double stretch_new,
                      struct dea_equal_tensor *A_new);
/* Energy of all branches [Pa], per unstretched volume. */
double dea_equal_energy(const struct dea_material *material, const struct dea_equal_tensor *A,
                        double stretch);
/* What they dissipate [J/m^3] in a step from A, by Gauss points along the way that C^-1 and A take
 * in it. */
double dea_equal_loss(const struct dea_material *material, const struct dea_equal_tensor *A,
                      double length_s, double stretch, double stretch_new);
