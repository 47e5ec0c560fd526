/* Fuzz target: reading a protocol and its instruments' sections, and checking what it would play,
 * without playing it. Its paths count from lab/examples, where a design is. */
#include "fuzz.h"

#include "film/film_of_design.h"
#include "instrument/instrument.h"

#include <stdint.h>

static void look(struct dea_context *ctx, const char *text, size_t length)
{
  struct dea_protocol *protocol;
  dea_status status =
      dea_protocol_read_memory(ctx, &dea_film_of_design, DEA_SOURCE_DIR "/lab/examples/fuzz.yaml",
                               text, length, NULL, 0, &protocol);
  fuzz_check_findings(ctx, status);
  if (status == DEA_OK && dea_instrument_check(ctx, protocol) == DEA_OK &&
      dea_finding_count(ctx, DEA_ERROR) == 0) {
    struct dea_protocol_plan plan;
    status = dea_protocol_check(ctx, protocol, &plan);
    if (status == DEA_OK && (plan.highest_V > protocol->amplifier.highest_V.si * (1 + 1e-9) ||
                             plan.lowest_V < protocol->amplifier.lowest_V.si * (1 + 1e-9))) {
      __builtin_trap(); // more than the amplifier's largest voltage would be played
    }
  }
  dea_protocol_destroy(ctx, protocol);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  look(ctx, (const char *)data, size);
  return 0;
}
