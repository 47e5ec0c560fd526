/* What is explored: some numbers in, named quantities out. A device is one (design_space.h); tests
 * have functions in closed form. */
#pragma once

#include "base/context.h"

enum {
  DEA_CASE_PARAMS_MAX = 12,
  DEA_CASE_VALUES_MAX = 256,
  DEA_CASE_MARKS_MAX = 32,
  DEA_CASE_ID_SIZE = 17,
  DEA_CASE_WHY_SIZE = 160,
};

/* One evaluation. */
struct dea_case {
  size_t number;             // in the plan
  char id[DEA_CASE_ID_SIZE]; // hash of the resolved design; "" where it cannot be built
  double wall_s;
  char why[DEA_CASE_WHY_SIZE];        // why a value is missing; "": all are there
  unsigned marks[DEA_CASE_MARKS_MAX]; // what a reader has to know of the values, in bits
  double p[DEA_CASE_PARAMS_MAX], q[DEA_CASE_VALUES_MAX];
  /* From here on only on the way to an evaluation. */
  size_t process; // that evaluates it, from 0
  bool has_near;
  double near[DEA_CASE_PARAMS_MAX]; // a design whose solution this one's may begin from
};

struct dea_evaluator {
  void *user;
  size_t param_count, value_count, mark_count;
  /* With gradients, d q[i] / d p[j] is value value_count + i * param_count + j: more values, for
   * pool and store. Without, who needs them takes finite differences. */
  bool gradients;
  /* Fills q, NAN for what there is not, with marks, id and why, from p. Another status than DEA_OK
   * ends the whole work. Called in a process of its own, which it may leave in any state. */
  dea_status (*evaluate)(void *user, struct dea_context *ctx, struct dea_case *io);
};

/* Values of a case, gradients included. */
static inline size_t dea_evaluator_values(const struct dea_evaluator *evaluator)
{
  return evaluator->value_count * (evaluator->gradients ? 1 + evaluator->param_count : 1);
}
