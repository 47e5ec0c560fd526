/* v . K v of small motions, as exactly as elements have it (docs/theory/vibration.md). */
#pragma once

#include "model/solid/assembly/problem.h"

/* v . K v of motions v [count][dofs], K that of the solid as good as incompressible at the state
 * (dea_solid_assemble_stiff), of which theta has to belong to u; without inertia. Held components
 * of v are 0; followers of bodies are set in v. out: [count]. Leaves work.g undefined. */
dea_status dea_solid_curvatures(struct dea_context *ctx, struct dea_solid *s, size_t count,
                                double *v, double *out);

/* v A v + 2 q . B^T v - q . M q / kappa and v . M v of a motion v [dofs] with pressures q
 * [multipliers] of elements and of loads, at the state and its pressures alone, without kappa but
 * in that term, where it is the one of the solid as good as incompressible
 * (docs/theory/gradients.md, "Frequencies"). Followers of bodies are set in v, and in u. Leaves
 * work.g undefined. */
dea_status dea_solid_motion(struct dea_context *ctx, struct dea_solid *s, double *v,
                            const double *q, double *stiffness, double *mass);
