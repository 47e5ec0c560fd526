#define _POSIX_C_SOURCE 200809L // strnlen
#include "base/context.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MESSAGE_MAX = 1024, CHAIN_MAX = 2048, KEPT_MAX = 4 };

struct kept_object {
  void *object;
  void (*release)(void *object);
};

struct dea_context {
  struct dea_allocator allocator;
  dea_status status;
  char message[MESSAGE_MAX];
  char chain[CHAIN_MAX];
  struct dea_finding *findings;
  size_t finding_count, finding_room;
  size_t errors, errors_kept; // all that were added; those among the findings
  unsigned trials;            // while there are some, findings are not kept
  char **names;
  size_t name_count, name_room;
  struct kept_object kept[KEPT_MAX];
  size_t kept_count;
  dea_progress_fn progress;
  void *progress_user;
  const volatile sig_atomic_t *interrupt;
  dea_interrupt_fn interrupt_fn;
  void *interrupt_user;
  bool (*any)(bool here);
  bool interrupted_elsewhere;
  dea_finding_fn finding_fn;
  void *finding_user;
  struct dea_solver_counters counters;
};

static void *default_resize(void *user, void *pointer, size_t size)
{
  (void)user;
  return realloc(pointer, size);
}

static void default_release(void *user, void *pointer)
{
  (void)user;
  free(pointer);
}

struct dea_solver_counters *dea_context_counters(struct dea_context *ctx)
{
  return &ctx->counters;
}

dea_status dea_context_create(const struct dea_allocator *allocator, struct dea_context **out)
{
  static const struct dea_allocator standard = {default_resize, default_release, NULL};
  const struct dea_allocator *a = allocator != NULL ? allocator : &standard;
  *out = a->resize(a->user, NULL, sizeof **out);
  DEA_TRY_MEMORY(*out != NULL);
  memset(*out, 0, sizeof **out);
  (*out)->allocator = *a;
  return DEA_OK;
}

void dea_context_destroy(struct dea_context *ctx)
{
  if (ctx == NULL) {
    return;
  }
  for (size_t i = 0; i < ctx->kept_count; i++) {
    ctx->kept[i].release(ctx->kept[i].object);
  }
  dea_finding_clear(ctx);
  dea_free(ctx, ctx->findings);
  for (size_t i = 0; i < ctx->name_count; i++) {
    dea_free(ctx, ctx->names[i]);
  }
  dea_free(ctx, ctx->names);
  struct dea_allocator allocator = ctx->allocator;
  allocator.release(allocator.user, ctx);
}

static bool fits(struct dea_context *ctx, size_t count, size_t size)
{
  if (size != 0 && count > SIZE_MAX / size) {
    dea_fail(ctx, DEA_E_MEMORY, "%zu items of %zu bytes are more than this machine can address",
             count, size);
    return false;
  }
  return true;
}

/* What came back for so many bytes. */
static void *checked(struct dea_context *ctx, void *pointer, size_t bytes)
{
  if (pointer == NULL) {
    dea_fail(ctx, DEA_E_MEMORY, "out of memory (%zu bytes wanted)", bytes);
  }
  return pointer;
}

void *dea_resize(struct dea_context *ctx, void *pointer, size_t count, size_t size)
{
  if (!fits(ctx, count, size)) {
    return NULL;
  }
  size_t bytes = count * size;
  return checked(ctx, ctx->allocator.resize(ctx->allocator.user, pointer, bytes > 0 ? bytes : 1),
                 bytes);
}

void *dea_alloc(struct dea_context *ctx, size_t count, size_t size)
{
  if (ctx->allocator.resize == default_resize && fits(ctx, count, size)) {
    size_t bytes = count * size; // calloc: a page that nobody writes to costs nothing
    return checked(ctx, calloc(bytes > 0 ? bytes : 1, 1), bytes);
  }
  void *pointer = dea_resize(ctx, NULL, count, size);
  if (pointer != NULL) {
    memset(pointer, 0, count * size > 0 ? count * size : 1);
  }
  return pointer;
}

dea_status dea_array_grow(struct dea_context *ctx, void *array, size_t count, size_t *capacity,
                          size_t size)
{
  void *items;
  if (count < *capacity) {
    return DEA_OK;
  }
  size_t wanted = *capacity > 0 ? 2 * *capacity : 8;
  memcpy(&items, array, sizeof items);
  items = dea_resize(ctx, items, wanted, size);
  DEA_TRY_MEMORY(items != NULL);
  memcpy(array, &items, sizeof items);
  *capacity = wanted;
  return DEA_OK;
}

char *dea_copy_text(struct dea_context *ctx, const char *text, size_t length)
{
  const size_t n = strnlen(text, length);
  char *copy = dea_resize(ctx, NULL, n + 1, 1);
  if (copy != NULL) {
    memcpy(copy, text, n);
    copy[n] = '\0';
  }
  return copy;
}

void dea_free(struct dea_context *ctx, void *pointer)
{
  if (pointer != NULL) {
    ctx->allocator.release(ctx->allocator.user, pointer);
  }
}

dea_status dea_fail(struct dea_context *ctx, dea_status status, const char *format, ...)
{
  va_list args;
  va_start(args, format);
  vsnprintf(ctx->message, sizeof ctx->message, format, args);
  va_end(args);
  ctx->chain[0] = '\0';
  ctx->status = status;
  return status;
}

dea_status dea_fail_chain(struct dea_context *ctx, dea_status status, const char *function,
                          const char *file, int line)
{
  if (status == DEA_OK) {
    return status;
  }
  if (ctx->status != status) {
    dea_fail(ctx, status, "%s", dea_status_message(status));
  }
  size_t used = strlen(ctx->chain);
  snprintf(ctx->chain + used, sizeof ctx->chain - used, "%s%s (%s:%d)", used > 0 ? " < " : "",
           function, file, line);
  return status;
}

const char *dea_context_message(const struct dea_context *ctx)
{
  return ctx->message;
}

const char *dea_context_chain(const struct dea_context *ctx)
{
  return ctx->chain;
}

dea_status dea_context_status(const struct dea_context *ctx)
{
  return ctx->status;
}

void dea_context_clear(struct dea_context *ctx)
{
  ctx->status = DEA_OK;
  ctx->message[0] = '\0';
  ctx->chain[0] = '\0';
}

bool dea_status_ends(dea_status status)
{
  return status == DEA_E_MEMORY || status == DEA_E_INTERRUPTED;
}

dea_status dea_forgive(struct dea_context *ctx, dea_status status)
{
  if (dea_status_ends(status)) {
    return status;
  }
  dea_context_clear(ctx);
  return DEA_OK;
}

static bool is_known(const struct dea_context *ctx, enum dea_severity severity,
                     struct dea_location location, const char *text)
{
  for (size_t i = 0; i < ctx->finding_count; i++) {
    const struct dea_finding *old = &ctx->findings[i];
    if (old->severity == severity && old->location.file == location.file &&
        old->location.line == location.line && old->location.column == location.column &&
        strcmp(old->text, text) == 0) {
      return true;
    }
  }
  return false;
}

dea_status dea_finding_add(struct dea_context *ctx, enum dea_severity severity,
                           struct dea_location location, const char *format, ...)
{
  char text[MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  bool error = severity == DEA_ERROR;
  ctx->errors += error; // also of what is not kept: callers stop when the number has grown
  if (ctx->trials > 0 || (error && ctx->errors_kept == DEA_ERRORS_KEPT) ||
      is_known(ctx, severity, location, text)) {
    return DEA_OK;
  }
  DEA_TRY_STATUS(dea_array_grow(ctx, &ctx->findings, ctx->finding_count, &ctx->finding_room,
                                sizeof *ctx->findings));
  char *copy = dea_copy_text(ctx, text, sizeof text);
  DEA_TRY_MEMORY(copy != NULL);
  ctx->findings[ctx->finding_count++] = (struct dea_finding){severity, location, copy};
  if (ctx->finding_fn != NULL) {
    ctx->finding_fn(ctx->finding_user, &ctx->findings[ctx->finding_count - 1]);
  }
  ctx->errors_kept += error;
  return error && ctx->errors_kept == DEA_ERRORS_KEPT
             ? dea_finding_add(ctx, DEA_NOTE, location, "errors after the first %d are not shown",
                               DEA_ERRORS_KEPT)
             : DEA_OK;
}

dea_status dea_refuse(struct dea_context *ctx, struct dea_location location, const char *text)
{
  DEA_TRY(ctx, dea_finding_add(ctx, DEA_ERROR, location, "%s", text));
  return dea_fail(ctx, DEA_E_DESIGN, "%s", text);
}

dea_status dea_refuse_argument(struct dea_context *ctx, struct dea_location location,
                               dea_status status)
{
  char text[MESSAGE_MAX];
  if (status != DEA_E_ARGUMENT) {
    return status;
  }
  snprintf(text, sizeof text, "%s", dea_context_message(ctx));
  dea_context_clear(ctx);
  return dea_refuse(ctx, location, text);
}

size_t dea_finding_count(const struct dea_context *ctx, enum dea_severity at_least)
{
  size_t count = ctx->errors;
  for (size_t i = 0; i < ctx->finding_count; i++) {
    count += ctx->findings[i].severity >= at_least && ctx->findings[i].severity < DEA_ERROR;
  }
  return count;
}

const struct dea_finding *dea_finding_get(const struct dea_context *ctx, size_t *count)
{
  *count = ctx->finding_count;
  return ctx->findings;
}

void dea_finding_clear(struct dea_context *ctx)
{
  for (size_t i = 0; i < ctx->finding_count; i++) {
    dea_free(ctx, ctx->findings[i].text);
  }
  ctx->finding_count = ctx->errors = ctx->errors_kept = 0;
}

size_t dea_finding_trial_begin(struct dea_context *ctx)
{
  ctx->trials++;
  return ctx->errors;
}

void dea_finding_trial_end(struct dea_context *ctx, size_t errors)
{
  ctx->trials--;
  ctx->errors = errors;
}

void dea_context_set_finding_sink(struct dea_context *ctx, dea_finding_fn fn, void *user)
{
  ctx->finding_fn = fn;
  ctx->finding_user = user;
}

const char *dea_intern(struct dea_context *ctx, const char *text)
{
  for (size_t i = 0; i < ctx->name_count; i++) {
    if (strcmp(ctx->names[i], text) == 0) {
      return ctx->names[i];
    }
  }
  if (dea_array_grow(ctx, &ctx->names, ctx->name_count, &ctx->name_room, sizeof *ctx->names) !=
      DEA_OK) {
    return NULL;
  }
  char *copy = dea_copy_text(ctx, text, SIZE_MAX);
  if (copy != NULL) {
    ctx->names[ctx->name_count++] = copy;
  }
  return copy;
}

dea_status dea_context_keep(struct dea_context *ctx, void *object, void (*release)(void *object))
{
  if (ctx->kept_count == KEPT_MAX) {
    release(object);
    return dea_fail(ctx, DEA_E_ARGUMENT, "a context keeps at most %d objects", KEPT_MAX);
  }
  ctx->kept[ctx->kept_count++] = (struct kept_object){object, release};
  return DEA_OK;
}

void *dea_context_kept(const struct dea_context *ctx, void (*release)(void *object))
{
  for (size_t i = 0; i < ctx->kept_count; i++) {
    if (ctx->kept[i].release == release) {
      return ctx->kept[i].object;
    }
  }
  return NULL;
}

void dea_context_set_progress(struct dea_context *ctx, dea_progress_fn fn, void *user)
{
  ctx->progress = fn;
  ctx->progress_user = user;
}

void dea_progress(struct dea_context *ctx, const char *what, size_t done, size_t total)
{
  if (ctx->progress != NULL) {
    ctx->progress(ctx->progress_user, what, done, total);
  }
}

void dea_context_set_interrupt(struct dea_context *ctx, const volatile sig_atomic_t *flag)
{
  ctx->interrupt = flag;
}

const volatile sig_atomic_t *dea_context_get_interrupt(const struct dea_context *ctx)
{
  return ctx->interrupt;
}

void dea_context_set_interrupt_fn(struct dea_context *ctx, dea_interrupt_fn fn, void *user)
{
  ctx->interrupt_fn = fn;
  ctx->interrupt_user = user;
}

bool dea_interrupted(const struct dea_context *ctx)
{
  return ctx->interrupted_elsewhere || (ctx->interrupt != NULL && *ctx->interrupt != 0) ||
         (ctx->interrupt_fn != NULL && ctx->interrupt_fn(ctx->interrupt_user));
}

void dea_context_set_agreement(struct dea_context *ctx, bool (*any)(bool here))
{
  ctx->any = any;
}

bool dea_interrupted_anywhere(struct dea_context *ctx)
{
  bool here = dea_interrupted(ctx);
  if (ctx->any != NULL) {
    ctx->interrupted_elsewhere = ctx->any(here);
    return ctx->interrupted_elsewhere;
  }
  return here;
}
