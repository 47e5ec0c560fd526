#include "study/time_stepper.h"

#include <math.h>

/* The next step over one with that error, which goes with the third power of the length; NAN: the
 * step failed. An error of 1 and more is itself the factor (model.h). */
static double factor_of(double error, double tolerance)
{
  return isnan(error)         ? 0.25
         : error <= tolerance ? fmin(0.9 * cbrt(tolerance / fmax(error, 1e-30)), 3)
         : error >= 1         ? fmin(0.95 / error, 0.7)
                              : fmin(fmax(0.9 * cbrt(tolerance / error), 0.1), 0.7);
}

dea_status dea_stepper_step(struct dea_context *ctx, struct dea_stepper *s,
                            const struct dea_model_type *type, struct dea_model *model,
                            double end_s, double *time_s, bool *last, struct dea_load_point *out)
{
  for (;;) {
    double left = end_s - *time_s, h = fmin(s->next_s, s->longest_s), error = NAN;
    *last = h >= left * (1 - 1e-9);
    h = *last ? left : fmin(h, fmax(0.5 * left, s->shortest_s)); // no last one that is much shorter
    const double to_s = *last ? end_s : *time_s + h;
    struct dea_time_step step = {.length_s = h};
    s->set(s->user, to_s, *last, &step);
    dea_status status = type->advance(ctx, model, &step, out, &error);
    error = status == DEA_OK ? error : NAN;
    const double factor = factor_of(error, s->tolerance);
    if (error <= s->tolerance) {
      type->accept(model);
      *time_s = to_s;
      s->next_s = fmax(s->next_s, h) * factor;
      return DEA_OK;
    }
    s->next_s = h * factor;
    if (dea_status_ends(status) || (status != DEA_OK && s->next_s < s->failing_s)) {
      return status;
    }
    if (s->next_s < s->shortest_s) {
      return dea_fail(ctx, DEA_E_NOT_CONVERGED, "the error of a step stays above the tolerance");
    }
  }
}
