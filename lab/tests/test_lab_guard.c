/* dea drive --arm that is killed, crashes, or is stopped: a second process brings the supply to 0
 * V. */
// ctest: supply
#include "supply_drive.h"

TEST(test_killed)
{
  static const int signals[] = {SIGKILL, SIGSEGV, SIGABRT, SIGBUS};
  for (size_t i = 0; i < 4; i++) {
    pid_t child = supply_playing((struct supply){.one_client = i % 2 == 1}, 1000);
    assert_int_equal(kill(child, signals[i]), 0);
    assert_int_equal(supply_wait(child, 5), -signals[i]);
    double took_s = supply_comes_down(&hv, supply_zero_V, 10);
    print_message("signal %d: at 0 V after %.3f s\n", signals[i], took_s);
    assert_true(isfinite(took_s));
    // it was read back: nothing is in the way of the next
    dea_clock_wait(2);
    supply_protocol(&hv, 1, SUPPLY_MEASURES);
    if (supply_wait(supply_arm("next.h5"), 20) != 0) {
      fail_msg("%s%s", command_out, command_err);
    }
    supply_stop(&hv);
  }
}

/* A second program neither arms the supply nor disturbs the first. */
TEST(test_one_supply_one_program)
{
  supply_set_up((struct supply){0}, 5, SUPPLY_MEASURES);
  pid_t first = supply_arm("first.h5");
  assert_true(supply_reaches(&hv, 1000, 60));
  assert_int_equal(supply_wait(supply_arm("second.h5"), 10), 6);
  assert_contains(command_err, "another program drives this supply", "armed by process");
  assert_true(supply_reaches(&hv, 1500, 60));
  assert_int_equal(supply_wait(first, 20), 0);
  assert_true(supply_volts(&hv) <= supply_zero_V);
  supply_stop(&hv);
}

/* By another name, of which nothing is kept: neither driven beside the first one, nor said to be at
 * 0 V when it was told that. */
TEST(test_two_names_of_one_supply)
{
  pid_t first = supply_playing((struct supply){0}, 1000);
  supply_host = "localhost";
  supply_protocol(&hv, 5, SUPPLY_MEASURES);
  assert_int_equal(supply_wait(supply_arm("second.h5"), 10), 6);
  assert_contains(command_err, "is driven by another program on this computer");
  assert_true(supply_reaches(&hv, 1500, 60)); // and the first one plays on
  int code = supply_run_dea(supply_zero, 20);
  assert_true(code == 6 && !supply_said_zero());
  supply_host = "127.0.0.1";
  kill(first, SIGINT);
  (void)supply_wait(first, 20);
  supply_protocol(&hv, 5, SUPPLY_MEASURES);
  // where the first one measured 0 V, which the second name had commanded, before it set its next
  // voltage, that is a doubt until somebody has looked
  if (supply_run_dea(supply_zero, 60) != 0) {
    assert_contains(command_out, "it had measured another voltage than was set");
  } else {
    assert_true(supply_said_zero() && supply_volts(&hv) <= supply_zero_V);
  }
  supply_check_zero(supply_checked);
  supply_stop(&hv);
}

/* The guard is not in the way of a clean end, nor of Ctrl-C of a terminal. */
TEST(test_interrupted)
{
  pid_t child = supply_playing((struct supply){0}, 1000);
  kill(child, SIGINT);
  assert_int_equal(supply_wait(child, 10), 130);
  assert_true(supply_said_zero() && supply_volts(&hv) <= supply_zero_V);
  supply_stop(&hv);
}

/* A program that is stopped gives no sign of life. When it goes on it plays nothing more. */
TEST(test_stopped)
{
  pid_t child = supply_playing((struct supply){0}, 1000);
  kill(child, SIGSTOP);
  double took_s = supply_comes_down(&hv, supply_zero_V, 10);
  print_message("stopped: at 0 V after %.3f s\n", took_s);
  assert_true(isfinite(took_s));
  (void)supply_highest(&hv);
  kill(child, SIGCONT);
  assert_int_equal(supply_wait(child, 20), 6);
  assert_contains(command_err, "its guard has taken over");
  assert_true(supply_highest(&hv) <= supply_zero_V);
  supply_stop(&hv);
}

/* Away for longer than the queue, and back before the guard takes over: the voltage goes on from
 * where it stands, and down along the ramp of 4 kV/s; the waveform is at 2 kV by then. */
TEST(test_stall_is_no_jump)
{
  const char *usual = supply_safety;
  supply_safety = ", guard_time: 20 s";
  pid_t child = supply_playing((struct supply){0}, 1000);
  supply_safety = usual;
  kill(child, SIGSTOP);
  dea_clock_wait(2.25);
  double held_V = supply_volts(&hv), last_V = held_V, fall_V = 0;
  (void)supply_highest(&hv);
  kill(child, SIGCONT);
  for (double until_s = dea_clock_s() + 10; last_V > supply_zero_V && dea_clock_s() < until_s;) {
    dea_clock_wait(0.01);
    double volts = supply_volts(&hv);
    fall_V = fmax(fall_V, last_V - volts);
    last_V = volts;
  }
  assert_int_equal(supply_wait(child, 20), 6);
  double highest_V = supply_highest(&hv);
  print_message("held at %.0f V, then at most %.0f V, falls by %.0f V at most\n", held_V, highest_V,
                fall_V);
  assert_contains(command_err, "longer than the queue");
  assert_true(supply_said_zero());
  assert_true(highest_V <= held_V + 1 && held_V > 900);
  assert_true(fall_V < 0.5 * held_V);
  supply_stop(&hv);
}

/* A guard that is killed or stopped guards nothing: that ends the measurement, along the ramp. */
TEST(test_guard_that_is_gone)
{
  static const int signals[] = {SIGKILL, SIGSTOP};
  for (size_t i = 0; i < 2; i++) {
    pid_t child = supply_playing((struct supply){0}, 1000);
    supply_signal_guard(child, signals[i]);
    assert_int_equal(supply_wait(child, 15), 6);
    assert_contains(command_err, "the guard of the output was killed, or is stopped");
    assert_true(supply_said_zero() && supply_volts(&hv) <= supply_zero_V);
    supply_stop(&hv);
  }
}

/* The computer dies, and the guard with it: the supply's own watchdog is fed while all is well,
 * disarmed at the end, and switches off when nobody feeds it. */
TEST(test_watchdog_of_the_supply)
{
  const char *keys =
      SUPPLY_MEASURES ", watchdog: {arm: WDOG ON, feed: WDOG FEED, disarm: WDOG OFF, "
                      "period: 0.2 s}";
  supply_set_up((struct supply){.watchdog_s = 1.5}, 3, keys);
  assert_int_equal(supply_wait(supply_arm("fed.h5"), 20), 0);
  assert_true(isnan(hv.fed_s));
  supply_protocol(&hv, 20, keys);
  pid_t child = supply_arm("dead.h5");
  assert_true(supply_reaches(&hv, 1000, 60));
  kill(child, SIGSTOP); // it must not notice
  supply_signal_guard(child, SIGKILL);
  kill(child, SIGKILL);
  assert_int_equal(supply_wait(child, 5), -SIGKILL);
  double took_s = supply_comes_down(&hv, supply_zero_V, 10);
  print_message("watchdog: at 0 V after %.3f s\n", took_s);
  assert_true(isfinite(took_s));
  // nobody has read that back
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6);
  assert_contains(command_err, "which did not end");
  supply_stop(&hv);
}

/* Deaf for 8 s, and then it obeys again: the guard, which has gone on after the program's end,
 * brings it to 0 V and says so; the next measurement waits until somebody has looked. */
TEST(test_deaf_for_a_while)
{
  static const struct supply_wrong deaf = {.deaf = true}, good = {0};
  pid_t child = supply_playing((struct supply){0}, 1500);
  supply_go_wrong(&hv, &deaf);
  double deaf_s = dea_clock_s();
  int code = supply_wait(child, 20);
  assert_true(code == 6 && !supply_said_zero() && supply_volts(&hv) > 1000);
  assert_contains(command_err, "switch the supply off; its guard goes on for 10 min");
  dea_clock_wait(deaf_s + 8 - dea_clock_s());
  assert_true(supply_volts(&hv) > 1000);
  supply_go_wrong(&hv, &good);
  double took_s = supply_comes_down(&hv, supply_zero_V, 20);
  print_message("at 0 V %.2f s after it obeys again\n", took_s);
  assert_true(isfinite(took_s));
  for (double until_s = dea_clock_s() + 10; strstr(command_err, "the guard of p.yaml") == NULL ||
                                            strstr(command_err, "(0 V read back") == NULL;) {
    assert_true(dea_clock_s() < until_s);
    command_read("err.txt", command_err);
    dea_clock_wait(0.05);
  }
  assert_int_equal(supply_wait(supply_arm("next.h5"), 30), 6);
  assert_contains(command_err, "did not end at 0 V as far as is known");
  supply_end_guards();
  supply_stop(&hv);
}

/* Another supply in the place of the first, at its address; `there` keeps its voltage. */
static void swap(struct supply *there, struct supply *next)
{
  supply_stop(there);
  next->port = there->port;
  supply_start(next);
}

/* The address is another supply's all at once, which is at 0 V: that says nothing of this one, not
 * to the program, nor to `--zero`, nor to the guard of one that was killed. */
TEST(test_neighbour)
{
  static struct supply neighbour;
  for (int killed = 0; killed < 2; killed++) {
    neighbour = (struct supply){.serial = 2};
    supply_set_up((struct supply){.serial = 1}, 20, SUPPLY_MEASURES);
    pid_t child = supply_begin("drive p.yaml --arm --checked -f -o n.h5");
    assert_true(supply_reaches(&hv, 1000, 60));
    assert_int_equal(killed ? kill(child, SIGSTOP) : 0, 0);
    swap(&hv, &neighbour);
    assert_int_equal(killed ? kill(child, SIGKILL) : 0, 0);
    int code = supply_wait(child, 20);
    print_message("%s: exit code %d, %.0f V\n", killed ? "killed" : "left", code, hv.volts);
    assert_int_equal(code, killed ? -SIGKILL : 6);
    assert_false(supply_said_zero());
    code = supply_run_dea(supply_zero, 20);
    assert_true(code == 6 && !supply_said_zero() && hv.volts > 500 && neighbour.commands > 0);
    assert_contains(command_err, "which the one that is meant would not");
    swap(&neighbour, &hv); // and back
    if (killed) {
      assert_true(
          isfinite(supply_comes_down(&hv, supply_zero_V, 20))); // by the guard, which has gone on
    }
    supply_check_zero(supply_zero);
    supply_stop(&hv);
  }
}

/* Asked for by somebody while it plays: it ends along its ramp, and then the supply is looked at.
 */
TEST(test_zero_while_it_plays)
{
  pid_t child = supply_playing((struct supply){0}, 1000);
  supply_check_zero(supply_zero);
  (void)supply_highest(&hv);
  assert_int_equal(supply_wait(child, 5), 130);
  dea_clock_wait(1);
  assert_true(supply_highest(&hv) <= supply_zero_V);
  supply_stop(&hv);
}

TESTS(command_set_up, supply_tear_down)
