/* Several programs at one serial line: what drives it, `dea drive --zero`, the guard of a program
 * that died. One at a time speaks, and "at 0 V" is not said while another one may go on. */
// ctest: supply
#include "shvps_supply.h"

/* The machine may be busy, and what is looked at is not how fast they are. */
#define PATIENT ", behind: 3 s"
static const char patient[] = "zero_time: 9 s, guard_time: 2 s";
static const char *const zero[] = {"drive", "p.yaml", "--zero", NULL};
/* 2 s of 1 kV, then 8 s of 0 V, and in these the program says little. */
static const char pulses[] =
    "kind: square, high: 1 kV, frequency: 0.1 Hz, duty: 0.2, rise_time: 0.3 s, cycles: 3";

static const char triangle[] =
    "kind: triangle, low: 0 kV, high: 2 kV, frequency: 0.25 Hz, cycles: 20";

/* A guard's first word may come before the supply has answered the last one of the dead. */
static const size_t dead = 1;

static bool falls(struct line_supply *s, double within_s)
{
  for (double until_s = dea_clock_s() + within_s; dea_clock_s() < until_s;) {
    if (line_supply_volts(s) <= supply_zero_V) {
      return true;
    }
    dea_clock_wait(0.005);
  }
  return false;
}

static void sleep_s(double seconds)
{
  for (double until_s = dea_clock_s() + seconds; dea_clock_s() < until_s;) {
    dea_clock_wait(until_s - dea_clock_s()); // a signal ends it early
  }
}

static void begin(struct line_supply *s, const char *waveform, const char *more)
{
  *s = (struct line_supply){0};
  shvps_begin(s);
  shvps_protocol_of(s->device, waveform, more);
}

/* Asked for between two pulses: the program that plays them ends, and no pulse comes any more. */
TEST(test_zero_between_pulses)
{
  static struct line_supply s;
  begin(&s, pulses, PATIENT ", interval: 60 s");
  pid_t child = shvps_arm("pulses.h5");
  assert_true(line_supply_reaches(&s, 900, 10) && falls(&s, 10));
  (void)line_supply_highest(&s);
  int code = supply_run_dea(zero, 40);
  if (code != 0 || !supply_said_zero()) {
    fail_msg("exit code %d: %s%s", code, command_out, command_err);
  }
  assert_int_equal(supply_wait(child, 40), 130);
  sleep_s(9);
  assert_true(line_supply_highest(&s) <= supply_zero_V && s.hurried == 0);
  command_prints("recording pulses.h5", 0, "another program (dea drive --zero) asked for 0 V");
  line_supply_stop(&s);
}

/* On its way up: along its own ramp, and no command before the last one was answered. */
TEST(test_zero_while_it_plays)
{
  static struct line_supply s;
  begin(&s, triangle, PATIENT);
  pid_t child = shvps_arm("up.h5");
  assert_true(line_supply_reaches(&s, 1000, 10));
  int code = supply_run_dea(zero, 40);
  if (code != 0 || !supply_said_zero()) {
    fail_msg("exit code %d: %s%s", code, command_out, command_err);
  }
  (void)line_supply_highest(&s);
  assert_int_equal(supply_wait(child, 40), 130);
  sleep_s(2);
  assert_true(line_supply_highest(&s) <= supply_zero_V && s.hurried == 0);
  line_supply_stop(&s);
}

/* The guard of a program that was killed, and two at once who want 0 V: one after the other. */
TEST(test_guard_and_zero_take_turns)
{
  static struct line_supply s;
  begin(&s, triangle, PATIENT);
  pid_t child = shvps_arm("killed.h5");
  assert_true(line_supply_reaches(&s, 1000, 10));
  assert_int_equal(kill(child, SIGKILL), 0);
  pid_t other = supply_begin(zero);
  int code = supply_run_dea(zero, 60);
  if (code != 0 || !supply_said_zero()) {
    fail_msg("exit code %d: %s%s", code, command_out, command_err);
  }
  assert_int_equal(supply_wait(other, 60), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  assert_true(line_supply_volts(&s) <= supply_zero_V && s.hurried <= dead);
  shvps_protocol(&s, 1, 1, PATIENT); // and nothing is left behind
  assert_int_equal(supply_wait(supply_arm("next.h5"), 30), 0);
  line_supply_stop(&s);
}

/* A guard that cannot believe what answers, as the supply was switched off and on, gives it to
 * somebody who has looked, and goes. */
TEST(test_guard_gives_the_supply_away)
{
  static const char *const checked[] = {"drive", "p.yaml", "--zero", "--checked", NULL};
  static struct line_supply s;
  begin(&s, triangle, PATIENT);
  pid_t child = shvps_arm("off.h5");
  assert_true(line_supply_reaches(&s, 1000, 10));
  assert_int_equal(kill(child, SIGSTOP), 0);
  atomic_store(&s.fault, LINE_SUPPLY_RESETS);
  sleep_s(0.1);
  atomic_store(&s.fault, LINE_SUPPLY_GOOD);
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  assert_int_equal(supply_run_dea(zero, 60), 6);
  assert_contains(command_err, "which the supply that is meant would not");
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6); // the guard has it again
  assert_contains(command_err, "another program drives this supply");
  assert_int_equal(supply_run_dea(checked, 60), 0);
  assert_true(supply_said_zero());
  shvps_protocol(&s, 1, 1, PATIENT);
  int code = 6;
  for (double until_s = dea_clock_s() + 20; code != 0 && dea_clock_s() < until_s;) {
    code = supply_wait(supply_arm("next.h5"), 30); // once the guard has seen that it is done
  }
  assert_int_equal(code, 0);
  line_supply_stop(&s);
}

/* One that is stopped, and whose guard waits for long, goes on one day: 0 V is commanded, and
 * nothing is said to be at 0 V. */
TEST(test_zero_beside_a_stopped_program)
{
  static struct line_supply s;
  shvps_safety = "zero_time: 1 s, guard_time: 2 s, longest_ramp: 1 s";
  begin(&s, triangle, PATIENT ", interval: 60 s");
  shvps_safety = patient;
  pid_t child = shvps_arm("stopped.h5");
  assert_true(line_supply_reaches(&s, 1000, 10));
  assert_int_equal(kill(child, SIGSTOP), 0);
  supply_kill_guard(child); // and its guard is no more
  int code = supply_run_dea(zero, 60);
  assert_true(code == 6 && !supply_said_zero());
  assert_contains(command_err, "is in use by process", "which may set another voltage",
                  "and did not end");
  assert_true(falls(&s, 5));
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(kill(child, SIGCONT), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  shvps_protocol_of(s.device, triangle, PATIENT);
  assert_int_equal(supply_run_dea(zero, 60), 0);
  assert_true(supply_said_zero());
  line_supply_stop(&s);
}

/* Another name of the same line is another supply to who knows only names. */
TEST(test_two_names_of_one_line)
{
  static struct line_supply s;
  char folder[] = "/tmp/dea-line-XXXXXX", link[64], in_use[64];
  begin(&s, triangle, PATIENT);
  assert_non_null(mkdtemp(folder));
  snprintf(link, sizeof link, "%s/by-id", folder);
  assert_int_equal(symlink(s.device, link), 0);
  pid_t child = shvps_arm("first.h5");
  assert_true(line_supply_reaches(&s, 1000, 10));
  shvps_protocol_of(link, triangle, PATIENT);
  static const char *const second[] = {"drive", "p.yaml", "--arm", "-o", "second.h5", NULL};
  int code = supply_run_dea(second, 30);
  snprintf(in_use, sizeof in_use, "is in use by process %d (dea-lab): end that first", (int)child);
  assert_int_equal(code, 6);
  assert_contains(command_err, in_use);
  assert_true(line_supply_reaches(&s, 1500, 10) && s.hurried == 0); // and the first one plays on
  code = supply_run_dea(zero, 60);
  assert_true(code == 6 && !supply_said_zero());
  assert_contains(command_err, "which may set another voltage");
  code = supply_wait(child, 30);
  assert_true(code == 6 && line_supply_volts(&s) <= supply_zero_V);
  assert_true(unlink(link) == 0 && rmdir(folder) == 0);
  line_supply_stop(&s);
}

int main(void)
{
  shvps_safety = patient;
  return run_all(command_set_up, supply_tear_down);
}
