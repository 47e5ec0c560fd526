/* From tables to recordings: guesses, mappings and their errors, clocks, profiles; COMSOL's export.
 */
#include "import_text.h"

/* A recording of a text file; mapping: NULL guesses. */
static void record_text(const char *text, const char *map)
{
  record_file("table.csv", text, map);
}

static void assert_channel(const char *name, enum dea_channel_kind kind, const double *values,
                           size_t count)
{
  const struct dea_channel *channel = dea_recording_channel(recording, name);
  if (channel == NULL) {
    fail_msg("no channel '%s'", name);
    return;
  }
  assert_int_equal(channel->kind, kind);
  assert_int_equal(channel->count, count);
  for (size_t i = 0; i < count; i++) {
    assert_close(channel->values[i], values[i], 1e-14, 0);
  }
}

TEST(test_guesses)
{
  static const double v[] = {0, 500, 1000}, i[] = {1e-6, 2e-6, 3e-6}, z[] = {0, 1e-5, 2e-5},
                      f[] = {0.001, 0.002, 0.003}, c[] = {0, 510, 1020};
  record_text("Zeit (ms);HV Monitor (kV);Strom (\xc2\xb5"
              "A);Laser (\xc2\xb5m);Kraft (mN);Setpoint (V);Temperature (K);Ch 7\n"
              "0;0;1;0;1;0;293;1\n0,1;0,5;2;10;2;510;293;2\n0,2;1;3;20;3;1020;294;3\n",
              NULL);
  assert_channel("HV Monitor", DEA_CHANNEL_VOLTAGE, v, 3);
  assert_channel("Strom", DEA_CHANNEL_CURRENT, i, 3);
  assert_channel("Laser", DEA_CHANNEL_DISPLACEMENT, z, 3);
  assert_channel("Kraft", DEA_CHANNEL_FORCE, f, 3);
  assert_channel("Setpoint", DEA_CHANNEL_COMMAND, c, 3);
  assert_int_equal(recording->channel_count, 5);
  assert_close(recording->channels[0].interval_s, 1e-4, 1e-12, 0);
  assert_true(is_said(DEA_NOTE, "'Laser' in \xc2\xb5m is taken as displacement"));
  assert_true(is_said(DEA_NOTE, "left out: 'Temperature', 'Ch 7'"));
  // without units, and a monitor that nobody scaled
  record_text("t,voltage\n0,1\n1,2\n2,3\n", NULL);
  assert_true(is_said(DEA_WARNING, "'voltage' has no unit"));
  assert_true(is_said(DEA_WARNING, "never exceeds 3 V"));
  // how far a column may be off is not that column, nor a time
  record_text("t (s);V (kV);V std (kV);z_centre (um);z_centre_SD (um);laser error (um);"
              "laser sigma;Stdev force (mN);uncertainty of F (mN);t err (s);"
              "\xcf\x83 z (um);standard (um)\n"
              "0;0;1;0;1;1;1;1;1;1;1;0\n0,1;0,5;1;10;1;1;1;1;1;1;1;10\n"
              "0,2;1;1;20;1;1;1;1;1;1;1;20\n",
              NULL);
  assert_channel("V", DEA_CHANNEL_VOLTAGE, v, 3);
  assert_channel("z_centre", DEA_CHANNEL_DISPLACEMENT, z, 3);
  assert_channel("standard", DEA_CHANNEL_DISPLACEMENT, z, 3);
  assert_int_equal(recording->channel_count, 3);
  assert_close(recording->channels[0].interval_s, 0.1, 1e-12, 0);
  assert_true(is_said(DEA_NOTE, "'V std' (by its name an uncertainty of something; if"));
  // a rate in the preamble; a sensor in volts is not taken for a length
  record_text("Sample rate: 2 kHz\nHV (kV),laser (V)\n0,1\n1,2\n2,3\n", NULL);
  assert_close(recording->channels[0].interval_s, 5e-4, 1e-12, 0);
  assert_int_equal(recording->channel_count, 1);
  assert_true(is_said(DEA_NOTE, "say per_unit"));
}

TEST(test_mapping)
{
  static const double v[] = {100, 1100, -900}, z[] = {-0.0025, -0.0015, -0.0005}, x[] = {5, 6, 7};
  record_text(
      "Dev1/ai0,Dev1/ai1,k,junk\n0,0,5,1\n1,1,6,1\n-1,2,7,1\n",
      "dea-import: 1\ntitle: A run\nrate: 10 kHz\ncolumns:\n"
      "  - {column: dev1/AI0, as: voltage, unit: V, per_unit: 1 kV, at_zero: 100 V, name: high}\n"
      "  - {column: Dev1/ai1, as: displacement, per_unit: 1 mm, at_zero: -2.5 mm, filter: 50 Hz}\n"
      "  - {column: k, as: other, unit: counts}\nignore: [ju*]\n");
  assert_channel("high", DEA_CHANNEL_VOLTAGE, v, 3);
  assert_channel("Dev1/ai1", DEA_CHANNEL_DISPLACEMENT, z, 3);
  assert_channel("k", DEA_CHANNEL_OTHER, x, 3);
  assert_string_equal(recording->channels[2].unit, "counts");
  assert_string_equal(recording->title, "A run");
  assert_close(recording->channels[0].interval_s, 1e-4, 1e-12, 0);
  assert_close(recording->channels[1].filter_Hz, 50, 1e-12, 0);
  assert_false(is_said(DEA_NOTE, "left out"));
  // the unit of times that are found by themselves; times that a rate replaces are told
  record_text("Time,HV\n5,0\n6,1\n7,2\n", "dea-import: 1\ntime_unit: ms\ncolumns:\n"
                                          "  - {column: HV, as: voltage, unit: kV}\n");
  assert_close(recording->channels[0].start_s, 5e-3, 1e-12, 0);
  assert_close(recording->channels[0].interval_s, 1e-3, 1e-12, 0);
  record_text("Time (s),HV\n5,0\n6,1\n7,2\n", "dea-import: 1\nrate: 10 kHz\ncolumns:\n"
                                              "  - {column: HV, as: voltage, unit: kV}\n");
  assert_close(recording->channels[0].interval_s, 1e-4, 1e-12, 0);
  assert_true(is_said(DEA_WARNING, "in place of the times 'Time'"));
  // the file's own unit of its times counts
  record_text("Time (s),HV\n5,0\n6,1\n7,2\n", "dea-import: 1\ntime_unit: ms\ncolumns:\n"
                                              "  - {column: HV, as: voltage, unit: kV}\n");
  assert_close(recording->channels[0].interval_s, 1, 1e-12, 0);
  // a clock of its own, and one that is not uniform
  record_text("t1 (ms),V (kV),t2 (s),F (mN)\n0,1,5,1\n1,2,5.1,2\n2,3,7,3\n",
              "dea-import: 1\ntime: t1\ncolumns:\n  - {column: V, as: voltage}\n"
              "  - {column: F, as: force, per_unit: -2, time: t2}\n");
  const struct dea_channel *force = dea_recording_kind(recording, DEA_CHANNEL_FORCE);
  assert_true(force->interval_s == 0);
  assert_close(force->time_s[1], 5.1, 1e-15, 0);
  assert_close(force->values[2], -0.006, 1e-14, 0);
  assert_close(recording->channels[0].interval_s, 1e-3, 1e-12, 0);
}

TEST(test_profile)
{
  const char *text = "t (s),z1,z2,z3,zero\n0,1,2,3,9\n0.5,4,5,6,9\n";
  for (int turned = 0; turned < 2; turned++) {
    record_text(
        turned ? "t (s),front z1,front z2,front z3,zero\n0,,2,3,9\n0.5,4,5,6,9\n" : text,
        turned ? "dea-import: 1\nprofile: {columns: '*z*', unit: mm, x_from: 15 mm, x_to: -15 mm}\n"
                 "columns: [{column: zero, as: other}]\n"
               : "dea-import: 1\nprofile: {columns: 'z*', unit: mm, per_unit: -1, at_zero: 7 mm, "
                 "x_from: -1 mm, x_to: 1 mm}\ncolumns: [{column: zero, as: other}]\n");
    const struct dea_profiles *p = &recording->profiles;
    assert_int_equal(p->points, 3);
    assert_int_equal(p->count, 2);
    assert_close(p->time_s[1], 0.5, 1e-15, 0);
    assert_close(p->x_m[0], turned ? -0.015 : -0.001, 1e-14, 0);
    assert_close(p->x_m[2], turned ? 0.015 : 0.001, 1e-14, 0);
    if (turned) { // places that fall are turned round
      assert_close(p->z_m[0], 3e-3, 1e-14, 0);
      assert_true(isnan(p->z_m[2]));
    } else {
      assert_close(p->z_m[0], 6e-3, 1e-14, 0);
      assert_close(p->z_m[5], 1e-3, 1e-14, 0);
    }
  }
}

/* What is wrong in a mapping, with its place; table NULL: already when it is read. */
TEST(test_mapping_errors)
{
  static const struct {
    const char *table, *map;
    size_t line;
    const char *part;
  } cases[] = {
      {NULL, "columns: []\n", 1, "dea-import"},
      {NULL, "dea-import: 2\n", 1, "dea-import"},
      {NULL, "dea-import: 1\nrate: 10 kHz\ntime: t\n", 3, "rate"},
      {NULL, "dea-import: 1\nrate: 10 ms\n", 2, "frequency"},
      {NULL, "dea-import: 1\ncolums: []\n", 2, "columns"},
      {NULL, "dea-import: 1\ncolumns:\n  - {column: a, as: volts}\n", 3, "volt"},
      {NULL, "dea-import: 1\ncolumns:\n  - {column: a, as: force}\n  - {column: A, as: force}\n", 4,
       "taken in line 3"},
      {NULL, "dea-import: 1\nprofile: {columns: z*}\n", 2, "x_from"},
      {"t,Voltage\n0,1\n1,2\n", "dea-import: 1\ncolumns:\n  - {column: Voltag, as: voltage}\n", 3,
       "did you mean 'Voltage'"},
      {"t,V (kV)\n0,1\n1,2\n", "dea-import: 1\ncolumns:\n  - {column: V, as: force}\n", 3,
       "is in 'kV', not in N"},
      {"t,V\n0,1\n1,2\n", "dea-import: 1\ncolumns:\n  - {column: V, as: voltage, unit: mm}\n", 3,
       "'mm' is no unit that becomes V"},
      {"t,V\n0,1\n1,2\n", "dea-import: 1\ncolumns:\n  - {column: V, as: voltage, per_unit: 1 mm}\n",
       3, "per_unit"},
      {"t,V\n0,1\n1,2\n", "dea-import: 1\ncolumns:\n  - {column: V, as: voltage, per_unit: 0}\n", 3,
       "must not be 0"},
      {"t,V\n0,1\n1,2\n", "dea-import: 1\ntime: V\ncolumns:\n  - {column: V, as: voltage}\n", 4,
       "taken as time already"},
      {"t,V\n0,1\n1,2\n", "dea-import: 1\nprofile: {columns: q*, x_from: 0 mm, x_to: 1 mm}\n", 2,
       "names 0 columns"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_mapping *mapping = NULL;
    if (cases[i].table != NULL) {
      read_text("t.csv", cases[i].table);
    }
    dea_finding_clear(ctx);
    dea_status status =
        dea_mapping_read_memory(ctx, "map.yaml", cases[i].map, strlen(cases[i].map), &mapping);
    if (cases[i].table != NULL) {
      assert_int_equal(status, DEA_OK);
      status = record_table(mapping);
    }
    assert_int_equal(status, DEA_E_DESIGN);
    size_t count, found = 0;
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    for (size_t k = 0; k < count; k++) {
      found += findings[k].severity == DEA_ERROR && findings[k].location.line == cases[i].line &&
               strstr(findings[k].text, cases[i].part) != NULL;
    }
    if (found == 0) {
      fail_msg("case %zu: '%s' at line %zu is not said; %s", i, cases[i].part, cases[i].line,
               count > 0 ? findings[0].text : "nothing");
    }
    dea_mapping_destroy(ctx, mapping);
  }
}

TEST(test_clock_errors)
{
  static const struct {
    const char *text, *part;
  } cases[] = {
      {"t (s),V (kV)\n0,1\n1,2\n1,3\n2,4\n", "repeats 1 in row 3"},
      {"t (s),V (kV)\n0,1\n1,2\n2,3\n0,4\n1,5\n", "starts again in row 4"},
      {"t (s),V (kV)\n0,1\n1,2\n2,3\n1.5,4\n", "falls in row 4"},
      {"t (s),V (kV)\n3,1\n2,2\n1,3\n0,4\n", "falls in row 2"},
      {"t (s),V (kV)\n0,1\n,2\n2,3\n", "no time in row 2 of its numbers, where 'V'"},
      {"t (s),V (kV)\n0,1\n1,2\n2,\n,3\n,\n", "no time in row 4"},
      {"Time,V (kV)\n,\n46348.4188,1\n46348.4189,2\n46348.4190,3\n", "spreadsheet"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    read_text("t.csv", cases[i].text);
    assert_int_equal(record_table(NULL), DEA_E_IO);
    assert_true(is_said(DEA_ERROR, cases[i].part));
  }
  read_text("t.csv", "V (kV),F (N)\n1,2\n2,3\n");
  assert_int_equal(record_table(NULL), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "rate: 10 kHz"));
  read_text("t.csv", "a,b\n1,2\n2,3\n");
  assert_int_equal(record_table(NULL), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "could be taken for anything"));
}

/* Columns on clocks of their own end where their times do: the shorter ones are blank from there
 * on. Rows without a time and without a value say nothing. */
TEST(test_rows_without_a_time)
{
  record_text("t1 (s),V (kV),t2 (ms),z (um)\n,,,\n0,1,0,5\n1,2,500,6\n,,1000,\n2,,,\n3,4,,\n",
              NULL);
  const struct dea_channel *v = &recording->channels[0], *z = &recording->channels[1];
  assert_int_equal(v->count, 4);
  assert_close(v->interval_s, 1, 1e-12, 0);
  assert_true(v->values[1] == 2000 && isnan(v->values[2]) && v->values[3] == 4000);
  assert_int_equal(z->count, 3);
  assert_close(z->interval_s, 0.5, 1e-12, 0);
  assert_close(z->values[1], 6e-6, 1e-12, 0);
  assert_true(isnan(z->values[2]));
  record_text("t (s),V (kV)\n0,1\n1,2\n,\n5,3\n", NULL);
  assert_int_equal(recording->channels[0].count, 3);
  assert_true(recording->channels[0].time_s[2] == 5 && recording->channels[0].values[2] == 3000);
}

/* A column in ms that is always the same is no clock. */
TEST(test_constant_times)
{
  record_text("Time (s),Exposure (ms),V (kV)\n0,3,1\n1,3,2\n2,3,3\n", NULL);
  assert_int_equal(recording->channel_count, 1);
  assert_close(recording->channels[0].interval_s, 1, 1e-12, 0);
}

/* Times written with few digits are uniform; a lost sample is not. Since 1970 becomes since 0. */
TEST(test_jitter)
{
  record_text("t (s),V (kV)\n0.000000,1\n0.000333,2\n0.000667,3\n0.001000,4\n", NULL);
  assert_close(recording->channels[0].interval_s, 1.0 / 3000, 1e-6, 0);
  record_text("t (s),V (kV)\n0,1\n1,2\n3,3\n4,4\n", NULL);
  assert_true(recording->channels[0].interval_s == 0);
  record_text("t (s),V (kV)\n1700000000,1\n1700000001,2\n1700000002,3\n", NULL);
  assert_true(recording->channels[0].start_s == 0);
  assert_true(is_said(DEA_NOTE, "the first one becomes 0"));
}

/* Times of day count from their first, which must be the same moment in both files. */
TEST(test_join_of_times_of_day)
{
  static const struct {
    const char *other;
    bool same;
  } cases[] = {
      {"Timestamp,z (um)\n2026-03-02 10:00:00,1\n2026-03-02 10:00:01,2\n", true},
      {"Timestamp,z (um)\n2026-03-02 10:00:30,1\n2026-03-02 10:00:31,2\n", false},
      {"Timestamp,z (um)\n2026-03-03 10:00:00,1\n2026-03-03 10:00:01,2\n", false},
      {"Time,z (um)\n10:00:00.0,1\n10:00:01.0,2\n", true},
      {"Time,z (um)\n10:00:30,1\n10:00:31,2\n", false},
      {"Time (s),z (um)\n0,1\n1,2\n", true},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    read_text("a.csv", "Timestamp,V (kV)\n2026-03-02 10:00:00,1\n2026-03-02 10:00:01,2\n");
    dea_status status = join_text("b.csv", cases[i].other);
    if (status != (cases[i].same ? DEA_OK : DEA_E_IO)) {
      fail_msg("case %zu: %s", i, dea_status_name(status));
    }
  }
  dea_context_clear(ctx);
}

TEST(test_join)
{
  read_text("a.csv", "t (s),V (kV)\n0,1\n1,2\n2,3\n");
  assert_int_equal(join_text("b.csv", "time (ms),F (mN)\n0,4\n1000,5\n2000,6\n"), DEA_OK);
  assert_int_equal(table->column_count, 3);
  static const double f[] = {4, 5, 6};
  assert_column("F", "mN", f, 3);
  assert_int_equal(join_text("b.csv", "time (ms),F (mN)\n0,4\n1000,5\n2500,6\n"), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "different clocks"));
}

// COMSOL -----------------------------------------------------------------------------------------

#define COMSOL                                                                                     \
  "% Model:              disc.mph\n% Version:            COMSOL 5.6.0.280\n"                       \
  "% Date:               May 3 2023, 10:00\n% Dimension:          1\n% Nodes:              3\n"

TEST(test_comsol)
{
  static const double x[] = {0, 0.5, 1}, w[] = {1e-3, -2.5e-2, NAN}, w2[] = {5, 6, 7};
  read_text("comsol.txt",
            COMSOL "% Expressions:        2\n% Description:        Displacement field\n"
                   "% Length unit:        mm\n"
                   "% X                       w (um) @ t=0.1           w (um) @ t=0.2\n"
                   "0                         0.001                    5\n"
                   "0.5                       -2.5E-2                  6\n"
                   "1                         NaN                      7\n");
  assert_string_equal(table->format, "comsol");
  assert_column("X", "mm", x, 3);
  assert_column("w (um) @ t=0.1", "um", w, 3);
  assert_column("w (um) @ t=0.2", "um", w2, 3);
  assert_non_null(strstr(table->note, "disc.mph"));
  read_text("table.csv", COMSOL "% Table:              Table 1 - Point (pt1)\n"
                                "% V0 (kV),\"w, centre (mm)\"\n0,0.001\n0.5,-0.025\n1,NaN\n");
  assert_column("V0", "kV", x, 3);
  assert_column("w, centre", "mm", w, 3);
  read_text("blanks.txt", COMSOL "% Time (s) V0 (kV) Line integration (N)\n"
                                 "0 5 0\n0.5 6 0.5\n1 7 1\n");
  assert_column("Time", "s", x, 3);
  assert_column("V0", "kV", w2, 3);
  assert_column("Line integration", "N", x, 3);
}

TEST(test_comsol_sections)
{
  static const double x[] = {0, 0.5, 1}, w[] = {5, 6, 7};
  read_text("sections.txt",
            COMSOL "% Length unit:        m\n% Coordinates\n0\n0.5\n1\n% Elements (edges)\n"
                   "1 2\n2 3\n% Data (w (um))\n5\n6\n7\n");
  assert_int_equal(table->column_count, 2);
  assert_column("x", "m", x, 3);
  assert_column("w", "um", w, 3);
}

static void record_once(struct dea_context *own)
{
  struct dea_table *read;
  struct dea_mapping *mapping = NULL;
  struct dea_recording *made = NULL;
  const char *map = "dea-import: 1\ncolumns: [{column: V, as: voltage}]\n"
                    "profile: {columns: 'z*', unit: mm, x_from: 0 mm, x_to: 1 mm}\n";
  dea_status status = dea_mapping_read_memory(own, "m", map, strlen(map), &mapping);
  status = status == DEA_OK ? dea_table_read(own, in_folder("memory.csv"), NULL, &read) : status;
  if (status == DEA_OK) {
    status = dea_table_record(own, read, mapping, &made);
    dea_table_destroy(own, read);
  }
  failing_check(own, status);
  dea_recording_destroy(own, made);
  dea_mapping_destroy(own, mapping);
}

TEST(test_memory)
{
  const char *text = "t (s),V (kV),z1,z2\n0,1,1,1\n1,2,1,2\n3,3,1,2\n";
  write_bytes("memory.csv", text, strlen(text));
  assert_true(failing_each(record_once) > 20);
}

TESTS(set_up, import_tear_down)
