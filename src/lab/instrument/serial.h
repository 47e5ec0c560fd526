/* Serial lines to instruments (RS-232, RS-422, a USB adapter), read and written as a connection of
 * socket.h. */
#ifndef DEA_LAB_INSTRUMENT_SERIAL_H
#define DEA_LAB_INSTRUMENT_SERIAL_H

#include "lab/instrument/socket.h"

/* Names of the parities, in the order of the number: "none", "even", "odd", NULL. */
extern const char *const dea_serial_parities[];

/* Opens a line of 8 bits and one stop bit without flow control, and drops what came before. what:
 * for messages ("the Keyence LK"). baud: bits a second, one of those that serial lines have. out:
 * closed on failure. DEA_E_INSTRUMENT with what to look at. */
dea_status dea_serial_open(struct dea_context *ctx, const char *what, const char *device, int baud,
                           int parity, struct dea_socket *out);
/* What tells the line, from when it was plugged in until it is pulled out, from what gets its name
 * later; "": it is closed. */
void dea_serial_mark(const struct dea_socket *line, char *out, size_t size);

#endif
