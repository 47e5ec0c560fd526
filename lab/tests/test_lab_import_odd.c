/* Import of text that could be read in two ways, one of which gives wrong numbers in silence. */
#include "import_text.h"

#include "recording/recording.h"

/* Reads and records a text; the first finding that holds `said` (NULL: none is looked for). */
static dea_status record(const char *name, const char *text, const char *said)
{
  size_t count;
  write_bytes(name, text, strlen(text));
  dea_status status = read_table(in_folder(name));
  status = status == DEA_OK ? record_table(NULL) : status;
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  bool found = said == NULL;
  for (size_t i = 0; i < count && !found; i++) {
    found = strstr(findings[i].text, said) != NULL;
  }
  if (!found) {
    fail_msg("%s: nothing says '%s' (%s)", name, said, dea_status_name(status));
  }
  return status;
}

static void refused(const char *name, const char *text, const char *said)
{
  assert_int_equal(record(name, text, said), DEA_E_IO);
}

TEST(test_thousands)
{
  refused("a.csv", "Time (s)\tVoltage (V)\n0\t900\n1\t1,000\n2\t1,100\n", "between thousands");
  refused("b.csv", "Time (s);Voltage (V)\n0;900\n1;1.000\n2;-1.100\n", "between thousands");
  refused("c.csv", "Time (s),Voltage (V)\n0,\"1,000\"\n1,\"2,000\"\n", "between thousands");
  static const double t[] = {0, 0.5, 1}, v[] = {2, 1.125, 2.25}, w[] = {1.5, 1.125, 2.125};
  read_text("d.csv", "Time (s);V (V);W (V)\n0;2;1,500\n0,5;1,125;1,125\n1;2,25;2,125\n");
  assert_column("Time", "s", t, 3);
  assert_column("V", "V", v, 3);
  assert_column("W", "V", w, 3);
}

TEST(test_times_of_unknown_unit)
{
  refused("ms.csv", "timestamp,V (kV)\n1795341781250,1\n1795341781260,2\n", "ms since 1970");
  refused("us.csv", "time,V (kV)\n1795341781250000,1\n1795341781260000,2\n", "us since 1970");
  refused("day.csv", "Time,V (kV)\n46348.4188,1\n46348.4189,2\n46348.4190,3\n", "spreadsheet");
  // seconds of the day, seconds since 1970 and since 1904 are no such thing
  assert_int_equal(record("s.csv", "Time,V (kV)\n46348.5,1\n46349.5,2\n", "taken in s"), DEA_OK);
  assert_close(recording->channels[0].interval_s, 1, 1e-9, 0);
  assert_int_equal(record("e.csv", "Time,V (kV)\n3878186581,1\n3878186582,2\n", "taken in s"),
                   DEA_OK);
}

TEST(test_units_in_titles)
{
  static const char *const titles[] = {
      "Time_\xb5s,Force_\xb5N",     "Time_\xce\xbcs,Force_\xce\xbcN", "Time: us,Force: uN",
      "Time {us},Force {uN}",       "Time <us>,Force <uN>",           "Time us,Force uN",
      "\"Time, us\",\"Force, uN\"", "Time/\xc2\xb5s,Force/\xc2\xb5N"};
  for (size_t i = 0; i < sizeof titles / sizeof titles[0]; i++) {
    char text[200], name[32];
    snprintf(text, sizeof text, "%s\n0,0\n2,4\n4,8\n", titles[i]);
    snprintf(name, sizeof name, "unit-%zu.csv", i);
    assert_int_equal(record(name, text, NULL), DEA_OK);
    assert_string_equal(recording->channels[0].name, "Force");
    assert_close(recording->channels[0].interval_s, 2e-6, 1e-9, 0);
    assert_close(recording->channels[0].values[2], 8e-6, 1e-9, 0);
  }
  static const double v[] = {1, 2};
  read_text("kv.csv", "Time (s),Voltage (KV)\n0,1\n1,2\n");
  assert_column("Voltage", "KV", v, 2);
}

/* Units that are not known, and columns with a unit that hold no numbers. */
TEST(test_odd_units)
{
  const char *odd = "its unit is not known";
  static const char *const left[] = {"Current (ma)", "Voltage (kVpp)",  "z (m/s)",
                                     "Voltage [mv]", "Voltage (kV DC)", "Voltage (V_rms)",
                                     "Force (dyn)",  "Current (mkA)"};
  for (size_t i = 0; i < sizeof left / sizeof left[0]; i++) {
    char text[100];
    snprintf(text, sizeof text, "Time (s),F (N),%s\n0,1,2\n1,2,3\n", left[i]);
    assert_int_equal(record("odd.csv", text, odd), DEA_OK);
    assert_int_equal(recording->channel_count, 1);
  }
  refused("odd.csv", "Time (mS),F (N)\n0,1\n1,2\n", NULL);
  assert_non_null(strstr(dea_context_message(ctx), "has no times"));
  static const char *const taken[] = {"Voltage (mon)", "Voltage (raw)", "Voltage (max)",
                                      "Voltage (set)", "Voltage (channel 2)"};
  for (size_t i = 0; i < sizeof taken / sizeof taken[0]; i++) {
    char text[100];
    snprintf(text, sizeof text, "Time (s),F (N),%s\n0,1,2\n1,2,3\n", taken[i]);
    assert_int_equal(record("even.csv", text, "taken in V"), DEA_OK);
    assert_int_equal(recording->channel_count, 2);
  }
  assert_int_equal(
      record("minus.csv", "Time (s),F (N),V (kV)\n0,1,(2)\n1,2,(3)\n", "'V (kV)' holds text"),
      DEA_OK);
  assert_true(is_said(DEA_WARNING, "'V (kV)' holds text"));
}

/* What oscilloscopes write where a sample is beyond the screen. */
TEST(test_overflow)
{
  static const double v[] = {1, NAN, NAN, NAN, 2, 1e37, 1e39};
  read_text("over.csv", "t (s),V (V)\n0,1\n1,9.9E+37\n2,9.91E37\n3,-9.9e37\n4,2\n5,1e37\n6,1e39\n");
  assert_column("V", "V", v, 7);
}

/* Rows above a repeated head, beside a column of dates. */
TEST(test_dates_and_two_tables)
{
  refused("two.csv",
          "Date;Time (s);V (kV)\n22.11.2026;0;1,5\n22.11.2026;1;2,5\n"
          "Date;Time (s);V (kV)\n22.11.2026;2;3,5\n22.11.2026;3;4,5\n",
          "split the file");
  refused("state.csv",
          "State,Time (s),V (kV)\nok,0,1.5\nok,1,2.5\nState,Time (s),V (kV)\nok,2,3.5\n",
          "split the file");
  static const double v[] = {3.5, 4.5};
  read_text("head.csv", "Scope;7;12\nDate;Time (s);V (kV)\n22.11.2026;2;3,5\n23.11.2026;3;4,5\n");
  assert_column("V", "kV", v, 2);
}

TEST(test_lvm_segments_of_other_channels)
{
#define SEGMENT(name, t)                                                                           \
  "Channels\t1\nSamples\t2\nX_Dimension\tTime\nX0\t0\nDelta_X\t1\n***End_of_Header***\n"           \
  "X_Value\t" name "\tComment\n" t
  refused("channels.lvm",
          "LabVIEW Measurement\nSeparator\tTab\nMulti_Headings\tYes\nX_Columns\tOne\n"
          "***End_of_Header***\n\n" SEGMENT("Voltage", "0\t1\n1\t2\n\n")
              SEGMENT("Force", "2\t3\n3\t4\n"),
          NULL);
  assert_non_null(strstr(dea_context_message(ctx), "'Force'"));
}

/* Each channel takes the times of its own struct, wherever they stand. */
TEST(test_times_of_their_struct)
{
  assert_int_equal(record("two.csv",
                          "t (s),s.time (s),s.voltage (V),voltage (V)\n0,0,1,5\n1,0.5,2,6\n"
                          "2,1,3,7\n3,1.5,4,8\n",
                          NULL),
                   DEA_OK);
  assert_int_equal(recording->channel_count, 2);
  for (size_t c = 0; c < 2; c++) {
    assert_close(recording->channels[c].interval_s, recording->channels[c].values[0] == 1 ? 0.5 : 1,
                 1e-12, 0);
  }
}

TESTS(set_up, import_tear_down)
