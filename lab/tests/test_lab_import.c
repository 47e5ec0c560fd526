/* Import of text: CSV in the dialects of instruments and spreadsheets. */
#include "import_text.h"

static const double t3[] = {0, 0.001, 0.002}, v3[] = {0, 0.5, -1.25e3};

/* Different texts of the same two columns. */
TEST(test_dialects)
{
  static const char *const texts[] = {
      "Time (s),Voltage (kV)\n0,0\n0.001,0.5\n0.002,-1.25E+03\n",
      "Time [s];Voltage [kV]\r\n0,000;0,0\r\n0,001;0,5\r\n0,002;-1,25e3\r\n",
      "Time/s\tVoltage/kV\n0\t0\n.001\t0.5\n.002\t-1250.\n",
      "Time / s;Voltage / kV\n0;0\n0.001;0.5\n0.002;-1250\n",
      "Time_s  Voltage_kV\n  0  0\n  1.0e-3   0.5\n  2.0D-3 -1250\n",
      "Time (s)  Voltage (kV)\n0 0\n0,001 0,5\n0,002 -1250,0\n",
      "Time in s;Voltage in kV\n0;0\n0,001;0,5\n0,002;-1250",
      "\xef\xbb\xbfTime (s),Voltage (kV)\n0,0\n0.001,0.5\n0.002,-1250\n",
      "sep=;\nTime (s);Voltage (kV)\n0;0\n0,001;0,5\n0,002;-1250\n",
      "# Time (s), Voltage (kV)\n0,0\n0.001,0.5\n0.002,-1250\n",
      "% Time (s) Voltage (kV)\n0 0\n0.001 0.5\n0.002 -1250\n",
      "// written by a logger\n// Time (s)\tVoltage (kV)\n0\t0\n0.001\t0.5\n0.002\t-1250\n",
      "Time,Voltage\ns,kV\n0,0\n0.001,0.5\n0.002,-1250\n",
      "Time;Voltage\n(s);(kV)\nclock;monitor\n0;0\n0.001;0.5\n0.002;-1250\n",
      "Scope 7\nSerial;12\nComment;a, b\n\nTime (s);Voltage (kV)\n\n0;0\n0,001;0,5\n0,002;-1250\n",
      "\"Time (s)\",\"Voltage (kV)\"\n\"0\",\"0\"\n\"0.001\",\"0.5\"\n\"0.002\",\"-1250\"\n",
      "\"Time (s)\",\"Voltage (kV)\"\n\"0,0\",\"0,0\"\n\"0,001\",\"0,5\"\n\"0,002\",\"-1250,0\"\n",
      "Time (s);Voltage (kV);\n0;0;\n0,001;0,5;\n0,002;-1250;\n",
      "Time (s),Voltage (kV)\n0,0\n# stopped here\n0.001,0.5\n\n0.002,-1250\n,\n,\n",
      "Time (s)|Voltage (kV)\n0|0\n0.001|0.5\n0.002|-1250\n",
  };
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
    char name[32];
    snprintf(name, sizeof name, "dialect-%zu.csv", i);
    read_text(name, texts[i]);
    assert_column("Time", "s", t3, 3);
    assert_column("Voltage", "kV", v3, 3);
    assert_int_equal(table->column_count, 2);
  }
}

TEST(test_encodings)
{
  static const unsigned char latin[] = "Zeit (s);Strom (\xb5"
                                       "A)\n0;1,5\n1;2,5\n";
  static const double current[] = {1.5, 2.5};
  read_bytes("latin.csv", latin, sizeof latin - 1);
  assert_column("Strom",
                "\xc2\xb5"
                "A",
                current, 2);
  for (int big = 0; big < 2; big++) {
    unsigned char wide[2 * sizeof latin];
    wide[big] = 0xff;
    wide[1 - big] = 0xfe;
    for (size_t i = 0; i < sizeof latin - 1; i++) {
      wide[2 + 2 * i + (size_t)big] = latin[i];
      wide[3 + 2 * i - (size_t)(2 * big) + (size_t)big] = 0;
    }
    read_bytes("wide.csv", wide, 2 * sizeof latin);
    assert_column("Strom",
                  "\xc2\xb5"
                  "A",
                  current, 2);
  }
}

/* Lines of old Macintosh programs end with a carriage return alone. */
TEST(test_carriage_returns)
{
  static const double t[] = {0, 0.5, 1}, v[] = {1.5, 2.5, 3};
  read_text("cr.csv", "Time (s),V (kV)\r0,1.5\r0.5,2.5\r1.0,3\r");
  assert_column("Time", "s", t, 3);
  assert_column("V", "kV", v, 3);
}

/* Times with a zone: those of winter and summer differ in name only. */
TEST(test_zones)
{
  static const double t[] = {0, 1, 2.5, 4};
  read_text("zone.csv", "Timestamp,V (kV)\n2026-03-29T01:59:59+01:00,1\n"
                        "2026-03-29T03:00:00+02:00,2\n2026-03-28 20:30:01.5-0430,3\n"
                        "2026-03-29 01:00:03Z,4\n");
  assert_column("Timestamp", "s", t, 4);
}

TEST(test_missing_values)
{
  static const double v[] = {1, NAN, NAN, NAN, NAN, NAN, 2};
  read_text("missing.csv",
            "t,V (V),x\n0,1,1\n1,,1\n2,NaN,1\n3,-nan,1\n4,OL,1\n5,1.#QNAN,1\n6,2,1\n");
  assert_column("V", "V", v, 7);
}

/* Rows of missing values above the first number, and below the last one, are rows: without a column
 * of times all that follows would come too early. */
TEST(test_rows_of_missing_values)
{
  enum { ROWS = 2500 }; // more than the dialect is found in
  static char text[ROWS * 16];
  size_t n = (size_t)sprintf(text, "V (kV),note,I (uA)\nnan,ok,nan\nOL,ok,nan\n");
  for (int i = 0; i < ROWS; i++) {
    n += (size_t)sprintf(text + n, "%d,ok,%d\n", i % 7, i % 5);
  }
  read_text("head.csv", text);
  const struct dea_table_column *v = column_of("V");
  assert_int_equal(v->count, ROWS + 2);
  assert_true(isnan(v->values[0]) && isnan(v->values[1]) && v->values[3] == 1);
  assert_string_equal(v->unit, "kV");
  static const double w[] = {NAN, 1, 2, NAN, NAN}, t[] = {0, 1};
  read_text("both.csv", "V (kV),W (kV)\nNaN,-nan(ind)\n1,1\n2,2\nnan,nan\nnan,nan\n");
  assert_column("W", "kV", w, 5);
  read_text("dashes.csv", "Time (s),note,V (kV)\n-,-,-\n0,ok,0\n1,ok,1\n"); // no units
  assert_column("Time", "s", t, 2);
  assert_column("V", "kV", t, 2);
}

/* To the last bit: against strtod in the C locale. */
TEST(test_numbers_exact)
{
  static const char *const numbers[] = {"0.1",
                                        "1e-7",
                                        "123456789.123456789",
                                        "9007199254740993",
                                        "4.35",
                                        "2.2250738585072014e-308",
                                        "1.7976931348623157e308",
                                        "0.000123456789012345678901",
                                        "-5e-324",
                                        "1E+03",
                                        "+7.",
                                        "1e23",
                                        "8.41e21",
                                        "100000000000000000000000"};
  enum { COUNT = sizeof numbers / sizeof numbers[0] };
  double values[COUNT];
  char text[1000] = "x\n";
  for (size_t i = 0; i < COUNT; i++) {
    strcat(strcat(text, numbers[i]), "\n");
    values[i] = strtod(numbers[i], NULL);
  }
  read_text("exact.csv", text);
  assert_column("x", "", values, COUNT);
}

TEST(test_headers)
{
  read_text("no.csv", "0,1\n1,2\n");
  assert_string_equal(table->columns[0].name, "column 1");
  read_text("odd.csv", "Dev1/ai0,Force (filtered),channel_A,laser_in,I_A,T (\xc2\xb0"
                       "C)\n1,2,3,4,5,6\n7,8,9,1,2,3\n");
  static const char *const names[] = {"Dev1/ai0", "Force (filtered)", "channel_A", "laser_in", "I",
                                      "T"};
  static const char *const units[] = {"", "", "", "", "A", "\302\260C"};
  for (size_t i = 0; i < 6; i++) {
    assert_string_equal(table->columns[i].name, names[i]);
    assert_string_equal(table->columns[i].unit, units[i]);
  }
  read_text("one.csv", "Voltage\n1,5\n2,5\n"); // one column with a decimal comma
  static const double v[] = {1.5, 2.5};
  assert_column("Voltage", "", v, 2);
}

/* Titles with line breaks in quotes (Alt+Enter in Excel) are none, rather than those of other
 * columns. */
TEST(test_titles_of_two_lines)
{
  static const double t[] = {0.5, 1.5};
  read_text("quoted.csv", "\"Time\n(s)\",\"Voltage\n(kV)\"\n0.5,1\n1.5,2\n");
  assert_column("column 1", "", t, 2);
  assert_true(is_said(DEA_NOTE, "name no 2 columns"));
}

TEST(test_text_columns_and_rates)
{
  static const double v[] = {1, 2};
  read_text("text.csv", "Sample rate: 2 kHz\nDate;V (V)\n2023-05-01 10:00;1\n2023-05-01 10:01;2\n");
  assert_column("V", "V", v, 2);
  const struct dea_table_column *rate = column_of("Sample rate");
  assert_int_equal(rate->count, 1);
  assert_true(rate->values[0] == 2);
  assert_string_equal(rate->unit, "kHz");
  assert_true(is_said(DEA_NOTE, "'Date' holds text ('2023-05-01 10:00')"));
  read_text("kV.csv", "t (s),V\n0,1.5 kV\n1,2.5 kV\n"); // no thousands
  assert_true(is_said(DEA_NOTE, "'V' holds text ('1.5 kV')"));
  read_text("odd.csv", "t (s),V\n0,1.5\n1,ERR\n2,ERR\n"); // numbers are lost
  assert_true(is_said(DEA_WARNING, "'V' holds text ('1.5')"));
}

TEST(test_refused)
{
  static const struct refused cases[] = {
      {"t;V\n0;1,234.5\n1;2,345.6\n", 2, "'1,234.5' has marks between thousands"},
      {"t,V\n0,\"1,234.5\"\n1,\"2,345.6\"\n", 2, "between thousands"},
      {"t;V\n0;1.234.567,5\n1;-2.345.678,5\n", 2, "'1.234.567,5' has marks between thousands"},
      {"t,V\n0,1\n1,oops\n2,3\n", 3, "'oops' stands in a line of numbers"},
      {"t,V\n0,1\n1,2\nt,V\n0,1\n1,2\n2,3\n", 2, "from line 5 on"},
      {"t,V\n0,1\n1,2\n2,3,4\n3,4,5\n4,5,6\n", 2, "from line 4 on"},
      {"t,V\n0,1\n1,2\nend\n", 4, "1 field where 2 are due"},
      {"just words\nand more\n", 0, "no lines of numbers"},
  };
  assert_all_refused("bad.csv", cases, sizeof cases / sizeof cases[0]);
  assert_refused("bad.csv", "a\0b", 3, 0, "no format that is known");
  write_bytes("empty.csv", "", 0);
  assert_int_equal(read_table(in_folder("empty.csv")), DEA_E_IO);
  assert_int_equal(read_table(in_folder("none.csv")), DEA_E_IO);
  assert_int_equal(read_table(folder), DEA_E_IO);
  assert_int_equal(dea_table_read(ctx, in_folder("bad.csv"), "cvs", &table), DEA_E_USAGE);
  assert_non_null(strstr(dea_context_message(ctx), "did you mean 'csv'"));
}

/* Lines that differ after the part that the dialect was found in. */
TEST(test_late_errors)
{
  static char text[40000];
  size_t n = (size_t)snprintf(text, sizeof text, "t,V\n");
  for (int i = 0; i < 2500; i++) {
    n += (size_t)snprintf(text + n, sizeof text - n,
                          i == 2100   ? "%d,a1\n"
                          : i == 2200 ? "%d\n"
                                      : "%d,1\n",
                          i);
  }
  assert_refused("late.csv", text, n, 2102, "'a1' is not a number");
  assert_true(is_said(DEA_ERROR, "1 field where 2 are due"));
  // a file that was cut off in its last line
  read_text("cut.csv", "t,V,W\n0,1,2\n1,2,3\n2,3");
  assert_int_equal(table->columns[0].count, 2);
  assert_true(is_said(DEA_WARNING, "cut off"));
}

static void read_once(struct dea_context *own)
{
  read_again(own, "memory.csv");
}

TEST(test_memory)
{
  const char *text = "Scope\nrate;100 Hz\nTime (s);Voltage (kV);note\n0;0;a\n1;0,5;b\n2;1;c\n";
  write_bytes("memory.csv", text, strlen(text));
  assert_true(failing_each(read_once) > 10);
}

TESTS(set_up, import_tear_down)
