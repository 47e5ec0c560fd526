/* Processes that evaluate cases. One that dies, whatever of, costs its case a reason and no more.
 */
#pragma once

#include "explore/evaluator.h"

struct dea_pool;

/* Takes a case that is done; anything but DEA_OK ends the work. */
typedef dea_status (*dea_case_sink)(void *user, const struct dea_case *done);
/* The next case into *out (number, p, near), whose `process` is set; false: there is none for
 * anybody. */
typedef bool (*dea_case_source)(void *user, struct dea_case *out);

/* evaluator: lent. processes: at least 1; they start with the first case that they get. out: owned
 * by the caller, NULL on failure. */
dea_status dea_pool_create(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                           size_t processes, struct dea_pool **out);
/* Ends the processes at once. NULL is fine. */
void dea_pool_destroy(struct dea_pool *pool);
/* Has all cases of a source evaluated, in any order. DEA_E_INTERRUPTED within a second of an
 * interruption, without the cases that were under way. */
dea_status dea_pool_run(struct dea_pool *pool, dea_case_source source, dea_case_sink sink,
                        void *user);
