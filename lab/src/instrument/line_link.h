/* A connection to an instrument that speaks in lines of text. */
#pragma once

#include "instrument/line_reader.h"
#include "instrument/socket.h"

/* Zero-initialise, and the socket's descriptor to -1. */
struct dea_line_link {
  struct dea_socket socket;
  struct dea_line_reader lines;
};

/* Waits for a line, *out, lent until the next; NULL: none in time. DEA_E_INSTRUMENT when more than
 * one came, DEA_E_INTERRUPTED when the run is ended meanwhile. */
dea_status dea_line_wait(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                         const char **out);
/* Nothing if bytes that came behind a line (NULL: without any) are its end, else DEA_E_INSTRUMENT.
 */
dea_status dea_line_alone(struct dea_context *ctx, const struct dea_line_link *link,
                          const char *line, const char *bytes, size_t length);
/* The same for all that has come and was not read yet, before a question is sent. */
dea_status dea_line_unasked(struct dea_context *ctx, const struct dea_line_link *link);
