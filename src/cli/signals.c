/* What may end a command before it is done, and the progress that it shows meanwhile. */
#define _XOPEN_SOURCE 700 // sigaction, SIGVTALRM
#include "cli/cli.h"

#include <poll.h>
#include <signal.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static volatile sig_atomic_t interrupt_flag, voltage_flag;

static void on_signal(int number)
{
  if (interrupt_flag != 0 && voltage_flag == 0) {
    _exit(128 + number); // a second one: the user means it
  }
  interrupt_flag = 1;
}

/* Whether a line can be written to stderr without waiting: a terminal that is held (Ctrl-S, a
 * connection that is gone) would keep the loop from playing, and the output at its voltage. */
static bool has_room(void)
{
  struct pollfd entry = {.fd = STDERR_FILENO, .events = POLLOUT};
  return poll(&entry, 1, 0) > 0 && (entry.revents & POLLOUT) != 0;
}

static double now_s(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ", 0:41, 1:10 left" after a second of work, "" before. A part begins where the one before it was
 * last heard of. */
static void add_times(struct dea_cli *cli, const char *what, size_t done, size_t total,
                      char out[64])
{
  double now = now_s();
  if (strncmp(cli->progress.what, what, sizeof cli->progress.what - 1) != 0) {
    snprintf(cli->progress.what, sizeof cli->progress.what, "%s", what);
    cli->progress.began_s = cli->progress.last_s;
  }
  cli->progress.last_s = now;
  double gone = now - cli->progress.began_s;
  double left = done > 0 ? gone * ((double)total / (double)done - 1) : 0;
  out[0] = '\0';
  if (gone >= 1 && gone < 1e6 && left < 1e6) {
    int length = snprintf(out, 64, ", %d:%02d", (int)gone / 60, (int)gone % 60);
    if (done < total) {
      snprintf(out + length, 64 - (size_t)length, ", %d:%02d left", (int)left / 60, (int)left % 60);
    }
  }
}

/* One line that is rewritten on a terminal, a plain line otherwise. */
static void show_progress(void *user, const char *what, size_t done, size_t total)
{
  struct dea_cli *cli = user;
  char times[64], count[48];
  add_times(cli, what, done, total, times);
  snprintf(count, sizeof count, total > 0 ? "%zu/%zu" : "%zu", done, total);
  if (cli->quiet || (voltage_flag != 0 && !has_room())) {
    return;
  }
  if (cli->terminal) {
    cli->progress.open = done != total;
    fprintf(stderr, "\r\033[K%s %s%s%s", what, count, times, done == total ? "\n" : "");
    fflush(stderr);
  } else if (done == total) {
    fprintf(stderr, "%s %s%s\n", what, count, times);
  }
}

void cli_progress_clear(struct dea_cli *cli)
{
  if (cli->progress.open) {
    fputs("\r\033[K\r", stderr);
    cli->progress.open = false;
  }
}

void cli_watch(struct dea_cli *cli)
{
  cli->progress.last_s = now_s();
  dea_context_set_progress(cli->ctx, show_progress, cli);
  dea_context_set_interrupt(cli->ctx, &interrupt_flag);
  struct sigaction action = {.sa_handler = on_signal};
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN); // a file that is too long is an error to write
}

void cli_voltage_is_on(void)
{
  // The terminal is closed, limits of time, what batch systems and timers send: all would end the
  // program at once.
  static const int outcome[] = {SIGHUP,  SIGQUIT, SIGALRM,   SIGUSR1,
                                SIGUSR2, SIGXCPU, SIGVTALRM, SIGPROF};
  static const int ignored[] = {SIGTSTP, SIGTTOU, SIGTTIN}; // it would leave the voltage on
  struct sigaction action = {.sa_handler = on_signal}, before;
  sigemptyset(&action.sa_mask);
  voltage_flag = 1;
  for (size_t i = 0; i < sizeof outcome / sizeof outcome[0]; i++) {
    // what was ignored before stays so: `nohup` asks for it
    if (sigaction(outcome[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN) {
      sigaction(outcome[i], &action, NULL);
    }
  }
  for (size_t i = 0; i < sizeof ignored / sizeof ignored[0]; i++) {
    signal(ignored[i], SIG_IGN);
  }
}
