/* The path of a force along an unstable mode (docs/theory/branches.md). */
#include "model/solid/equilibrium/continuation.h"

#include <math.h>
#include <string.h>

enum { POINTS_MAX = 80 };

static const double step_first = 0.1, step_most = 1; // of the solid's length, root mean square

/* The controls as they are (where the path starts), and with a force that would hold the mode back
 * at a displacement of the solid's length if its stiffness stayed what it is. */
static dea_status controls(struct dea_context *ctx, struct dea_solid *s, double value,
                           const double *mode, double *from, double *goal)
{
  size_t moves = 3 * s->grid->node_count;
  double volume = 0, *mass = dea_alloc(ctx, s->dofs, sizeof *mass);
  DEA_TRY(ctx, dea_solid_agree(ctx, s, mass != NULL ? DEA_OK : DEA_E_MEMORY));
  dea_solid_masses(s, mass);
  for (size_t i = 0; i < moves; i++) {
    volume += mass[i] / 3;
  }
  double amplitude = s->length_m * sqrt(volume);
  dea_solid_controls_get(s, from);
  memcpy(goal, from, s->path.control_count * sizeof *goal);
  for (size_t i = 0; i < moves; i++) {
    goal[1 + i] += fabs(value) * amplitude * mass[i] * mode[i];
  }
  dea_free(ctx, mass);
  return DEA_OK;
}

/* Along the path until the force has come to nothing. */
static dea_status follow(struct dea_context *ctx, struct dea_solid_continuation *trace)
{
  struct dea_continuation_point point = {0};
  double first = 0;
  for (int i = 0; i < POINTS_MAX; i++) {
    DEA_TRY(ctx, dea_solid_continuation_step(ctx, trace, &point));
    first = i == 0 ? point.load : first;
    if (point.load * first <= 0) {
      return DEA_OK;
    }
  }
  return dea_fail(ctx, DEA_E_NOT_CONVERGED, "a force along an unstable mode does not vanish");
}

dea_status dea_solid_mode_continuation(struct dea_context *ctx, struct dea_solid *s, int side,
                                       double value, const double *mode,
                                       struct dea_solid_report *report)
{
  // the stiffness is negative: a force against the mode leads along it
  const struct dea_continuation_options options = {side > 0 ? -step_first : step_first, step_most,
                                                   s->length_m};
  struct dea_solid_continuation *trace = NULL;
  double *from = dea_alloc(ctx, s->path.control_count, sizeof *from);
  double *goal = dea_alloc(ctx, s->path.control_count, sizeof *goal);
  dea_status status = dea_solid_agree(ctx, s, from != NULL && goal != NULL ? DEA_OK : DEA_E_MEMORY);
  if (status == DEA_OK) {
    status = controls(ctx, s, value, mode, from, goal);
  }
  if (status == DEA_OK) {
    status = dea_continuation_create_to(ctx, s, goal, &options, &trace);
  }
  if (status == DEA_OK) {
    status = follow(ctx, trace);
    dea_solid_controls_set(s, from);
  }
  if (status == DEA_OK) {
    status = dea_solid_equilibrate(ctx, s, report);
  }
  dea_solid_continuation_destroy(ctx, trace);
  dea_free(ctx, from);
  dea_free(ctx, goal);
  return status;
}
