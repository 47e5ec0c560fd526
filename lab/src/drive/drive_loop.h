/* The loop of `dea drive` on instruments that are open already. */
#pragma once

#include "drive/drive.h"
#include "drive/guard.h"
#include "drive/writer.h"
#include "instrument/instrument.h"

struct dea_drive_bench {
  struct dea_instrument *const *instruments; // [count], open; lent
  size_t count;
  double settle_s; // of the amplifier after a jump
  double stall_s;  // an instrument that reads the inputs and gives nothing for so long has failed
  struct dea_guard *guard;         // NULL: none; lent
  const struct dea_supply *supply; // that somebody else may ask for; NULL: none; lent
  double capacitance_F;            // of the film; 0 or NAN: not known
};

/* Plays the protocol and records it in `file`, which must not exist. Every instrument is stopped
 * once, whatever happens, and none is closed. Status and out as dea_drive_run. */
dea_status dea_drive_play(struct dea_context *ctx, const struct dea_protocol *protocol,
                          const struct dea_drive_bench *bench, const char *file,
                          struct dea_drive_report *out);

/* Stops instruments that will not play, for the reason that `status` and the context have. The
 * status, which is another one where the output is not known to be at 0 V then, and was before. */
dea_status dea_drive_abort(struct dea_context *ctx, const struct dea_protocol *protocol,
                           struct dea_instrument *const *instruments, size_t count,
                           dea_status status, struct dea_drive_report *out);

/* Who does what; lent. */
struct dea_drive_roles {
  struct dea_instrument *player; // of the output
  struct dea_instrument *reader; // of the inputs; NULL when the protocol has no channels
  struct dea_instrument *sensor; // of profiles; NULL without
};
/* DEA_E_INSTRUMENT when they are not what a protocol is played with. */
dea_status dea_drive_find_roles(struct dea_context *ctx, const struct dea_protocol *protocol,
                                const struct dea_drive_bench *bench, struct dea_drive_roles *out);
/* Makes the recording of a bench: channel 0 the asked voltage, then the inputs of the protocol,
 * then the readings of the instruments in their order. sensor: that sends profiles; NULL. */
dea_status dea_drive_recorder(struct dea_context *ctx, const struct dea_protocol *protocol,
                              const struct dea_drive_bench *bench, const char *file,
                              const struct dea_instrument *sensor, struct dea_recorder **out);
