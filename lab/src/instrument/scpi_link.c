/* Lines to and from an instrument that speaks SCPI. */
#include "instrument/scpi.h"

#include <stdio.h>
#include <string.h>

dea_status dea_scpi_connect(struct dea_context *ctx, const struct dea_scpi_raw *raw,
                            const char *host, double timeout_s, struct dea_line_link *link)
{
  *link = (struct dea_line_link){.socket.descriptor = -1};
  return dea_socket_connect(ctx, "the instrument", host[0] != '\0' ? host : raw->address.text,
                            (int)raw->port.si, timeout_s, &link->socket);
}

dea_status dea_scpi_send(struct dea_context *ctx, const struct dea_line_link *link,
                         double timeout_s, const char *command)
{
  char line[DEA_SCPI_COMMAND_SIZE];
  int length = snprintf(line, sizeof line, "%s\n", command);
  return dea_socket_write(ctx, &link->socket, timeout_s, line, (size_t)length);
}

void dea_scpi_send_if_possible(const struct dea_line_link *link, const char *command)
{
  char line[DEA_SCPI_COMMAND_SIZE];
  int length = snprintf(line, sizeof line, "%s\n", command);
  dea_socket_write_if_possible(&link->socket, line, (size_t)length);
}

dea_status dea_scpi_question(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                             const char *question)
{
  DEA_TRY(ctx, dea_line_unasked(ctx, link));
  return dea_scpi_send(ctx, link, timeout_s, question);
}

dea_status dea_scpi_query(struct dea_context *ctx, struct dea_line_link *link, double timeout_s,
                          const char *question, const char **out)
{
  *out = NULL;
  DEA_TRY(ctx, dea_scpi_question(ctx, link, timeout_s, question));
  return dea_line_wait(ctx, link, timeout_s, out);
}

bool dea_scpi_is_same(const struct dea_scpi_raw *raw, const char *mark, const char *response)
{
  return strstr(response, raw->identity.text) != NULL &&
         (mark[0] == '\0' || strncmp(response, mark, DEA_INSTRUMENT_MARK_SIZE - 1) == 0);
}

dea_status dea_scpi_no_response(struct dea_context *ctx, const struct dea_scpi *s,
                                const char *question, double timeout_s)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s did not answer '%.100s' within %g s; look at whether it knows that question",
                  s->name, question, timeout_s);
}
