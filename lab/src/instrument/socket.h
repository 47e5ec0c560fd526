/* TCP connections to instruments, and what is read and written like one (serial.h): every wait
 * ends, a lost connection is a sentence, and no write raises SIGPIPE. */
#pragma once

#include "base/context.h"

enum { DEA_SOCKET_NAME_SIZE = 320, DEA_SOCKET_HOST_SIZE = 64 };

/* {.descriptor = -1} is a closed one. */
struct dea_socket {
  int descriptor;
  char name[DEA_SOCKET_NAME_SIZE]; // "the Gocator at 192.168.1.10, port 3196", for messages
  char host[DEA_SOCKET_HOST_SIZE]; // number of what it is connected to; "": not known
};

/* Connects within timeout_s. what: for messages ("the Gocator"). host: a name or an address;
 * looking up a name takes as long as the system's resolver lets it, a number (`host` of an earlier
 * connection) takes no time. out: closed on failure.
 * DEA_E_INSTRUMENT with what to look at. */
dea_status dea_socket_connect(struct dea_context *ctx, const char *what, const char *host, int port,
                              double timeout_s, struct dea_socket *out);
/* Takes what is there, waiting up to timeout_s (0: not at all) for it; *length is 0 when nothing
 * came, or a signal did. DEA_E_INSTRUMENT once the connection is lost. */
dea_status dea_socket_read(struct dea_context *ctx, const struct dea_socket *connection,
                           double timeout_s, void *bytes, size_t capacity, size_t *length);
/* Sends all of it, or fails with DEA_E_INSTRUMENT after timeout_s. */
dea_status dea_socket_write(struct dea_context *ctx, const struct dea_socket *connection,
                            double timeout_s, const void *bytes, size_t length);
/* Sends what goes without waiting; for the way out, where nothing may fail. */
void dea_socket_write_if_possible(const struct dea_socket *connection, const void *bytes,
                                  size_t length);
/* Whether the other end has gone, as far as is known without sending; a closed one has. */
bool dea_socket_is_lost(const struct dea_socket *connection);
/* Claims what a connection leads to, by its number and port, for this computer: whatever name it
 * was called by, one program at a time has it. false: another one does, or nobody can know. *claim:
 * to be closed like a file by whoever has it (the system does it for a program that dies), -1 on
 * failure.
 */
bool dea_socket_claim(const struct dea_socket *connection, int *claim);
/* A closed one is fine. */
void dea_socket_close(struct dea_socket *connection);
