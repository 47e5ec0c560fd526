/* "At 0 V" is said of what was read back and of nothing else, and what is not known stays known as
 * that: dea drive on an imitated supply that is slow, hangs, lies, or cannot be read. */
#define _GNU_SOURCE
#include "supply_drive.h"

/* Whether the supply was at 0 V when dea said so, and stayed there. */
static void check_said(struct supply *s, int code)
{
  double volts = supply_volts(s);
  (void)supply_highest(s);
  dea_clock_wait(1.5); // what it has in its queue
  double later_V = supply_highest(s);
  if (supply_said_zero() && !(volts <= supply_zero_V && later_V <= supply_zero_V)) {
    fail_msg("'at 0 V' and exit code %d, with %.0f V at the end and %.0f V later", code, volts,
             later_V);
  }
}

/* Commands that take 0.4 s each, which are sent every 20 ms: a queue that grows. */
static void test_slow_supply(void **state)
{
  (void)state;
  static struct supply s;
  s = (struct supply){.delay_s = 0.4};
  atomic_store(&s.fault, SUPPLY_SLOW);
  supply_start(&s);
  supply_protocol(&s, 3, SUPPLY_MEASURES);
  int code = supply_wait(supply_arm("slow.h5"), 20);
  check_said(&s, code);
  assert_true(code == 0 ? supply_said_zero() : code == 6);
  supply_stop(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slow_supply),
  };
  return cmocka_run_group_tests(tests, command_set_up, command_tear_down);
}
