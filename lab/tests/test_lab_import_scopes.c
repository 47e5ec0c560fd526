/* Files of oscilloscopes: one shot, 1 kHz from -1 ms on, as each maker writes it. */
#include "import_text.h"

static const double times_s[] = {-1e-3, 0, 1e-3, 2e-3}, first_V[] = {0, 1.5, 3, 1.5},
                    second_V[] = {0.01, 0.02, 0.03, 0.02};

/* A channel of the shot; per_V: what 1 V stands for. */
static void assert_shot(const char *name, enum dea_channel_kind kind, const double *volts,
                        double per_V)
{
  const struct dea_channel *c = dea_recording_channel(recording, name);
  assert_non_null(c);
  assert_int_equal(c->kind, kind);
  assert_int_equal(c->count, 4);
  assert_close(c->start_s, -1e-3, 1e-9, 0);
  assert_close(c->interval_s, 1e-3, 1e-9, 0);
  for (size_t i = 0; i < 4; i++) {
    assert_close(c->values[i], per_V * volts[i], 1e-12, 1e-15);
  }
}

static void assert_both(const char *first, const char *second)
{
  assert_shot(first, DEA_CHANNEL_VOLTAGE, first_V, 1e3);
  assert_shot(second, DEA_CHANNEL_CURRENT, second_V, 1e-3);
}

#define MONITORS(first, second)                                                                    \
  "dea-import: 1\ncolumns:\n"                                                                      \
  "  - {column: " first ", as: voltage, per_unit: 1 kV}\n"                                         \
  "  - {column: " second ", as: current, per_unit: 1 mA}\n"

#define TDS(source, a, b, c, d)                                                                    \
  "Record Length,4.000000e+00,,-00000.001000000000,  " a ",\r\n"                                   \
  "Sample Interval,1.000000e-03,,000000.000000000000,  " b ",\r\n"                                 \
  "Source," source ",,000000.001000000000,  " c ",\r\n"                                            \
  "Vertical Units,V,,000000.002000000000,  " d ",\r\n"

/* TDS: a file a channel, with its header beside the first samples. */
TEST(test_beside)
{
  read_text("F0000CH1.CSV", TDS("CH1", "0.00", "1.50", "3.00", "1.50"));
  assert_string_equal(table->format, "tektronix");
  assert_column("Time", "s", times_s, 4);
  assert_column("CH1", "V", first_V, 4);
  assert_non_null(strstr(table->note, "; Sample Interval: 1.000000e-03;"));
  struct dea_mapping *mapping = map_text(MONITORS("CH1", "CH2"));
  assert_int_equal(join_text("F0000CH2.CSV", TDS("CH2", "0.01", "0.02", "0.03", "0.02")), DEA_OK);
  assert_int_equal(join_text("copy.CSV", TDS("CH1", "0.00", "1.50", "3.00", "1.50")), DEA_E_IO);
  assert_non_null(strstr(dea_context_message(ctx), "already, value by value"));
  assert_int_equal(record_table(mapping), DEA_OK);
  assert_both("CH1", "CH2");
  dea_mapping_destroy(ctx, mapping);
  // TDS3000: with quotes, a word between, no comma at the end; a header longer than the record
  read_text("tek.csv", "\"Record Length\",4,\"Points\",-1E-3,0\n"
                       "\"Sample Interval\",1.0E-3,\"s\",0,1.5\n"
                       "\"Vertical Units\",\"V\",,1E-3,3\n\"Source\",\"CH3\",,2E-3,1.5\n");
  assert_column("Time", "s", times_s, 4);
  assert_column("CH3", "V", first_V, 4);
  const char *odd = "Record Length,4,,-0.001,0,\n,,,oops,1,\n,,,0.001,2,\n";
  assert_refused("odd.csv", odd, strlen(odd), 2, "'oops' is not a number");
}

/* Where the samples begin and how far apart they are, at the end of the names or below them. */
TEST(test_start_and_increment)
{
  record_file("ds1.csv",
              "X,CH1,CH2,Start,Increment,\r\n"
              "Sequence,VOLT,VOLT,-1.000000e-03,1.000000e-03\r\n"
              "0,0.00e+00,1.00e-02,\r\n1,1.50e+00,2.00e-02,\r\n"
              "2,3.00e+00,3.00e-02,\r\n3,1.50e+00,2.00e-02,\r\n",
              MONITORS("CH1", "CH2"));
  assert_both("CH1", "CH2");
  record_file("mso5.csv",
              "Time(s),CH1V,CH2V,t0 =-1.000000e-03, tInc = 1.000000e-03,\r\n"
              "-1.000000e-03,0.00,0.01,\r\n0.000000e+00,1.50,0.02,\r\n"
              "1.000000e-03,3.00,0.03,\r\n2.000000e-03,1.50,0.02,\r\n",
              MONITORS("CH1", "CH2"));
  assert_both("CH1", "CH2");
  record_file("memory.csv",
              "CH1V,CH2V,t0 =-1.000000e-03s, tInc = 1.000000e-03s\n"
              "0.00,0.01,\n1.50,0.02,\n3.00,0.03,\n1.50,0.02,\n",
              MONITORS("CH1", "CH2"));
  assert_both("CH1", "CH2");
  // every other sample, and one that is missing: the number of each counts
  record_file("sparse.csv",
              "X,CH1,Start,Increment,\nSequence,Volt,-1e-3,5e-4\n"
              "0,0,\n2,1.5,\n4,3,\n6,1.5,\n",
              NULL);
  assert_shot("CH1", DEA_CHANNEL_VOLTAGE, first_V, 1);
  record_file("gap.csv",
              "X,CH1,Start,Increment,\nSequence,Volt,-1e-3,1e-3\n"
              "0,0,\n1,1.5,\n3,1.5,\n",
              NULL);
  assert_close(dea_channel_time(&recording->channels[0], 2), 2e-3, 1e-12, 0);
  // times of seven digits, which repeat: the header knows them better
  record_file("fine.csv",
              "\xef\xbb\xbfTime(s),CH1V,t0 =-0.2, tInc = 2e-08,\n"
              "-2.000000e-01,0,\n-2.000000e-01,1.5,\n-2.000000e-01,3,\n",
              NULL);
  assert_close(recording->channels[0].start_s, -0.2, 1e-12, 0);
  assert_close(recording->channels[0].interval_s, 2e-8, 1e-6, 0);
  // words that are no such thing
  read_text("list.csv", "Sample,Start,Increment\n1,2,3\n2,4,6\n");
  assert_string_equal(table->format, "csv");
  assert_int_equal(table->column_count, 3);
}

/* With lines above the numbers, as other text. */
TEST(test_lines_above)
{
  record_file("dpo.csv",
              "Model,MSO2024\r\nPoint Format,Y,\r\nHorizontal Units,S,\r\n"
              "Sample Interval,1e-03,\r\nRecord Length,4,\r\nProbe Attenuation,1,1\r\n"
              "Vertical Units,V,A\r\nVertical Offset,0,0\r\nVertical Scale,1,0.01\r\n"
              "\r\nLabel,,\r\nTIME,CH1,CH2\r\n-1e-3,0,0.01\r\n0,1.5,0.02\r\n"
              "1e-3,3,0.03\r\n2e-3,1.5,0.02\r\n",
              MONITORS("CH1", "CH2"));
  assert_both("CH1", "CH2");
  read_text("units.csv", "Vertical Units,V,A\nLabel,,\nTIME,CH1,CH2\n"
                         "-1e-3,0,0.01\n0,1.5,0.02\n1e-3,3,0.03\n"
                         "2e-3,1.5,0.02\n");
  assert_column("TIME", "", times_s, 4);
  assert_column("CH1", "V", first_V, 4);
  assert_column("CH2", "A", second_V, 4);
  read_text("words.csv", "Second,Volt,Ampere\n-1e-3,0,0.01\n0,1.5,0.02\n1e-3,3,0.03\n"
                         "2e-3,1.5,0.02\n");
  assert_column("Second", "Second", times_s, 4);
  assert_column("Ampere", "Ampere", second_V, 4);
  // the unit of a product is none that is known; the others stay
  read_text("product.csv", "Vertical Units,V,VV\nLabel,,\nTIME,CH1,MATH\n"
                           "-1e-3,0,0.01\n0,1.5,0.02\n1e-3,3,0.03\n2e-3,1.5,0.02\n");
  assert_column("CH1", "V", first_V, 4);
  assert_column("MATH", "", second_V, 4);
  // a title's own unit counts, and "In" is a name
  read_text("own.csv", "Vertical Units,V,A\nt (s),CH1 (mV),In mV\n-1e-3,0,0.01\n0,1.5,0.02\n"
                       "1e-3,3,0.03\n2e-3,1.5,0.02\n");
  assert_column("CH1", "mV", first_V, 4);
  assert_column("In", "mV", second_V, 4);
  static const struct {
    const char *name, *text, *columns[2];
  } files[] = {
      {"rohde-schwarz.csv",
       "in s,C1 in V,C2 in V\n-1e-3,0,0.01\n0,1.5,0.02\n1e-3,3,0.03\n2e-3,1.5,0.02\n",
       {"C1", "C2"}},
      {"keysight.csv",
       "x-axis,1,2\nsecond,Volt,Volt\n-1.0E-03,0,0.01\n0,1.5,0.02\n1E-3,3,0.03\n2E-3,1.5,0.02\n",
       {"1", "2"}},
      {"siglent.csv",
       "Record Length,Analog:4\nSample Interval,Analog:0.001\nVertical Units,CH1:V,CH2:V\n"
       "Model Number,SDS1104X-E\nSource,CH1,CH2\nSecond,Volt,Volt\n"
       "-0.001,0,0.01\n0,1.5,0.02\n0.001,3,0.03\n0.002,1.5,0.02\n",
       {"CH1", "CH2"}},
      {"picoscope.csv",
       "Time,Channel A,Channel B\n(ms),(V),(V)\n\n-1,0,0.01\n0,1.5,0.02\n1,3,0.03\n2,1.5,0.02\n",
       {"Channel A", "Channel B"}},
      {"analog-discovery.csv",
       "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n"
       "#Sample rate: 1000Hz\n#Samples: 4\n\nTime (s),Channel 1 (V),Channel 2 (V)\n"
       "-0.001,0,0.01\n0,1.5,0.02\n0.001,3,0.03\n0.002,1.5,0.02\n",
       {"Channel 1", "Channel 2"}}};
  for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
    const char *const *c = files[i].columns;
    char map[300];
    snprintf(map, sizeof map, MONITORS("\"%s\"", "\"%s\""), c[0], c[1]);
    record_file(files[i].name, files[i].text, map);
    assert_both(c[0], c[1]);
  }
}

TESTS(set_up, import_tear_down)
