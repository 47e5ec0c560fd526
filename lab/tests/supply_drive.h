/* `dea drive --arm` on an imitated supply, as a process of its own that a test can stop and kill.
 */
#pragma once

#include "command.h"
#include "fake_supply.h"

#include <signal.h>
#include <stdbool.h>
#include <sys/prctl.h>
#include <sys/wait.h>

/* Volts that are 0 V for these tests and in their protocols. */
static const double supply_zero_V = 20;

/* More keys of `safety`. */
static const char *supply_safety = ", guard_time: 2 s";

#define SUPPLY_MEASURES ", measure: \"MEAS:VOLT?\""

/* Longer times than usual, as the machine may be busy. Writes p.yaml: a triangle of 0 to 2 kV,
 * `seconds` cycles of 1 s. more: keys of the supply. */
static const char *supply_host = "127.0.0.1";

static inline void supply_protocol(const struct supply *s, int seconds, const char *more)
{
  char text[2048];
  snprintf(text, sizeof text,
           "dea-protocol: 1\n"
           "waveform: {kind: triangle, low: 0 kV, high: 2 kV, cycles: %d, frequency: 1 Hz}\n"
           "amplifier: {gain: 1000, max_voltage: 5 kV}\n"
           "rate: 100 Hz\n"
           "safety: {ramp: 4 kV/s, voltage_error: 300 V, at_zero: %g V, zero_time: 4 s%s}\n"
           "instruments:\n"
           "  - {kind: scpi, address: %s, port: %d, timeout: 1 s, setup: [OUTP ON],\n"
           "     output: \"VOLT %%g\", output_factor: 1000, output_off: OUTP OFF,\n"
           "     queue: 1 s, behind: 1 s%s}\n",
           seconds, supply_zero_V, supply_safety, supply_host, s->port, more);
  command_write("p.yaml", text);
}

/* Ends the guards that went on after the end of their programs, which are children of the test
 * then; `but`: of them; 0: all. What they would do is not done any more. */
static inline void supply_end_guards(pid_t but)
{
  char path[64];
  int child;
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)getpid(), (int)getpid());
  FILE *file = fopen(path, "r");
  while (file != NULL && fscanf(file, "%d", &child) == 1) {
    if (child != but && kill(child, SIGKILL) == 0) {
      waitpid(child, NULL, 0);
    }
  }
  if (file != NULL) {
    fclose(file);
  }
}

static inline int supply_tear_down(void **state)
{
  supply_end_guards(0);
  return command_tear_down(state);
}

/* Starts dea with these arguments, at most 11 and a NULL; what it says goes to out.txt, err.txt. */
static inline pid_t supply_begin(const char *const *arguments)
{
  char state[600];
  char *all[16] = {"dea"};
  size_t n = 1;
  while (arguments[n - 1] != NULL && n < 15) {
    all[n] = (char *)arguments[n - 1];
    n++;
  }
  snprintf(state, sizeof state, "%s/state", command_folder);
  prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    setenv("XDG_STATE_HOME", state, 1);
    if (chdir(command_folder) != 0 || freopen("out.txt", "w", stdout) == NULL ||
        freopen("err.txt", "w", stderr) == NULL) {
      _exit(99);
    }
    execv(DEA_COMMAND, all);
    _exit(98);
  }
  return child;
}

static inline pid_t supply_arm(const char *file)
{
  const char *const arguments[] = {"drive", "p.yaml", "--arm", "-f", "-o", file, NULL};
  return supply_begin(arguments);
}

/* Waits for the end; the exit code, or -(signal). Reads what was said. */
static inline int supply_wait(pid_t child, double within_s)
{
  int status = 0;
  double until_s = dea_clock_s() + within_s;
  pid_t ended;
  while ((ended = waitpid(child, &status, WNOHANG)) == 0 && dea_clock_s() < until_s) {
    dea_clock_wait(0.005);
  }
  if (ended != child) {
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    fail_msg("dea did not end within %g s", within_s);
  }
  command_read("out.txt", command_out);
  command_read("err.txt", command_err);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

static inline int supply_run_dea(const char *const *arguments, double within_s)
{
  return supply_wait(supply_begin(arguments), within_s);
}

/* Sends a signal to the one child of a program that drives: its guard. */
static inline void supply_signal_guard(pid_t parent, int number)
{
  char path[64];
  int child;
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
  FILE *file = fopen(path, "r");
  if (file == NULL) {
    skip(); // a kernel without that list
  }
  size_t sent = 0;
  while (fscanf(file, "%d", &child) == 1) {
    sent += kill(child, number) == 0;
  }
  fclose(file);
  assert_int_equal(sent, 1);
}

static inline void supply_kill_guard(pid_t parent)
{
  supply_signal_guard(parent, SIGKILL);
}

/* What dea says of the output, from the line of its report. */
static inline bool supply_said_zero(void)
{
  return strstr(command_out, "output            at 0 V") != NULL;
}
