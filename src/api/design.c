/* Designs of the public interface: the text as it was read, what was set since, and both read. */
#include "api/api.h"

#include "base/file.h"
#include "base/write_file.h"
#include "base/yaml_write.h"
#include "figures/device_drawing.h"
#include "job/job.h"
#include "study/design_file.h"
#include "study/study.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

/* The design with settings in the place of its own. */
static dea_status read_with(struct dea_context *ctx, const dea_design *design,
                            const struct api_texts *settings, struct dea_design **out)
{
  *out = NULL;
  return dea_design_read_memory(ctx, design->name, design->bytes, design->length, settings->at,
                                settings->count, out);
}

dea_status api_design_build(struct dea_context *ctx, const dea_design *design,
                            struct dea_design **inner, struct dea_device **device)
{
  *device = NULL;
  DEA_TRY(ctx, read_with(ctx, design, &design->settings, inner));
  return DEA_CHAIN(ctx, dea_device_build(ctx, *inner, device));
}

/* Puts a newly read form into the place of the one that is there. Takes inner. */
static dea_status read_inner(struct dea_context *ctx, dea_design *design, struct dea_design *inner)
{
  const struct dea_listing *listing = &inner->values;
  dea_value *values = dea_alloc(ctx, listing->count, sizeof *values);
  if (values == NULL) {
    dea_design_destroy(ctx, inner);
    return DEA_E_MEMORY;
  }
  for (size_t i = 0; i < listing->count; i++) {
    const struct dea_listed *from = &listing->items[i];
    values[i] = (dea_value){.key = from->path,
                            .text = from->origin == DEA_ABSENT ? "" : from->text,
                            .si = from->unit != NULL ? from->si : NAN,
                            .unit = from->unit != NULL ? from->unit : "",
                            .origin = from->origin,
                            .line = from->origin == DEA_GIVEN ? from->location.line : 0,
                            .column = from->origin == DEA_GIVEN ? from->location.column : 0};
  }
  dea_free(ctx, design->values);
  dea_design_destroy(ctx, design->inner);
  dea_text_free(&design->text);
  dea_text_free(&design->svg);
  design->values = values;
  design->inner = inner;
  return DEA_OK;
}

void dea_design_free(dea_design *design)
{
  if (design == NULL) {
    return;
  }
  struct dea_context *ctx = design->ctx->inner;
  dea_arena_free(&design->settings.memory);
  dea_design_destroy(ctx, design->inner);
  dea_text_free(&design->text);
  dea_text_free(&design->svg);
  dea_free(ctx, design->values);
  dea_free(ctx, design->name);
  dea_free(ctx, design->bytes);
  dea_free(ctx, design);
}

/* A design of these bytes (copied) and settings (taken, also on failure). */
static dea_status build(dea_context *owner, const char *name, const char *bytes, size_t length,
                        struct api_texts settings, dea_design **out)
{
  struct dea_context *ctx = owner->inner;
  dea_design *design = settings.memory.failed ? NULL : dea_alloc(ctx, 1, sizeof *design);
  if (design == NULL) {
    dea_arena_free(&settings.memory);
    return DEA_E_MEMORY;
  }
  *design = (dea_design){.ctx = owner,
                         .name = dea_copy_text(ctx, name, SIZE_MAX),
                         .bytes = dea_copy_text(ctx, bytes, length),
                         .length = length,
                         .settings = settings,
                         .text = {.ctx = ctx},
                         .svg = {.ctx = ctx}};
  struct dea_design *inner = NULL;
  dea_status status = DEA_E_MEMORY;
  if (design->name != NULL && design->bytes != NULL) {
    status = read_with(ctx, design, &design->settings, &inner);
  }
  status = status == DEA_OK ? read_inner(ctx, design, inner) : status;
  DEA_TRY_ELSE(ctx, status, dea_design_free(design));
  *out = design;
  return DEA_OK;
}

dea_status dea_design_open(dea_context *ctx, const char *path, dea_design **out)
{
  char *bytes;
  size_t length;
  *out = NULL;
  api_begin(ctx);
  DEA_TRY(ctx->inner, dea_file_read(ctx->inner, path, DEA_YAML_SIZE_MAX, &bytes, &length));
  dea_status status = build(ctx, path, bytes, length, (struct api_texts){0}, out);
  dea_free(ctx->inner, bytes);
  return status;
}

dea_status dea_design_parse(dea_context *ctx, const char *text, const char *name, dea_design **out)
{
  *out = NULL;
  api_begin(ctx);
  return DEA_CHAIN(ctx->inner, build(ctx, name != NULL ? name : "design", text, strlen(text),
                                     (struct api_texts){0}, out));
}

dea_status api_design_create(dea_context *ctx, const char *name, const char *text, const char *set,
                             dea_design **out)
{
  struct api_texts settings = {.memory = {.ctx = ctx->inner}};
  for (const char *line = set; line != NULL && *line != '\0';) { // "key=value"
    size_t length = strcspn(line, "\n"), key = strcspn(line, "=");
    if (key < length) {
      api_texts_add(&settings, line, key, line + key + 1, length - key - 1);
    }
    line += length + (line[length] == '\n');
  }
  return DEA_CHAIN(ctx->inner, build(ctx, name, text, strlen(text), settings, out));
}

/* The settings of a design and more of them at their end, each key once: the last one holds. Owned
 * by the caller. */
static struct api_texts join_settings(struct dea_context *ctx, const dea_design *design,
                                      const char *const *keys, const char *const *values,
                                      size_t count)
{
  const struct api_texts *own = &design->settings;
  struct api_texts settings = {.memory = {.ctx = ctx}};
  for (size_t i = 0; i < own->count + count; i++) {
    const char *key = i < own->count ? own->at[i].key : keys[i - own->count];
    const char *value = i < own->count ? own->at[i].value : values[i - own->count];
    size_t at = 0;
    while (at < settings.count && strcmp(settings.at[at].key, key) != 0) {
      at++;
    }
    if (at < settings.count) { // goes to the end: a section may have been set since
      settings.count--;
      memmove(&settings.at[at], &settings.at[at + 1], (settings.count - at) * sizeof *settings.at);
    }
    api_texts_add(&settings, key, strlen(key), value, strlen(value));
  }
  return settings;
}

dea_status dea_design_copy(dea_context *ctx, const dea_design *design, dea_design **out)
{
  *out = NULL;
  api_begin(ctx);
  return DEA_CHAIN(ctx->inner, build(ctx, design->name, design->bytes, design->length,
                                     join_settings(ctx->inner, design, NULL, NULL, 0), out));
}

dea_status dea_design_set_all(dea_context *ctx, dea_design *design, const char *const *keys,
                              const char *const *values, size_t count)
{
  struct dea_context *inner_ctx = api_begin(ctx);
  struct dea_design *inner;
  DEA_TRY(inner_ctx, api_check_owner(ctx, design->ctx, "design"));
  struct api_texts settings = join_settings(inner_ctx, design, keys, values, count);
  dea_status status = dea_arena_status(&settings.memory);
  status = status == DEA_OK ? read_with(inner_ctx, design, &settings, &inner) : status;
  status = status == DEA_OK ? read_inner(inner_ctx, design, inner) : status;
  DEA_TRY_ELSE(inner_ctx, status, dea_arena_free(&settings.memory));
  dea_arena_free(&design->settings.memory);
  design->settings = settings;
  return DEA_OK;
}

dea_status dea_design_set(dea_context *ctx, dea_design *design, const char *key, const char *value)
{
  return dea_design_set_all(ctx, design, &key, &value, 1);
}

const dea_value *dea_design_value_at(const dea_design *design, size_t index)
{
  return index < design->inner->values.count ? &design->values[index] : NULL;
}

dea_status dea_design_get(dea_context *ctx, const dea_design *design, const char *key,
                          const dea_value **out)
{
  size_t count = design->inner->values.count;
  *out = NULL;
  for (size_t i = 0; i < count; i++) {
    if (strcmp(design->values[i].key, key) == 0) {
      *out = &design->values[i];
      return DEA_OK;
    }
  }
  const char **known = dea_alloc(ctx->inner, count, sizeof *known);
  DEA_TRY_MEMORY(known != NULL);
  for (size_t i = 0; i < count; i++) {
    known[i] = design->values[i].key;
  }
  dea_status status = dea_unknown_name(ctx->inner, "value", key, known, count);
  dea_free(ctx->inner, known);
  return status;
}

dea_status dea_design_text(dea_context *ctx, dea_design *design, const char **out)
{
  *out = NULL;
  DEA_TRY(ctx->inner, api_check_owner(ctx, design->ctx, "design"));
  if (design->settings.count == 0) {
    *out = design->bytes;
    return DEA_OK;
  }
  if (design->text.length == 0) {
    dea_yaml_write(dea_yaml_root(design->inner->document), &design->text);
    if (design->text.failed) {
      dea_text_free(&design->text);
      return DEA_E_MEMORY;
    }
  }
  *out = dea_text_get(&design->text);
  return DEA_OK;
}

dea_status dea_design_write(dea_context *ctx, dea_design *design, const char *path)
{
  const char *text;
  DEA_TRY(ctx->inner, dea_design_text(ctx, design, &text));
  // NOLINTNEXTLINE(clang-analyzer-core.NonNullParamChecker): dea_design_text sets it or fails
  return DEA_CHAIN(ctx->inner, dea_file_write(ctx->inner, path, text, strlen(text)));
}

dea_status dea_design_check(dea_context *ctx, const dea_design *design)
{
  struct dea_context *inner_ctx = api_begin(ctx);
  struct dea_design *inner;
  struct dea_device *device;
  struct dea_job job = {.folder = NULL};
  dea_status status = api_design_build(inner_ctx, design, &inner, &device);
  if (inner != NULL) {
    const dea_status known = dea_job_models(inner_ctx, inner, &job);
    status = status != DEA_OK ? status : known;
    const struct dea_result result = {.design = inner, .device = device};
    const dea_status good = dea_job_check(inner_ctx, &job, true, &result);
    status = status != DEA_OK ? status : good;
  }
  status = status == DEA_OK ? dea_study_warn(inner_ctx, inner, device) : status;
  dea_device_destroy(inner_ctx, device);
  dea_design_destroy(inner_ctx, inner);
  return status;
}

dea_status dea_design_svg(dea_context *ctx, dea_design *design, const char **out)
{
  struct dea_context *inner_ctx = api_begin(ctx);
  *out = NULL;
  DEA_TRY(inner_ctx, api_check_owner(ctx, design->ctx, "design"));
  if (design->svg.length == 0) {
    struct dea_device *device = NULL;
    DEA_TRY(inner_ctx, dea_device_build(inner_ctx, design->inner, &device));
    const struct dea_device_drawing drawing = {.layout = device->layout};
    bool failed = dea_device_drawing_add_svg(&drawing, 1, &design->svg) != DEA_OK;
    dea_device_destroy(inner_ctx, device);
    if (failed) {
      dea_text_free(&design->svg);
      return DEA_E_MEMORY;
    }
  }
  *out = dea_text_get(&design->svg);
  return DEA_OK;
}
