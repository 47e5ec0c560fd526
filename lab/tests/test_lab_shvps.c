/* The open high-voltage supply SHVPS, imitated on a pseudo-terminal: what dea drive plays on it,
 * and what it says of the output when the supply is slow, hangs, lies, makes no sense, begins anew
 * or is pulled out, and when dea itself is killed or stopped. `test_lab_shvps COUNT [SEED]` makes
 * that many runs with a fault at a random moment. */
// ctest: supply
#include "shvps_supply.h"

/* In pieces of 1 to 3 bytes too: a triangle up to 2 kV, whose voltage the recording has. */
TEST(test_plays)
{
  static const char plateau[] = // it may be slow, and is to be seen at the top
      "kind: square, high: 2 kV, rise_time: 1 s, frequency: 0.25 Hz, cycles: 1";
  for (size_t fragment = 0; fragment < 4; fragment += 3) {
    shvps_set_up((struct supply){.fragment = fragment});
    shvps_protocol_of(hv.device, plateau, SHVPS_PATIENT ", channel: supply, name: bench");
    pid_t child = supply_arm_checked("good.h5");
    int code = supply_wait(child, 30);
    if (code != 0) {
      fail_msg("%d\n%s", code, command_err);
    }
    assert_true(supply_said_zero());
    assert_null(strstr(command_err, "zero_time"));
    assert_true(supply_volts(&hv) <= supply_zero_V && hv.mode == 0);
    double highest_V = supply_highest(&hv);
    assert_true(highest_V > 1900 && highest_V <= 2000);
    assert_true(hv.commands > 40 && hv.overflows == 0 && hv.hurried == 0);
    command_prints("recording good.h5 --csv csv --force", 0, "supply");
    assert_contains(command_out, "at 0 V (0 V read back)");
    supply_stop(&hv);
  }
}

static const struct supply_wrong stuck = {.latched = true}, lies = {.frozen = true};
static const struct fault_case {
  enum supply_fault fault;
  const struct supply_wrong *wrong; // instead; what is compared with all that was set
  const char *message;
} faults[] = {
    {SUPPLY_SLOW, NULL, "did not answer"},  {SUPPLY_HANGS, NULL, "did not answer"},
    {SUPPLY_GOOD, &lies, "measures"},       {SUPPLY_GOOD, &stuck, "measures"},
    {SUPPLY_GARBLES, NULL, "answered '"},   {SUPPLY_ERRS, NULL, "answered 'Err' to '"},
    {SUPPLY_RESETS, NULL, "to 'QF' where"}, {SUPPLY_HANGS_UP, NULL, "the connection to the SHVPS"}};
enum { FAULTS = sizeof faults / sizeof faults[0] };

static void fail_as(const struct fault_case *fault)
{
  static const struct supply_wrong nothing = {0};
  supply_go_wrong(&hv, fault->wrong != NULL ? fault->wrong : &nothing);
  atomic_store(&hv.fault, fault->fault);
}

/* Above 1 kV something happens; dea says so, and of the output only what is true. */
TEST(test_faults)
{
  for (size_t i = 0; i < FAULTS; i++) {
    const enum supply_fault fault = faults[i].fault;
    // what is compared with all that was set within `behind` has to be found by a shorter one
    pid_t child = shvps_playing((struct supply){.delay_s = 2},
                                fault == SUPPLY_GOOD ? ", behind: 0.5 s" : SHVPS_PATIENT);
    fail_as(&faults[i]);
    int code = supply_wait(child, 20);
    supply_check_said(code);
    print_message("fault %zu: exit code %d, %s, %.0f V\n", i, code,
                  supply_said_zero() ? "at 0 V" : "not known", supply_volts(&hv));
    assert_int_equal(code, 6);
    assert_contains(command_err, faults[i].message);
    // one that began anew answers, and one that is slow may: all others cannot be believed
    assert_true(supply_said_zero() == (fault == SUPPLY_RESETS) || fault == SUPPLY_SLOW);
    supply_stop(&hv);
  }
}

/* A square wave whose supply stays at 2 kV when 0 V are set, where nothing else is sent for 10 s.
 */
TEST(test_stuck_in_a_pause)
{
  shvps_set_up((struct supply){0});
  const char *const usual = shvps_safety;
  shvps_safety = "zero_time: 3 s, guard_time: 2 s"; // which is a part of what is measured
  shvps_protocol_of(hv.device, "kind: square, low: 0 kV, high: 2 kV, cycles: 1, frequency: 0.05 Hz",
                    ", behind: 0.5 s");
  shvps_safety = usual;
  pid_t child = supply_arm_checked("stuck.h5");
  assert_true(supply_reaches(&hv, 1900, 60));
  double since_s = dea_clock_s();
  supply_go_wrong(&hv, &stuck);
  int code = supply_wait(child, 40);
  double after_s = dea_clock_s() - since_s - 10;
  supply_check_said(code);
  print_message("said %.1f s after 0 V were set\n", after_s);
  assert_int_equal(code, 6);
  assert_contains(command_err, "kV where 0 kV was set");
  assert_true(after_s < 3 + 3); // found, and tried to bring to 0 V for zero_time
  supply_stop(&hv);
}

static void answer_off(struct supply *s, const char *command, char out[SUPPLY_ANSWER])
{
  shvps_answer(s, command, out);
  if (strcmp(command, "QVnow") == 0) {
    snprintf(out, SUPPLY_ANSWER, "%.0f", 1.08 * s->shown_V);
  }
}

/* It reads 8 % too much, on the ramp that this ends with too: that is begun once only. */
TEST(test_ramp_of_one_that_is_off)
{
  shvps_set_up((struct supply){.answer = answer_off});
  shvps_protocol_of(hv.device, "kind: square, low: 0 kV, high: 2 kV, cycles: 1, frequency: 0.01 Hz",
                    ", interval: 10 ms");
  pid_t child = supply_arm_checked("off.h5");
  assert_true(supply_reaches(&hv, 1990, 60));
  assert_int_equal(supply_wait(child, 40), 6);
  assert_contains(command_err, "off by more than safety.readback_error");
  if (!supply_said_zero()) {
    fail_msg("%s%s", command_out, command_err);
  }
  const char *ended = strstr(command_err, "ended after ");
  assert_non_null(ended);
  double played_s = strtod(ended + strlen("ended after "), NULL);
  print_message("ended after %g s\n", played_s);
  assert_true(played_s > 4.5 && played_s < 9); // none of its 5 s is taken off again and again
  supply_stop(&hv);
}

/* Its reading stands at 0 V while the output moves: what it reads back at the end says nothing. */
TEST(test_lie_from_the_start)
{
  shvps_set_up((struct supply){.slew_V_per_s = 500});
  shvps_protocol(2, 20, ", behind: 0.5 s");
  pid_t child = supply_arm_checked("lie.h5");
  assert_true(supply_reaches(&hv, 5, 60));
  supply_go_wrong(&hv, &lies);
  int code = supply_wait(child, 20);
  supply_check_said(code);
  assert_int_equal(code, 6);
  assert_contains(command_err, "measures 0");
  assert_false(supply_said_zero());
  assert_contains(command_out, "it had measured another voltage than was set)");
  supply_stop(&hv);
}

/* Another supply at 0 V gets the name of the line. */
static struct supply neighbour;
static char neighbour_folder[] = "/tmp/dea-line-XXXXXX", line[64];

static void put_at_line(const char *device)
{
  char next[80];
  snprintf(next, sizeof next, "%s.next", line);
  assert_int_equal(symlink(device, next), 0);
  assert_int_equal(rename(next, line), 0);
}

/* A supply that is driven by a name of its line, and the other one. */
static pid_t begin_beside(char own[64])
{
  neighbour = (struct supply){0};
  shvps_set_up(neighbour);
  shvps_begin(&neighbour);
  memcpy(strchr(neighbour_folder, '-') + 6, "XXXXXX", 6);
  assert_non_null(mkdtemp(neighbour_folder));
  snprintf(line, sizeof line, "%s/line", neighbour_folder);
  snprintf(own, sizeof hv.device, "%s", hv.device);
  put_at_line(own);
  snprintf(hv.device, sizeof hv.device, "%s", line);
  shvps_protocol(2, 20, ", behind: 0.5 s");
  pid_t child = supply_arm_checked("beside.h5");
  assert_true(supply_reaches(&hv, 1000, 60));
  return child;
}

static void end_beside(void)
{
  supply_stop(&hv);
  supply_stop(&neighbour);
  assert_true(unlink(line) == 0 && rmdir(neighbour_folder) == 0);
}

/* Pulled out, and what the other one reads back says nothing of this one. */
TEST(test_neighbour)
{
  char own[64];
  pid_t child = begin_beside(own);
  put_at_line(neighbour.device);
  atomic_store(&hv.fault, SUPPLY_HANGS_UP);
  int code = supply_wait(child, 20);
  supply_check_said(code);
  assert_int_equal(code, 6);
  assert_true(neighbour.commands > 0 && supply_volts(&hv) > 500);
  assert_false(supply_said_zero());
  end_beside();
}

/* The line's name is another supply's when the program is killed: neither its guard nor --zero take
 * the other one's 0 V for this one's; `--checked` says that somebody has looked. */
TEST(test_neighbour_of_the_guard)
{
  char own[64];
  pid_t child = begin_beside(own);
  assert_int_equal(kill(child, SIGSTOP), 0);
  put_at_line(neighbour.device);
  assert_int_equal(kill(child, SIGKILL), 0);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  assert_int_equal(supply_run_dea(supply_zero, 40), 6);
  assert_false(supply_said_zero());
  assert_contains(command_err, "which the supply that is meant would not");
  assert_true(neighbour.commands > 0 && supply_volts(&hv) > 500);
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6); // the guard has not given up
  assert_contains(command_err, "another program drives this supply");
  put_at_line(own);
  (void)supply_comes_down(&hv, supply_zero_V, 15);
  supply_check_zero(supply_zero);
  // one that was switched off and on has lost its mark; somebody has looked, but not at its name
  shvps_protocol(2, 20, SHVPS_PATIENT ", name: rack");
  assert_int_equal(supply_run_dea(supply_checked, 20), 6);
  assert_contains(command_err, "answers 'bench 5', which the supply that is meant would not");
  end_beside();
}

/* One that hung was switched off and on: its mark is gone, so that --zero believes it only with
 * somebody's word that they have looked. */
TEST(test_zero_after_a_new_beginning)
{
  pid_t child = shvps_playing((struct supply){0}, ", behind: 0.5 s");
  atomic_store(&hv.fault, SUPPLY_HANGS);
  assert_int_equal(supply_wait(child, 20), 6);
  atomic_store(&hv.fault, SUPPLY_RESETS);
  dea_clock_wait(0.1);
  atomic_store(&hv.fault, SUPPLY_GOOD);
  assert_int_equal(supply_run_dea(supply_zero, 20), 6);
  assert_contains(command_err, "then --zero --checked says that you have");
  supply_check_zero(supply_checked);
  supply_stop(&hv);
}

static size_t run_count = 3;
static unsigned first_seed = 1;

static double uniform(unsigned *seed, double from, double to)
{
  return from + (to - from) * rand_r(seed) / RAND_MAX;
}

/* At any moment from the start on, for good or for a while: what is said is true. */
TEST(test_faults_at_random_moments)
{
  for (size_t i = 0; i < run_count; i++) {
    unsigned seed = 2654435761U * (first_seed + (unsigned)i); // neighbours are alike otherwise
    size_t fault = (size_t)uniform(&seed, 0, FAULTS - 1e-6);
    double after_s = uniform(&seed, 0, 5), lasts_s = uniform(&seed, 0.05, 6);
    shvps_set_up((struct supply){.delay_s = uniform(&seed, 0.2, 3),
                                 .slew_V_per_s = uniform(&seed, 0, 1) < 0.5 ? 100e3 : 2e3,
                                 .fragment = (size_t)uniform(&seed, 0, 4)});
    shvps_protocol(2, 1, ", behind: 0.5 s");
    pid_t child = supply_arm_checked("random.h5");
    dea_clock_wait(after_s);
    fail_as(&faults[fault]);
    if (uniform(&seed, 0, 1) < 0.5 && faults[fault].fault != SUPPLY_HANGS_UP) {
      dea_clock_wait(lasts_s);
      fail_as(&(const struct fault_case){0});
    }
    int code = supply_wait(child, 40);
    print_message("seed %u: fault %zu after %.2f s, exit code %d, %s, %.0f V\n",
                  first_seed + (unsigned)i, fault, after_s, code,
                  supply_said_zero() ? "at 0 V" : "not known", supply_volts(&hv));
    assert_true(code >= 0 && code != SUPPLY_NO_DEA);
    supply_check_said(code);
    supply_stop(&hv);
  }
}

/* What was left up is known by the next program, and ends with a supply that answers. */
TEST(test_zero)
{
  pid_t child = shvps_playing((struct supply){0}, SHVPS_PATIENT);
  atomic_store(&hv.fault, SUPPLY_HANGS);
  assert_int_equal(supply_wait(child, 20), 6);
  assert_int_equal(supply_run_dea(supply_zero, 20), 6);
  assert_contains(command_out, "not known to be at 0 V");
  assert_true(supply_volts(&hv) > 500);
  atomic_store(&hv.fault, SUPPLY_GOOD);
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6);
  assert_contains(command_err, "did not end at 0 V as far as is known");
  assert_int_equal(supply_run_dea(supply_zero, 20), 0);
  assert_contains(command_out, "output            at 0 V (0 V read back)");
  assert_true(supply_volts(&hv) <= supply_zero_V);
  supply_stop(&hv);
}

/* The guard opens the line by itself. */
TEST(test_killed_and_stopped)
{
  static const int signals[] = {SIGKILL, SIGSTOP};
  for (size_t i = 0; i < 2; i++) {
    pid_t child = shvps_playing((struct supply){0}, SHVPS_PATIENT);
    assert_int_equal(kill(child, signals[i]), 0);
    (void)supply_comes_down(&hv, supply_zero_V, 10);
    dea_clock_wait(2); // until it was read back
    (void)supply_highest(&hv);
    assert_int_equal(kill(child, SIGCONT), 0);
    assert_int_equal(supply_wait(child, 20), signals[i] == SIGKILL ? -SIGKILL : 6);
    assert_true(supply_highest(&hv) <= supply_zero_V);
    supply_stop(&hv);
  }
}

/* Refused before any voltage: more than it says that it gives, another one, a negative sign. */
TEST(test_refused)
{
  shvps_set_up((struct supply){0});
  shvps_protocol(3, 1, SHVPS_PATIENT);
  assert_int_equal(supply_wait(supply_arm_checked("r.h5"), 20), 6);
  assert_contains(command_err, "the sequence goes to 3 kV, and the SHVPS at /dev/",
                  "says that it gives 2.5 kV at most");
  shvps_protocol(2, 1, SHVPS_PATIENT ", name: rack");
  assert_int_equal(supply_wait(supply_arm_checked("r.h5"), 20), 6);
  assert_contains(command_err, "is a 'bench 5', not a 'rack'");
  shvps_protocol(2, 1, SHVPS_PATIENT);
  assert_int_equal(supply_run_dea("drive p.yaml --arm -o r.h5 --set 'amplifier.max_voltage=10 kV' "
                                  "--set 'safety.at_zero=90 V'",
                                  20),
                   6);
  assert_contains(command_err,
                  "safety.at_zero calls 90 V 0 V, and of the 2.5 kV that the SHVPS at");
  assert_true(supply_highest(&hv) == 0);
  assert_int_equal(supply_run_dea("drive p.yaml --set 'amplifier.min_voltage=-5 kV'", 20), 3);
  assert_contains(command_err, "this supply gives one sign only");
  supply_stop(&hv);
}

/* Said before anything is played: a time in which 0 V cannot be seen to stay. */
TEST(test_too_short_for_zero)
{
  shvps_set_up((struct supply){0});
  shvps_protocol(2, 1, ", behind: 4 s");
  assert_int_equal(supply_run_dea("drive p.yaml", 20), 0);
  assert_contains(command_err, "p.yaml:7:",
                  "a late answer leaves it not known to be at 0 V; write zero_time: 16 s");
  assert_int_equal(supply_run_dea("drive p.yaml --set 'safety.zero_time=4 s'", 20), 0);
  assert_contains(command_err, "it will never be known to be at 0 V; write zero_time: 16 s");
  assert_int_equal(supply_run_dea("drive p.yaml --set 'safety.zero_time=16 s'", 20), 0);
  assert_null(strstr(command_err, "zero_time"));
  supply_stop(&hv);
}

int main(int count, char **arguments)
{
  const struct CMUnitTest many[] = {cmocka_unit_test(test_faults_at_random_moments)};
  if (count > 1) {
    run_count = (size_t)strtoul(arguments[1], NULL, 10);
    first_seed = count > 2 ? (unsigned)strtoul(arguments[2], NULL, 10) : 1;
    return cmocka_run_group_tests(many, command_set_up, supply_tear_down);
  }
  return run_all(command_set_up, supply_tear_down);
}
