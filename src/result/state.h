/* The state of a model between two solves: arrays from which it goes on as if it had never stopped,
 * and marks of what they belong to (mesh, materials, ...), which have to be the same when they come
 * back. What the arrays mean only the model knows. */
#pragma once

#include "base/context.h"

enum { DEA_STATE_PARTS_MAX = 16, DEA_STATE_NUMBERS_MAX = 1024 };

struct dea_state_array {
  const char *name;
  size_t count;
  const double *values;
};
struct dea_state_mark {
  const char *name; // as a message calls it: "mesh"
  size_t size;
  const void *bytes;
};

/* Names, arrays and bytes are lent; `numbers` is room for small ones, so a state is not copied.
 * Start from a zeroed one. */
struct dea_state {
  size_t array_count, mark_count, number_count;
  struct dea_state_array arrays[DEA_STATE_PARTS_MAX];
  struct dea_state_mark marks[DEA_STATE_PARTS_MAX];
  double numbers[DEA_STATE_NUMBERS_MAX];
};

/* Each adds one part; DEA_E_UNSUPPORTED when there are too many. */
dea_status dea_state_add(struct dea_context *ctx, struct dea_state *state, const char *name,
                         const double *values, size_t count);
/* The same for a few numbers, which are copied into the state. */
dea_status dea_state_add_numbers(struct dea_context *ctx, struct dea_state *state, const char *name,
                                 const double *values, size_t count);
dea_status dea_state_add_mark(struct dea_context *ctx, struct dea_state *state, const char *name,
                              const void *bytes, size_t size);
/* The array of that name and length, NULL when there is none; lent. */
const double *dea_state_find(const struct dea_state *state, const char *name, size_t count);

/* Copies the arrays of a state, not its marks; values of out, which start as none: owned by the
 * caller, also after a failure. */
dea_status dea_state_copy_values(struct dea_context *ctx, const struct dea_state *state,
                                 struct dea_state *out);
/* Frees the values of a state that owns them. */
void dea_state_free_values(struct dea_context *ctx, struct dea_state *state);
