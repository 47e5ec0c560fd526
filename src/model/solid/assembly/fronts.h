/* Cholesky's factor of a K that is positive definite, by fronts (docs/theory/fronts.md): of one
 * process, with three unknowns a node. */
#pragma once

#include "model/solid/assembly/ranks.h"

#include <petscmat.h>

struct dea_fronts;

/* Order of elimination and what comes of it. out: owned by the caller; NULL on failure, and where
 * PETSc cannot list K's blocks. */
dea_status dea_fronts_create(struct dea_context *ctx, Mat K, struct dea_fronts **out);
/* Whether K's pattern is that of the analysis. */
bool dea_fronts_fit(const struct dea_fronts *fronts, Mat K);
/* NULL is fine. */
void dea_fronts_destroy(struct dea_context *ctx, struct dea_fronts *fronts);
/* *negative: pivots below 0, of which no more are looked for after `most`; or -1 where one is
 * hardly more than rounding. There is a factor where it is 0, and a rough one (of pivots that were
 * not looked for) where it is up to `most`. */
dea_status dea_fronts_factor(struct dea_context *ctx, struct dea_fronts *fronts, Mat K, int most,
                             int *negative);
/* x = K^-1 right with the last factor; vectors of K's rows, not the same. */
dea_status dea_fronts_solve(struct dea_context *ctx, struct dea_fronts *fronts, Vec right, Vec x);
