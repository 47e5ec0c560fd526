/* Files as instruments and spreadsheets of other countries write them (lab/tests/cases). */
#include "import_text.h"

#include "recording/recording.h"

#define CASES DEA_SOURCE_DIR "/lab/tests/cases/"

/* Records a file, guessed; NULL: it is refused. */
static void record(const char *name)
{
  char file[400];
  snprintf(file, sizeof file, CASES "%s", name);
  dea_recording_destroy(ctx, recording);
  recording = NULL;
  if (read_table(file) == DEA_OK) {
    (void)record_table(NULL);
  }
}

static const struct dea_channel *channel_of(enum dea_channel_kind kind, size_t nth)
{
  for (size_t i = 0; recording != NULL && i < recording->channel_count; i++) {
    if (recording->channels[i].kind == kind && nth-- == 0) {
      return &recording->channels[i];
    }
  }
  fail_msg("no such channel; %s", dea_context_message(ctx));
  return NULL;
}

static void assert_values(const struct dea_channel *channel, double start_s, double interval_s,
                          const double *values, size_t count)
{
  assert_int_equal(channel->count, count);
  assert_null(channel->time_s);
  assert_close(channel->start_s, start_s, 1e-9, 1e-12);
  assert_close(channel->interval_s, interval_s, 1e-9, 0);
  for (size_t i = 0; i < count; i++) {
    if (!(isnan(values[i]) ? isnan(channel->values[i])
                           : fabs(channel->values[i] - values[i]) < 1e-12)) {
      fail_msg("%s[%zu] = %.10g, wanted %.10g", channel->name, i, channel->values[i], values[i]);
    }
  }
}

/* A finding that holds all of the text, at that line (0: any). */
static void assert_error(const char *name, size_t line, const char *part)
{
  size_t count;
  record(name);
  const struct dea_finding *findings = dea_finding_get(ctx, &count);
  for (size_t i = 0; recording == NULL && i < count; i++) {
    if (findings[i].severity == DEA_ERROR && strstr(findings[i].text, part) != NULL &&
        (line == 0 || findings[i].location.line == line)) {
      return;
    }
  }
  fail_msg("%s: '%s' in line %zu is not said: %s", name, part, line,
           count > 0 ? findings[count - 1].text : "");
}

/* Separators at the ends of rows that the titles do not have. */
TEST(test_trailing_blanks)
{
  static const char *const names[] = {"comma", "ds1204b", "semi", "tab"};
  static const double v2[] = {1, 1.5, 2}, v4[] = {2, 2.5, 3};
  for (size_t i = 0; i < 4; i++) {
    char name[64];
    snprintf(name, sizeof name, "scope-trailing-blank/%s.csv", names[i]);
    record(name);
    const struct dea_channel *second = channel_of(DEA_CHANNEL_VOLTAGE, 0);
    assert_string_equal(second->name, "CH2");
    assert_values(second, -1e-3, 1e-3, v2, 3);
    assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 1), -1e-3, 1e-3, v4, 3);
  }
}

/* A data logger whose milliseconds stand in a column of their own, with words over the range. */
TEST(test_graphtec)
{
  static const char *const names[] = {"gl240", "gl240-en", "gl980", "over", "sign-space"};
  for (size_t i = 0; i < 5; i++) {
    char name[64];
    double volt[7], newton[7];
    for (size_t k = 0; k < 7; k++) {
      volt[k] = 0.5 * (double)k;
      newton[k] = 1e-4 * (double)k;
    }
    volt[3] = i == 3 ? NAN : volt[3];
    snprintf(name, sizeof name, "graphtec/%s.csv", names[i]);
    record(name);
    assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 0), 0, 0.2, volt, 7);
    assert_values(channel_of(DEA_CHANNEL_FORCE, 0), 0, 0.2, newton, 7);
  }
  record("graphtec/slow-1500ms.csv");
  static const double slow[] = {0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5};
  assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 0), 0, 1.5, slow, 8);
}

TEST(test_repeated_rows)
{
  assert_error("duplicate-row/first-twice.csv", 0, "row 2 repeats the time of row 1: take one out");
  assert_error("duplicate-row/last-twice.csv", 0, "row 4 repeats the time of row 3: take one out");
  assert_error("duplicate-row/one-in-the-middle.csv", 0,
               "row 4 repeats the time of row 3: take one out");
}

/* The first field with marks between thousands is quoted with its line. */
TEST(test_thousands)
{
  assert_error("thousands/de-thousands.csv", 3, "'1.000' has marks between thousands");
  assert_error("thousands/french-space.csv", 3, "'1 000' has marks between thousands");
  assert_error("thousands/late.csv", 6, "'1.002.000' has marks between thousands");
  assert_error("thousands/nbsp.csv", 3, "000' has marks between thousands");
  assert_error("thousands/swiss.csv", 3, "'1'000' has marks between thousands");
  assert_error("thousands/us-quoted.csv", 3, "'1,000' has marks between thousands");
  assert_error("thousands/value-two-marks.csv", 2, "'1.002.000' has marks between thousands");
}

/* A column that a mapping names is never left out in silence. */
TEST(test_named_column_of_text)
{
  read_text("t.csv", "t (s),V (kV),F (N)\n0,1,1\n1,sat,1\n2,sat,1\n");
  struct dea_mapping *mapping = map_text("dea-import: 1\ncolumns:\n  - {column: V, as: voltage}\n");
  assert_int_equal(record_table(mapping), DEA_E_DESIGN);
  assert_true(is_said(DEA_ERROR, "'sat' of the column 'V' is not a number"));
  dea_mapping_destroy(ctx, mapping);
}

/* Letters of Shift-JIS hold bytes of ASCII that are no words; full-width units are units. */
TEST(test_encodings)
{
  static const char *const names[] = {"laser-mm", "fullwidth-unit"};
  static const double kilovolt[] = {0, 1e3, 2e3}, mm[] = {0, 1e-4, 2e-4};
  for (size_t i = 0; i < 2; i++) {
    char name[64];
    snprintf(name, sizeof name, "shift-jis/%s.csv", names[i]);
    record(name);
    assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 0), 0, 0.1, kilovolt, 3);
    assert_values(channel_of(DEA_CHANNEL_DISPLACEMENT, 0), 0, 0.1, mm, 3);
  }
  static const char *const frames[] = {"same-utf8", "utm", "utm-units-row"};
  static const double newton[] = {0, 0.015, 0.031, 0.046}, way[] = {0, 1e-4, 2e-4, 3e-4};
  for (size_t i = 0; i < 3; i++) {
    char name[64];
    snprintf(name, sizeof name, "shift-jis/%s.csv", frames[i]);
    record(name);
    const struct dea_channel *force = channel_of(DEA_CHANNEL_FORCE, 0);
    assert_string_equal(force->name, "\xe8\xa9\xa6\xe9\xa8\x93\xe5\x8a\x9b");
    assert_values(force, 0, 0.1, newton, i == 1 ? 4 : 3);
    assert_values(channel_of(DEA_CHANNEL_DISPLACEMENT, 0), 0, 0.1, way, i == 1 ? 4 : 3);
  }
  record("shift-jis/laser-no-unit.csv");
  assert_int_equal(recording->channel_count, 1); // the laser's unit is not said
  assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 0), 0, 0.1, kilovolt, 3);
  static const double um[] = {0, 1e-5, 2e-5};
  record("shift-jis/cp1251.csv");
  assert_values(channel_of(DEA_CHANNEL_VOLTAGE, 0), 0, 0.1, kilovolt, 3);
  assert_values(channel_of(DEA_CHANNEL_DISPLACEMENT, 0), 0, 0.1, um, 3);
  assert_error("shift-jis/korean.csv", 1,
               "letters in an encoding that is not known: save as UTF-8");
}

TESTS(set_up, import_tear_down)
