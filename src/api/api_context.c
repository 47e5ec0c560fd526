/* Contexts of the public interface: they hand the callbacks on. */
#include "api/api.h"

#include "base/version.h"

#include <math.h>
#include <string.h>

const char *dea_version(void)
{
  return DEA_VERSION;
}

const char *dea_error_name(dea_status status)
{
  return dea_status_name(status);
}

const char *dea_error_meaning(dea_status status)
{
  return dea_status_message(status);
}

static void on_progress(void *user, const char *what, size_t done, size_t total)
{
  const dea_context *ctx = user;
  ctx->options.progress(ctx->options.user, what, done, total);
}

static bool on_interrupt(void *user)
{
  const dea_context *ctx = user;
  return ctx->options.interrupt(ctx->options.user) != 0;
}

static void on_finding(void *user, const struct dea_finding *finding)
{
  const dea_context *ctx = user;
  if (ctx->running) {
    ctx->options.note(ctx->options.user, finding->severity, finding->text);
  }
}

dea_status dea_context_new(const dea_context_options *options, dea_context **out)
{
  dea_context_options all = DEA_CONTEXT_OPTIONS_INIT;
  *out = NULL;
  if (options != NULL) { // of an older or a newer caller
    DOOR_COPY(all, options);
  }
  if ((all.resize == NULL) != (all.release == NULL)) {
    return DEA_E_ARGUMENT;
  }
  const struct dea_allocator own = {all.resize, all.release, all.user};
  struct dea_context *inner;
  DEA_TRY_STATUS(dea_context_create(all.resize != NULL ? &own : NULL, &inner));
  dea_context *ctx = dea_alloc(inner, 1, sizeof *ctx);
  if (ctx == NULL) {
    dea_context_destroy(inner);
    return DEA_E_MEMORY;
  }
  *ctx = (dea_context){.inner = inner, .options = all};
  dea_context_set_progress(inner, all.progress != NULL ? on_progress : NULL, ctx);
  dea_context_set_interrupt_fn(inner, all.interrupt != NULL ? on_interrupt : NULL, ctx);
  dea_context_set_finding_sink(inner, all.note != NULL ? on_finding : NULL, ctx);
  *out = ctx;
  return DEA_OK;
}

void dea_context_free(dea_context *ctx)
{
  if (ctx != NULL) {
    struct dea_context *inner = ctx->inner;
    dea_free(inner, ctx->shown);
    dea_free(inner, ctx);
    dea_context_destroy(inner);
  }
}

const char *dea_error_message(const dea_context *ctx)
{
  return dea_context_message(ctx->inner);
}

const char *dea_error_trace(const dea_context *ctx)
{
  return dea_context_chain(ctx->inner);
}

const dea_finding *dea_finding_at(dea_context *ctx, size_t index)
{
  size_t count;
  const struct dea_finding *findings = dea_finding_get(ctx->inner, &count);
  if (index >= count) {
    return NULL;
  }
  if (ctx->shown_count != count) {
    dea_finding *shown = dea_resize(ctx->inner, ctx->shown, count, sizeof *shown);
    if (shown == NULL) {
      return NULL;
    }
    for (size_t i = 0; i < count; i++) {
      const struct dea_location *at = &findings[i].location;
      shown[i] = (dea_finding){findings[i].severity, findings[i].text,
                               at->file != NULL ? at->file : "", at->line, at->column};
    }
    ctx->shown = shown;
    ctx->shown_count = count;
  }
  return &ctx->shown[index];
}

struct dea_context *api_begin(dea_context *ctx)
{
  dea_finding_clear(ctx->inner);
  dea_context_clear(ctx->inner);
  ctx->shown_count = 0;
  return ctx->inner;
}

dea_status api_check_owner(dea_context *ctx, const dea_context *owner, const char *what)
{
  return ctx == owner
             ? DEA_OK
             : dea_fail(ctx->inner, DEA_E_ARGUMENT,
                        "the %s belongs to the context that made it, this is another one", what);
}

dea_status api_check_numbers(dea_context *ctx, const struct api_numbers *numbers, size_t count)
{
  for (size_t k = 0; k < count; k++) {
    const struct api_numbers *n = &numbers[k];
    for (size_t i = 0; n->values != NULL && i < n->count; i++) {
      if (!isfinite(n->values[i]) && !(n->endless && !isnan(n->values[i]))) {
        return n->count > 1
                   ? dea_fail(ctx->inner, DEA_E_ARGUMENT,
                              "%s[%zu] is %g, and has to be a finite number", n->name, i,
                              n->values[i])
                   : dea_fail(ctx->inner, DEA_E_ARGUMENT, "%s is %g, and has to be a finite number",
                              n->name, n->values[i]);
      }
    }
  }
  return DEA_OK;
}

void *api_grow(struct dea_arena *memory, void *items, size_t count, size_t *capacity, size_t size)
{
  if (count < *capacity) {
    return items;
  }
  *capacity = *capacity > 0 ? 2 * *capacity : 32;
  void *moved = dea_arena_alloc(memory, *capacity, size);
  if (moved != NULL && count > 0) {
    memcpy(moved, items, count * size);
  }
  return moved;
}

static const char *copy(struct dea_arena *memory, const char *text, size_t length)
{
  char *made = dea_arena_alloc(memory, length + 1, 1);
  return made != NULL ? memcpy(made, text, length) : NULL;
}

void api_texts_add(struct api_texts *texts, const char *key, size_t key_length, const char *value,
                   size_t value_length)
{
  texts->at = api_grow(&texts->memory, texts->at, texts->count, &texts->room, sizeof *texts->at);
  const struct dea_override pair = {copy(&texts->memory, key, key_length),
                                    copy(&texts->memory, value, value_length)};
  if (!texts->memory.failed) {
    texts->at[texts->count++] = pair;
  }
}
