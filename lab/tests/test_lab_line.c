/* Several programs at one serial line: what drives it, `dea drive --zero`, the guard of a program
 * that died. One at a time speaks, and "at 0 V" is not said while another one may go on. */
// ctest: supply
#include "shvps_supply.h"

/* The machine may be busy, and what is looked at is not how fast they are. */
#define PATIENT ", behind: 3 s"
static const char patient[] = "zero_time: 9 s, guard_time: 2 s";
/* 2 s of 1 kV, then 8 s of 0 V, and in these the program says little. */
static const char pulses[] =
    "kind: square, high: 1 kV, frequency: 0.1 Hz, duty: 0.2, rise_time: 0.3 s, cycles: 3";

static const char triangle[] =
    "kind: triangle, low: 0 kV, high: 2 kV, frequency: 0.25 Hz, cycles: 20";

/* A guard's first word may come before the supply has answered the last one of the dead. */
static const size_t dead = 1;

static void sleep_s(double seconds)
{
  for (double until_s = dea_clock_s() + seconds; dea_clock_s() < until_s;) {
    dea_clock_wait(until_s - dea_clock_s()); // a signal ends it early
  }
}

/* One that plays a waveform, and is above a voltage; the program that drives it. */
static pid_t playing(double volts, const char *waveform, const char *more)
{
  shvps_set_up((struct supply){0});
  shvps_protocol_of(hv.device, waveform, more);
  pid_t child = supply_arm_checked("played.h5");
  assert_true(supply_reaches(&hv, volts, 60));
  return child;
}

/* Asked for between two pulses: the program that plays them ends, and no pulse comes any more. */
TEST(test_zero_between_pulses)
{
  pid_t child = playing(900, pulses, PATIENT ", interval: 60 s");
  assert_true(isfinite(supply_comes_down(&hv, supply_zero_V, 10)));
  (void)supply_highest(&hv);
  supply_check_zero(supply_zero);
  assert_int_equal(supply_wait(child, 40), 130);
  sleep_s(9);
  assert_true(supply_highest(&hv) <= supply_zero_V && hv.hurried == 0);
  command_prints("recording played.h5", 0, "another program (dea drive --zero) asked for 0 V");
  supply_stop(&hv);
}

/* On its way up: along its own ramp, and no command before the last one was answered. */
TEST(test_zero_while_it_plays)
{
  pid_t child = playing(1000, triangle, PATIENT);
  supply_check_zero(supply_zero);
  (void)supply_highest(&hv);
  assert_int_equal(supply_wait(child, 40), 130);
  sleep_s(2);
  assert_true(supply_highest(&hv) <= supply_zero_V && hv.hurried == 0);
  supply_stop(&hv);
}

/* The guard of a program that was killed, and two at once who want 0 V: one after the other. */
TEST(test_guard_and_zero_take_turns)
{
  pid_t child = playing(1000, triangle, PATIENT);
  assert_int_equal(kill(child, SIGKILL), 0);
  pid_t other = supply_begin(supply_zero);
  supply_check_zero(supply_zero);
  assert_int_equal(supply_wait(other, 60), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  assert_true(supply_volts(&hv) <= supply_zero_V && hv.hurried <= dead);
  shvps_protocol(1, 1, PATIENT); // and nothing is left behind
  assert_int_equal(supply_wait(supply_arm("next.h5"), 30), 0);
  supply_stop(&hv);
}

/* A guard that cannot believe what answers, as the supply was switched off and on, gives it to
 * somebody who has looked, and goes. */
TEST(test_guard_gives_the_supply_away)
{
  pid_t child = playing(1000, triangle, PATIENT);
  assert_int_equal(kill(child, SIGSTOP), 0);
  atomic_store(&hv.fault, SUPPLY_RESETS);
  sleep_s(0.1);
  atomic_store(&hv.fault, SUPPLY_GOOD);
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  assert_int_equal(supply_run_dea(supply_zero, 60), 6);
  assert_contains(command_err, "which the supply that is meant would not");
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6); // the guard has it again
  assert_contains(command_err, "another program drives this supply");
  supply_check_zero(supply_checked);
  shvps_protocol(1, 1, PATIENT);
  int code = 6;
  for (double until_s = dea_clock_s() + 20; code != 0 && dea_clock_s() < until_s;) {
    code = supply_wait(supply_arm("next.h5"), 30); // once the guard has seen that it is done
  }
  assert_int_equal(code, 0);
  supply_stop(&hv);
}

/* One that is stopped, and whose guard waits for long, goes on one day: 0 V is commanded, and
 * nothing is said to be at 0 V. */
TEST(test_zero_beside_a_stopped_program)
{
  shvps_safety = "zero_time: 1 s, guard_time: 2 s, longest_ramp: 1 s";
  pid_t child = playing(1000, triangle, PATIENT ", interval: 60 s");
  shvps_safety = patient;
  assert_int_equal(kill(child, SIGSTOP), 0);
  supply_signal_guard(child, SIGKILL); // and its guard is no more
  int code = supply_run_dea(supply_zero, 60);
  assert_true(code == 6 && !supply_said_zero());
  assert_contains(command_err, "is in use by process", "which may set another voltage",
                  "and did not end");
  assert_true(isfinite(supply_comes_down(&hv, supply_zero_V, 5)));
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(kill(child, SIGCONT), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  shvps_protocol_of(hv.device, triangle, PATIENT);
  supply_check_zero(supply_zero);
  supply_stop(&hv);
}

/* Another name of the same line is another supply to who knows only names. */
TEST(test_two_names_of_one_line)
{
  char folder[] = "/tmp/dea-line-XXXXXX", link[64], in_use[64];
  pid_t child = playing(1000, triangle, PATIENT);
  assert_non_null(mkdtemp(folder));
  snprintf(link, sizeof link, "%s/by-id", folder);
  assert_int_equal(symlink(hv.device, link), 0);
  shvps_protocol_of(link, triangle, PATIENT);
  int code = supply_run_dea("drive p.yaml --arm -o second.h5", 30);
  snprintf(in_use, sizeof in_use, "is in use by process %d (dea-lab): end that first", (int)child);
  assert_int_equal(code, 6);
  assert_contains(command_err, in_use);
  assert_true(supply_reaches(&hv, 1500, 60) && hv.hurried == 0); // and the first one plays on
  code = supply_run_dea(supply_zero, 60);
  assert_true(code == 6 && !supply_said_zero());
  assert_contains(command_err, "which may set another voltage");
  code = supply_wait(child, 30);
  assert_true(code == 6 && supply_volts(&hv) <= supply_zero_V);
  assert_true(unlink(link) == 0 && rmdir(folder) == 0);
  supply_stop(&hv);
}

int main(void)
{
  shvps_safety = patient;
  return run_all(command_set_up, supply_tear_down);
}
