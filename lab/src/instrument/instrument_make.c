#include "instrument/instrument_make.h"

#include "base/schema_value.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

dea_status dea_instrument_check_reading(const struct dea_reader *reader,
                                        const struct dea_protocol *protocol,
                                        const struct dea_label *name,
                                        const struct dea_instrument *sketch)
{
  const char *taken = NULL;
  for (size_t i = 0; i < sketch->reading_count; i++) {
    taken = strcmp(sketch->readings[i].name, name->text) == 0 ? "another reading" : taken;
  }
  for (size_t i = 0; i < protocol->input_count; i++) {
    taken = strcmp(protocol->inputs[i].name.text, name->text) == 0 ? "an input" : taken;
  }
  if (taken != NULL) {
    return dea_schema_error(reader, name->location,
                            "'%.60s' is the name of %s too; give it another", name->text, taken);
  }
  if (strlen(name->text) >= DEA_CHANNEL_NAME_SIZE) {
    return dea_schema_error(reader, name->location,
                            "a name has at most %d bytes; shorten '%.20s...'",
                            DEA_CHANNEL_NAME_SIZE - 1, name->text);
  }
  return DEA_OK;
}

void dea_instrument_add_reading(struct dea_instrument *instrument, const struct dea_label *name,
                                const struct dea_choice *kind, const struct dea_label *unit)
{
  struct dea_instrument_reading *reading = &instrument->readings[instrument->reading_count++];
  reading->kind = (enum dea_channel_kind)kind->value;
  snprintf(reading->name, sizeof reading->name, "%.*s", DEA_CHANNEL_NAME_SIZE - 1, name->text);
  if (reading->kind == DEA_CHANNEL_OTHER) {
    snprintf(reading->unit, sizeof reading->unit, "%.*s", DEA_CHANNEL_NAME_SIZE - 1, unit->text);
  }
}

void dea_instrument_add_displacement(struct dea_instrument *instrument,
                                     const struct dea_label *name)
{
  static const struct dea_choice displacement = {.value = DEA_CHANNEL_DISPLACEMENT};
  static const struct dea_label no_unit;
  dea_instrument_add_reading(instrument, name, &displacement, &no_unit);
}

struct dea_zero dea_instrument_stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  char message[1024];
  if (instrument->type->stop == NULL) {
    return (struct dea_zero){DEA_ZERO_NONE, NAN, NULL};
  }
  dea_status status = dea_context_status(ctx);
  const volatile sig_atomic_t *interrupt = dea_context_get_interrupt(ctx);
  snprintf(message, sizeof message, "%s", dea_context_message(ctx));
  dea_context_set_interrupt(ctx, NULL);
  struct dea_zero zero = instrument->type->stop(ctx, instrument);
  dea_context_set_interrupt(ctx, interrupt);
  if (status != DEA_OK) {
    dea_fail(ctx, status, "%s", message);
  }
  return zero;
}
