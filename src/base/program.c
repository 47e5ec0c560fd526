#define _GNU_SOURCE // posix_spawn_file_actions_addchdir_np, pipe2, environ
#include "base/program.h"

#include "base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static bool actions_make(posix_spawn_file_actions_t *actions, const char *directory, int pipe_end,
                         bool all)
{
  return posix_spawn_file_actions_addopen(actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0) == 0 &&
         (all ? posix_spawn_file_actions_adddup2(actions, pipe_end, STDOUT_FILENO)
              : posix_spawn_file_actions_addopen(actions, STDOUT_FILENO, "/dev/null", O_WRONLY,
                                                 0)) == 0 &&
         posix_spawn_file_actions_adddup2(actions, pipe_end, STDERR_FILENO) == 0 &&
         posix_spawn_file_actions_addchdir_np(actions, directory) == 0;
}

int dea_program_start(char *const argv[], const char *directory, bool all,
                      struct dea_program *program)
{
  posix_spawn_file_actions_t actions;
  int ends[2], reason = posix_spawn_file_actions_init(&actions);
  if (reason != 0) {
    return reason;
  }
  if (pipe2(ends, O_CLOEXEC) != 0) {
    reason = errno;
    posix_spawn_file_actions_destroy(&actions);
    return reason;
  }
  posix_spawnattr_t group; // its own: what it starts ends with it
  reason = posix_spawnattr_init(&group);
  if (reason == 0) {
    reason = actions_make(&actions, directory, ends[1], all) &&
                     posix_spawnattr_setflags(&group, POSIX_SPAWN_SETPGROUP) == 0
                 ? posix_spawnp(&program->process, argv[0], &actions, &group, argv, environ)
                 : ENOMEM;
    posix_spawnattr_destroy(&group);
  }
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (reason != 0) {
    close(ends[0]);
  }
  program->said = ends[0];
  return reason;
}

/* Reads what there is and keeps the last of it; false at its end. */
static bool receive(int pipe_end, char *said, size_t *used)
{
  char more[512];
  ssize_t n = read(pipe_end, more, sizeof more);
  if (n <= 0) {
    return n < 0 && errno == EINTR;
  }
  size_t got = (size_t)n, capacity = DEA_PROGRAM_SAID - 1;
  if (*used + got > capacity) { // the first of it goes
    size_t gone = *used + got - capacity;
    memmove(said, said + gone, *used - gone);
    *used -= gone;
  }
  memcpy(said + *used, more, got);
  *used += got;
  return true;
}

/* Processor time of a process that runs, 0 where that is not known. */
static double processor_time_s(pid_t process)
{
  clockid_t clock;
  struct timespec used;
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0) {
    return 0;
  }
  return (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
}

enum dea_program_end dea_program_wait(const struct dea_context *ctx,
                                      const struct dea_program *program, double limit_s,
                                      char said[DEA_PROGRAM_SAID], int *number)
{
  enum { LOOK_MS = 100 }; // how often the limit and the context are looked at
  enum dea_program_end end = DEA_PROGRAM_DONE;
  static const double clock_share = 10; // of the limit: a program that waits for something
  double start_s = dea_clock_s();
  size_t used = 0;
  for (bool open = true; open;) {
    struct pollfd wait = {.fd = program->said, .events = POLLIN};
    int ready = poll(&wait, 1, LOOK_MS);
    if (ready > 0) {
      open = receive(program->said, said, &used);
    }
    if (end == DEA_PROGRAM_DONE && ctx != NULL && dea_interrupted(ctx)) {
      end = DEA_PROGRAM_INTERRUPTED;
    } else if (end == DEA_PROGRAM_DONE && (processor_time_s(program->process) > limit_s ||
                                           dea_clock_s() - start_s > clock_share * limit_s)) {
      end = DEA_PROGRAM_TOO_LONG;
    }
    if (end != DEA_PROGRAM_DONE) {
      kill(-program->process, SIGKILL);
      break;
    }
  }
  close(program->said);
  while (used > 0 && strchr(" \t\r\n", said[used - 1]) != NULL) {
    used--;
  }
  said[used] = '\0';
  int state = 0;
  while (waitpid(program->process, &state, 0) < 0 && errno == EINTR) {
  }
  *number = WIFEXITED(state) ? WEXITSTATUS(state) : WTERMSIG(state);
  return end != DEA_PROGRAM_DONE ? end
         : !WIFEXITED(state)     ? DEA_PROGRAM_CRASHED
         : *number != 0          ? DEA_PROGRAM_FAILED
                                 : DEA_PROGRAM_DONE;
}

const char *dea_last_lines(const char *text, int lines)
{
  const char *at = text + strlen(text);
  while (at > text) {
    if (at[-1] == '\n' && --lines == 0) {
      break;
    }
    at--;
  }
  return at;
}
