/* A connection to an instrument that speaks in lines of text. */
#ifndef DEA_LAB_INSTRUMENT_LINE_LINK_H
#define DEA_LAB_INSTRUMENT_LINE_LINK_H

#include "lab/instrument/line_reader.h"
#include "lab/instrument/socket.h"

/* Zero-initialise, and the socket's descriptor to -1. */
struct dea_line_link {
  struct dea_socket socket;
  struct dea_line_reader lines;
};

/* Waits for a line, *out, lent until the next; NULL: none in time. DEA_E_INTERRUPTED when the run
 * is ended meanwhile. */
dea_status dea_line_wait(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                         const char **out);

#endif
