/* Import of LabVIEW's text measurements, written line by line from NI's published layout. */
#include "import_text.h"

#define HEADER(x, headings, rest)                                                                  \
  "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"                  \
  "Decimal_Separator\t.\nMulti_Headings\t" headings "\nX_Columns\t" x                              \
  "\nTime_Pref\tAbsolute\nOperator\tsomeone\nDate\t2023/05/01\nTime\t10:00:00.0\n" rest            \
  "***End_of_Header***\t\n\t\n"
#define SEGMENT(samples, time, x0, delta) DATED("2023/05/01", samples, time, x0, delta)
#define DATED(date, samples, time, x0, delta)                                                      \
  "Channels\t2\t\nSamples\t" samples "\nDate\t" date "\t" date "\nTime\t" time "\t" time           \
  "\nY_Unit_Label\tkV\tuA\nX_Dimension\tTime\tTime\nX0\t" x0 "\t" x0 "\nDelta_X\t" delta           \
  "\t" delta "\n***End_of_Header***\t\t\n"
#define TITLES "X_Value\tHV\tMonitor\tComment\n"

static const double hv[] = {0, 1.5, 3}, monitor[] = {-1, 2e-3, 4};

static void check_clock(const char *name, double start, double interval)
{
  const struct dea_table_column *column = column_of(name);
  assert_close(column->start, start, 1e-12, 0);
  assert_close(column->interval, interval, 1e-12, 0);
}

TEST(test_no_times)
{
  read_text("no.lvm", HEADER("No", "No", "") SEGMENT("3\t3", "10:00:00.5", "0.25", "0.001") TITLES
            "\t0.0\t-1\tstart\n\t1.5\t2E-3\n\t3.0\t4\n");
  assert_string_equal(table->format, "lvm");
  assert_int_equal(table->column_count, 2);
  assert_column("HV", "kV", hv, 3);
  assert_column("Monitor", "uA", monitor, 3);
  check_clock("HV", 0.25, 0.001);
  // the other way of writing it: no field for the times at all
  read_text("bare.lvm", HEADER("No", "No", "") SEGMENT(
                            "3\t3", "10:00:00", "0",
                            "0.5") "HV\tMonitor\tComment\n0.0\t-1\tstart\n1.5\t2E-3\n3.0\t4\n");
  assert_column("HV", "kV", hv, 3);
  assert_column("Monitor", "uA", monitor, 3);
}

TEST(test_one_column_of_times)
{
  static const double t[] = {0, 0.1, 0.35};
  read_text("one.lvm", HEADER("One", "No", "") SEGMENT("3\t3", "10:00:00", "0", "1.0") TITLES
            "0.0\t0.0\t-1\n0.1\t1.5\t0.002\n0.35\t3.0\t4\n");
  assert_column("X_Value", "s", t, 3);
  assert_column("HV", "kV", hv, 3);
  assert_int_equal(column_of("Monitor")->clock, 1);
  assert_true(isnan(column_of("Monitor")->interval));
}

TEST(test_times_for_each)
{
  static const double t2[] = {5, 6};
  read_text("multi.lvm",
            HEADER("Multi", "Yes", "")
                SEGMENT("3\t2", "10:00:00", "0", "1") "X_Value\tHV\tX_Value\tMonitor\tComment\n"
                                                      "0\t0\t5\t-1\n1\t1.5\t6\t2e-3\n2\t3\t\t\n");
  assert_column("HV", "kV", hv, 3);
  assert_column("Monitor", "uA", monitor, 2);
  assert_column("X_Value 2", "s", t2, 2);
  assert_int_equal(column_of("Monitor")->clock, 3);
}

TEST(test_commas)
{
  read_text(
      "comma.lvm",
      "LabVIEW Measurement\t\r\nSeparator\tTab\r\nDecimal_Separator\t,\r\nMulti_Headings\tNo\r\n"
      "X_Columns\tNo\r\n***End_of_Header***\t\r\nChannels\t1\r\nSamples\t3\r\nDelta_X\t0,001\r\n"
      "X0\t0,0E+0\r\n***End_of_Header***\r\nX_Value\tHV\tComment\r\n\t0,0\r\n\t1,5\r\n\t3,0\r\n");
  assert_column("HV", "", hv, 3);
  check_clock("HV", 0, 0.001);
  read_text("separator.lvm",
            "LabVIEW Measurement,\nSeparator,Comma\nX_Columns,No\n***End_of_Header***,\n"
            "Channels,1\nDelta_X,0.5\n***End_of_Header***\nX_Value,HV\n,0\n,1.5\n,3\n");
  assert_column("HV", "", hv, 3);
  check_clock("HV", 0, 0.5);
}

/* Segments that follow one another are one measurement; a gap gives every sample its time. */
TEST(test_segments)
{
  static const double both[] = {0, 1.5, 3, 0, 1.5}, t[] = {0, 0.5, 1, 9.5, 10};
  read_text("follow.lvm", HEADER("No", "Yes", "") SEGMENT("3\t3", "10:00:00", "0", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n\t3\t3\n\n" SEGMENT("2\t2", "10:00:01.5", "0", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n");
  assert_column("HV", "kV", both, 5);
  check_clock("HV", 0, 0.5);
  assert_int_equal(table->column_count, 2);
  read_text("gap.lvm", HEADER("No", "Yes", "") SEGMENT("3\t3", "23:59:59.5", "0", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n\t3\t3\n\n" SEGMENT("2\t2", "00:00:09.0", "0", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n");
  assert_column("HV", "kV", both, 5);
  assert_column("X_Value", "s", t, 5); // over midnight
  assert_true(is_said(DEA_NOTE, "without a gap"));
}

/* Segments of several days, by their dates: later in the morning than the first one in the evening,
 * and at the same time of day. */
TEST(test_segments_of_days)
{
  static const double t[] = {0, 1, 46800, 46801, 169200, 169201};
  read_text("days.lvm",
            HEADER("One", "Yes", "") DATED("2024/02/28", "2\t2", "20:00:00", "0", "1") TITLES
            "0\t0\t1\n1\t1\t2\n\n" DATED("2024/02/29", "2\t2", "09:00:00", "0", "1") TITLES
            "0\t0\t1\n1\t1\t2\n\n" DATED("2024/03/01", "2\t2", "19:00:00", "0", "1") TITLES
            "0\t0\t1\n1\t1\t2\n");
  assert_column("X_Value", "s", t, 6);
}

/* Segments whose X0 goes on by itself (absolute times, or seconds since the first): their clock is
 * not added to that. */
TEST(test_segments_that_count_on)
{
  static const double both[] = {0, 1.5, 0, 1.5}, t[] = {100, 100.5, 110, 110.5};
  read_text("on.lvm", HEADER("No", "Yes", "") SEGMENT("2\t2", "10:00:00", "3765000000", "0.5")
                          TITLES "\t0\t1\n\t1.5\t2\n\n" SEGMENT("2\t2", "10:00:01", "3765000001",
                                                                "0.5") TITLES "\t0\t1\n\t1.5\t2\n");
  assert_column("HV", "kV", both, 4);
  check_clock("HV", 3765000000.0, 0.5);
  read_text("on.lvm", HEADER("No", "Yes", "") SEGMENT("2\t2", "10:00:00", "100", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n\n" SEGMENT("2\t2", "10:00:10", "110", "0.5") TITLES
            "\t0\t1\n\t1.5\t2\n");
  assert_column("X_Value", "s", t, 4);
}

TEST(test_special_blocks_and_missing)
{
  static const double v[] = {0, NAN, 3};
  read_text(
      "special.lvm",
      HEADER("No", "No", "***Start_Special***\nNI Something\t1\nChannels\t9\n***End_Special***\n")
          SEGMENT("3\t3", "10:00:00", "0", "1") TITLES
      "\t0\t1\n***Start_Special***\nodd\n***End_Special***\n\t\t2\n\t3\t3\n");
  assert_column("HV", "kV", v, 3);
  assert_int_equal(column_of("Monitor")->count, 3);
}

TEST(test_refused)
{
  static const struct refused cases[] = {
      {"LabVIEW Measurement\nSeparator\tTab\n", 0, "no line ***End_of_Header***"},
      {"LabVIEW Measurement\n***End_of_Header***\n", 0, "no segment"},
      {"LabVIEW Measurement\n***End_of_Header***\nChannels\t0\n", 0, "line 3"},
      {"LabVIEW Measurement\n***End_of_Header***\nChannels\t1e9\n", 0, "number of channels"},
      {"LabVIEW Measurement\n***End_of_Header***\nChannels\t1\nX0\t0\n", 0, "does not end"},
      {"LabVIEW Measurement\n***End_of_Header***\nSamples\t1\n***End_of_Header***\n", 0,
       "how many channels"},
      {"LabVIEW "
       "Measurement\n***End_of_Header***\nChannels\t1\n***End_of_Header***\nX_Value\tA\n0\t1\n"
       "1\ttwo\n",
       7, "'two' is not a number"},
  };
  assert_all_refused("bad.lvm", cases, sizeof cases / sizeof cases[0]);
}

// Cases ------------------------------------------------------------------------------------------

/* A channel: its unit, and values and times that begin at `start` and rise by `step`; behind the
 * first `pause` of them the second segment begins, 10 s and `again` later. */
struct wanted {
  const char *name, *unit;
  double start, step, from, rise;
  size_t count, pause;
  double again;
};

static void check_case(const char *name, size_t count, const struct wanted *wanted)
{
  char file[512];
  snprintf(file, sizeof file, DEA_SOURCE_DIR "/lab/tests/cases/lvm/%s", name);
  assert_int_equal(read_table(file), DEA_OK);
  for (size_t c = 0; c < count; c++) {
    const struct wanted *w = &wanted[c];
    const struct dea_table_column *column = column_of(w->name);
    const double *times = column->clock > 0 ? table->columns[column->clock - 1].values : NULL;
    assert_string_equal(column->unit, w->unit);
    assert_true(column->count == w->count || (times != NULL && column->count > w->count));
    for (size_t i = 0; i < column->count; i++) {
      bool later = w->pause > 0 && i >= w->pause;
      double k = (double)(later ? i - w->pause : i);
      double time = w->start + k * w->step + (later ? 10 : 0);
      double value = w->from + k * w->rise + (later ? w->again : 0);
      double its = times != NULL ? times[i] : column->start + (double)i * column->interval;
      if (!(fabs(its - time) < 1e-9) ||
          (i < w->count && !(fabs(column->values[i] - value) < 1e-9))) {
        fail_msg("%s: %s[%zu] = %g at %g s, wanted %g at %g s", name, w->name, i, column->values[i],
                 its, value, time);
      }
      assert_true(i < w->count || isnan(column->values[i])); // where another channel is longer
    }
  }
}

/* Every channel has its own number of samples, start and step. */
TEST(test_own_clocks)
{
  static const struct wanted two_rates[] = {{"HV", "kV", 0, 0.1, 0, 0.1, 10, 0, 0},
                                            {"Laser", "mm", 0.5, 0.2, 0, 0.01, 5, 0, 0}};
  static const struct wanted shorter[] = {{"HV", "kV", 0, 0.2, 0, 0.1, 3, 0, 0},
                                          {"Laser", "mm", 0, 0.1, 0, 0.01, 8, 0, 0}};
  static const struct wanted shorter_one[] = {{"HV", "kV", 0, 0.1, 0, 0.1, 3, 0, 0},
                                              {"Laser", "mm", 0, 0.1, 0, 0.01, 8, 0, 0}};
  static const struct wanted start[] = {{"HV", "kV", 0, 0.1, 0, 0.1, 5, 0, 0},
                                        {"Laser", "mm", 0.05, 0.1, 0, 0.01, 5, 0, 0}};
  check_case("two-rates.lvm", 2, two_rates);
  check_case("first-shorter.lvm", 2, shorter);
  check_case("first-shorter-one.lvm", 2, shorter_one);
  check_case("different-start.lvm", 2, start);
}

/* Of X_Columns Multi every column has a field in the header. */
TEST(test_multi_headers)
{
  static const struct wanted one[] = {{"HV", "kV", 0, 0.1, 0, 0.5, 4, 0, 0},
                                      {"Displacement", "mm", 0, 0.1, 0, 0.25, 4, 0, 0},
                                      {"Force", "mN", 0, 0.1, 0, 2, 4, 0, 0}};
  static const struct wanted two[] = {{"HV", "kV", 0, 0.1, 0, 0.5, 8, 4, 1},
                                      {"Displacement", "mm", 0, 0.1, 0, 0.25, 8, 4, 1},
                                      {"Force", "mN", 0, 0.1, 0, 2, 8, 4, 5}};
  static const struct wanted units[] = {{"HV", "kV", 0, 0.1, 0, 0.5, 6, 0, 0},
                                        {"laser 1", "mm", 0, 0.1, 0, 0.01, 6, 0, 0},
                                        {"laser 2", "um", 0, 0.1, 0, 10, 6, 0, 0}};
  static const struct wanted samples[] = {{"HV", "kV", 0, 0.1, 0, 0.5, 8, 0, 0},
                                          {"Force slow", "", 0, 0.1, 0, 1, 3, 0, 0},
                                          {"Displacement", "", 0, 0.1, 0, 0.001, 8, 0, 0}};
  check_case("one-segment.lvm", 3, one);
  check_case("two-segments.lvm", 3, two);
  check_case("units-shift.lvm", 3, units);
  check_case("samples-shift.lvm", 3, samples);
}

/* Channels of two rates with a pause: each has times of its own. */
TEST(test_two_rates_with_a_gap)
{
#define TWO_RATES(time, rows)                                                                      \
  "Channels\t2\nSamples\t4\t2\nTime\t" time "\t" time "\nX0\t0\t0.5\nDelta_X\t0.5\t1\n"            \
  "***End_of_Header***\n" TITLES rows "\n"
  static const double fast[] = {0, 0.5, 1, 1.5, 20, 20.5, 21, 21.5},
                      slow[] = {0.5, 1.5, 20.5, 21.5};
  static const double v[] = {1, 2, 3, 4, 5, 6, 7, 8}, m[] = {10, 20, 30, 40};
  read_text("rates.lvm",
            HEADER("No", "Yes", "") TWO_RATES("10:00:00", "\t1\t10\n\t2\t20\n\t3\t\n\t4\t\n")
                TWO_RATES("10:00:20", "\t5\t30\n\t6\t40\n\t7\t\n\t8\t\n"));
  assert_column("HV", "", v, 8);
  assert_column("Monitor", "", m, 4);
  assert_column("X_Value", "s", fast, 8);
  assert_column("X_Value 2", "s", slow, 4);
  assert_int_equal(column_of("Monitor")->clock, 3);
}

static void read_once(struct dea_context *own)
{
  read_again(own, "gap.lvm");
}

TEST(test_memory)
{
  assert_true(failing_each(read_once) > 5);
}

TESTS(set_up, import_tear_down)
