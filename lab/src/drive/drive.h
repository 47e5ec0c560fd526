/* Plays a protocol through its instruments into a recording, and always comes back to 0 V. */
#pragma once

#include "base/context.h"
#include "instrument/output_zero.h"

struct dea_protocol;

struct dea_drive_options {
  bool simulate;    // play on the simulated bench of protocol->sim instead of the instruments
  const char *file; // recording to make; it must not exist
  /* Folder in which it is kept whether a supply was left at 0 V; NULL: nothing is kept. A supply
   * that was not is refused, unless `checked` says that somebody has looked. */
  const char *state_folder;
  bool checked;
  /* A second process brings the output to 0 V should this one die, or end without knowing that it
   * is there. It says in `tell`, a file that nobody waits for the end of, what came of it; -1: to
   * nobody, but it is kept with the supply. */
  bool guard;
  int tell;
};

struct dea_drive_report {
  double played_s;          // of the protocol's sequence
  size_t cycles;            // played to their end, and recorded
  size_t lost;              // samples, frames and replies that did not arrive
  struct dea_zero zero;     // what is known of the output; volts: at the amplifier's output
  double largest_current_A; // by amount; NAN: no channel of it
  char ended[256];          // why it ended early; ""
};

/* Checks the protocol (DEA_E_INTERLOCK, and nothing is played), opens the instruments, and plays.
 * Where it ends early the output goes to 0 V along the protocol's ramp, still being recorded, and
 * the recording stays readable: DEA_E_INTERRUPTED after a signal (a second one changes nothing),
 * DEA_E_INTERLOCK after a limit was exceeded, DEA_E_INSTRUMENT when an instrument failed or the
 * output is not known to be at 0 V, DEA_E_IO when the recording could not be written. out is filled
 * in all cases. */
dea_status dea_drive_run(struct dea_context *ctx, const struct dea_protocol *protocol,
                         const struct dea_drive_options *options, struct dea_drive_report *out);
/* Brings the output of the protocol's supply to 0 V and says what is known then (volts: at the
 * amplifier's output). A program that drives it is asked to end, and waited for; where it does not,
 * or where what was kept cannot be read, 0 V is commanded all the same, and the output is not known
 * to be there. What was kept of an unclean end goes once 0 V was read back, or was commanded and
 * `checked`. DEA_E_INSTRUMENT when it is not known to be at 0 V. */
dea_status dea_drive_zero(struct dea_context *ctx, const struct dea_protocol *protocol,
                          const char *state_folder, bool checked, struct dea_zero *out);
