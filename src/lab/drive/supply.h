/* What is known of the supplies of this computer, kept over the end of the program: a file each, in
 * a folder of the user's. While a supply is in use the file is locked, so that no second program
 * drives it. While it is armed the file says so, and it goes on saying so until its output was read
 * back at 0 V: a program that is killed leaves that behind. */
#ifndef DEA_LAB_DRIVE_SUPPLY_H
#define DEA_LAB_DRIVE_SUPPLY_H

#include "base/context.h"
#include "lab/instrument/instrument.h"

enum { DEA_SUPPLY_LEFT_SIZE = 256 };

struct dea_supply {
  int file; // -1: none is kept
  char path[512];
  char left[DEA_SUPPLY_LEFT_SIZE]; // what the last program left behind; "": nothing
  /* Of the supply that it is about (struct dea_instrument); "": not known. Read with `left`, and
   * written with what is left. */
  char mark[DEA_INSTRUMENT_MARK_SIZE];
};

/* Opens the file of a supply, made with its folders where there is none, and locks it. folder: NULL
 * keeps nothing. address: as dea_instrument_address. DEA_E_INTERLOCK when another program drives
 * it. */
dea_status dea_supply_open(struct dea_context *ctx, const char *folder, const char *address,
                           struct dea_supply *out);
/* Puts down what is left behind should nothing follow, and the mark, on the disk before it returns;
 * "": nothing. */
dea_status dea_supply_leave(struct dea_context *ctx, struct dea_supply *supply, const char *text);
/* Lets the next program have it. One that is closed is fine. */
void dea_supply_close(struct dea_supply *supply);

#endif
