/* Files of load frames as they are written, each by a mapping, and times that are text. */
#include "import_text.h"

#include "table/clock_text.h"

/* All fixtures hold the same pull of a strip: 10 Hz, these displacements and forces. */
static const double pulled_m[] = {0, 0.167e-3, 0.334e-3, 0.501e-3};
static const double pulled_N[] = {0.0012, 0.0243, 0.0481, 0.0702};

static void assert_pull(const char *way, const char *force)
{
  const struct dea_channel *z = dea_recording_channel(recording, way);
  const struct dea_channel *f = dea_recording_channel(recording, force);
  assert_true(z != NULL && f != NULL);
  assert_true(z->kind == DEA_CHANNEL_DISPLACEMENT && f->kind == DEA_CHANNEL_FORCE);
  assert_true(z->count == 4 && f->count == 4);
  assert_close(z->interval_s, 0.1, 1e-9, 0);
  assert_close(z->start_s, 0, 0, 1e-12);
  for (size_t i = 0; i < 4; i++) {
    assert_close(z->values[i], pulled_m[i], 1e-12, 1e-18);
    assert_close(f->values[i], pulled_N[i], 1e-12, 0);
  }
}

/* Instron Bluehill: "key : value" lines, quoted titles, a line of units. */
TEST(test_bluehill)
{
  record_file("vhb 10x20 mm 1 mm.csv",
              "\"Test Method : Tensile.im_tens\"\r\n\"Sample name : VHB 4910\"\r\n"
              "\"Width : 10.00 mm\"\r\n\"Rate 1 : 100 mm/min\"\r\n\r\n"
              "\"Time\",\"Extension\",\"Load\",\"Tensile stress\"\r\n"
              "\"(s)\",\"(mm)\",\"(N)\",\"(MPa)\"\r\n"
              "\"0.000\",\"0.000\",\"0.0012\",\"0.0001\"\r\n"
              "\"0.100\",\"0.167\",\"0.0243\",\"0.0024\"\r\n"
              "\"0.200\",\"0.334\",\"0.0481\",\"0.0048\"\r\n"
              "\"0.300\",\"0.501\",\"0.0702\",\"0.0070\"\r\n",
              "dea-import: 1\ntime: Time\ncolumns:\n"
              "  - {column: Extension, as: displacement}\n"
              "  - {column: Load, as: force}\nignore: [\"*sile s*ess\"]\n");
  assert_pull("Extension", "Load");
}

/* JSON of TRIOS: columns by key, rows in any order of keys, columns of text, a missing value. */
TEST(test_trios)
{
#define TRIOS_HEADERS                                                                              \
  "\"ColumnHeaders\": {\"Step_id\": {\"DisplayName\": \"Step\", \"ValueType\": \"Uuid\"},"         \
  "\"Time_s\": {\"DisplayName\": \"Time\", \"ValueType\": \"Number\", \"Unit\": {\"Name\": "       \
  "\"s\"}},"                                                                                       \
  "\"Gap_mm\": {\"DisplayName\": \"Gap\", \"ValueType\": \"Number\", \"Unit\": {\"Name\": "        \
  "\"mm\"}},"                                                                                      \
  "\"Axial force_N\": {\"DisplayName\": \"Axial force\", \"ValueType\": \"Number\","               \
  "\"Unit\": {\"Name\": \"N\"}}},"
#define TRIOS_ROWS                                                                                 \
  "\"Rows\": [{\"Axial force_N\": 1.2E-3, \"Gap_mm\": 0, \"Time_s\": 0, \"Step_id\": \"a-b\"},"    \
  "{\"Time_s\": 0.1, \"Gap_mm\": 0.167, \"Axial force_N\": 0.0243},"                               \
  "{\"Time_s\": 0.2, \"Gap_mm\": 0.334, \"Axial force_N\": 0.0481},"                               \
  "{\"Time_s\": 0.3, \"Gap_mm\": 0.501, \"Axial force_N\": 0.0702}]"
  static const char map[] = "dea-import: 1\ntime: Time\ncolumns:\n"
                            "  - {column: Gap, as: displacement}\n"
                            "  - {column: Axial force, as: force}\n";
  record_file("strip.json",
              "\xef\xbb\xbf{\"Schema\": {\"Url\": \"TRIOSJSONExportSchema\"},"
              "\"Sample\": {\"Name\": \"VHB\"}, \"Results\": {\"Unprocessed\": {},"
              "\"Processed\": {" TRIOS_HEADERS TRIOS_ROWS "}}}",
              map);
  assert_pull("Gap", "Axial force");
  record_file("old.json", "{\"Results\": {" TRIOS_HEADERS TRIOS_ROWS "}}", map);
  assert_pull("Gap", "Axial force");
  read_text("gap.json",
            "{\"Results\": {" TRIOS_HEADERS "\"Rows\": [{\"Time_s\": 1}, {\"Gap_mm\": null}]}}");
  assert_int_equal(table->column_count, 3);
  assert_true(table->columns[0].values[0] == 1 && isnan(table->columns[0].values[1]));
  assert_true(isnan(table->columns[1].values[1]) && isnan(table->columns[2].values[0]));
}

TEST(test_trios_that_is_wrong)
{
  static const struct {
    const char *text, *says;
  } wrong[] = {
      {"{\"Results\": {" TRIOS_HEADERS "\"Rows\": [{\"Gap_mm\": \"1,5\"}]}}",
       "row 1: 'Gap_mm' is no number"},
      {"{\"Results\": {" TRIOS_HEADERS "\"Rows\": [{}, 3]}}", "row 2: it is no object"},
      {"{\"Results\": {\"Rows\": []}}", "it has no 'Results' with 'ColumnHeaders' and 'Rows'"},
      {"{\"Results\": {\n \"Rows\": [}}", "has errors"},
      {"{\"Results\": {\"ColumnHeaders\": {}, \"Rows\": []}}", "holds no column of numbers"},
  };
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    size_t count;
    write_bytes("wrong.json", wrong[i].text, strlen(wrong[i].text));
    assert_int_equal(read_table(in_folder("wrong.json")), DEA_E_IO);
    assert_non_null(strstr(dea_context_message(ctx), wrong[i].says));
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    assert_true(count == (i == 3));
    assert_true(count == 0 || findings[0].location.line == 2);
  }
}

/* Decimal commas, semicolons, Latin-1, kN. */
TEST(test_decimal_comma)
{
  record_file("zug.csv",
              "\"Pr\xfc"
              "fmethode : Zug.im_tens\"\r\n\"Vorkraft : 0,01 N\"\r\n\r\n"
              "\"Zeit\";\"Verl\xe4ngerung\";\"Kraft\"\r\n"
              "\"(s)\";\"(mm)\";\"(kN)\"\r\n"
              "\"0,000\";\"0,000\";\"0,0000012\"\r\n"
              "\"0,100\";\"0,167\";\"0,0000243\"\r\n"
              "\"0,200\";\"0,334\";\"0,0000481\"\r\n"
              "\"0,300\";\"0,501\";\"0,0000702\"\r\n",
              "dea-import: 1\ntime: Zeit\ncolumns:\n"
              "  - {column: Verl\xc3\xa4ngerung, as: displacement, name: way}\n"
              "  - {column: Kraft, as: force}\n");
  assert_pull("way", "Kraft");
}

/* GB18030 as it is saved in China, each number in quotes: names are letters, not noise. */
TEST(test_gb18030)
{
  static const char bytes[] = "\"\xca\xd4\xd1\xe9\xb7\xbd\xb7\xa8\",\"\xc0\xad\xc9\xec\"\r\n"
                              "\"\xca\xb1\xbc\xe4\",\"\xce\xbb\xd2\xc6\",\"\xc1\xa6\"\r\n"
                              "\"(s)\",\"(mm)\",\"(N)\"\r\n"
                              "\"0.00\",\"0.000\",\"0.0012\"\r\n\"0.10\",\"0.167\",\"0.0243\"\r\n"
                              "\"0.20\",\"0.334\",\"0.0481\"\r\n\"0.30\",\"0.501\",\"0.0702\"\r\n";
  record_file("gb.csv", bytes,
              "dea-import: 1\ntime: \xe6\x97\xb6\xe9\x97\xb4\ncolumns:\n"
              "  - {column: \xe4\xbd\x8d\xe7\xa7\xbb, as: displacement}\n"
              "  - {column: \xe5\x8a\x9b, as: force}\n");
  assert_pull("\xe4\xbd\x8d\xe7\xa7\xbb", "\xe5\x8a\x9b");
  // a sign of Latin-1 is not half of a letter, and UTF-8 stays what it is
  static const double values[] = {1, 2};
  read_text("latin.csv", "\xc4nderung (\xb5m);Gr\xf6\xdf"
                         "e (mN)\n1;1\n2;2\n");
  assert_column("\xc3\x84nderung", "\xc2\xb5m", values, 2);
  read_text("utf8.csv", "\xe6\x97\xb6\xe9\x97\xb4 (s),\xe5\x8a\x9b (N)\n1,1\n2,2\n");
  assert_column("\xe6\x97\xb6\xe9\x97\xb4", "s", values, 2);
}

/* A clock beside the force, once with a date and across midnight, once without. */
TEST(test_times_as_text)
{
  static const char *const times[][4] = {{"2026-02-28 23:59:59.9", "2026-03-01 00:00:00.0",
                                          "2026-03-01 00:00:00.1", "2026-03-01 00:00:00.2"},
                                         {"28.02.2024 23:59:59,9", "29.02.2024 00:00:00,0",
                                          "29.02.2024 00:00:00,1", "29.02.2024 00:00:00,2"},
                                         {"2026/12/31T23:59:59.90Z", "2027/01/01T00:00:00.00Z",
                                          "2027/01/01T00:00:00.10Z", "2027/01/01T00:00:00.20Z"},
                                         {"23:59:59.9", "0:00:00.0", "0:00:00.1", "0:00:00.2"}};
  for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
    char text[1024] = "When;Travel (mm);Load (N)\n";
    for (size_t i = 0; i < 4; i++) {
      size_t at = strlen(text);
      snprintf(text + at, sizeof text - at, "%s;%.3f;%.4f\n", times[k][i], 1e3 * pulled_m[i],
               pulled_N[i]);
    }
    record_file("clock.csv", text,
                "dea-import: 1\ntime: When\ncolumns:\n"
                "  - {column: Travel, as: displacement}\n  - {column: Load, as: force}\n");
    assert_pull("Travel", "Load");
  }
}

/* Whole seconds of faster rows are no clock; numbers are the better one; what changes its form in
 * the middle is an error; a date that is two is text. */
TEST(test_other_times)
{
  static const double t[] = {0, 0.5, 1}, f[] = {1, 2, 3};
  read_text("a.csv", "Clock,F (N)\n10:00:00,1\n10:00:00,2\n10:00:01,3\n");
  assert_int_equal(table->column_count, 1);
  assert_column("F", "N", f, 3);
  assert_true(is_said(DEA_WARNING, "the times in 'Clock' repeat or fall"));
  read_text("b.csv", "Clock,Time (s),F (N)\n10:00:00,0,1\n10:00:00,0.5,2\n10:00:01,1,3\n");
  assert_int_equal(table->column_count, 2);
  assert_column("Time", "s", t, 3);
  read_text("c.csv", "Clock,F (N)\n03/02/2026 10:00:00,1\n03/02/2026 10:00:01,2\n");
  assert_int_equal(table->column_count, 1);
  static const struct refused wrong[] = {
      {"Clock,F (N)\n10:00:00,1\n2026-03-02 10:00:01,2\n", 3, "is no time as those above it are"},
      {"Clock,F (N)\n10:00:00,1\n10:00:61,2\n", 3, "'10:00:61' is no time"},
      {"Clock,F (N)\n2026-02-28 10:00:00,1\n2026-02-29 10:00:00,2\n", 3, "is no time"}};
  assert_all_refused("d.csv", wrong, 3);
}

/* Days between dates against a count day by day. */
TEST(test_days)
{
  static const int lengths[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  double wanted = 0;
  for (int year = 1970; year < 2110; year++) {
    bool branch_jump = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    for (int month = 1; month <= 12; month++) {
      char text[40];
      double days, seconds;
      bool dated;
      int last = lengths[month - 1] + (branch_jump && month == 2);
      snprintf(text, sizeof text, "%04d-%02d-01 01:02:03.25", year, month);
      assert_true(dea_clock_text((struct dea_slice){text, strlen(text)}, &days, &seconds, &dated));
      assert_true(dated && days == wanted && seconds == 3723.25);
      snprintf(text, sizeof text, "%04d-%02d-%02d 00:00:00", year, month, last + 1);
      assert_false(dea_clock_text((struct dea_slice){text, strlen(text)}, &days, &seconds, &dated));
      wanted += last;
    }
  }
}

TESTS(set_up, import_tear_down)
