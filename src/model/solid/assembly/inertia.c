#include "model/solid/assembly/inertia.h"

#include "model/solid/assembly/internal.h"
#include "model/solid/assembly/mass.h"

#include <math.h>

/* *quadratic and *linear: the two terms; leaves M (u - u*) in inertia->force. */
static dea_status evaluate(struct dea_context *ctx, const struct dea_solid *s, const double *u,
                           double *quadratic, double *linear)
{
  const struct dea_solid_inertia *inertia = s->inertia;
  size_t count = 3 * s->grid->node_count;
  *quadratic = *linear = 0;
  for (size_t i = 0; i < count; i++) {
    inertia->away[i] = u[i] - inertia->around[i];
  }
  DEA_TRY(ctx, dea_solid_mass_apply(ctx, s, inertia->away, inertia->force));
  for (size_t i = 0; i < count; i++) {
    *quadratic += 0.5 * inertia->factor * inertia->away[i] * inertia->force[i];
    *linear += inertia->constant[i] * u[i];
  }
  return DEA_OK;
}

dea_status dea_solid_inertia_energy(const struct dea_solid *s, const double *u, double *energy)
{
  double quadratic = 0, linear = 0;
  // no context: masses do not depend on the state, and have been evaluated before
  dea_status status = s->inertia != NULL ? evaluate(NULL, s, u, &quadratic, &linear) : DEA_OK;
  *energy += quadratic + linear;
  return status;
}

dea_status dea_solid_inertia_add(struct dea_context *ctx, struct dea_solid *s,
                                 enum dea_eval_order level, double *energy)
{
  const struct dea_solid_inertia *inertia = s->inertia;
  double quadratic, linear;
  if (inertia == NULL) {
    return DEA_OK;
  }
  DEA_TRY(ctx, evaluate(ctx, s, s->u, &quadratic, &linear));
  *energy += quadratic + linear;
  s->energy_scale += fabs(quadratic) + fabs(linear);
  for (size_t i = 0; i < 3 * s->grid->node_count; i++) {
    double force = inertia->factor * inertia->force[i] + inertia->constant[i];
    s->g[i] += force;
    s->squares += force * force;
  }
  if (level >= DEA_TANGENT) {
    DEA_TRY(ctx, dea_solid_add_mass(ctx, s, s->K, inertia->factor));
  }
  return DEA_OK;
}
