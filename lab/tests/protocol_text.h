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

static struct dea_protocol *p; // that was read last

static inline int protocol_tear_down(void **state)
{
  dea_protocol_destroy(ctx, p);
  return tear_down(state);
}

static inline dea_status protocol_read(const char *file, const struct dea_override *sets,
                                       size_t count)
{
  dea_protocol_destroy(ctx, p);
  p = NULL;
  return dea_protocol_read(ctx, &dea_film_of_design, file, sets, count, &p);
}

/* Reads text as protocol.yaml beside a good design.yaml. */
static inline dea_status protocol_of(const char *text)
{
  write_in_folder("design.yaml", GOOD_DESIGN);
  write_in_folder("protocol.yaml", text);
  return protocol_read(in_folder("protocol.yaml"), NULL, 0);
}

static inline void good_protocol(const char *text)
{
  dea_finding_clear(ctx);
  if (protocol_of(text) != DEA_OK) {
    print_findings(ctx);
    fail_msg("%s: %s", text, dea_context_message(ctx));
  }
}
