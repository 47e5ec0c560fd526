#define _DEFAULT_SOURCE // fork, pipe, dprintf, MAP_ANONYMOUS
#include "drive/guard.h"

#include "base/clock.h"
#include "base/file.h"
#include "instrument/instrument.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

static const double again_s = 0.2, longest_s = 600; // between attempts, and for all of them
static const double silent_least_s = 1;             // that the guard may be, on a busy computer
static const double last_s = 2; // for its end, once it was told that all is done
static const char clean_end = 'E', not_known = 'N';
const char dea_guard_goes_on[] = "it was not known to be at 0 V at the end; its guard goes on";
enum { poll_ms = 50 };

/* In memory of both. */
struct signs {
  atomic_uint beats, limit_ms; // of the program; the second 0: none
  atomic_uint turns;           // of the guard
  atomic_bool taken;           // the guard has begun to bring the output to 0 V
  atomic_bool known;           // mark and host are there
  _Atomic(const char *) doubt; // static, and so the same in both
  char mark[DEA_INSTRUMENT_MARK_SIZE], host[DEA_INSTRUMENT_HOST_SIZE];
};

struct dea_guard {
  struct signs *signs;
  int pipe;      // written at the clean end; closed by the system when the program dies
  pid_t process; // 0: it has ended
  // what was seen of it
  unsigned turns;
  double turned_s, silent_s; // when this was looked at last, and how long it did not change
};

// The guard's side -------------------------------------------------------------------------------

/* Nothing of the program's is kept open: what waits for its end must not wait for the guard. */
static void release_guard(int pipe, int tell, const struct dea_supply *supply)
{
  long most = sysconf(_SC_OPEN_MAX);
  for (int file = 0; file < (most > 0 && most < 65536 ? (int)most : 65536); file++) {
    if (file != pipe && file != tell && file != supply->file && file != supply->ask) {
      close(file);
    }
  }
  for (int file = open("/dev/null", O_RDWR); file >= 0 && file < 2;) {
    file = dup(file);
  }
  for (int number = 1; number < 32; number++) {
    if (number != SIGCHLD) {
      signal(number, SIG_IGN); // KILL and STOP cannot be
    }
  }
  static const int of_errors[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
  for (size_t i = 0; i < sizeof of_errors / sizeof of_errors[0]; i++) {
    signal(of_errors[i], SIG_DFL);
  }
  setsid();
}

/* Waits for the end, and what was said of it; 0: nothing, or it is silent. Time in which this
 * process itself did not run counts for little: the other one may not have run either. */
static char wait_for_end(int pipe, struct signs *signs)
{
  unsigned beats = atomic_load(&signs->beats);
  double turned_s = dea_clock_s(), silent_s = 0;
  for (;;) {
    struct pollfd entry = {.fd = pipe, .events = POLLIN};
    char byte = 0;
    atomic_fetch_add(&signs->turns, 1);
    if (poll(&entry, 1, poll_ms) > 0) {
      ssize_t got = read(pipe, &byte, 1);
      if (got >= 0 || (errno != EINTR && errno != EAGAIN)) {
        return got == 1 ? byte : 0;
      }
    }
    unsigned limit_ms = atomic_load(&signs->limit_ms), now = atomic_load(&signs->beats);
    double now_s = dea_clock_s();
    bool alive = now != beats || limit_ms == 0;
    silent_s = alive ? 0 : silent_s + fmin(now_s - turned_s, 2e-3 * poll_ms);
    turned_s = now_s;
    beats = now;
    if (1e3 * silent_s > limit_ms) {
      return 0;
    }
  }
}

/* Until the output is at 0 V, somebody else has brought it there or drives it, or the time is over.
 * died: as the program has; else it ended, and somebody is to look whatever comes of it. */
static void bring_to_zero(struct dea_context *ctx, const struct dea_protocol *protocol,
                          const struct dea_protocol_instrument *section, struct dea_supply *supply,
                          const struct dea_instrument_past *past, bool died, int tell)
{
  struct dea_zero zero = {DEA_ZERO_UNKNOWN, NAN, NULL};
  char known[DEA_ZERO_TEXT_SIZE], said[DEA_ZERO_TEXT_SIZE] = "", text[DEA_SUPPLY_LEFT_SIZE];
  double began_s = dea_clock_s(), until_s = began_s + longest_s;
  for (bool more = true; more;) {
    if (dea_instrument_zero(ctx, section, protocol, past, &zero) != DEA_OK) {
      zero.state = DEA_ZERO_UNKNOWN;
    }
    zero.volts *= protocol->amplifier.gain.si;
    dea_zero_text(zero, known);
    more = zero.state == DEA_ZERO_UNKNOWN && dea_clock_s() < until_s &&
           (died || zero.why != dea_zero_other);
    snprintf(text, sizeof text, "%s%s: the output is %s",
             died ? "the program that drove it died" : dea_guard_goes_on,
             !died && !more ? " no more" : "", known);
    (void)dea_supply_leave(ctx, supply, died && zero.state == DEA_ZERO_READ_BACK ? "" : text);
    if (tell >= 0 && (!more || strcmp(known, said) != 0)) {
      dprintf(tell, "dea: %.1f s after the end the guard of %s says: the output is %s%s\n",
              dea_clock_s() - began_s, dea_path_name(protocol->file), known,
              more                             ? "; it goes on"
              : zero.state == DEA_ZERO_UNKNOWN ? ", and it has given up"
                                               : "");
      memcpy(said, known, sizeof said);
    }
    if (more && dea_supply_is_asked(supply)) {
      more = dea_supply_release(supply, until_s - dea_clock_s()) &&
             strncmp(supply->left, text, strcspn(text, "(")) == 0;
    }
    dea_clock_wait(more ? again_s : 0);
  }
}

static void guard(const struct dea_protocol *protocol,
                  const struct dea_protocol_instrument *section, struct dea_supply supply,
                  struct signs *signs, int pipe, int tell)
{
  struct dea_instrument_past past = {supply.mark, getppid(), protocol->safety.zero_time_s.si,
                                     supply.host, NULL};
  struct dea_context *ctx;
  release_guard(pipe, tell, &supply);
  char end = wait_for_end(pipe, signs);
  if (end == clean_end) {
    return;
  }
  atomic_store(&signs->taken, true);
  if (atomic_load(&signs->known)) {
    memcpy(supply.mark, signs->mark, sizeof supply.mark);
    memcpy(supply.host, signs->host, sizeof supply.host);
  }
  past.doubt = atomic_load(&signs->doubt);
  if (dea_context_create(NULL, &ctx) != DEA_OK) {
    return;
  }
  bring_to_zero(ctx, protocol, section, &supply, &past, end != not_known, tell);
  dea_context_destroy(ctx);
}

// The program's side -----------------------------------------------------------------------------

dea_status dea_guard_begin(struct dea_context *ctx, const struct dea_protocol *protocol,
                           const struct dea_protocol_instrument *section,
                           const struct dea_supply *supply, int tell, struct dea_guard **out)
{
  int ends[2];
  *out = NULL;
  struct dea_guard *made = dea_alloc(ctx, 1, sizeof *made);
  DEA_TRY_MEMORY(made != NULL);
  struct signs *signs =
      mmap(NULL, sizeof *signs, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (signs == MAP_FAILED || pipe(ends) != 0) {
    dea_status status = dea_fail(ctx, DEA_E_INSTRUMENT,
                                 "the guard of the output cannot be made: %s", strerror(errno));
    if (signs != MAP_FAILED) {
      munmap(signs, sizeof *signs);
    }
    dea_free(ctx, made);
    return status;
  }
  *made = (struct dea_guard){.signs = signs, .pipe = ends[1], .turned_s = dea_clock_s()};
  fcntl(ends[1], F_SETFD, FD_CLOEXEC);
  made->process = fork();
  if (made->process == 0) {
    close(ends[1]);
    guard(protocol, section, *supply, signs, ends[0], tell);
    _exit(0);
  }
  close(ends[0]);
  if (made->process < 0) {
    dea_status status = dea_fail(ctx, DEA_E_INSTRUMENT,
                                 "the guard of the output cannot be made: %s", strerror(errno));
    close(ends[1]);
    munmap(signs, sizeof *signs);
    dea_free(ctx, made);
    return status;
  }
  *out = made;
  return DEA_OK;
}

void dea_guard_know(struct dea_guard *guard, const struct dea_instrument *instrument)
{
  if (guard != NULL) {
    memcpy(guard->signs->mark, instrument->mark, sizeof guard->signs->mark);
    memcpy(guard->signs->host, instrument->host, sizeof guard->signs->host);
    atomic_store(&guard->signs->known, true);
  }
}

void dea_guard_doubt(struct dea_guard *guard, const char *doubt)
{
  if (guard != NULL) {
    atomic_store(&guard->signs->doubt, doubt);
  }
}

void dea_guard_limit(struct dea_guard *guard, double silence_s)
{
  if (guard != NULL) {
    atomic_fetch_add(&guard->signs->beats, 1);
    atomic_store(&guard->signs->limit_ms, (unsigned)(1e3 * silence_s));
  }
}

/* Of a silence counts what this process has seen of it, as on the other side. */
static bool is_silent(struct dea_guard *guard)
{
  double now_s = dea_clock_s(), limit_s = 1e-3 * atomic_load(&guard->signs->limit_ms);
  unsigned turns = atomic_load(&guard->signs->turns);
  bool alive = turns != guard->turns || limit_s == 0;
  guard->silent_s = alive ? 0 : guard->silent_s + fmin(now_s - guard->turned_s, 2e-3 * poll_ms);
  guard->turned_s = now_s;
  guard->turns = turns;
  return guard->silent_s > fmax(limit_s, silent_least_s);
}

/* Waits for its end, at most so long, and then ends it: a guard that is stopped would never. One
 * that takes over is left alone: it ends by itself. */
static void reap(struct dea_guard *guard, double within_s)
{
  double until_s = dea_clock_s() + within_s;
  while (!atomic_load(&guard->signs->taken) && waitpid(guard->process, NULL, WNOHANG) == 0) {
    if (dea_clock_s() > until_s) {
      kill(guard->process, SIGKILL);
    }
    dea_clock_wait(again_s / 100);
  }
  guard->process = 0;
}

enum dea_guard_state dea_guard_beat(struct dea_guard *guard)
{
  if (guard == NULL) {
    return DEA_GUARD_WATCHES;
  }
  atomic_fetch_add(&guard->signs->beats, 1);
  if (atomic_load(&guard->signs->taken)) {
    return DEA_GUARD_TAKEN;
  }
  if (guard->process != 0 && waitpid(guard->process, NULL, WNOHANG) != 0) {
    guard->process = 0;
  } else if (guard->process != 0 && is_silent(guard)) {
    reap(guard, 0);
  }
  return guard->process != 0 ? DEA_GUARD_WATCHES : DEA_GUARD_GONE;
}

void dea_guard_end(struct dea_context *ctx, struct dea_guard *guard, bool known)
{
  if (guard == NULL) {
    return;
  }
  struct sigaction ignore = {.sa_handler = SIG_IGN}, before;
  sigaction(SIGPIPE, &ignore, &before);
  (void)!write(guard->pipe, known ? &clean_end : &not_known, 1);
  sigaction(SIGPIPE, &before, NULL);
  close(guard->pipe);
  if (guard->process != 0 && known) {
    reap(guard, last_s);
  }
  munmap(guard->signs, sizeof *guard->signs);
  dea_free(ctx, guard);
}
