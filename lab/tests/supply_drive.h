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

enum { SUPPLY_NO_DEA = 127 }; // exit code, of the shell too

#define SUPPLY_MEASURES ", measure: \"MEAS:VOLT?\""

static const char *supply_host = "127.0.0.1";

/* Longer times than usual, as the machine may be busy. Writes p.yaml: a triangle of 0 to 2 kV,
 * `seconds` cycles of 1 s. more: keys of the supply. */
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

/* The only child of a process, if it has one: of a program that drives, its guard; of the test, the
 * guard that went on after the end of its program. 0: none. */
static inline pid_t supply_child_of(pid_t parent)
{
  char path[64];
  int child = 0;
  snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)parent, (int)parent);
  FILE *file = fopen(path, "r");
  if (file != NULL) {
    child = fscanf(file, "%d", &child) == 1 ? child : 0;
    fclose(file);
  }
  return child;
}

/* Ends the guards that went on, which write no more to a line or a port whose name another has. */
static inline void supply_end_guards(void)
{
  for (pid_t child; (child = supply_child_of(getpid())) > 0;) {
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
  }
}

static struct supply hv; // the one that is driven

static inline int supply_tear_down(void **state)
{
  supply_end_guards();
  if (hv.started) { // where a check failed
    supply_stop(&hv);
  }
  return command_tear_down(state);
}

/* Starts dea in a folder with arguments as a shell reads them; what it says goes to out.txt and
 * err.txt there. */
static inline pid_t supply_begin_in(const char *in, const char *arguments)
{
  char state[600], text[1000];
  snprintf(state, sizeof state, "%s/state", in);
  snprintf(text, sizeof text, "exec '%s' %s >out.txt 2>err.txt", DEA_COMMAND, arguments);
  prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0);
  fflush(NULL);
  pid_t child = fork();
  assert_true(child >= 0);
  if (child == 0) {
    setenv("XDG_STATE_HOME", state, 1);
    if (chdir(in) == 0) {
      execl("/bin/sh", "sh", "-c", text, (char *)NULL);
    }
    _exit(SUPPLY_NO_DEA);
  }
  return child;
}

static inline pid_t supply_begin(const char *arguments)
{
  return supply_begin_in(command_folder, arguments);
}

static inline pid_t supply_arm(const char *file)
{
  char text[64];
  snprintf(text, sizeof text, "drive p.yaml --arm -f -o %s", file);
  return supply_begin(text);
}

/* Whatever the one before has left: a line may have the name of another. */
static inline pid_t supply_arm_checked(const char *file)
{
  char text[64];
  snprintf(text, sizeof text, "drive p.yaml --arm --checked -f -o %s", file);
  supply_end_guards();
  return supply_begin(text);
}

/* Starts it as told, with a protocol for it. */
static inline void supply_set_up(struct supply as, int seconds, const char *more)
{
  hv = as;
  supply_start(&hv);
  supply_protocol(&hv, seconds, more);
}

/* It plays the usual protocol, and is above a voltage; the program that drives it. */
static inline pid_t supply_playing(struct supply as, double volts)
{
  supply_set_up(as, 20, SUPPLY_MEASURES);
  pid_t child = supply_arm("played.h5");
  assert_true(supply_reaches(&hv, volts, 60));
  return child;
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

static inline int supply_run_dea(const char *arguments, double within_s)
{
  return supply_wait(supply_begin(arguments), within_s);
}

static inline void supply_signal_guard(pid_t parent, int number)
{
  pid_t guard = supply_child_of(parent);
  assert_true(guard > 0 && kill(guard, number) == 0);
}

/* What dea says of the output, from the line of its report. */
static inline bool supply_said_zero(void)
{
  return strstr(command_out, "output            at 0 V") != NULL;
}

/* 0 V is asked for, also with the word of somebody who has looked. */
static const char supply_zero[] = "drive p.yaml --zero",
                  supply_checked[] = "drive p.yaml --zero --checked";

static inline void supply_check_zero(const char *arguments)
{
  int code = supply_run_dea(arguments, 60);
  if (code != 0 || !supply_said_zero() || supply_volts(&hv) > supply_zero_V) {
    fail_msg("exit code %d, %.0f V: %s%s", code, supply_volts(&hv), command_out, command_err);
  }
}

/* Whether the supply was at 0 V when dea said so, and stayed there. */
static inline void supply_check_said(int code)
{
  double volts = supply_volts(&hv);
  (void)supply_highest(&hv);
  dea_clock_wait(2); // what it has in its queue
  double later_V = supply_highest(&hv);
  if (supply_said_zero() && !(volts <= supply_zero_V && later_V <= supply_zero_V)) {
    fail_msg("'at 0 V' and exit code %d, with %.0f V at the end and %.0f V later", code, volts,
             later_V);
  }
}
