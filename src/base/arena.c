#include "base/arena.h"

#include <stddef.h>
#include <stdint.h>

/* A piece with its link before it, aligned for anything. */
struct dea_arena_piece {
  struct dea_arena_piece *before;
  max_align_t memory[];
};

void *dea_arena_alloc(struct dea_arena *arena, size_t count, size_t size)
{
  const size_t head = sizeof(struct dea_arena_piece);
  if (arena->failed) {
    return NULL;
  }
  bool countable = size == 0 || count <= (SIZE_MAX - head) / size;
  struct dea_arena_piece *piece = countable ? dea_alloc(arena->ctx, 1, head + count * size)
                                            : dea_alloc(arena->ctx, count, size); // says why not
  if (piece == NULL) {
    arena->failed = true;
    return NULL;
  }
  piece->before = arena->last;
  arena->last = piece;
  return piece->memory;
}

dea_status dea_arena_status(const struct dea_arena *arena)
{
  return arena->failed ? DEA_E_MEMORY : DEA_OK;
}

void dea_arena_free(struct dea_arena *arena)
{
  while (arena->last != NULL) {
    struct dea_arena_piece *piece = arena->last;
    arena->last = piece->before;
    dea_free(arena->ctx, piece);
  }
  arena->failed = false;
}
