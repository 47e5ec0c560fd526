/* The list of kinds of instruments; reading their sections and opening them. */
#include "instrument/instrument.h"

#include "base/schema_value.h"
#include "instrument/instrument_make.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const struct dea_instrument_type *const types[] = {
#define INSTRUMENT_ROW(name) &dea_instrument_##name,
    DEA_INSTRUMENT_LIST(INSTRUMENT_ROW)
#undef INSTRUMENT_ROW
        NULL};
enum { TYPES = sizeof types / sizeof types[0] - 1 };

void dea_instrument_protocol_schema(struct dea_protocol_schema *out)
{
  static const struct dea_record *const all[] = {
#define INSTRUMENT_RECORD(name) &dea_instrument_##name##_record,
      DEA_INSTRUMENT_LIST(INSTRUMENT_RECORD)
#undef INSTRUMENT_RECORD
          NULL};
  static const struct dea_record *const sim[] = {&dea_instrument_sim_record, NULL};
  dea_protocol_schema_fill(all, sim, out);
}

const struct dea_instrument_type *dea_instrument_find(const char *name)
{
  for (size_t i = 0; types[i] != NULL; i++) {
    if (strcmp(types[i]->name, name) == 0) {
      return types[i];
    }
  }
  return NULL;
}

/* Reads a section into *raw (owned by the caller). *raw stays NULL after findings. */
static dea_status read_section(struct dea_context *ctx,
                               const struct dea_protocol_instrument *section,
                               const struct dea_protocol *protocol,
                               const struct dea_instrument_type **type, void **raw)
{
  const struct dea_reader reader = {ctx, protocol->document, NULL};
  const char *names[TYPES + 1];
  size_t index, errors = dea_finding_count(ctx, DEA_ERROR);
  *raw = NULL;
  for (size_t i = 0; types[i] != NULL; i++) {
    names[i] = types[i]->name;
  }
  DEA_TRY(ctx, dea_schema_kind(&reader, section->section, "an instrument", names, TYPES, &index));
  *type = types[index];
  if (*type == NULL) {
    return DEA_OK;
  }
  void *read = dea_alloc(ctx, 1, (*type)->raw_size);
  dea_status status = read != NULL ? DEA_OK : DEA_E_MEMORY;
  if (status == DEA_OK) {
    status = dea_schema_read(&reader, (*type)->record, section->section, section->path, read);
  }
  if (status == DEA_OK && (*type)->check != NULL && dea_finding_count(ctx, DEA_ERROR) == errors) {
    status = (*type)->check(&reader, read, protocol);
  }
  if (status != DEA_OK || dea_finding_count(ctx, DEA_ERROR) > errors) {
    dea_free(ctx, read);
    read = NULL;
  }
  *raw = read;
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

/* The same where findings are a failure: *raw is there. */
static dea_status read_good(struct dea_context *ctx, const struct dea_protocol_instrument *section,
                            const struct dea_protocol *protocol,
                            const struct dea_instrument_type **type, void **raw)
{
  DEA_TRY(ctx, read_section(ctx, section, protocol, type, raw));
  return *raw != NULL ? DEA_OK
                      : dea_fail(ctx, DEA_E_DESIGN, "the section %s of %s has errors",
                                 section->path, protocol->file);
}

/* Stops one that could not be set up; the status, DEA_E_INTERLOCK where its output is not known to
 * be at 0 V then. */
static dea_status abandon(struct dea_context *ctx, struct dea_instrument *instrument,
                          dea_status status)
{
  char why[512];
  if (dea_instrument_stop(ctx, instrument).state != DEA_ZERO_UNKNOWN) {
    return status;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  return dea_fail(ctx, DEA_E_INTERLOCK, "%s; its output is not known to be at 0 V: switch it off",
                  why);
}

dea_status dea_instrument_open(struct dea_context *ctx,
                               const struct dea_protocol_instrument *section,
                               const struct dea_protocol *protocol, struct dea_instrument **out)
{
  const struct dea_instrument_type *type;
  void *raw;
  *out = NULL;
  DEA_TRY(ctx, read_good(ctx, section, protocol, &type, &raw));
  struct dea_instrument *instrument = dea_alloc(ctx, 1, type->size);
  dea_status status = DEA_E_MEMORY;
  if (instrument != NULL) {
    instrument->type = type;
    instrument->roles = type->roles;
    status = type->open(ctx, instrument, raw, protocol);
  }
  if (status != DEA_OK && instrument != NULL) {
    status = instrument->reached ? abandon(ctx, instrument, status) : status;
    type->close(ctx, instrument);
    instrument = NULL;
  }
  dea_free(ctx, raw);
  *out = instrument;
  return status == DEA_OK ? status : dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
}

dea_status dea_instrument_address(struct dea_context *ctx,
                                  const struct dea_protocol_instrument *section,
                                  const struct dea_protocol *protocol,
                                  char out[DEA_INSTRUMENT_ADDRESS_SIZE])
{
  const struct dea_instrument_type *type;
  void *raw;
  char where[DEA_INSTRUMENT_ADDRESS_SIZE - 20] = "";
  out[0] = '\0';
  DEA_TRY(ctx, read_good(ctx, section, protocol, &type, &raw));
  if (type->address != NULL) {
    type->address(raw, where, sizeof where);
  }
  if (where[0] != '\0') {
    snprintf(out, DEA_INSTRUMENT_ADDRESS_SIZE, "%.16s %s", type->name, where);
  }
  dea_free(ctx, raw);
  return DEA_OK;
}

dea_status dea_instrument_zero(struct dea_context *ctx,
                               const struct dea_protocol_instrument *section,
                               const struct dea_protocol *protocol,
                               const struct dea_instrument_past *past, struct dea_zero *out)
{
  const struct dea_instrument_type *type;
  void *raw;
  *out = (struct dea_zero){DEA_ZERO_NONE, NAN, NULL};
  DEA_TRY(ctx, read_good(ctx, section, protocol, &type, &raw));
  if (type->zero != NULL) {
    *out = dea_zero_believe(type->zero(ctx, raw, protocol, past), past->doubt);
  }
  dea_free(ctx, raw);
  return DEA_OK;
}

dea_status dea_instrument_check(struct dea_context *ctx, const struct dea_protocol *protocol)
{
  for (size_t i = 0; i < protocol->instrument_count; i++) {
    const struct dea_instrument_type *type;
    void *raw;
    DEA_TRY(ctx, read_section(ctx, &protocol->instruments[i], protocol, &type, &raw));
    dea_free(ctx, raw);
  }
  return DEA_OK;
}
