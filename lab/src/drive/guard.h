/* A process that outlives the one that drives. When that one dies, or gives no sign of life for too
 * long, it brings the supply to 0 V by a connection of its own; when that one says that it has
 * ended, it goes. Signals of the terminal do not reach it. */
#pragma once

#include "drive/supply.h"
#include "protocol/protocol.h"

struct dea_guard; // NULL: none

/* Begins what a supply leaves behind while a guard goes on with it after the program's end. */
extern const char dea_guard_goes_on[];

enum dea_guard_state {
  DEA_GUARD_WATCHES,
  DEA_GUARD_TAKEN, // it has taken over: nothing may be played
  DEA_GUARD_GONE   // it was killed, or gave no sign of life itself: nobody would bring it to 0 V
};

/* Forks it, before any instrument is open. section: of the instrument that plays. supply: that it
 * writes what it has done into. tell: file that it says that to as well; -1: none. out: owned by
 * the caller (dea_guard_end), NULL on failure. */
dea_status dea_guard_begin(struct dea_context *ctx, const struct dea_protocol *protocol,
                           const struct dea_protocol_instrument *section,
                           const struct dea_supply *supply, int tell, struct dea_guard **out);
/* What tells the supply, now that it is open, from another one that gets its address, and where it
 * is (struct dea_instrument); the guard believes no other. */
void dea_guard_know(struct dea_guard *guard, const struct dea_instrument *instrument);
/* From here on no two signs of life may be farther apart; 0: it waits for the end only. */
void dea_guard_limit(struct dea_guard *guard, double silence_s);
/* Why what measures the output is not believed at 0 V, static, should the program die now; NULL: it
 * is. */
void dea_guard_doubt(struct dea_guard *guard, const char *doubt);
/* A sign of life, and whether the guard gives one: it is gone when it has ended, or was silent for
 * as long as the program may be, 1 s at least. Of no guard: it watches. */
enum dea_guard_state dea_guard_beat(struct dea_guard *guard);
/* The program has done all that it can do. The guard goes, or, where the output is not known to be
 * at 0 V, goes on bringing it there as if the program had died: until it is, or for 10 minutes. */
void dea_guard_end(struct dea_context *ctx, struct dea_guard *guard, bool known);
