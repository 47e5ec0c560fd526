/* Reading and freeing waveforms; the list of kinds. */
#include "base/schema_value.h"
#include "waveform/wave_list.h"
#include "waveform/wave_make.h"

#include <math.h>
#include <string.h>

#define WAVE_DECLARE(name)                                                                         \
  extern const struct dea_wave_type dea_wave_##name;                                               \
  extern const struct dea_record dea_wave_##name##_record;
DEA_WAVE_LIST(WAVE_DECLARE)
#undef WAVE_DECLARE

static const struct dea_wave_type *const types[] = {
#define WAVE_ROW(name) &dea_wave_##name,
    DEA_WAVE_LIST(WAVE_ROW)
#undef WAVE_ROW
};
enum { TYPES = sizeof types / sizeof types[0] };

const struct dea_record *const dea_wave_records[] = {
#define WAVE_RECORD(name) &dea_wave_##name##_record,
    DEA_WAVE_LIST(WAVE_RECORD)
#undef WAVE_RECORD
        NULL};

const struct dea_wave_type *const *dea_wave_all(size_t *count)
{
  *count = TYPES;
  return types;
}

/* The kind that a section names, or NULL after a finding. */
static dea_status find_type(const struct dea_reader *reader, const struct dea_node *node,
                            const struct dea_wave_type **out)
{
  const struct dea_node *kind = dea_node_find(node, "kind");
  const char *names[TYPES];
  char list[256] = "";
  *out = NULL;
  for (size_t i = 0; i < TYPES; i++) {
    names[i] = types[i]->name;
    strcat(strcat(list, i > 0 ? ", " : ""), names[i]);
    if (kind != NULL && strcmp(kind->text, names[i]) == 0) {
      *out = types[i];
    }
  }
  if (*out != NULL) {
    return DEA_OK;
  }
  if (kind == NULL || kind->kind != DEA_NODE_VALUE || kind->empty) {
    return dea_schema_error(reader,
                            kind != NULL        ? kind->place
                            : node->key != NULL ? node->key_place
                                                : node->place,
                            "a waveform needs its kind: %s", list);
  }
  const char *nearest = dea_nearest_name(kind->text, names, TYPES);
  return dea_schema_error(reader, kind->place, "there is no waveform '%.60s'%s%s%s: %s", kind->text,
                          nearest != NULL ? "; did you mean '" : "", nearest != NULL ? nearest : "",
                          nearest != NULL ? "'? All are" : "; there are", list);
}

dea_status dea_waveform_read(const struct dea_reader *reader, const struct dea_node *node,
                             const char *path, const char *beside, struct dea_waveform **out)
{
  struct dea_context *ctx = reader->ctx;
  const struct dea_wave_type *type;
  size_t errors = dea_finding_count(ctx, DEA_ERROR);
  *out = NULL;
  DEA_TRY(ctx, find_type(reader, node, &type));
  if (type == NULL) {
    return DEA_OK;
  }
  void *raw = dea_alloc(ctx, 1, type->raw_size);
  struct dea_waveform *waveform = dea_alloc(ctx, 1, sizeof *waveform);
  dea_status status = raw != NULL && waveform != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    *waveform = (struct dea_waveform){.type = type, .ctx = ctx, .longest_step_s = INFINITY};
    status = dea_schema_read(reader, type->record, node, path, raw);
  }
  if (status == DEA_OK && dea_finding_count(ctx, DEA_ERROR) == errors) {
    status = type->make(reader, raw, beside, waveform);
  }
  dea_free(ctx, raw);
  if (status != DEA_OK || dea_finding_count(ctx, DEA_ERROR) > errors) {
    dea_waveform_destroy(waveform);
    waveform = NULL;
  }
  *out = waveform;
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

void dea_waveform_destroy(struct dea_waveform *waveform)
{
  if (waveform != NULL) {
    struct dea_context *ctx = waveform->ctx;
    dea_free(ctx, waveform->knots);
    dea_free(ctx, waveform->blocks);
    dea_free(ctx, waveform);
  }
}
