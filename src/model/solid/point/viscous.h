/* Viscosity of a part material: springs in series with dashpots beside its law, in steps of time
 * (docs/theory/time.md).
 *
 * Symbol   meaning                                                                     unit
 * C        F^T F, counted from the stretched flat film                                 1
 * A_i      internal variable of branch i, C^-1 when it carries nothing                 1
 * G_i      its shear modulus                                                           Pa
 * B, b     sum_i G_i (e_i A_i + w_0i C^-1) at the begin of the step, sum_i G_i (1 - w_1i)   Pa
 *
 * Energy of a step per volume: 1/2 B : (C - 1) - b ln J. A part material's pre-stretch G drops out:
 * with A_i counted like C, G A G of the unstretched material, the equations are the same.
 *
 * Symmetric tensors are in the order 11 22 33 23 13 12. */
#pragma once

#include "material/branch.h"
#include "model/solid/point/part_material.h"

/* Adds the step of a point q of an element to energy and stress and, if asked for, to the tangent.
 * Nothing to do for a part material without one. */
void dea_viscous_add(const struct dea_part_material *part_material, int q, const double F[9],
                     const double cof[9], double J, bool tangent, struct dea_point *point);

/* C and C^-1 of a film with the metric c of its plane, 11 22 12; J = 1. */
void dea_viscous_strain_flat(const double c[3], double C[6], double inverse[6]);

/* C and C^-1 from F with cofactors cof and determinant J. */
void dea_viscous_strain(const double F[9], const double cof[9], double J, double C[6],
                        double inverse[6]);

/* 1/2 B : (C - 1) - b ln J. */
double dea_viscous_energy(const double B[6], double b_Pa, const double C[6]);

/* Energy stored in a branch per volume, modulus/2 (A : C - 3 - ln det A - ln det C). */
double dea_branch_energy(double modulus_Pa, const double A[6], const double C[6]);

/* A step of a branch: its weights, and the same at the places in the step where its dissipation is
 * summed up, with what each counts. */
enum { DEA_BRANCH_PLACES_MAX = 16 };
struct dea_branch_step {
  struct dea_branch_weights end;
  size_t count;
  struct {
    double share, seconds;
    struct dea_branch_weights weights;
  } place[DEA_BRANCH_PLACES_MAX];
};

/* step_s: 0 for a step that takes no time. */
void dea_branch_step_set(const struct dea_branch *branch, double step_s,
                         struct dea_branch_step *out);

/* A at the end of the step; A_next may be A. */
void dea_branch_update(const struct dea_branch_weights *weights, const double A[6],
                       const double from[6], const double to[6], double A_next[6]);

/* What a branch dissipates per volume in a step over which C^-1 goes linearly from one to the other
 * [J/m^3]: the integral of G/(2 tau) tr(X + X^-1 - 2), X = A C, with A at the begin. */
double dea_branch_dissipation(const struct dea_branch *branch, const struct dea_branch_step *step,
                              const double A[6], const double from[6], const double to[6]);
