#include "result/state.h"

#include <string.h>

static dea_status full(struct dea_context *ctx, const char *name)
{
  return dea_fail(ctx, DEA_E_UNSUPPORTED, "a model's state has no room for '%.60s'", name);
}

dea_status dea_state_add(struct dea_context *ctx, struct dea_state *state, const char *name,
                         const double *values, size_t count)
{
  if (state->array_count == DEA_STATE_PARTS_MAX) {
    return full(ctx, name);
  }
  state->arrays[state->array_count++] = (struct dea_state_array){name, count, values};
  return DEA_OK;
}

dea_status dea_state_add_numbers(struct dea_context *ctx, struct dea_state *state, const char *name,
                                 const double *values, size_t count)
{
  if (count > DEA_STATE_NUMBERS_MAX - state->number_count) {
    return full(ctx, name);
  }
  double *own = state->numbers + state->number_count;
  memcpy(own, values, count * sizeof *own);
  state->number_count += count;
  return dea_state_add(ctx, state, name, own, count);
}

dea_status dea_state_add_mark(struct dea_context *ctx, struct dea_state *state, const char *name,
                              const void *bytes, size_t size)
{
  if (state->mark_count == DEA_STATE_PARTS_MAX) {
    return full(ctx, name);
  }
  state->marks[state->mark_count++] = (struct dea_state_mark){name, size, bytes};
  return DEA_OK;
}

const double *dea_state_find(const struct dea_state *state, const char *name, size_t count)
{
  for (size_t i = 0; i < state->array_count; i++) {
    if (strcmp(state->arrays[i].name, name) == 0 && state->arrays[i].count == count) {
      return state->arrays[i].values;
    }
  }
  return NULL;
}

dea_status dea_state_copy_values(struct dea_context *ctx, const struct dea_state *state,
                                 struct dea_state *out)
{
  out->array_count = 0;
  for (size_t i = 0; i < state->array_count; i++) {
    const struct dea_state_array *from = &state->arrays[i];
    double *values = dea_alloc(ctx, from->count, sizeof *values);
    DEA_TRY_MEMORY(values != NULL);
    memcpy(values, from->values, from->count * sizeof *values);
    out->arrays[out->array_count++] = (struct dea_state_array){from->name, from->count, values};
  }
  return DEA_OK;
}

void dea_state_free_values(struct dea_context *ctx, struct dea_state *state)
{
  for (size_t i = 0; i < state->array_count; i++) {
    dea_free(ctx, (double *)state->arrays[i].values);
  }
  state->array_count = 0;
}
