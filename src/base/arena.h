/* Memory of many pieces that lives and dies together, so that it is checked once and freed once:
 *
 *   struct dea_arena arena = {.ctx = ctx};
 *   double *x = dea_arena_alloc(&arena, n, sizeof *x), *y = dea_arena_alloc(&arena, n, sizeof *y);
 *   if (!arena.failed) {
 *     ...
 *   }
 *   dea_arena_free(&arena);
 */
#pragma once

#include "base/context.h"

/* Zero-initialise with the context set. May be moved. */
struct dea_arena {
  struct dea_context *ctx;
  struct dea_arena_piece *last; // list of what was given; owned
  bool failed;                  // some piece could not be given; stays set
};

/* Zeroed memory, as dea_alloc; it lives until the arena is freed. NULL on failure, and for all that
 * is asked for after one. */
void *dea_arena_alloc(struct dea_arena *arena, size_t count, size_t size);
/* DEA_E_MEMORY when something could not be given. */
dea_status dea_arena_status(const struct dea_arena *arena);
/* Frees every piece; the arena is as new. One of zeros, without a context, is fine. */
void dea_arena_free(struct dea_arena *arena);
