#define _GNU_SOURCE // names of POSIX
#include "explore/pool.h"

#include "base/clock.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { PROCESSES_MAX = 256, ASK_MS = 100 };

struct worker {
  pid_t process; // 0: none
  int socket;
  bool busy;
  struct dea_case now; // what it is at
};

/* What comes of a case. */
struct reply {
  struct dea_case done;
  dea_status status;
  char message[256];
};

struct dea_pool {
  struct dea_context *ctx;
  const struct dea_evaluator *evaluator;
  size_t count;
  struct worker *workers; // [count]
};

// The process -------------------------------------------------------------------------------------

static void clear_values(struct dea_case *io)
{
  for (size_t i = 0; i < DEA_CASE_VALUES_MAX; i++) {
    io->q[i] = NAN;
  }
}

/* Evaluates the case that is in it; q of it: NAN where there is no value. */
static void evaluate(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                     struct reply *reply)
{
  const double began_s = dea_clock_s();
  clear_values(&reply->done);
  reply->status = evaluator->evaluate(evaluator->user, ctx, &reply->done);
  snprintf(reply->message, sizeof reply->message, "%.255s", dea_context_message(ctx));
  reply->done.wall_s = dea_clock_s() - began_s;
}

/* One message; false where the other end is gone. */
static bool receive_message(int socket, void *bytes, size_t length)
{
  ssize_t n;
  do {
    n = recv(socket, bytes, length, 0);
  } while (n < 0 && errno == EINTR);
  return n == (ssize_t)length;
}

/* Evaluates what it is sent until nobody sends any more. */
static void work(struct dea_context *ctx, const struct dea_evaluator *evaluator, int socket)
{
  struct reply reply;
  memset(&reply, 0, sizeof reply); // all bytes of it are sent
  while (receive_message(socket, &reply.done, sizeof reply.done)) {
    evaluate(ctx, evaluator, &reply);
    if (send(socket, &reply, sizeof reply, MSG_NOSIGNAL) < 0) {
      return;
    }
  }
}

/* A copy of this process with a socket between both, a message a case, that works until this one
 * ends, however that ends, and leaves Ctrl-C to it. */
static dea_status start(struct dea_pool *pool, struct worker *worker)
{
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
    return dea_fail(pool->ctx, DEA_E_IO, "no socket for another process: %s", strerror(errno));
  }
  const pid_t parent = getpid(), process = fork();
  const int socket = ends[process == 0 ? 1 : 0];
  close(ends[process == 0 ? 0 : 1]);
  if (process < 0) {
    close(socket);
    return dea_fail(pool->ctx, DEA_E_IO, "no other process: %s", strerror(errno));
  }
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGINT, SIG_IGN);
    signal(SIGTERM, SIG_DFL);
    if (getppid() != parent) {
      _exit(1);
    }
    dea_context_set_progress(pool->ctx, NULL, NULL);
    dea_context_set_interrupt(pool->ctx, NULL);
    for (size_t k = 0; k < pool->count; k++) { // the end of one is seen by this socket alone
      if (pool->workers[k].process > 0) {
        close(pool->workers[k].socket);
      }
    }
    work(pool->ctx, pool->evaluator, socket);
    _exit(0);
  }
  worker->process = process;
  worker->socket = socket;
  return DEA_OK;
}

/* Ends a process. why: how it had ended, NULL: not wanted. */
static void end(struct worker *worker, char why[DEA_CASE_WHY_SIZE])
{
  int how = 0;
  if (worker->process > 0) {
    kill(worker->process, SIGKILL);
    while (waitpid(worker->process, &how, 0) < 0 && errno == EINTR) {
    }
    close(worker->socket);
    if (why != NULL) {
      snprintf(why, DEA_CASE_WHY_SIZE, "the process of this case ended by %s %d",
               WIFSIGNALED(how) ? "signal" : "exit code",
               WIFSIGNALED(how) ? WTERMSIG(how) : WEXITSTATUS(how));
    }
  }
  worker->process = 0;
  worker->busy = false;
}

// The pool ----------------------------------------------------------------------------------------

dea_status dea_pool_create(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                           size_t processes, struct dea_pool **out)
{
  *out = NULL;
  if (processes < 1 || processes > PROCESSES_MAX || evaluator->param_count > DEA_CASE_PARAMS_MAX ||
      dea_evaluator_values(evaluator) > DEA_CASE_VALUES_MAX) {
    return dea_fail(ctx, DEA_E_ARGUMENT, "from 1 to %d processes", PROCESSES_MAX);
  }
  struct dea_pool *pool = dea_alloc(ctx, 1, sizeof *pool);
  struct worker *workers = dea_alloc(ctx, processes, sizeof *workers);
  if (pool == NULL || workers == NULL) {
    dea_free(ctx, pool);
    dea_free(ctx, workers);
    return DEA_E_MEMORY;
  }
  *pool = (struct dea_pool){ctx, evaluator, processes, workers};
  *out = pool;
  return DEA_OK;
}

void dea_pool_destroy(struct dea_pool *pool)
{
  if (pool != NULL) {
    for (size_t k = 0; k < pool->count; k++) {
      end(&pool->workers[k], NULL);
    }
    dea_free(pool->ctx, pool->workers);
    dea_free(pool->ctx, pool);
  }
}

/* Sends a case to a process that has none, and starts one where there is none. */
static dea_status assign_case(struct dea_pool *pool, struct worker *worker)
{
  DEA_TRY(pool->ctx, worker->process == 0 ? start(pool, worker) : DEA_OK);
  worker->busy = true;
  send(worker->socket, &worker->now, sizeof worker->now, MSG_NOSIGNAL); // its end is seen later
  return DEA_OK;
}

/* What a process says of its case, or what is left of that where it has died. */
static dea_status receive(struct dea_pool *pool, struct worker *worker, dea_case_sink sink,
                          void *user)
{
  struct reply reply;
  if (receive_message(worker->socket, &reply, sizeof reply)) {
    worker->busy = false;
  } else {
    reply = (struct reply){.done = worker->now};
    clear_values(&reply.done);
    end(worker, reply.done.why);
  }
  if (reply.status != DEA_OK) {
    return dea_fail(pool->ctx, reply.status, "%s", reply.message);
  }
  return sink(user, &reply.done);
}

dea_status dea_pool_run(struct dea_pool *pool, dea_case_source source, dea_case_sink sink,
                        void *user)
{
  struct pollfd polled[PROCESSES_MAX];
  dea_status status = DEA_OK;
  size_t busy = 0;
  bool more = true;
  while (status == DEA_OK && (more || busy > 0)) {
    busy = 0;
    for (size_t k = 0; k < pool->count && status == DEA_OK; k++) {
      struct worker *worker = &pool->workers[k];
      if (!worker->busy && more) {
        memset(&worker->now, 0, sizeof worker->now);
        worker->now.process = k;
        more = source(user, &worker->now);
        status = more ? assign_case(pool, worker) : DEA_OK;
      }
      busy += worker->busy ? 1U : 0U;
      polled[k] = (struct pollfd){.fd = worker->busy ? worker->socket : -1, .events = POLLIN};
    }
    if (dea_interrupted(pool->ctx)) {
      status = dea_fail(pool->ctx, DEA_E_INTERRUPTED, "interrupted; what was done is kept");
    }
    if (status == DEA_OK && busy > 0 && poll(polled, pool->count, ASK_MS) > 0) {
      for (size_t k = 0; k < pool->count && status == DEA_OK; k++) {
        if (polled[k].revents != 0) {
          status = receive(pool, &pool->workers[k], sink, user);
        }
      }
    }
  }
  for (size_t k = 0; k < pool->count && status != DEA_OK;
       k++) { // no answer to what was asked before
    end(&pool->workers[k], NULL);
  }
  return status;
}
