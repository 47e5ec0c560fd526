/* base/units: numbers with units. */
#include "base/units.h"
#include "context_fixture.h"
#include "testing.h"

#include <locale.h>
#include <string.h>

TEST(test_reads_what_designs_write)
{
  static const struct {
    const char *text, *unit;
    double si;
  } good[] = {
      {"100 um", "m", 1e-4},
      {"100um", "m", 1e-4},
      {"100 \xc2\xb5m", "m", 1e-4}, // micro sign
      {"100 \xce\xbcm", "m", 1e-4}, // Greek mu
      {"2.5 kV", "V", 2500},
      {"80 V/um", "V/m", 8e7},
      {"80 V um-1", "V/m", 8e7},
      {"970 kg/m^3", "kg/m^3", 970},
      {"970 kg m-3", "kg/m^3", 970},
      {"-6.0 kPa", "Pa", -6000},
      {"1e3 kPa", "Pa", 1e6},
      {".5 mm", "m", 5e-4},
      {"+2 mm", "m", 2e-3},
      {"180 degree", "radian", 3.14159265358979323846},
      {"-90 deg", "radian", -0.5 * 3.14159265358979323846},
      {"0.2", "1", 0.2},
      {"-3", "1", -3},
  };
  for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
    char why[DEA_WHY_SIZE];
    double si = NAN;
    if (!dea_units_read(ctx, good[i].text, (struct dea_measure){good[i].unit, "1 x"}, &si, why)) {
      fail_msg("'%s': %s", good[i].text, why);
    }
    assert_close(si, good[i].si, 1e-14, 0);
  }
}

TEST(test_refuses_with_a_reason)
{
  static const struct {
    const char *text, *unit, *example, *why;
  } bad[] = {
      {"100", "m", "100 um", "'100' has no unit: a length is due; write for example '100 um'"},
      {"8000", "V", "8 kV", "'8000' has no unit: a voltage is due; write for example '8000 V'"},
      {"-100", "V", "8 kV", "'-100' has no unit: a voltage is due; write for example '-100 V'"},
      {"8", "V", "8 kV", "'8' has no unit: a voltage is due; write for example '8 V' or '8 kV'"},
      {"3 kV", "m", "2 mm", "'3 kV' is a voltage, but a length is due, such as '2 mm'"},
      {"1.5 mm", "1", "1.5", "'1.5 mm' is a length, but a number without a unit is due"},
      {"150 %", "1", "1.5", "'150 %' is a percentage, but a number without a unit is due"},
      {"5 xyz", "m", "2 mm", "'xyz' in '5 xyz' is not a known unit"},
      {"5 UM", "m", "2 mm", "'UM' in '5 UM' is not a known unit"},
      {"nan um", "m", "2 mm", "not a finite number"},
      {"-.inf", "1", "2", "not a finite number"},
      {"inf", "m", "2 mm", "not a finite number"},
      {"1e999 m", "m", "2 mm", "too large"},
      {"1e308 Em", "m", "2 mm", "too large"},
      {"2,5 mm", "m", "2 mm", "has a comma"},
      {"0x10 mm", "m", "2 mm", "is not a number"},
      {"abc", "m", "2 mm", "is not a number"},
      {"", "m", "2 mm", "is not a number"},
      {"5 3 mm", "m", "2 mm", "is not a number with a unit"},
      {"5 m since 3", "m", "2 mm", "is not a number with a unit"},
      {"5 m @ 3", "m", "2 mm", "is not a number with a unit"},
      {"5 m^99999999999", "m", "2 mm", "is not a number with a unit"},
      {"5 lg(re mW)", "m", "2 mm", "is not a number with a unit"},
      {"5 %", "radian", "30 degree", "but an angle is due"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    char why[DEA_WHY_SIZE];
    double si = NAN;
    struct dea_measure due = {bad[i].unit, bad[i].example};
    assert_false(dea_units_read(ctx, bad[i].text, due, &si, why));
    if (strstr(why, bad[i].why) == NULL) {
      fail_msg("'%s' says: %s", bad[i].text, why);
    }
  }
}

TEST(test_ignores_the_locale)
{
  // Whether such a locale is installed or not, the point stays the decimal sign.
  setlocale(LC_NUMERIC, "de_DE.UTF-8");
  char why[DEA_WHY_SIZE];
  double si = NAN;
  bool read = dea_units_read(ctx, "2.5 mm", (struct dea_measure){"m", "2 mm"}, &si, why);
  setlocale(LC_NUMERIC, "C");
  assert_true(read);
  assert_close(si, 2.5e-3, 1e-14, 0);
}

TESTS(context_set_up, context_tear_down)
