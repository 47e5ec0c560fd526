/* What is known of the supplies of this computer, kept over the end of the program: a file each, in
 * a folder of the user's. While a supply is in use the file is locked, so that no second program
 * drives it. While it is armed the file says so, and it goes on saying so until its output was read
 * back at 0 V: a program that is killed leaves that behind.
 *
 * Who brings a supply to 0 V for somebody (`dea drive --zero`) asks for it by the lock of a second
 * file. The program that drives it ends then, and the guard of one that has died gives the supply
 * away until that is done. A lock goes with its process: nothing asks for longer than that lives.
 */
#pragma once

#include "base/context.h"
#include "instrument/instrument.h"

enum { DEA_SUPPLY_LEFT_SIZE = 256 };

struct dea_supply {
  int file; // -1: none is kept
  int ask;  // locked by who asks for it; -1 with `file`
  char path[512];
  char left[DEA_SUPPLY_LEFT_SIZE]; // what the last program left behind; "": nothing
  /* Of the supply that it is about (struct dea_instrument); "": not known. Read with `left`, and
   * written with what is left. */
  char mark[DEA_INSTRUMENT_MARK_SIZE];
  char host[DEA_INSTRUMENT_HOST_SIZE]; // and where it was
};

/* Opens the file of a supply, made with its folders where there is none, and locks it. folder: NULL
 * keeps nothing. address: as dea_instrument_address. DEA_E_INTERLOCK when another program drives
 * it. */
dea_status dea_supply_open(struct dea_context *ctx, const char *folder, const char *address,
                           struct dea_supply *out);
/* The same for who brings it to 0 V: asks for it, and waits up to wait_s. DEA_E_INTERLOCK: it was
 * not given; `left` and `mark` are there, and it is asked for until it is closed. */
dea_status dea_supply_request(struct dea_context *ctx, const char *folder, const char *address,
                              double wait_s, struct dea_supply *out);
/* Whether somebody asks for it. */
bool dea_supply_is_asked(const struct dea_supply *supply);
/* Gives it to who asks for it, and takes it again as soon as nobody does, with what was left then.
 * False: it was not given back within the time. */
bool dea_supply_release(struct dea_supply *supply, double within_s);
/* Puts down what is left behind should nothing follow, and the mark, on the disk before it returns;
 * "": nothing. */
dea_status dea_supply_leave(struct dea_context *ctx, struct dea_supply *supply, const char *text);
/* Lets the next program have it. One that is closed is fine. */
void dea_supply_close(struct dea_supply *supply);
