/* Small motions of a solid about its last equilibrium (docs/theory/vibration.md): K v = omega^2 M v
 * with the tangent K there and the consistent mass M, and the response to an AC excitation of the
 * voltage. */
#pragma once

#include "model/solid/assembly/internal_variables.h"

/* Viscous damping: a matrix mass M + stiffness K, and for each mode this ratio of its critical one,
 * which those above the modes of the response do without. */
struct dea_damping {
  double ratio;      // of the critical one
  double mass_per_s; // shares of M and K
  double stiffness_s;
};

struct dea_solid_response;

/* DEA_E_UNSUPPORTED for a coupled field, of which no response is known. */
dea_status dea_solid_response_check(struct dea_context *ctx, const struct dea_solid *solid);
/* Prepares answers up to a frequency: all modes up to twice that, and of what the higher ones do a
 * series in omega^2. The solid has to be at a stable equilibrium and stays as it is; lent, outlives
 * the response. DEA_E_NOT_CONVERGED at an unstable one; DEA_E_UNSUPPORTED for a coupled field or
 * more than DEA_MODES_MAX modes. memory: of the response. */
dea_status dea_solid_response_create(struct dea_context *ctx, struct dea_solid *solid,
                                     double highest_rad_per_s, struct dea_arena *memory,
                                     struct dea_solid_response **out);

/* Displacements of a node per volt of the excitation dV exp(i omega t) [m/V]: real and imaginary
 * part. omega 0: slope of the static displacement. */
void dea_solid_response_at(const struct dea_solid_response *response, size_t node, double rad_per_s,
                           const struct dea_damping *damping, double real[3], double imaginary[3]);

/* Answers of a solid whose part materials have branches (internal_variables.h), solved at each
 * frequency: as branches follow, K goes from its slow to its fast form. branches: [part materials
 * of the solid]; the ratio of the damping is not looked at. take gets the whole answer of each
 * frequency i, [3 node_count] of both parts [m/V]. Otherwise as a response. */
dea_status
dea_solid_respond_viscous(struct dea_context *ctx, struct dea_solid *solid,
                          const struct dea_branches *branches, const struct dea_damping *damping,
                          const double *rad_per_s, size_t count,
                          dea_status (*take)(struct dea_context *ctx, void *user, size_t i,
                                             const double *real, const double *imaginary),
                          void *user);
