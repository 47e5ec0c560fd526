/* How long the command takes to answer: median wall time of 20 runs, process start included. */
#include "bench.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { RUNS = 20 };

/* Runs argv with its output thrown away; wall time [s]. Ends the program when it fails. */
static double run_once(char *const argv[])
{
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
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
    fprintf(stderr, "bench_startup: %s %s failed\n", argv[0], argv[1]);
    exit(EXIT_FAILURE);
  }
  return time;
}

static void bench_command(const char *name, char *const argv[])
{
  double times[RUNS];
  run_once(argv); // fills the file cache
  for (int i = 0; i < RUNS; i++) {
    times[i] = run_once(argv);
  }
  bench_print(name, 1e3 * bench_median(times, RUNS), "ms");
}

int main(void)
{
  static char command[] = DEA_COMMAND, version[] = "--version", check[] = "check",
              quiet[] = "--quiet", design[] = DEA_SOURCE_DIR "/examples/frdea-4.yaml";
  bench_command("startup.version", (char *[]){command, version, NULL});
  bench_command("startup.check", (char *[]){command, check, quiet, design, NULL});
  return 0;
}
