/* Import of LabVIEW's binary measurements, built byte by byte from NI's published layout. */
#include "import_text.h"

#include <stdint.h>

enum { METADATA = 2, NEW_LIST = 4, RAW = 8, INTERLEAVED = 32, BIG = 64, DAQMX = 128 };
enum { NONE = -1, AS_BEFORE = 0 };

/* A file in the making. */
static unsigned char bytes[1 << 20];
static size_t length, segment, raw_at;
static bool big;

static void put(uint64_t value, size_t size)
{
  for (size_t i = 0; i < size; i++) {
    bytes[length++] = (unsigned char)(value >> 8 * (big ? size - 1 - i : i));
  }
}

static void put_text(const char *text)
{
  put(strlen(text), 4);
  memcpy(bytes + length, text, strlen(text));
  length += strlen(text);
}

static void put_double(double value)
{
  uint64_t bits;
  memcpy(&bits, &value, sizeof bits);
  put(bits, 8);
}

/* A lead-in whose lengths end_segment fills in. */
static void begin_segment(unsigned contents)
{
  segment = length;
  memcpy(bytes + length, "TDSm", 4);
  length += 4;
  big = false;
  put(contents, 4);
  big = (contents & BIG) != 0;
  put(4713, 4);
  put(0, 8);
  put(0, 8);
  raw_at = length;
}

/* A file of one segment with so many objects. */
static void begin_file(unsigned contents, size_t objects)
{
  length = 0;
  begin_segment(METADATA | NEW_LIST | contents);
  put(objects, 4);
}

static void begin_raw(void)
{
  raw_at = length;
}

static void end_segment(void)
{
  size_t end = length;
  length = segment + 12;
  put(end - segment - 28, 8);
  put(raw_at - segment - 28, 8);
  length = end;
}

/* A channel with `count` values of a type in this segment, or NONE, or AS_BEFORE. */
static void put_object(const char *name, unsigned type, int count, unsigned properties)
{
  put_text(name);
  if (count == NONE) {
    put(0xffffffff, 4);
  } else if (count == AS_BEFORE) {
    put(0, 4);
  } else {
    put(20, 4);
    put(type, 4);
    put(1, 4);
    put((uint64_t)count, 8);
  }
  put(properties, 4);
}

static void put_real_property(const char *name, double value)
{
  put_text(name);
  put(10, 4);
  put_double(value);
}

static void put_text_property(const char *name, const char *value)
{
  put_text(name);
  put(0x20, 4);
  put_text(value);
}

/* "/", "/'bench'" and two channels of two values. */
static void put_bench(unsigned contents)
{
  begin_file(contents, 4);
  put_object("/", 0, NONE, 1);
  put_text_property("name", "a run");
  put_object("/'bench'", 0, NONE, 0);
  put_object("/'bench'/'HV'", 10, 2, 3);
  put_real_property("wf_increment", 0.001);
  put_real_property("wf_start_offset", 0.5);
  put_text_property("unit_string", "kV");
  put_object("/'bench'/'Dev1/ai0'", 2, 2, 0); // int16
  begin_raw();
}

TEST(test_segments)
{
  static const double hv[] = {1.5, -2.25, 3, 4, 5, 6, 7, 8}, ai[] = {-1, 300, 7, 8};
  for (unsigned endian = 0; endian <= BIG; endian += BIG) {
    put_bench(RAW | endian);
    put_double(1.5);
    put_double(-2.25);
    put((uint64_t)-1, 2);
    put(300, 2);
    end_segment();
    // no metadata: as before, and two chunks of it, the second cut
    begin_segment(RAW | endian);
    put_double(3);
    put_double(4);
    put(7, 2);
    put(8, 2);
    put_double(5);
    end_segment();
    // one channel goes on with another number of values, the other one has none
    begin_segment(METADATA | RAW | endian);
    put(2, 4);
    put_object("/'bench'/'HV'", 10, 3, 0);
    put_object("/'bench'/'Dev1/ai0'", 0, NONE, 0);
    begin_raw();
    put_double(6);
    put_double(7);
    put_double(8);
    end_segment();
    read_bytes("run.tdms", bytes, length);
    assert_string_equal(table->format, "tdms");
    assert_int_equal(table->column_count, 2);
    assert_column("HV", "kV", hv, 8);
    assert_column("Dev1/ai0", "", ai, 4);
    assert_true(table->columns[0].interval == 0.001 && table->columns[0].start == 0.5);
    assert_true(isnan(table->columns[1].interval));
  }
}

TEST(test_interleaved)
{
  static const double hv[] = {1, 2, 3}, ai[] = {10, 20, 30};
  put_bench(RAW | INTERLEAVED);
  for (int i = 1; i <= 3; i++) {
    put_double(i);
    put((uint64_t)(10 * i), 2);
  }
  end_segment();
  read_bytes("run.tdms", bytes, length);
  assert_column("HV", "kV", hv, 3);
  assert_column("Dev1/ai0", "", ai, 3);
}

TEST(test_types)
{
  static const struct {
    unsigned type, size;
    uint64_t bits;
    double value;
  } types[] = {
      {1, 1, 0x80, -128},
      {2, 2, 0xfffe, -2},
      {3, 4, 0x80000000, -2147483648.0},
      {4, 8, UINT64_MAX, -1},
      {5, 1, 200, 200},
      {6, 2, 65535, 65535},
      {7, 4, 4294967295, 4294967295.0},
      {8, 8, 1ull << 63, 9223372036854775808.0},
      {9, 4, 0x3fc00000, 1.5},
      {0x19, 4, 0xbfc00000, -1.5},
      {0x1a, 8, 0x4000000000000000, 2},
      {0x21, 1, 1, 1},
  };
  for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
    begin_file(RAW | (i % 2 ? BIG : 0), 1);
    put_object("/'g'/'it''s'", types[i].type, 1, 0);
    begin_raw();
    put(types[i].bits, types[i].size);
    end_segment();
    read_bytes("type.tdms", bytes, length);
    assert_column("it's", "", &types[i].value, 1);
  }
}

TEST(test_times_and_texts)
{
  static const double t[] = {0, 0.25}, v[] = {5, 6};
  begin_file(RAW, 3);
  put_object("/'g'/'when'", 0x44, 2, 0);
  put_text("/'g'/'words'"); // texts: offsets, then letters; 4 + 4 + 3 bytes
  put(28, 4);
  put(0x20, 4);
  put(1, 4);
  put(2, 8);
  put(11, 8);
  put(0, 4);
  put_object("/'h'/'V'", 10, 2, 0);
  begin_raw();
  put(0, 8);
  put(3765000000u, 8);
  put(1ull << 62, 8);
  put(3765000000u, 8);
  put(1, 4);
  put(3, 4);
  memcpy(bytes + length, "abc", 3);
  length += 3;
  put_double(5);
  put_double(6);
  end_segment();
  read_bytes("time.tdms", bytes, length);
  assert_int_equal(table->column_count, 2 + 0);
  assert_column("g/when", "s", t, 2);
  assert_column("h/V", "", v, 2);
}

/* Two devices with times of their own: the second one began a quarter of a second later. */
TEST(test_times_of_two_devices)
{
  static const double t[] = {0, 0.5}, late[] = {0.25, 0.75};
  begin_file(RAW, 2);
  put_object("/'g'/'when'", 0x44, 2, 0);
  put_object("/'h'/'when'", 0x44, 2, 0);
  begin_raw();
  for (uint64_t quarter = 0; quarter < 4; quarter++) {
    put((quarter % 2 == 0 ? 0 : 2) * (1ull << 62) + (quarter / 2) * (1ull << 62), 8);
    put(3765000000u, 8);
  }
  end_segment();
  read_bytes("two.tdms", bytes, length);
  assert_column("g/when", "s", t, 2);
  assert_column("h/when", "s", late, 2);
}

static void put_time_property(const char *name, uint64_t seconds, uint64_t fraction)
{
  put_text(name);
  put(0x44, 4);
  put(fraction, 8);
  put(seconds, 8);
}

/* Waveforms of two devices, the second of which was started 2.5 s later; one does not say when.
 * What is appended writes the time again. */
TEST(test_waveforms_of_two_devices)
{
  static const double starts[] = {0.5, 3.0, 0.5};
  static const char *const names[] = {"/'a'/'V'", "/'b'/'z'", "/'c'/'F'"};
  length = 0;
  for (uint64_t turn = 0; turn < 2; turn++) {
    begin_segment(METADATA | NEW_LIST | RAW);
    put(3, 4);
    for (size_t i = 0; i < 3; i++) {
      put_object(names[i], 10, 2, i < 2 ? 3 : 2);
      put_real_property("wf_increment", 0.001);
      put_real_property("wf_start_offset", 0.5);
      if (i < 2) {
        put_time_property("wf_start_time", 3765000000u + 2 * i + turn, i << 63);
      }
    }
    begin_raw();
    for (size_t i = 0; i < 6; i++) {
      put_double((double)i);
    }
    end_segment();
  }
  read_bytes("waves.tdms", bytes, length);
  for (size_t i = 0; i < 3; i++) {
    assert_close(table->columns[i].start, starts[i], 1e-9, 0);
    assert_int_equal(table->columns[i].count, 4);
  }
  assert_true(is_said(DEA_NOTE, "'b/z' begins 2.5 s after"));
}

/* A program that crashed leaves -1 as the length of its last segment. */
/* Raw values with a linear scale in their properties; one that was applied already; another one. */
TEST(test_scales)
{
  static const double scaled[] = {0.5, 151}, raw[] = {-1, 300};
  static const struct {
    const char *type, *status;
    const double *wanted;
    enum dea_severity said;
    const char *text;
  } cases[] = {{"Linear", "unscaled", scaled, DEA_NOTE, "raw x 0.5 + 1"},
               {"Linear", "scaled", raw, DEA_NOTE, NULL},
               {"Polynomial", "unscaled", raw, DEA_WARNING, "not applied"}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    begin_file(RAW, 1);
    put_object("/'bench'/'ai0'", 2, 2, 5); // int16
    put_text_property("NI_Scaling_Status", cases[i].status);
    put_text("NI_Number_Of_Scales");
    put(7, 4); // u32
    put(1, 4);
    put_text_property("NI_Scale[0]_Scale_Type", cases[i].type);
    put_real_property("NI_Scale[0]_Linear_Slope", 0.5);
    put_real_property("NI_Scale[0]_Linear_Y_Intercept", 1);
    begin_raw();
    put(0xffff, 2);
    put(300, 2);
    end_segment();
    read_bytes("scale.tdms", bytes, length);
    assert_column("ai0", "", cases[i].wanted, 2);
    assert_true(cases[i].text == NULL || is_said(cases[i].said, cases[i].text));
  }
}

TEST(test_crashed)
{
  static const double hv[] = {1, 2, 3};
  put_bench(RAW);
  put_double(1);
  put_double(2);
  put(1, 2);
  put(2, 2);
  put_double(3);
  put(7, 4); // half a value
  size_t end = length;
  end_segment();
  length = segment + 12;
  put(UINT64_MAX, 8);
  length = end;
  read_bytes("crash.tdms", bytes, length);
  assert_column("HV", "kV", hv, 3);
  assert_true(is_said(DEA_WARNING, "was not closed"));
}

TEST(test_refused)
{
  static const struct {
    uint64_t type;
    int count;
    const char *said;
  } channels[] = {{10, 0x7fffffff, "more values than the file has bytes"},
                  {0x10000d, 1, "type 0x10000d"},
                  {10, AS_BEFORE, "as before"}};
  put_bench(RAW | DAQMX);
  end_segment();
  assert_refused("bad.tdms", bytes, length, 0, "DAQmx raw data");
  begin_file(0, 1);
  put_text("/'g'/'c'");
  put(0x1269, 4);
  begin_raw();
  end_segment();
  assert_refused("bad.tdms", bytes, length, 0, "DAQmx raw data");
  for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
    begin_file(RAW, 1);
    put_object("/'g'/'c'", (unsigned)channels[i].type, channels[i].count, 0);
    begin_raw();
    end_segment();
    assert_refused("bad.tdms", bytes, length, 0, channels[i].said);
  }
  begin_file(0, 0xffffffff);
  begin_raw();
  end_segment();
  assert_refused("bad.tdms", bytes, length, 0, "end early");
  length = 0;
  begin_segment(0);
  end_segment();
  assert_refused("bad.tdms", bytes, length, 0, "no column");
  memcpy(bytes + length, "rubbish, twenty-eight bytes..", 28);
  assert_refused("bad.tdms", bytes, length + 28, 0, "byte 28: no segment");
}

/* Every cut of a file is read as far as it goes, or refused; never beyond its end. */
TEST(test_cuts)
{
  put_bench(RAW);
  put_double(1);
  put_double(2);
  put(1, 2);
  put(2, 2);
  end_segment();
  for (size_t n = 4; n < length; n++) {
    write_bytes("cut.tdms", bytes, n);
    dea_status status = read_table(in_folder("cut.tdms"));
    assert_true(status == DEA_OK || status == DEA_E_IO);
    assert_int_equal(status == DEA_OK, table != NULL);
    assert_true(status != DEA_OK || table->columns[0].count <= 2);
  }
}

// Files of the size of a measurement, of all layouts ----------------------------------------------

enum { CHANNELS = 4, VALUES = 1536 };
static const struct {
  const char *path, *name, *unit;
  unsigned type, size;
} channels[CHANNELS] = {{"/'run'/'HV'", "HV", "V", 10, 8},
                        {"/'run'/'ai1'", "ai1", "", 2, 2},
                        {"/'run'/'Laser'", "Laser", "mm", 9, 4},
                        {"/'run'/'when'", "when", "s", 0x44, 16}};

/* Value i of a channel; no two are equal, and all can be written exactly. */
static double value_of(size_t channel, size_t i)
{
  const double values[CHANNELS] = {0.37 * (double)i - 100, 7 * (double)i - 5000,
                                   0.125 * (double)i + 1000, 0.25 * (double)i};
  return values[channel];
}

static void put_value(size_t channel, size_t i)
{
  double value = value_of(channel, i);
  float single = (float)value;
  uint32_t bits;
  memcpy(&bits, &single, sizeof bits);
  uint64_t fraction = (uint64_t)(i % 4) << 62, seconds = 3765000000u + i / 4;
  switch (channel) {
  case 0:
    put_double(value);
    break;
  case 1:
    put((uint64_t)(int64_t)value, 2);
    break;
  case 2:
    put(bits, 4);
    break;
  default: // of 128 bits
    put(big ? seconds : fraction, 8);
    put(big ? fraction : seconds, 8);
  }
}

/* A chunk of values, cut off after `cut` bytes. */
static void put_chunk(size_t from, size_t count, bool interleaved, size_t cut)
{
  size_t start = length;
  for (size_t a = 0; a < (interleaved ? count : CHANNELS); a++) {
    for (size_t b = 0; b < (interleaved ? CHANNELS : count); b++) {
      put_value(interleaved ? b : a, from + (interleaved ? a : b));
    }
  }
  length = length - start < cut ? length : start + cut;
}

struct layout {
  unsigned contents;    // of the lead-ins, beside what all have
  size_t chunk, chunks; // values a channel in a chunk; chunks in a segment
  size_t last;          // values a channel of one more chunk at the end of the last segment
  bool open;            // which was not closed
  size_t cut;           // bytes of that chunk that are there
};

static size_t put_layout(const struct layout *l)
{
  size_t done = 0;
  bool interleaved = (l->contents & INTERLEAVED) != 0;
  length = 0;
  while (done + l->chunk * l->chunks + l->last <= VALUES) {
    bool first = done == 0;
    done += l->chunk * l->chunks;
    bool last = done + l->chunk * l->chunks + l->last > VALUES;
    begin_segment(RAW | l->contents | (first ? METADATA | NEW_LIST : 0));
    if (first) {
      put(CHANNELS, 4);
      for (size_t c = 0; c < CHANNELS; c++) {
        put_object(channels[c].path, channels[c].type, (int)l->chunk, c < 3 ? 3 : 0);
        if (c < 3) {
          put_real_property("wf_increment", 0.002);
          put_real_property("wf_start_offset", 0.25);
          put_text_property("unit_string", channels[c].unit);
        }
      }
      begin_raw();
    }
    for (size_t k = l->chunks; k > 0; k--) {
      put_chunk(done - k * l->chunk, l->chunk, interleaved, SIZE_MAX);
    }
    if (last && l->last > 0) {
      put_chunk(done, l->last, interleaved, l->cut);
      done += l->last;
    }
    size_t end = length;
    end_segment();
    if (last && l->open) {
      length = segment + 12;
      put(UINT64_MAX, 8);
      length = end;
    }
  }
  return done;
}

static void check_layout(const struct layout *l, size_t done)
{
  bool interleaved = (l->contents & INTERLEAVED) != 0;
  read_bytes("layout.tdms", bytes, length);
  assert_int_equal(table->column_count, CHANNELS);
  size_t left = l->cut < l->last * 30 ? l->cut : l->last * 30;
  for (size_t c = 0; c < CHANNELS; c++) {
    const struct dea_table_column *column = column_of(channels[c].name);
    size_t share = channels[c].size * l->last, there = left < share ? left : share;
    size_t count = done - l->last + (interleaved ? left / 30 : there / channels[c].size);
    left -= interleaved ? 0 : there;
    assert_string_equal(column->unit, channels[c].unit);
    if (column->count != count) {
      fail_msg("%s has %zu values, not %zu", channels[c].name, column->count, count);
    }
    assert_true(c == 3 || (column->interval == 0.002 && column->start == 0.25));
    for (size_t i = 0; i < count; i++) {
      if (column->values[i] != value_of(c, i)) {
        fail_msg("%s[%zu] = %.17g, wanted %.17g", channels[c].name, i, column->values[i],
                 value_of(c, i));
      }
    }
  }
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), l->open);
}

/* Both byte orders, interleaved or not, one segment or many, of one chunk or many, with a shorter
 * chunk at the end that holds the same share of each channel, and of a program that was ended in
 * the midst of each channel. */
TEST(test_layouts)
{
  static const unsigned contents[] = {0, BIG, INTERLEAVED, INTERLEAVED | BIG};
  static const struct layout layouts[] = {
      {0, 1500, 1, 0, false, SIZE_MAX},  {0, 1, 1500, 0, false, SIZE_MAX},
      {0, 100, 1, 0, false, SIZE_MAX},   {0, 25, 10, 0, false, SIZE_MAX},
      {0, 500, 2, 417, false, SIZE_MAX}, {0, 60, 5, 7, false, SIZE_MAX},
      {0, 100, 3, 1, false, SIZE_MAX},   {0, 100, 3, 99, false, SIZE_MAX},
      {0, 100, 2, 100, true, SIZE_MAX},  {0, 100, 2, 100, true, 400},
      {0, 100, 2, 100, true, 803},       {0, 100, 2, 100, true, 905},
      {0, 100, 2, 100, true, 1234},      {0, 100, 2, 100, true, 2000}};
  for (size_t i = 0; i < 4 * sizeof layouts / sizeof layouts[0]; i++) {
    struct layout l = layouts[i / 4];
    l.contents = contents[i % 4];
    size_t done = put_layout(&l);
    assert_true(done >= 1200);
    check_layout(&l, done);
  }
}

static void check_case(const char *name, size_t count, const struct dea_table_column *wanted,
                       size_t values)
{
  char file[512];
  snprintf(file, sizeof file, DEA_SOURCE_DIR "/lab/tests/cases/tdms/%s", name);
  assert_int_equal(read_table(file), DEA_OK);
  assert_int_equal(table->column_count, count);
  for (size_t c = 0; c < count; c++) {
    assert_column(wanted[c].name, wanted[c].unit, wanted[c].values, values);
    assert_true(table->columns[c].interval == 0.1);
  }
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 0);
}

/* Files whose first segment holds more values than bytes of metadata, and closed ones whose last
 * chunk is short, as LabVIEW writes and reads them. */
TEST(test_cases)
{
  static double one[1000], two[1000], small_one[1000], small_two[1000];
  for (size_t i = 0; i < 1000; i++) {
    one[i] = (double)i;
    two[i] = 2 * (double)i;
    small_one[i] = (double)(i % 10);
    small_two[i] = 2 * (double)(i % 10);
  }
  static char V[] = "V", A[] = "A", mm[] = "mm", HV[] = "HV", I[] = "I", Laser[] = "Laser";
  struct dea_table_column linear[] = {{.name = HV, .unit = V, .values = one},
                                      {.name = Laser, .unit = mm, .values = two}};
  check_case("n40.tdms", 2, linear, 40);
  check_case("n60.tdms", 2, linear, 60);
  check_case("n1000.tdms", 2, linear, 1000);
  check_case("one-channel.tdms", 1, linear, 100);
  linear[0].values = small_one;
  linear[1].values = small_two;
  check_case("small-chunks.tdms", 2, linear, 1000);
  static double volts[] = {1000, 2000, 3000, 4000, 5000, 6000, 7000};
  static double mms[] = {.1, .2, .3, .4, .5, .6, .7}, amps[] = {1e-6, 1e-6, 1e-6, 1e-6, 2e-6, 2e-6};
  const struct dea_table_column shorter[] = {{.name = HV, .unit = V, .values = volts},
                                             {.name = Laser, .unit = mm, .values = mms},
                                             {.name = I, .unit = A, .values = amps}};
  check_case("two-channels.tdms", 2, shorter, 7);
  check_case("three-channels.tdms", 3, shorter, 6);
}

/* A closed segment that ends within a value, or with other shares, is read as far as it goes. */
TEST(test_uneven_end)
{
  struct layout l = {.chunk = 100, .chunks = 2, .last = 100, .cut = 1234};
  put_layout(&l);
  read_bytes("uneven.tdms", bytes, length);
  assert_int_equal(column_of("HV")->count, 1500);
  assert_int_equal(column_of("when")->count, 1400);
  assert_true(is_said(DEA_WARNING, "the values end within a row of channels"));
}

static void read_once(struct dea_context *own)
{
  read_again(own, "run.tdms");
}

/* Names of channels are kept up to 511 bytes, which is more than any of them should have. */
TEST(test_long_names)
{
  for (int letters = 509; letters < 514; letters++) {
    char name[640], wanted[600];
    memset(wanted, 'n', sizeof wanted);
    wanted[letters] = '\0';
    snprintf(name, sizeof name, "/'g'/'%s'", wanted);
    wanted[letters < 511 ? letters : 511] = '\0';
    begin_file(RAW, 1);
    put_object(name, 10, 2, 0);
    begin_raw();
    put_double(1);
    put_double(2);
    end_segment();
    read_bytes("long.tdms", bytes, length);
    assert_int_equal(table->column_count, 1);
    assert_string_equal(table->columns[0].name, wanted);
  }
}

TEST(test_memory)
{
  assert_true(failing_each(read_once) > 5);
}

TESTS(set_up, import_tear_down)
