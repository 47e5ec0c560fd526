/* In which order cases are evaluated: neighbours after each other, in groups that begin from the
 * solution of one of them. */
#pragma once

#include "explore/plan.h"

struct dea_order {
  size_t *cases; // [count] numbers of cases in the order of evaluation
  size_t *first; // [count] for each place in that order the first case of its group, from which the
                 // others begin
  size_t group;  // most cases of a group; 1: each is one by itself, in the order of the plan
};

/* Groups of the plan alone: the same whatever is done, and however many processes do it. Arrays:
 * owned by the caller. */
dea_status dea_order_build(const struct dea_case_key *case_key, const struct dea_plan *plan,
                           struct dea_order *out);
/* The same of points p [count][params] in groups of at most `group`; whole[j]: numbers of
 * parameter j are whole ones, which neighbours have in common. */
dea_status dea_order_of(struct dea_context *ctx, const double *p, size_t count, size_t params,
                        const bool *whole, size_t group, struct dea_order *out);
void dea_order_free(struct dea_context *ctx, struct dea_order *order);
