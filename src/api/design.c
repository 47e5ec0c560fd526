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

struct dea_override *api_overrides(struct dea_context *ctx, const struct api_setting *settings,
                                   size_t count)
{
  struct dea_override *overrides = dea_alloc(ctx, count, sizeof *overrides);
  for (size_t i = 0; overrides != NULL && i < count; i++) {
    overrides[i] = (struct dea_override){settings[i].key, settings[i].value};
  }
  return overrides;
}

/* The design with settings in the place of its own. */
static dea_status read_with(struct dea_context *ctx, const dea_design *design,
                            const struct api_setting *settings, size_t count,
                            struct dea_design **out)
{
  *out = NULL;
  struct dea_override *overrides = api_overrides(ctx, settings, count);
  DEA_TRY_MEMORY(overrides != NULL);
  dea_status status = dea_design_read_memory(ctx, design->name, design->bytes, design->length,
                                             overrides, count, out);
  dea_free(ctx, overrides);
  return status;
}

dea_status api_design_build(struct dea_context *ctx, const dea_design *design,
                            struct dea_design **inner, struct dea_device **device)
{
  *device = NULL;
  DEA_TRY(ctx, read_with(ctx, design, design->settings, design->setting_count, inner));
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

static void free_settings(struct dea_context *ctx, struct api_setting *settings, size_t count)
{
  for (size_t i = 0; settings != NULL && i < count; i++) {
    dea_free(ctx, settings[i].key);
    dea_free(ctx, settings[i].value);
  }
  dea_free(ctx, settings);
}

void dea_design_free(dea_design *design)
{
  if (design == NULL) {
    return;
  }
  struct dea_context *ctx = design->ctx->inner;
  free_settings(ctx, design->settings, design->setting_count);
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
                        struct api_setting *settings, size_t setting_count, dea_design **out)
{
  struct dea_context *ctx = owner->inner;
  dea_design *design = dea_alloc(ctx, 1, sizeof *design);
  if (design == NULL) {
    free_settings(ctx, settings, setting_count);
    return DEA_E_MEMORY;
  }
  *design = (dea_design){.ctx = owner,
                         .name = dea_copy_text(ctx, name, SIZE_MAX),
                         .bytes = dea_copy_text(ctx, bytes, length),
                         .length = length,
                         .settings = settings,
                         .setting_count = setting_count,
                         .text = {.ctx = ctx},
                         .svg = {.ctx = ctx}};
  struct dea_design *inner = NULL;
  dea_status status = DEA_E_MEMORY;
  if (design->name != NULL && design->bytes != NULL) {
    status = read_with(ctx, design, settings, setting_count, &inner);
  }
  status = status == DEA_OK ? read_inner(ctx, design, inner) : status;
  if (status != DEA_OK) {
    dea_design_free(design);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
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
  dea_status status = build(ctx, path, bytes, length, NULL, 0, out);
  dea_free(ctx->inner, bytes);
  return status;
}

dea_status dea_design_parse(dea_context *ctx, const char *text, const char *name, dea_design **out)
{
  *out = NULL;
  api_begin(ctx);
  return DEA_CHAIN(ctx->inner,
                   build(ctx, name != NULL ? name : "design", text, strlen(text), NULL, 0, out));
}

/* Number of lines of the form "key=value" in a text; their places into settings, if not NULL:
 * copies. *failed: set when there is no memory. */
static size_t split_settings(struct dea_context *ctx, const char *text,
                             struct api_setting *settings, bool *failed)
{
  size_t count = 0;
  for (const char *line = text; line != NULL && *line != '\0';) {
    size_t length = strcspn(line, "\n"), key = strcspn(line, "=");
    if (key < length) {
      if (settings != NULL) {
        settings[count].key = dea_copy_text(ctx, line, key);
        settings[count].value = dea_copy_text(ctx, line + key + 1, length - key - 1);
        *failed = *failed || settings[count].key == NULL || settings[count].value == NULL;
      }
      count++;
    }
    line += length + (line[length] == '\n');
  }
  return count;
}

dea_status api_design_create(dea_context *ctx, const char *name, const char *text, const char *set,
                             dea_design **out)
{
  bool failed = false;
  size_t count = split_settings(ctx->inner, set, NULL, &failed);
  struct api_setting *settings = dea_alloc(ctx->inner, count, sizeof *settings);
  if (settings != NULL) {
    split_settings(ctx->inner, set, settings, &failed);
  }
  if (settings == NULL || failed) {
    free_settings(ctx->inner, settings, count);
    return DEA_E_MEMORY;
  }
  return DEA_CHAIN(ctx->inner, build(ctx, name, text, strlen(text), settings, count, out));
}

/* Where a key is among settings; count when it is not there. */
static size_t find_setting(const struct api_setting *settings, size_t count, const char *key)
{
  size_t i = 0;
  while (i < count && strcmp(settings[i].key, key) != 0) {
    i++;
  }
  return i;
}

/* Copies the settings of a design and puts more of them at their end, each key once: the last one
 * holds. out: owned by the caller, NULL on failure. */
static dea_status join_settings(struct dea_context *ctx, const dea_design *design,
                                const char *const *keys, const char *const *values, size_t count,
                                struct api_setting **out, size_t *out_count)
{
  struct api_setting *settings = dea_alloc(ctx, design->setting_count + count, sizeof *settings);
  size_t n = 0;
  bool failed = settings == NULL;
  for (size_t i = 0; !failed && i < design->setting_count + count; i++) {
    bool old = i < design->setting_count;
    const char *key = old ? design->settings[i].key : keys[i - design->setting_count];
    const char *value = old ? design->settings[i].value : values[i - design->setting_count];
    size_t at = find_setting(settings, n, key);
    if (at < n) { // goes to the end: a section may have been set since
      dea_free(ctx, settings[at].key);
      dea_free(ctx, settings[at].value);
      memmove(&settings[at], &settings[at + 1], (n - at - 1) * sizeof *settings);
      n--;
    }
    settings[n].key = dea_copy_text(ctx, key, SIZE_MAX);
    settings[n].value = dea_copy_text(ctx, value, SIZE_MAX);
    failed = settings[n].key == NULL || settings[n].value == NULL;
    n++;
  }
  if (failed) {
    free_settings(ctx, settings, n);
    settings = NULL;
  }
  *out = settings;
  *out_count = n;
  return settings != NULL ? DEA_OK : DEA_E_MEMORY;
}

dea_status dea_design_copy(dea_context *ctx, const dea_design *design, dea_design **out)
{
  struct api_setting *settings;
  size_t count;
  *out = NULL;
  api_begin(ctx);
  DEA_TRY(ctx->inner, join_settings(ctx->inner, design, NULL, NULL, 0, &settings, &count));
  return DEA_CHAIN(ctx->inner,
                   build(ctx, design->name, design->bytes, design->length, settings, count, out));
}

dea_status dea_design_set_all(dea_context *ctx, dea_design *design, const char *const *keys,
                              const char *const *values, size_t count)
{
  struct dea_context *inner_ctx = api_begin(ctx);
  struct api_setting *settings;
  size_t setting_count;
  struct dea_design *inner;
  DEA_TRY(inner_ctx, api_check_owner(ctx, design->ctx, "design"));
  DEA_TRY(inner_ctx,
          join_settings(inner_ctx, design, keys, values, count, &settings, &setting_count));
  dea_status status = read_with(inner_ctx, design, settings, setting_count, &inner);
  status = status == DEA_OK ? read_inner(inner_ctx, design, inner) : status;
  if (status != DEA_OK) {
    free_settings(inner_ctx, settings, setting_count);
    return dea_fail_chain(inner_ctx, status, __func__, __FILE__, __LINE__);
  }
  free_settings(inner_ctx, design->settings, design->setting_count);
  design->settings = settings;
  design->setting_count = setting_count;
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
  dea_status status = api_unknown(ctx, "value", key, known, count);
  dea_free(ctx->inner, known);
  return status;
}

dea_status dea_design_text(dea_context *ctx, dea_design *design, const char **out)
{
  *out = NULL;
  DEA_TRY(ctx->inner, api_check_owner(ctx, design->ctx, "design"));
  if (design->setting_count == 0) {
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
