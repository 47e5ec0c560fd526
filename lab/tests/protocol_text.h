/* Protocols from text in tests, in a folder of their own. */
#pragma once

#include "design_text.h"
#include "film/film_of_design.h"
#include "protocol/protocol.h"

#include "own_folder.h" // after: its context shadows no name of the headers above

#define PROTOCOL_AMPLIFIER                                                                         \
  "amplifier: {name: Trek 10/10B-HS, gain: 1000 V/V, max_voltage: 10 kV, slew_limit: 700 V/us, "   \
  "current_limit: 10 mA}\n"
/* Up to line 4; what is played follows. */
#define PROTOCOL_HEAD                                                                              \
  "dea-protocol: 1\n"                                                                              \
  "design: design.yaml\n" PROTOCOL_AMPLIFIER                                                       \
  "safety: {largest_field: 400 V/um, field_reason: a test}\n"

static inline void write_in_folder(const char *name, const char *text)
{
  FILE *file = fopen(in_folder(name), "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
  fclose(file);
}

/* Reads text as protocol.yaml beside a good design.yaml. */
static inline dea_status protocol_of(struct dea_context *context, const char *text,
                                     struct dea_protocol **out)
{
  write_in_folder("design.yaml", GOOD_DESIGN);
  write_in_folder("protocol.yaml", text);
  return dea_protocol_read(context, &dea_film_of_design, in_folder("protocol.yaml"), NULL, 0, out);
}

static inline struct dea_protocol *good_protocol(struct dea_context *context, const char *text)
{
  struct dea_protocol *protocol;
  dea_finding_clear(context);
  if (protocol_of(context, text, &protocol) != DEA_OK) {
    print_findings(context);
    fail_msg("%s: %s", text, dea_context_message(context));
  }
  return protocol;
}
