/* Wall time of the command as a user starts it. */
#pragma once

#include "timing.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Runs argv with its output thrown away; wall time [s]. Ends the program when it fails. */
static inline double bench_run_once(char *const argv[])
{
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child;
  int status = 0;
  double start = bench_now_s();
  int code = posix_spawn(&child, argv[0], &actions, NULL, argv, environ);
  if (code == 0) {
    waitpid(child, &status, 0);
  }
  double time = bench_now_s() - start;
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    fprintf(stderr, "%s %s failed\n", argv[0], argv[1]);
    exit(EXIT_FAILURE);
  }
  return time;
}

/* Median wall time [ms] of runs of argv, after one that fills the file cache. */
static inline void bench_command(const char *name, char *const argv[], size_t runs)
{
  enum { RUNS_MAX = 100 };
  double times[RUNS_MAX];
  bench_run_once(argv);
  for (size_t i = 0; i < runs && i < RUNS_MAX; i++) {
    times[i] = bench_run_once(argv);
  }
  bench_print(name, 1e3 * bench_median(times, runs), "ms");
}
