#define _GNU_SOURCE // prctl, pipe2
#include "explore/ranks.h"

#include "base/aside.h"
#include "base/clock.h"
#include "base/write_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ASK_MS = 100, WORDS_MAX = 24 };

/* How lines begin: that they are there, with the hash of what they are asked, cases and replies. */
static const char hello[] = "dea-ranks ", letter[] = "dea-bytes ";

void dea_reply_find(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                    struct dea_reply *reply)
{
  const double began_s = dea_clock_s();
  for (size_t i = 0; i < DEA_CASE_VALUES_MAX; i++) {
    reply->done.q[i] = NAN;
  }
  reply->status = evaluator->evaluate(evaluator->user, ctx, &reply->done);
  snprintf(reply->message, sizeof reply->message, "%.255s", dea_context_message(ctx));
  reply->done.wall_s = dea_clock_s() - began_s;
}

// Lines -------------------------------------------------------------------------------------------

/* Bytes as a line, two letters each; returns its length. */
static size_t spell(const void *bytes, size_t length, char line[DEA_RANKS_LINE])
{
  size_t used = (size_t)snprintf(line, DEA_RANKS_LINE, "%s", letter);
  for (size_t i = 0; i < length; i++) {
    const unsigned char byte = ((const unsigned char *)bytes)[i];
    line[used++] = (char)('a' + byte / 16);
    line[used++] = (char)('a' + byte % 16);
  }
  line[used++] = '\n';
  return used;
}

/* A line that holds so many bytes and no others; false: it is another one. */
static bool read_bytes(const char *line, void *bytes, size_t length)
{
  const size_t head = strlen(letter);
  if (strncmp(line, letter, head) != 0 || strspn(line + head, "abcdefghijklmnop") != 2 * length) {
    return false;
  }
  for (size_t i = 0; i < length; i++) {
    const char *two = line + head + 2 * i;
    ((unsigned char *)bytes)[i] = (unsigned char)(16 * (two[0] - 'a') + two[1] - 'a');
  }
  return true;
}

/* Some of what comes, for which this waits; false at the end. */
static bool receive(struct dea_ranks_running *ranks)
{
  if (ranks->used == sizeof ranks->line) {
    ranks->used = 0; // none of ours is so long
  }
  const ssize_t n =
      read(ranks->socket, ranks->line + ranks->used, sizeof ranks->line - ranks->used);
  ranks->used += n > 0 ? (size_t)n : 0;
  return n > 0 || (n < 0 && errno == EINTR);
}

/* The next line of what has come, into out [DEA_RANKS_LINE]; false: none is whole. */
static bool take_line(struct dea_ranks_running *ranks, char *out)
{
  const char *end = memchr(ranks->line, '\n', ranks->used);
  if (end == NULL) {
    return false;
  }
  size_t length = (size_t)(end - ranks->line);
  memcpy(out, ranks->line, length);
  ranks->used -= length + 1;
  memmove(ranks->line, end + 1, ranks->used);
  while (length > 0 && out[length - 1] == '\r') { // of a terminal
    length--;
  }
  out[length] = '\0';
  return true;
}

// Here --------------------------------------------------------------------------------------------

/* Becomes mpirun, in a group of its own, out of reach of Ctrl-C; it ends its ranks in good order
 * when this process ends. Returns where it cannot. */
static void become(const struct dea_ranks *ranks, int socket, int said)
{
  static const struct {
    const char *name, *value;
  } settings[] = {
      {"OMPI_MCA_odls_base_sigkill_timeout", "0"},    // seconds between SIGTERM and SIGKILL
      {"OMPI_MCA_hwloc_base_binding_policy", "none"}, // else all designs share the first cores
      {"OMPI_MCA_mpi_yield_when_idle", "1"},          // where others want the cores too
  };
  char with[512], count[24], *words[WORDS_MAX + 8], *rest = NULL;
  size_t n = 0;
  const char *given = getenv("DEA_MPIRUN");
  snprintf(with, sizeof with, "%s", given != NULL && given[0] != '\0' ? given : "mpirun");
  snprintf(count, sizeof count, "%zu", ranks->count);
  for (char *word = strtok_r(with, " ", &rest); word != NULL && n < WORDS_MAX;
       word = strtok_r(NULL, " ", &rest)) {
    words[n++] = word;
  }
  const char *const own[] = {"-n",      count, ranks->program, ranks->command, ranks->file,
                             "--serve", NULL};
  memcpy(words + n, own, sizeof own);
  for (size_t i = 0; i < sizeof settings / sizeof settings[0]; i++) {
    setenv(settings[i].name, settings[i].value, 0);
  }
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  setpgid(0, 0);
  if (dup2(socket, STDIN_FILENO) >= 0 && dup2(socket, STDOUT_FILENO) >= 0 &&
      dup2(said, STDERR_FILENO) >= 0) {
    execvp(words[0], words);
    dprintf(STDERR_FILENO, "%s: %s\n", words[0], strerror(errno));
  }
}

/* The first or the last line of what they have said that says something, without rulers. */
static void quote(FILE *said, bool last, char out[DEA_CASE_WHY_SIZE])
{
  char line[400];
  out[0] = '\0';
  rewind(said);
  while (fgets(line, sizeof line, said) != NULL) {
    line[strcspn(line, "\n")] = '\0';
    if (line[strspn(line, "- ")] != '\0' && (last || out[0] == '\0')) {
      snprintf(out, DEA_CASE_WHY_SIZE, "%.*s", DEA_CASE_WHY_SIZE - 1, line);
    }
  }
}

/* Whether they are there and are asked the same. */
static dea_status greet(struct dea_context *ctx, const struct dea_ranks *ranks,
                        struct dea_ranks_running *running)
{
  char line[DEA_RANKS_LINE], why[DEA_CASE_WHY_SIZE];
  for (bool there = true; there;) {
    struct pollfd polled = {.fd = running->socket, .events = POLLIN};
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted; what was done is kept");
    }
    if (poll(&polled, 1, ASK_MS) <= 0) {
      continue;
    }
    there = receive(running);
    while (take_line(running, line)) {
      if (strncmp(line, hello, strlen(hello)) == 0) {
        return strcmp(line + strlen(hello), ranks->question) == 0
                   ? DEA_OK
                   : dea_fail(ctx, DEA_E_IO, "'%.200s' or its design has been changed meanwhile",
                              ranks->file);
      }
    }
  }
  quote(running->said, false, why);
  return dea_fail(ctx, DEA_E_TOOL, "%zu ranks could not be started by mpirun: %s", ranks->count,
                  why);
}

dea_status dea_ranks_start(struct dea_context *ctx, const struct dea_ranks *ranks,
                           struct dea_ranks_running *out)
{
  *out = (struct dea_ranks_running){.said = tmpfile()};
  if (out->said == NULL) {
    return dea_fail(ctx, DEA_E_IO, "no file for what mpirun says: %s", strerror(errno));
  }
  dea_status status = dea_fork_beside(ctx, &out->process, &out->socket);
  if (status != DEA_OK) {
    fclose(out->said);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  if (out->process == 0) {
    become(ranks, out->socket, fileno(out->said));
    _exit(127);
  }
  status = greet(ctx, ranks, out);
  if (status != DEA_OK) {
    dea_ranks_end(out, NULL);
    return dea_fail_chain(ctx, status, __func__, __FILE__, __LINE__);
  }
  return DEA_OK;
}

bool dea_ranks_give(const struct dea_ranks_running *ranks, const struct dea_case *now)
{
  char line[DEA_RANKS_LINE];
  return dea_send_all(ranks->socket, line, spell(now, sizeof *now, line));
}

enum dea_ranks_heard dea_ranks_hear(struct dea_ranks_running *ranks, struct dea_reply *out)
{
  char line[DEA_RANKS_LINE];
  const bool there = receive(ranks);
  while (take_line(ranks, line)) { // what else they say may come in one piece with it
    if (read_bytes(line, out, sizeof *out)) {
      return DEA_RANKS_REPLY;
    }
  }
  return there ? DEA_RANKS_NOTHING : DEA_RANKS_GONE;
}

void dea_ranks_end(struct dea_ranks_running *ranks, char why[DEA_CASE_WHY_SIZE])
{
  static const double patience_s = 5;
  const double began_s = dea_clock_s();
  int how = 0;
  pid_t gone = 0;
  if (why == NULL) {
    kill(ranks->process, SIGTERM); // it ends the ranks, and takes its files away
  }
  while ((gone = waitpid(ranks->process, &how, WNOHANG)) == 0 || (gone < 0 && errno == EINTR)) {
    if (dea_clock_s() - began_s > patience_s) {
      kill(-ranks->process, SIGKILL);
    }
    dea_clock_wait(5e-3);
  }
  close(ranks->socket);
  if (why != NULL) {
    char said[DEA_CASE_WHY_SIZE], by[DEA_ENDED_BY];
    quote(ranks->said, true, said);
    snprintf(why, DEA_CASE_WHY_SIZE, "the ranks of this case ended by %s: %.100s",
             dea_ended_by(how, by), said);
  }
  fclose(ranks->said);
  *ranks = (struct dea_ranks_running){.socket = -1};
}

// There -------------------------------------------------------------------------------------------

/* What the first of them comes to: a case, or the end of all. */
struct order {
  bool more;
  struct dea_case now;
};

static void wait_for_order(struct dea_ranks_running *from, struct order *out)
{
  char line[DEA_RANKS_LINE];
  out->more = false;
  do {
    while (!out->more && take_line(from, line)) {
      out->more = read_bytes(line, &out->now, sizeof out->now);
    }
  } while (!out->more && receive(from));
}

dea_status dea_ranks_serve(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                           const char *question, bool first,
                           dea_status (*tell)(struct dea_context *ctx, void *bytes, size_t length))
{
  struct dea_ranks_running from = {.socket = STDIN_FILENO};
  struct dea_reply reply;
  struct order order;
  char line[DEA_RANKS_LINE];
  prctl(PR_SET_PDEATHSIG, SIGKILL); // mpirun is gone
  signal(SIGTERM, SIG_DFL);
  dea_context_set_progress(ctx, NULL, NULL);
  dea_context_set_interrupt(ctx, NULL);
  const int to = dup(STDOUT_FILENO);
  if (to < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0) { // what a library prints goes there
    return dea_fail(ctx, DEA_E_IO, "no way for replies: %s", strerror(errno));
  }
  memset(&order, 0, sizeof order);
  memset(&reply, 0, sizeof reply);               // all bytes of both are sent
  DEA_TRY(ctx, tell(ctx, &order, sizeof order)); // all are there
  const int length = snprintf(line, sizeof line, "%s%.64s\n", hello, question);
  bool good = !first || dea_write_all(to, line, (size_t)length);
  while (good) {
    if (first) {
      wait_for_order(&from, &order);
    }
    DEA_TRY(ctx, tell(ctx, &order, sizeof order));
    if (!order.more) {
      break;
    }
    reply.done = order.now;
    dea_reply_find(ctx, evaluator, &reply);
    good = !first || dea_write_all(to, line, spell(&reply, sizeof reply, line));
  }
  close(to);
  return DEA_OK;
}
