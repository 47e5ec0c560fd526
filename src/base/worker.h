/* Work in processes beside this one. Each is a copy of this one (fork), so that it has all that was
 * there; what it does is not seen here, but for the bytes and findings that it hands back. */
#pragma once

#include "base/bytes.h"

#include <sys/types.h>

/* One of them; zeros: none. */
struct dea_worker {
  pid_t process; // while it runs
  int socket;
  struct dea_bytes said;     // what has come of it
  bool begun, asked_to_stop; // told: to stop
};

/* What another process does: its context, and what it hands back. */
typedef dea_status (*dea_worker_work)(struct dea_context *ctx, void *user, struct dea_bytes *out);

/* Begins work in another process, which ends with this one, leaves Ctrl-C to it, and tells no
 * progress; it is interrupted as this one is while that waits. */
dea_status dea_worker_start(struct dea_context *ctx, dea_worker_work work, void *user,
                            struct dea_worker *worker);
/* Waits until at most `most` of them [count] run. */
dea_status dea_worker_wait(struct dea_context *ctx, struct dea_worker *all, size_t count,
                           size_t most);
/* Whether it has ended, and not with DEA_OK. */
bool dea_worker_failed(const struct dea_worker *worker);
/* Of one that has ended: its status, with its message, after its findings are added to those here;
 * *bytes [*length]: what it has handed back, also where it failed, lent until dea_worker_end.
 * DEA_E_TOOL where it died. */
dea_status dea_worker_collect(struct dea_context *ctx, const struct dea_worker *worker,
                              const char **bytes, size_t *length);
/* Ends it at once if it still runs, and frees what came of it. */
void dea_worker_end(struct dea_worker *worker);

// What other pools of processes are made of ------------------------------------------------------

/* Makes a copy of this process, with a socket between both. *process: 0 in the copy, which ends
 * with this one and leaves Ctrl-C to it. */
dea_status dea_fork_beside(struct dea_context *ctx, pid_t *process, int *socket);
/* All bytes [length] through a socket; false where the other end is gone. */
bool dea_send_all(int socket, const void *bytes, size_t length);
/* "signal 9" or "exit code 1", of what waitpid says; out, filled. */
enum { DEA_ENDED_BY = 24 };
const char *dea_ended_by(int how, char out[DEA_ENDED_BY]);
