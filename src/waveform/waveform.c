/* Reading and freeing waveforms; the list of kinds. */
#include "base/schema_value.h"
#include "waveform/wave_list.h"
#include "waveform/wave_make.h"

#include <math.h>

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

/* The kind that a section names, or NULL after a finding. */
static dea_status find_type(const struct dea_reader *reader, const struct dea_node *node,
                            const struct dea_wave_type **out)
{
  const char *names[TYPES];
  size_t index;
  *out = NULL;
  for (size_t i = 0; i < TYPES; i++) {
    names[i] = types[i]->name;
  }
  DEA_TRY(reader->ctx, dea_schema_kind(reader, node, "a waveform", names, TYPES, &index));
  *out = index < TYPES ? types[index] : NULL;
  return DEA_OK;
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
