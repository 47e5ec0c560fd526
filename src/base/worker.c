#define _GNU_SOURCE // prctl's names, MSG_NOSIGNAL
#include "base/worker.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ASIDE_MAX = 256, ASK_MS = 100, CHUNK = 1 << 16 };

/* What stands before all that is handed back: bytes, then findings. */
struct head {
  dea_status status;
  char message[1024];
  size_t bytes, findings;
};

/* Before the text of a finding and the name of its file, both without their end. */
struct finding {
  enum dea_severity severity;
  size_t line, column, text, file;
};

// There ------------------------------------------------------------------------------------------

/* The process that waits has shut its side, or is gone. */
static bool has_message(void *user)
{
  struct pollfd end = {.fd = *(const int *)user, .events = POLLIN};
  return poll(&end, 1, 0) > 0;
}

/* Findings from the `known` ones on. */
static void add_findings(const struct dea_context *ctx, size_t known, struct dea_bytes *out)
{
  size_t count;
  const struct dea_finding *all = dea_finding_get(ctx, &count);
  for (size_t i = known; i < count; i++) {
    const struct dea_location *at = &all[i].location;
    const struct finding finding = {all[i].severity, at->line, at->column, strlen(all[i].text),
                                    strlen(at->file != NULL ? at->file : "")};
    dea_bytes_add(out, &finding, sizeof finding);
    dea_bytes_add(out, all[i].text, finding.text);
    dea_bytes_add(out, at->file, finding.file);
  }
}

bool dea_send_all(int socket, const void *bytes, size_t length)
{
  for (const char *from = bytes; length > 0;) {
    const ssize_t n = send(socket, from, length, MSG_NOSIGNAL);
    if (n <= 0 && errno != EINTR) {
      return false;
    }
    from += n > 0 ? n : 0;
    length -= n > 0 ? (size_t)n : 0;
  }
  return true;
}

const char *dea_ended_by(int how, char out[DEA_ENDED_BY])
{
  snprintf(out, DEA_ENDED_BY, "%s %d", WIFSIGNALED(how) ? "signal" : "exit code",
           WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
  return out;
}

/* The whole of the other process; returns its exit code. */
static int run_worker(struct dea_context *ctx, dea_worker_work work, void *user, int socket)
{
  struct dea_bytes bytes = {.ctx = ctx}, findings = {.ctx = ctx};
  struct head head;
  size_t known;
  memset(&head, 0, sizeof head); // all bytes of it are sent
  dea_finding_get(ctx, &known);
  dea_context_set_progress(ctx, NULL, NULL);
  dea_context_set_finding_sink(ctx, NULL, NULL);
  dea_context_set_interrupt(ctx, NULL);
  dea_context_set_interrupt_fn(ctx, has_message, &socket);
  head.status = work(ctx, user, &bytes);
  snprintf(head.message, sizeof head.message, "%s", dea_context_message(ctx));
  add_findings(ctx, known, &findings);
  head.bytes = bytes.length;
  head.findings = findings.length;
  return !bytes.failed && !findings.failed && dea_send_all(socket, &head, sizeof head) &&
                 dea_send_all(socket, bytes.data, bytes.length) &&
                 dea_send_all(socket, findings.data, findings.length)
             ? 0
             : 1;
}

// Here -------------------------------------------------------------------------------------------

dea_status dea_fork_beside(struct dea_context *ctx, pid_t *process, int *socket)
{
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    return dea_fail(ctx, DEA_E_IO, "no socket for another process: %s", strerror(errno));
  }
  const pid_t parent = getpid();
  *process = fork();
  *socket = ends[*process == 0 ? 1 : 0];
  close(ends[*process == 0 ? 0 : 1]);
  if (*process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    if (getppid() != parent) {
      _exit(1);
    }
  } else if (*process < 0) {
    close(*socket);
    return dea_fail(ctx, DEA_E_IO, "no other process: %s", strerror(errno));
  }
  return DEA_OK;
}

dea_status dea_worker_start(struct dea_context *ctx, dea_worker_work work, void *user,
                            struct dea_worker *worker)
{
  pid_t process = -1;
  int socket = -1;
  DEA_TRY(ctx, dea_fork_beside(ctx, &process, &socket));
  if (process == 0) {
    _exit(run_worker(ctx, work, user, socket));
  }
  *worker = (struct dea_worker){process, socket, {.ctx = ctx}, true, false};
  return DEA_OK;
}

/* Its end; nothing of one that did not hand back all counts. */
static void reap(struct dea_worker *worker)
{
  int how = 0;
  while (waitpid(worker->process, &how, 0) < 0 && errno == EINTR) {
  }
  close(worker->socket);
  worker->process = 0;
  worker->said.length = WIFEXITED(how) && WEXITSTATUS(how) == 0 ? worker->said.length : 0;
}

/* Some of what it says, or its end. */
static dea_status receive(struct dea_context *ctx, struct dea_worker *worker)
{
  char chunk[CHUNK];
  const ssize_t n = recv(worker->socket, chunk, sizeof chunk, 0);
  if (n > 0) {
    dea_bytes_add(&worker->said, chunk, (size_t)n);
  } else if (n == 0 || errno != EINTR) {
    reap(worker);
  }
  return worker->said.failed ? dea_context_status(ctx) : DEA_OK;
}

/* Tells one that this process was interrupted, once. */
static void send_status(const struct dea_context *ctx, struct dea_worker *worker)
{
  if (!worker->asked_to_stop && dea_interrupted(ctx)) {
    shutdown(worker->socket, SHUT_WR);
    worker->asked_to_stop = true;
  }
}

dea_status dea_worker_wait(struct dea_context *ctx, struct dea_worker *all, size_t count,
                           size_t most)
{
  struct pollfd polled[ASIDE_MAX];
  size_t at[ASIDE_MAX];
  for (;;) {
    nfds_t run = 0;
    for (size_t i = 0; i < count && run < ASIDE_MAX; i++) {
      if (all[i].process > 0) {
        send_status(ctx, &all[i]);
        at[run] = i;
        polled[run++] = (struct pollfd){.fd = all[i].socket, .events = POLLIN};
      }
    }
    if (run <= most) {
      return DEA_OK;
    }
    if (poll(polled, run, ASK_MS) > 0) {
      for (nfds_t k = 0; k < run; k++) {
        DEA_TRY(ctx, polled[k].revents != 0 ? receive(ctx, &all[at[k]]) : DEA_OK);
      }
    }
  }
}

/* false: it has died. */
static bool read_head(const struct dea_worker *worker, struct head *head)
{
  const bool whole = worker->said.length >= sizeof *head;
  if (whole) {
    memcpy(head, worker->said.data, sizeof *head);
  }
  return whole && worker->said.length == sizeof *head + head->bytes + head->findings;
}

bool dea_worker_failed(const struct dea_worker *worker)
{
  struct head head;
  return worker->begun && worker->process == 0 &&
         !(read_head(worker, &head) && head.status == DEA_OK);
}

static dea_status read_findings(struct dea_context *ctx, const char *from, size_t length)
{
  struct finding finding;
  for (const char *end = from + length; from < end; from += finding.file) {
    memcpy(&finding, from, sizeof finding);
    const char *text = from + sizeof finding;
    from = text + finding.text;
    char *file = dea_copy_text(ctx, from, finding.file);
    const char *name = file != NULL ? dea_intern(ctx, file) : NULL;
    dea_free(ctx, file);
    DEA_TRY_MEMORY(name != NULL);
    DEA_TRY(ctx, dea_finding_add(ctx, finding.severity,
                                 (struct dea_location){name, finding.line, finding.column}, "%.*s",
                                 (int)finding.text, text));
  }
  return DEA_OK;
}

dea_status dea_worker_collect(struct dea_context *ctx, const struct dea_worker *worker,
                              const char **bytes, size_t *length)
{
  struct head head;
  *bytes = NULL;
  *length = 0;
  if (!read_head(worker, &head)) {
    return dea_fail(ctx, DEA_E_TOOL, "a process of this run has died");
  }
  *bytes = worker->said.data + sizeof head;
  *length = head.bytes;
  DEA_TRY(ctx, read_findings(ctx, *bytes + head.bytes, head.findings));
  return head.status == DEA_OK ? DEA_OK : dea_fail(ctx, head.status, "%s", head.message);
}

void dea_worker_end(struct dea_worker *worker)
{
  if (worker->process > 0) {
    kill(worker->process, SIGKILL);
    reap(worker);
  }
  if (worker->begun) {
    dea_bytes_free(&worker->said);
  }
  *worker = (struct dea_worker){0};
}
