/* Serial lines to instruments (RS-232, RS-422, a USB adapter), read and written as a connection of
 * socket.h. */
#pragma once

#include "instrument/socket.h"

/* Names of the parities, in the order of the number: "none", "even", "odd", NULL. */
extern const char *const dea_serial_parities[];

/* Where another program has the line. */
struct dea_serial_turn {
  double wait_s; // how long it is waited for; then it is opened all the same
  long program;  // process beside which it is opened at once; 0: none
  // which dea_serial_open_in_turn fills
  bool beside; // another one than `program` has it, and may go on
  long holder; // process that has it; 0: none, or it is not known which
};

/* Opens a line of 8 bits and one stop bit without flow control, and drops what came before. what:
 * for messages ("the Keyence LK"). baud: bits a second, one of those that serial lines have. out:
 * closed on failure. DEA_E_INSTRUMENT with what to look at.
 *
 * While it is open the line is locked (flock), whatever name it has: a second program that asks for
 * the lock is refused, with the process that has it. The terminal's own exclusive mode (TIOCEXCL)
 * is not used: it would keep the guard of a stopped program out, too. */
dea_status dea_serial_open(struct dea_context *ctx, const char *what, const char *device, int baud,
                           int parity, struct dea_socket *out);
/* The same for what has to be said whoever has the line. turn: NULL as dea_serial_open. */
dea_status dea_serial_open_in_turn(struct dea_context *ctx, const char *what, const char *device,
                                   int baud, int parity, struct dea_serial_turn *turn,
                                   struct dea_socket *out);
/* "process 4711 (picocom)", as far as it is known. */
enum { DEA_SERIAL_HOLDER_SIZE = 64 };
void dea_serial_holder_text(long holder, char out[DEA_SERIAL_HOLDER_SIZE]);
/* What tells the line, from when it was plugged in until it is pulled out, from what gets its name
 * later; "": it is closed. */
void dea_serial_mark(const struct dea_socket *line, char *out, size_t size);
