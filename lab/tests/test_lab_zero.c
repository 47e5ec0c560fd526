/* "At 0 V" is said of what was read back and of nothing else, and what is not known stays known as
 * that: dea drive on an imitated supply that is slow, hangs, lies, or cannot be read. */
// ctest: supply
#include "supply_drive.h"

/* Commands that take 0.4 s each, which are sent every 20 ms: a queue that grows. */
TEST(test_slow_supply)
{
  supply_set_up((struct supply){.delay_s = 0.4, .fault = SUPPLY_SLOW}, 3, SUPPLY_MEASURES);
  int code = supply_wait(supply_arm("slow.h5"), 30);
  supply_check_said(code);
  assert_true(code == 0 ? supply_said_zero() : code == 6);
  supply_stop(&hv);
}

/* Begins, and lets the fault come once the supply is above a voltage; the exit code. */
static int fault_above(const char *file, double volts, enum supply_fault fault)
{
  pid_t child = supply_arm(file);
  assert_true(supply_reaches(&hv, volts, 60));
  atomic_store(&hv.fault, fault);
  return supply_wait(child, 20);
}

/* The output stays up: that is not known, is said, is kept, and ends with a supply that answers. */
TEST(test_hung_supply)
{
  supply_set_up((struct supply){0}, 5, SUPPLY_MEASURES);
  int code = fault_above("hung.h5", 500, SUPPLY_HANGS);
  assert_true(supply_volts(&hv) > 400); // it is so
  assert_int_equal(code, 6);
  assert_contains(command_out, "SWITCH THE SUPPLY OFF: it is not known to be at 0 V");
  assert_contains(command_err, "did not answer '*OPC?' within 1 s",
                  "not known to be at 0 V (no answer that can be believed): switch the "
                  "supply off");
  command_prints("recording hung.h5", 0, "output         not known to be at 0 V (no answer");
  // the next program knows, while the supply hangs and afterwards
  assert_int_equal(supply_run_dea(supply_zero, 20), 6);
  assert_contains(command_out, "not known to be at 0 V");
  atomic_store(&hv.fault, SUPPLY_GOOD);
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 6);
  assert_contains(command_err, "did not end at 0 V as far as is known");
  assert_int_equal(supply_run_dea(supply_zero, 20), 0);
  assert_contains(command_out, "output            at 0 V (0 V read back)");
  assert_true(supply_volts(&hv) <= supply_zero_V);
  supply_protocol(&hv, 1, SUPPLY_MEASURES);
  assert_int_equal(supply_wait(supply_arm("next.h5"), 20), 0);
  assert_true(supply_said_zero());
  command_prints("recording next.h5", 0, "output         at 0 V (0 V read back)");
  supply_stop(&hv);
}

/* One that lies is found out by its voltage, one that makes no sense or hangs up is not believed.
 */
TEST(test_other_faults)
{
  static const enum supply_fault faults[] = {SUPPLY_LIES, SUPPLY_GARBLES, SUPPLY_HANGS_UP};
  for (size_t i = 0; i < 3; i++) {
    supply_set_up((struct supply){.delay_s = 0.4}, 5, SUPPLY_MEASURES);
    int code = fault_above("other.h5", 500, faults[i]);
    supply_check_said(code);
    assert_int_equal(code, 6);
    assert_false(supply_said_zero());
    supply_stop(&hv);
  }
}

/* Its meter shows 0 V from the start, and its output stays where it was at 1 kV: that is not known
 * to be at 0 V, to `--zero` neither, until somebody says that they have looked. */
TEST(test_meter_that_shows_0_V)
{
  static const struct supply_wrong blind = {.blind = true},
                                   stays = {.blind = true, .latched = true}, good = {0};
  supply_set_up((struct supply){.wrong = blind}, 12, SUPPLY_MEASURES);
  pid_t child = supply_arm("blind.h5");
  assert_true(supply_reaches(&hv, 1000, 60));
  supply_go_wrong(&hv, &stays);
  int code = supply_wait(child, 30);
  assert_true(supply_volts(&hv) > 900);
  assert_int_equal(code, 6);
  assert_false(supply_said_zero());
  assert_contains(command_out, "(0 V read back; it had measured another voltage than was set)");
  assert_contains(command_err, "its guard goes on for 10 min");
  assert_int_equal(supply_run_dea(supply_zero, 20), 6);
  assert_false(supply_said_zero());
  supply_go_wrong(&hv, &good);
  supply_check_zero(supply_checked);
  supply_end_guards();
  supply_stop(&hv);
}

/* What cannot be read back is commanded, and never "at 0 V". */
TEST(test_without_measure)
{
  supply_set_up((struct supply){0}, 1, "");
  assert_int_equal(supply_wait(supply_arm("blind.h5"), 20), 0);
  assert_false(supply_said_zero());
  assert_contains(command_out, "output            commanded to 0 V, not read back");
  assert_contains(command_err, "has no 'measure'");
  supply_stop(&hv);
}

/* A supply that was left at 2 kV, and a protocol for it. */
static void left_up(struct supply as)
{
  as.on = true;
  as.set_V = 2000;
  supply_set_up(as, 1, SUPPLY_MEASURES);
  assert_true(supply_reaches(&hv, 1900, 60));
}

/* One that does not obey, and answers its 2 kV in words that begin with "2". */
TEST(test_other_words_for_volts)
{
  static const struct {
    const char *behind;
    bool comma;
  } words[] = {{" kV", false}, {"E+03", true},   {" E+03", false},
               {" V", true},   {";2000", false}, {"\r2000", false}};
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    left_up(
        (struct supply){.wrong.deaf = true, .behind = words[i].behind, .comma = words[i].comma});
    int code = supply_run_dea(supply_zero, 20);
    assert_true(code == 6 && !supply_said_zero() && supply_volts(&hv) > 1900);
    supply_stop(&hv);
  }
}

/* A protocol that calls anything 0 V: `--arm` refuses it, and `--zero` believes it no more. */
TEST(test_much_that_is_called_zero)
{
  left_up((struct supply){.wrong.deaf = true});
  assert_int_equal(supply_run_dea("drive p.yaml --zero --set 'safety.at_zero=9 kV'", 20), 6);
  assert_contains(command_out, "not known to be at 0 V (2e+03 V read back)");
  // more than gain and control voltage make
  assert_int_equal(supply_run_dea("drive p.yaml --arm --set 'safety.at_zero=9 kV' --set "
                                  "'amplifier.max_voltage=1 MV'",
                                  20),
                   6);
  assert_contains(command_err, "refused: 9000 V would be called 0 V; at most 100 V are");
  supply_stop(&hv);
}

/* 0 V does not wait for what the film would do, nor for a design that is there, for a specimen's
 * file, or that of a waveform. */
TEST(test_zero_without_other_files)
{
  char text[4096];
  left_up((struct supply){0});
  supply_check_zero("drive p.yaml --zero --set design=no.yaml");
  supply_stop(&hv);
  left_up((struct supply){0});
  supply_check_zero("drive p.yaml --zero --set 'waveform={kind: table, file: gone.csv}'");
  command_read("p.yaml", command_out);
  snprintf(text, sizeof text, "%.4000sspecimen: gone.yaml\n", command_out);
  command_write("p.yaml", text);
  supply_check_zero(supply_zero);
  supply_stop(&hv);
}

/* It hangs while another instrument is waited for: nothing is played, and that it is not known to
 * be at 0 V is said all the same. */
TEST(test_hangs_before_anything_is_played)
{
  static struct supply mute;
  char more[200];
  mute = (struct supply){.fault = SUPPLY_HANGS};
  supply_start(&mute);
  snprintf(more, sizeof more,
           SUPPLY_MEASURES "}\n  - {kind: scpi, address: 127.0.0.1, port: %d, timeout: 3 s, "
                           "readings: [{name: a, query: \"A?\", quantity: current}]",
           mute.port);
  supply_set_up((struct supply){0}, 1, more);
  pid_t child = supply_arm("none.h5");
  for (double until_s = dea_clock_s() + 10; !supply_is_on(&hv) && dea_clock_s() < until_s;) {
    dea_clock_wait(0.01);
  }
  dea_clock_wait(0.5);
  atomic_store(&hv.fault, SUPPLY_HANGS);
  assert_int_equal(supply_wait(child, 20), 6);
  assert_contains(command_err, "did not answer '*IDN?' within 3 s",
                  "the output is not known to be at 0 V: switch the supply off");
  supply_stop(&hv);
  supply_stop(&mute);
}

/* Where what was left cannot be kept or read, 0 V is commanded all the same, and not believed. */
TEST(test_zero_without_a_place)
{
  left_up((struct supply){0});
  char state_folder[600], kept[600];
  snprintf(state_folder, sizeof state_folder, "%s/state", command_folder);
  snprintf(kept, sizeof kept, "%s/kept", command_folder);
  bool there = rename(state_folder, kept) == 0;
  command_write("state", "a file where a folder should be");
  int code = supply_run_dea(supply_zero, 20);
  double volts = supply_volts(&hv);
  assert_true(remove(state_folder) == 0 && (!there || rename(kept, state_folder) == 0));
  assert_true(volts <= supply_zero_V);
  assert_int_equal(code, 6);
  assert_contains(command_err, "cannot make the folder");
  assert_contains(command_out, "not known to be at 0 V (0 V read back)");
  supply_stop(&hv);
}

TEST(test_checked_by_somebody)
{
  supply_set_up((struct supply){0}, 5, "");
  assert_int_equal(fault_above("c.h5", 500, SUPPLY_HANGS), 6);
  atomic_store(&hv.fault, SUPPLY_GOOD);
  assert_int_equal(supply_run_dea(supply_zero, 20), 6); // commanded only
  assert_contains(command_err, "--zero --checked");
  assert_int_equal(supply_run_dea(supply_checked, 20), 0);
  supply_protocol(&hv, 1, "");
  assert_int_equal(supply_wait(supply_arm("c.h5"), 20), 0);
  supply_stop(&hv);
}

TESTS(command_set_up, supply_tear_down)
