// SCPI instruments against an emulator on the loopback interface.
#include "emulator.h"
#include "failing_allocator.h"
#include "instrument/line_reader.h"
#include "instrument/scpi_parse.h"
#include "instrument/timed_output.h"

#include "message_fixture.h"

#include <dlfcn.h>
#include <netdb.h>
#include <sys/syscall.h>
#include <time.h>

/* The system's clocks, of which one alone goes on while a computer sleeps. */
static atomic_int slept_s;

int clock_gettime(clockid_t clock, struct timespec *out)
{
  long result = syscall(SYS_clock_gettime, clock, out);
  out->tv_sec += clock == CLOCK_BOOTTIME ? atomic_load(&slept_s) : 0;
  return (int)result;
}

/* The system's look-up of names; who answers for names may be gone. */
static atomic_bool no_names;

int getaddrinfo(const char *name, const char *service, const struct addrinfo *hints,
                struct addrinfo **out)
{
  static int (*real)(const char *, const char *, const struct addrinfo *, struct addrinfo **);
  unsigned char number[sizeof(struct in6_addr)];
  if (real == NULL) {
    *(void **)&real = dlsym(RTLD_NEXT, "getaddrinfo");
  }
  bool is_name = inet_pton(AF_INET, name, number) != 1 && inet_pton(AF_INET6, name, number) != 1;
  return is_name && atomic_load(&no_names) ? EAI_AGAIN : real(name, service, hints, out);
}

/* How the emulated instrument behaves. */
struct behaviour {
  const char *identity, *error; // NULL: no answer
  const char *current;          // answer to MEAS:CURR?, without its line end
  size_t current_length;        // bytes of it that are sent, then it hangs up; 0: all
  const char *before;           // sent before each answer
  const char *then;             // answer of MEAS:CURR? from the second question on; NULL: the same
  int asked;
};

static void answer(struct emulator *e, int connection, const char *question)
{
  struct behaviour *b = e->user;
  const char *text = NULL;
  char line[8192];
  if (strcmp(question, "*IDN?") == 0) {
    text = b->identity;
  } else if (strcmp(question, "*OPC?") == 0) {
    text = "1";
  } else if (strcmp(question, "SYST:ERR?") == 0) {
    text = b->error;
  } else if (strcmp(question, "MEAS:FORC?") == 0) {
    text = "  250";
  } else if (strcmp(question, "MEAS:CURR?") == 0) {
    text = b->asked++ > 0 && b->then != NULL ? b->then : b->current;
  }
  if (text != NULL) {
    int length = snprintf(line, sizeof line, "%s%s\r\n", b->before != NULL ? b->before : "", text);
    bool cut = text == b->current && b->current_length > 0;
    emulator_send(e, connection, line, cut ? b->current_length : (size_t)length);
    if (cut) {
      shutdown(connection, SHUT_RDWR);
    }
  }
}

static void serve(struct emulator *e, int connection)
{
  struct dea_line_reader reader = {0};
  char bytes[512];
  size_t length;
  while ((length = emulator_receive(e, connection, bytes, sizeof bytes)) > 0) {
    const char *at = bytes, *line;
    while ((line = dea_line_next(&reader, &at, &length)) != NULL) {
      answer(e, connection, line);
    }
  }
}

static const struct behaviour usual = {
    "ACME,Electrometer 6,0815,1.0", "+0,\"No error\"", "+2.5E-9A", 0, NULL, NULL, 0};
// A short timeout only where it is to pass: the machine may be busy.
#define READS(timeout)                                                                             \
  "kind: scpi\naddress: 127.0.0.1\nport: %d\ntimeout: " timeout "\ninterval: 5 ms\n"               \
  "setup: [\"FUNC 'CURR'\", \"ZCOR ON\"]\nat_stop: [OUTP OFF, \"SYST:LOC\"]\nidentity: "           \
  "Electrometer\n"                                                                                 \
  "readings:\n"                                                                                    \
  "  - {name: leakage, query: \"MEAS:CURR?\", quantity: current}\n"                                \
  "  - {name: load, query: \"MEAS:FORC?\", quantity: force, factor: 1e-3, offset: 1}\n"
static const char reads[] = READS("5 s");
static const char hasty[] = READS("0.15 s");

/* Of one instrument; protocol and fragment are set before it begins. */
static struct bench {
  struct emulator emulator;
  struct behaviour behaviour;
  struct dea_protocol protocol;
  struct dea_instrument *instrument;
  struct emulator_sink sink;
  char text[2048];
} b;

static dea_status begin(const struct behaviour *behaviour, const char *section)
{
  b.behaviour = *behaviour;
  b.sink = (struct emulator_sink){0};
  emulator_start(&b.emulator, serve, &b.behaviour);
  snprintf(b.text, sizeof b.text, section, b.emulator.port);
  dea_finding_clear(ctx);
  dea_status status = emulator_open(ctx, &b.protocol, b.text, &b.instrument);
  status = status == DEA_OK ? b.instrument->type->start(ctx, b.instrument) : status;
  return status;
}

static void end(void)
{
  if (b.instrument != NULL) {
    emulator_close(ctx, b.instrument);
  }
  emulator_stop(&b.emulator);
  b.instrument = NULL;
  b.protocol = (struct dea_protocol){0};
  b.emulator.fragment = 0;
}

TEST(test_numbers)
{
  static const struct {
    const char *text;
    double value; // NAN: no number
    bool good;
    size_t field;
  } cases[] = {{"+1.04E-11", 1.04e-11, true, 0},
               {" -5", -5, true, 0},
               {".5", 0.5, true, 0},
               {"1.2E-9A,+3.1E+2secs,+0RDNG#", 1.2e-9, true, 1},
               {"1.2E-9A,+3.1E+2secs,+0RDNG#", 310, true, 2},
               {"1.2E-9A,+3.1E+2secs,+0RDNG#", 0, true, 3},
               {"1.2E-9A,+3.1E+2secs,+0RDNG#", NAN, false, 4},
               {"1.2E-9A,+3.1E+2secs,+0RDNG#", NAN, false, 0}, // which of them?
               {"+6.0E+02,+6.1E-07,+9.91E+37", 6.1e-7, true, 2},
               {"+6.0E+02,+6.1E-07,+9.91E+37", NAN, true, 3},
               {"+6.0E+02,+6.1E-07,+9.91E+37", NAN, false, 0},
               {"1,OFF", NAN, false, 2},
               {"3;4", 3, true, 1},
               {"3;4", 4, true, 2},
               {"0;2000", NAN, false, 0},
               {"5,", NAN, false, 0},
               {"9.9E37", NAN, true, 0},
               {"-9.9E+37", NAN, true, 0},
               {"+9.91E37", NAN, true, 0},
               {"1e999", NAN, true, 0},
               {"", NAN, false, 0},
               {"nan", NAN, false, 0},
               {"INF", NAN, false, 0},
               {"ON", NAN, false, 0},
               {"-", NAN, false, 0},
               {"12:30:01", NAN, false, 0},
               {"1.2.3", NAN, false, 0},
               {"0,123", NAN, false, 0}, // one number or two?
               {"-2,5E+03", NAN, false, 0},
               {"0,123", NAN, false, 1},
               {"0,123", NAN, false, 2},
               {"7.5,0,123", NAN, false, 2},
               {"7.5,0,123", NAN, false, 3},
               {"7.5,0,123", 7.5, true, 1},
               {"1, 2", 1, true, 1},
               {"1, 2", 2, true, 2},
               {"1.5,2", 1.5, true, 1},
               {"1.5,2", 2, true, 2},
               {"#15hello", NAN, false, 0}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    double value = 0;
    bool good = dea_scpi_number(cases[i].text, cases[i].field, &value);
    if (good != cases[i].good ||
        (good && !(value == cases[i].value) && !(isnan(value) && isnan(cases[i].value)))) {
      fail_msg("'%s' gave %d, %g", cases[i].text, good, value);
    }
  }
}

TEST(test_units_behind_numbers)
{
  static const char *const units[][2] = {{" +10.000 nA", "+10.000 nA"},
                                         {"1E-9NADC,+3secs", "1E-9 A"},
                                         {"-2.5E+3VDC", "-2.5E+3 V"},
                                         {"1E-9nADC", "1E-9 nA"},
                                         {"1E-9OADC", "1E-9 OA"},
                                         {"5 m N", "5 mN"},
                                         {"5 MV", NULL},
                                         {"5 MPa", "5 MPa"},
                                         {"OFF", NULL}};
  for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
    char text[DEA_SCPI_VALUE_SIZE];
    bool good = dea_scpi_with_unit(units[i][0], i == 1, text);
    if (good != (units[i][1] != NULL) || (good && strcmp(text, units[i][1]) != 0)) {
      fail_msg("'%s' gave %d, '%s'", units[i][0], good, good ? text : "");
    }
  }
}

TEST(test_voltages_and_errors)
{
  static const struct {
    const char *text;
    double in_V, in_kV; // NAN: no voltage
  } voltages[] = {{"2.000", 2, 2},
                  {" -0 ", 0, 0},
                  {"1.5E+03V", 1500, NAN},
                  {"+2 VDC", 2, NAN},
                  {"2.00 kV", NAN, 2},
                  {"2KVDC", NAN, 2},
                  {"2.000,0.001", NAN, NAN},
                  {"+2 VDC,3", NAN, NAN},
                  {"0;2000", NAN, NAN},
                  {"2,000E+03", NAN, NAN},
                  {"2.0 E+03", NAN, NAN},
                  {"2.0D+03", NAN, NAN},
                  {"2 mV", NAN, NAN},
                  {"2 MV", NAN, NAN},
                  {"2 ?", NAN, NAN},
                  {"2 V?", NAN, NAN},
                  {"9.91E37", NAN, NAN},
                  {"1e308", NAN, NAN},
                  {"", NAN, NAN}};
  for (size_t i = 0; i < 2 * sizeof voltages / sizeof voltages[0]; i++) {
    double value = NAN, wanted = i % 2 == 0 ? voltages[i / 2].in_V : voltages[i / 2].in_kV;
    bool good = dea_scpi_voltage(voltages[i / 2].text, 0, i % 2 == 0, i % 2 == 1, &value);
    if (good != !isnan(wanted) || (good && value != wanted)) {
      fail_msg("'%s' gave %d, %g", voltages[i / 2].text, good, value);
    }
  }
  double value;
  assert_true(dea_scpi_voltage("1E-3 A,2.5V;7", 2, true, false, &value) && value == 2.5);
  assert_false(dea_scpi_voltage("1E-3 A,2.5V;7", 1, true, false, &value));
  const char *text;
  int code;
  assert_true(dea_scpi_error("-113,\"Undefined header\"", &code, &text));
  assert_int_equal(code, -113);
  assert_string_equal(text, "\"Undefined header\"");
  assert_true(dea_scpi_error("+0,\"No error\"", &code, &text));
  assert_int_equal(code, 0);
  assert_false(dea_scpi_error("nothing", &code, &text));
  assert_false(dea_scpi_error("1e30,\"x\"", &code, &text));
}

TEST(test_reads)
{
  static const size_t fragments[] = {0, 1, 2, 5};
  for (size_t f = 0; f < sizeof fragments / sizeof fragments[0]; f++) {
    b.emulator.fragment = fragments[f];
    assert_int_equal(begin(&usual, reads), DEA_OK);
    assert_int_equal(b.instrument->roles, DEA_GIVES_READINGS);
    assert_int_equal(b.instrument->reading_count, 2);
    assert_string_equal(b.instrument->readings[1].name, "load");
    assert_int_equal(b.instrument->readings[1].kind, DEA_CHANNEL_FORCE);
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 8, 0, 0), DEA_OK);
    assert_true(b.sink.readings >= 8);
    for (size_t i = 0; i < 8; i++) {
      assert_int_equal(b.sink.reading[i].reading, i % 2);
      assert_close(b.sink.reading[i].value, i % 2 == 0 ? 2.5e-9 : 1.25, 1e-12, 0);
      assert_true(b.sink.reading[i].time_s >= 0 && b.sink.reading[i].time_s < 2);
      assert_true(i == 0 || b.sink.reading[i].time_s > b.sink.reading[i - 1].time_s);
    }
    // Three intervals of 5 ms, never less; half an answer's way may be missing.
    assert_true(b.sink.reading[6].time_s - b.sink.reading[0].time_s > 0.01);
    assert_int_equal(b.instrument->lost, 0);
    emulator_check_clock(ctx, b.instrument, &b.sink);
    end();
    assert_true(strncmp(b.emulator.log, "*IDN?\n*CLS\nFUNC 'CURR'\nZCOR ON\nSYST:ERR?\n", 40) == 0);
    assert_string_equal(strstr(b.emulator.log, "OUTP OFF"), "OUTP OFF\nSYST:LOC\n");
  }
}

TEST(test_plays)
{
  static const char plays[] =
      "kind: scpi\naddress: 127.0.0.1\nport: %d\ntimeout: 5 s\n"
      "output: \"SOUR:VOLT %%g\"\noutput_factor: 2\noutput_interval: 40 ms\nqueue: 0.2 s\n";
  const double beyond[][2] = {{0, 5.01}, {-1.51, 0}, {0, NAN}, {INFINITY, 0}, {0, -1e300}};
  double volts[60];
  b.protocol.rate_Hz.si = 100;      // slow enough for a machine that is busy
  b.protocol.amplifier.gain.si = 2; // of a supply that is set in V
  b.protocol.amplifier.control_V.si = 5;
  b.protocol.amplifier.highest_V.si = 10;
  b.protocol.amplifier.lowest_V.si = -3;
  b.protocol.safety.zero_time_s.si = 2;
  assert_int_equal(begin(&usual, plays), DEA_OK);
  assert_int_equal(b.instrument->roles, DEA_PLAYS_OUTPUT);
  for (size_t i = 0; i < 60; i++) {
    volts[i] = i < 30 ? 0.125 * (double)(i / 10) : -1.5;
  }
  // 0.6 s do not fit into a queue of 0.2 s: this waits until the first 0.4 s have been played.
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 60), DEA_OK);
  for (int i = 0; i < 200 && strstr(b.emulator.log, "-3") == NULL; i++) {
    const struct dea_sink nothing = {0};
    assert_int_equal(b.instrument->type->get(ctx, b.instrument, 0.01, &nothing), DEA_OK);
  }
  for (size_t i = 0; i < sizeof beyond / sizeof beyond[0]; i++) { // nothing of it goes out
    assert_message(b.instrument->type->put(ctx, b.instrument, beyond[i], 2), DEA_E_INTERLOCK,
                   "was about to go out");
  }
  end();
  const char *log = strstr(b.emulator.log, "SOUR:VOLT 0\n");
  assert_non_null(log);
  assert_string_equal(log, "SOUR:VOLT 0\n*CLS\nSOUR:VOLT 0\n*OPC?\nSYST:ERR?\n"
                           "SOUR:VOLT 0.25\n*OPC?\nSOUR:VOLT 0.5\n*OPC?\nSOUR:VOLT -3\n*OPC?\n"
                           "SOUR:VOLT 0\n*OPC?\n");
}

TEST(test_makes_no_sense)
{
  static char long_line[5000];
  memset(long_line, 'x', sizeof long_line - 1);
  static const char *const answers[] = {"nothing", "\x01\x02", long_line};
  for (size_t i = 0; i < 3; i++) {
    struct behaviour behaviour = usual;
    behaviour.current = answers[i];
    behaviour.then = "7";
    assert_int_equal(begin(&behaviour, reads), DEA_OK);
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 3, 0, 0), DEA_OK);
    assert_true(isnan(b.sink.reading[0].value)); // lost, and the next is good again
    assert_close(b.sink.reading[1].value, 1.25, 1e-12, 0);
    assert_close(b.sink.reading[2].value, 7, 1e-12, 0);
    assert_int_equal(b.instrument->lost, 1);
    end();
  }
}

#define READS_CURRENT(keys)                                                                        \
  "kind: scpi\naddress: 127.0.0.1\nport: %d\ninterval: 5 ms\nreadings:\n"                          \
  "  - {name: leak, query: \"MEAS:CURR?\"" keys "}\n"

/* An answer is one number with a unit that fits, converted to SI. At first anything else ends the
 * measurement with what to write; later, when a range changes or a display says that it is at its
 * end, the value is left out. */
TEST(test_units_and_fields)
{
  static const char amps[] = READS_CURRENT(", quantity: current"),
                    second[] = READS_CURRENT(", quantity: current, field: 2"),
                    volts[] = READS_CURRENT(", quantity: voltage, field: 1"),
                    force[] = READS_CURRENT(", quantity: force"),
                    in_mN[] = READS_CURRENT(", quantity: force, factor: -1e-3, offset: 0.5"),
                    shunt[] = READS_CURRENT(", quantity: current, factor: 1e-3"),
                    kelvin[] = READS_CURRENT(", unit: K"), plain[] = READS_CURRENT("");
  static const char keithley[] = "+6.000000E+02,+6.100000E-07,+9.910000E+37,+1.2E+00,+2.150000E+04";
  static const struct {
    const char *section, *first, *then;
    double value, next;  // NAN: left out
    const char *refused; // at first; NULL: nothing is
  } cases[] = {
      {amps, "2.5E-9", "3E-9", 2.5e-9, 3e-9, NULL},
      {amps, "10.000 nA", "1.5 uA", 1e-8, 1.5e-6, NULL},
      {amps, "10.000 nA", "1.5", 1e-8, NAN, NULL},
      {amps, "2.5E-9", "3 nA", 2.5e-9, 3e-9, NULL},
      {amps, "1E-9NADC", "2E-3OADC", 1e-9, NAN, NULL},
      {amps, "9.91E37", "3 nA", NAN, 3e-9, NULL},
      {amps, "2E-9", "2E-9,600", 2e-9, NAN, NULL},
      {amps, "0;2000", NULL, 0, 0, "which has 2 field(s): say which of them is 'leak' (field: 1 "},
      {amps, keithley, NULL, 0, 0, "which has 5 field(s)"},
      {second, keithley, keithley, 6.1e-7, 6.1e-7, NULL},
      {volts, keithley, keithley, 600, 600, NULL},
      {second, "1E-9NADC,+3secs", NULL, 0, 0, "whose unit does not fit 'leak'"},
      {second, "1E-9", NULL, 0, 0, "which has 1 field(s)"},
      {amps, "600 V", NULL, 0, 0, "whose unit does not fit 'leak'"},
      {amps, "10 NA", NULL, 0, 0, "whose unit does not fit 'leak'"},
      {force, "950 mN", "1.05 N", 0.95, 1.05, NULL},
      {in_mN, "950", "951", -0.45, -0.451, NULL},
      {in_mN, "950 mN", "1.05 N", -0.45, NAN, NULL},
      {in_mN, "0.95 N", NULL, 0, 0, "whose unit does not fit 'leak'"},
      {shunt, "2.5 V", "2500 mV", 2.5e-3, NAN, NULL},
      {shunt, "2.5 A", NULL, 0, 0, "whose unit does not fit 'leak'"},
      {kelvin, "20 degC", "300 K", 293.15, 300, NULL},
      {plain, "20", "21", 20, 21, NULL},
      {plain, "20 degC", NULL, 0, 0, "whose unit does not fit 'leak'"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct behaviour behaviour = usual;
    behaviour.current = cases[i].first;
    behaviour.then = cases[i].then;
    assert_int_equal(begin(&behaviour, cases[i].section), DEA_OK);
    dea_status status = emulator_get(ctx, b.instrument, &b.sink, 2, 0, 0);
    if (cases[i].refused != NULL) {
      assert_message(status, DEA_E_INSTRUMENT, cases[i].refused);
      assert_int_equal(b.sink.readings, 0);
    } else {
      const double values[] = {cases[i].value, cases[i].next};
      assert_int_equal(status, DEA_OK);
      for (size_t k = 0; k < 2; k++) {
        double value = b.sink.reading[k].value;
        if (!(fabs(value - values[k]) <= 1e-12 * fabs(values[k])) &&
            !(isnan(value) && isnan(values[k]))) {
          fail_msg("'%s', '%s': value %zu is %g", cases[i].first, cases[i].then, k, value);
        }
      }
      bool left = isnan(cases[i].next);
      assert_int_equal(dea_finding_count(ctx, DEA_WARNING), left);
      assert_int_equal(b.instrument->lost > 0, left);
    }
    end();
  }
  char suffix[DEA_SCPI_SUFFIX_SIZE];
  dea_scpi_suffix(" +1.5E-3 m N ,7 V", 1, suffix);
  assert_string_equal(suffix, "mN");
  dea_scpi_suffix("OFF", 0, suffix);
  assert_string_equal(suffix, "");
  dea_scpi_suffix("1 a unit that is longer than any unit that there is", 0, suffix);
  assert_int_equal(strlen(suffix), DEA_SCPI_SUFFIX_SIZE - 1);
}

/* More lines than one were asked for: none of them is taken, in whatever pieces they come. */
TEST(test_speaks_unasked)
{
  static const char *const answers[] = {"1\r\n2\r\n\r\n3", "0\r2000"};
  struct behaviour behaviour = usual;
  for (size_t i = 0; i < 8; i++) {
    behaviour.current = answers[i % 2];
    b.emulator.fragment = i / 2;
    assert_int_equal(begin(&behaviour, reads), DEA_OK);
    dea_status status = emulator_get(ctx, b.instrument, &b.sink, 30, 0, 0);
    assert_int_equal(status, DEA_E_INSTRUMENT);
    if (b.emulator.fragment == 0) { // both at once
      assert_message(status, DEA_E_INSTRUMENT, "answered with more than one line");
      assert_int_equal(b.sink.readings, 0);
    }
    assert_true(b.sink.readings < 5);
    end();
  }
}

TEST(test_goes_silent)
{
  struct behaviour behaviour = usual;
  behaviour.current = NULL;
  assert_int_equal(begin(&behaviour, hasty), DEA_OK);
  dea_status status = emulator_get(ctx, b.instrument, &b.sink, 1, 0, 0);
  assert_message(status, DEA_E_INSTRUMENT, "did not answer 'MEAS:CURR?' within 0.15 s");
  end();
  behaviour.identity = NULL;
  assert_message(begin(&behaviour, hasty), DEA_E_INSTRUMENT, "did not answer '*IDN?'");
  end();
}

TEST(test_hangs_up)
{
  struct behaviour behaviour = usual;
  for (size_t n = 1; n <= strlen(usual.current); n++) {
    behaviour.current_length = n;
    assert_int_equal(begin(&behaviour, reads), DEA_OK);
    dea_status status = emulator_get(ctx, b.instrument, &b.sink, 1, 0, 0);
    assert_message(status, DEA_E_INSTRUMENT, "the connection to the instrument at 127.0.0.1");
    assert_int_equal(b.sink.readings, 0); // half a number is none
    end();                                // writes to it twice, without SIGPIPE
  }
}

TEST(test_not_there)
{
  snprintf(b.text, sizeof b.text, reads, emulator_no_port());
  assert_message(emulator_open(ctx, &b.protocol, b.text, &b.instrument), DEA_E_INSTRUMENT,
                 "Connection refused");
  snprintf(b.text, sizeof b.text, "kind: scpi\naddress: no.such.host.invalid\noutput: V %%g\n");
  b.protocol.rate_Hz.si = 100;
  assert_message(emulator_open(ctx, &b.protocol, b.text, &b.instrument), DEA_E_INSTRUMENT,
                 "is not known");
}

TEST(test_refuses)
{
  struct behaviour behaviour = usual;
  behaviour.identity = "OTHER,Scope,1,2";
  assert_message(begin(&behaviour, reads), DEA_E_INSTRUMENT,
                 "is a 'OTHER,Scope,1,2', not a 'Electrometer'");
  end();
  behaviour = usual;
  behaviour.error = "-113,\"Undefined header\"";
  assert_message(begin(&behaviour, reads), DEA_E_INSTRUMENT,
                 "does not accept its setup: error -113, \"Undefined header\"");
  end();
  behaviour.error = NULL; // knows no SYST:ERR?
  assert_int_equal(begin(&behaviour, hasty), DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1);
  end();
}

TEST(test_wrong_keys)
{
  static const struct {
    const char *text, *finding;
  } cases[] = {
      {"kind: scpj\n", "there is no instrument 'scpj'; did you mean 'scpi'?"},
      {"address: x\n", "an instrument needs its kind: "},
      {"kind: scpi\naddress: x\n", "it neither reads nor plays"},
      {"kind: scpi\naddress: x\noutput: VOLT\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %s\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %g %n\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT 1%g\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %g0\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT -%g\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %g kV\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %g;VOLT 9000\n", "must have one %g"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\noutput_factor: 5000\n", "output_factor is 1"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\noutput_factor: -1\n", "output_factor is 1"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\noutput_factor: -1e300\n", "output_factor is 1"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\noutput_factor: 0\n", "output_factor is 1"},
      {"kind: scpi\naddress: x\noutput: SOUR:VOLT %g\nsetup: [OUTP ON, ':source:voltage 5E3']\n",
       "':source:voltage 5E3' sets the output"},
      {"kind: scpi\naddress: x\noutput: \"C1:BSWV OFST,%g\"\nsetup: [\"*RST;C1:BSWV OFST,5\"]\n",
       "sets the output"},
      {"kind: scpi\naddress: x\noutput: \"C1:BSWV OFST,%g\"\nsetup: [\"C1:BSWV WVTP,DC,OFST,5\"]\n",
       "sets the output"},
      {"kind: scpi\naddress: x\noutput: \"C1:BSWV OFST,%g\"\nsetup: [\"c1:bswv hlev, -2.5V\"]\n",
       "sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nat_stop: [VOLT 1]\n", "'VOLT 1' sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: [VOLT MAX]\n", "sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: ['SOUR:VOLT:LEV:IMM 5']\n", "sets the"},
      {"kind: scpi\naddress: x\noutput: 'VOLT:LEV %g'\nsetup: ['VOLT:AMPL 5']\n", "sets the"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: [VOLT UP]\n", "sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: ['*RCL 1']\n", "sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: ['APPL P25V, 5, 1']\n", "sets the output"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nsetup: [\"OUTP ON\\nVOLT 5\"]\n", "is one line"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nmeasure: \"V?\\nVOLT 5\"\n", "is one line"},
      {"kind: scpi\naddress: x\noutput: VOLT %g\nmeasure: \"V?\\rVOLT 5\"\n", "control character"},
      {"kind: scpi\naddress: x\noutput: \"VOLT 5\\nVOLT %g\"\n", "must have one %g"},
      {"kind: scpi\naddress: x\nreadings: [{name: a, query: b}]\nsetup: [OUTP ON, VOLT 5E3]\n",
       "'VOLT 5E3' sets a voltage, and this instrument has no 'output'"},
      {"kind: scpi\nadress: x\noutput: VOLT %g\n", "did you mean 'address'?"},
      {"kind: scpi\naddress: x\nport: 70000\noutput: VOLT %g\n", "port"},
      {"kind: scpi\naddress: x\nreadings: [{name: a, query: b}, {name: a, query: c}]\n",
       "is the name of another reading too"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_protocol protocol = {0};
    struct dea_instrument *instrument;
    size_t count;
    dea_finding_clear(ctx);
    assert_int_equal(emulator_open(ctx, &protocol, cases[i].text, &instrument), DEA_E_DESIGN);
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    assert_true(count >= 1);
    if (strstr(findings[0].text, cases[i].finding) == NULL || findings[0].location.line == 0) {
      fail_msg("'%s' lacks '%s'", findings[0].text, cases[i].finding);
    }
  }
  dea_finding_clear(ctx);
}

/* What sets no voltage may be said: words of a generator, ranges, questions. */
TEST(test_harmless_commands)
{
  static const char *const harmless[] = {
      "VOLT 0",         "VOLT? MAX", "MEAS:VOLT?", "VOLT:RANG 1000", "OUTP ON", "*RST",
      "VOLT:PROT 5000", "VOLT",      "APPL?",      "VOLT ON,(@0)",   "VOLT OFF"};
  for (size_t i = 0; i < sizeof harmless / sizeof harmless[0]; i++) {
    assert_false(dea_scpi_sets_output(harmless[i], "SOUR:VOLT %g"));
  }
  assert_true(dea_scpi_sets_output("VOLT 5", ":SOUR:VOLT %g"));
  assert_false(dea_scpi_sets_output(":VOLT ON,(@0)", ":VOLT %g,(@0)"));
  assert_false(dea_scpi_sets_output(":VOLT OFF,(@0)", ":VOLT %g,(@0)"));
  assert_true(dea_scpi_sets_output(":VOLT ON,(@0);:VOLT 5,(@0)", ":VOLT %g,(@0)"));
  assert_true(dea_scpi_sets_output(":VOLT ONE", ":VOLT %g,(@0)"));
  assert_false(dea_scpi_sets_output("C1:BSWV WVTP,DC,OFST,0", "C1:BSWV OFST,%g"));
  assert_true(dea_scpi_configures("CONF:VOLT:DC 10") && dea_scpi_configures(":sens:volt 10"));
  assert_false(dea_scpi_configures("CONF:VOLT;VOLT 5") || dea_scpi_configures("SOUR:VOLT 5"));
}

/* The computer's lid was closed for an hour: what is due by then is not caught up with. */
TEST(test_computer_that_slept)
{
  static const char plays[] = "kind: scpi\naddress: 127.0.0.1\nport: %d\noutput: VOLT %%g\n";
  double volts[20] = {0}, held_V = NAN;
  b.protocol.rate_Hz.si = 100;
  b.protocol.safety.zero_time_s.si = 2;
  b.protocol.amplifier.control_V.si = 10;
  b.protocol.amplifier.highest_V.si = 10;
  b.protocol.amplifier.gain.si = 1;
  for (size_t i = 0; i < 20; i++) {
    volts[i] = 0.5 * (double)i;
  }
  assert_int_equal(begin(&usual, plays), DEA_OK);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 20), DEA_OK);
  atomic_store(&slept_s, 3600);
  const struct dea_sink nothing = {0};
  assert_message(b.instrument->type->get(ctx, b.instrument, 0, &nothing), DEA_E_INTERLOCK,
                 "the computer was away for 3.6e+03 s, longer than the queue");
  assert_int_equal(b.instrument->type->hold(ctx, b.instrument, &held_V), DEA_OK);
  assert_true(held_V < 9);
  end();
}

/* A supply that took nothing for 0.4 s, while the program waited for it: what became due meanwhile
 * is as late as after a stall. */
TEST(test_late_samples)
{
  static const double volts[] = {0, 1, 2, 3, 4};
  struct dea_timed_output o = {.rate_Hz = 100, .queue_s = 0.25, .behind_s = 1};
  assert_int_equal(dea_timed_begin(ctx, &o), DEA_OK);
  assert_int_equal(dea_timed_write(ctx, &o, volts, 5, NULL, NULL), DEA_OK);
  dea_timed_start(&o, 0);
  assert_int_equal(dea_timed_read(ctx, &o, 0.011), DEA_OK); // two of them
  o.turned_s = 0.2;
  assert_int_equal(dea_timed_read(ctx, &o, 0.021 + 0.2), DEA_OK); // 0.2 s late
  o = (struct dea_timed_output){
      .rate_Hz = 100, .queue_s = 0.25, .behind_s = 1, .queue = o.queue, .capacity = o.capacity};
  o.clock_s = o.waiting_s = NAN;
  assert_int_equal(dea_timed_write(ctx, &o, volts, 5, NULL, NULL), DEA_OK);
  dea_timed_start(&o, 0);
  assert_int_equal(dea_timed_read(ctx, &o, 0.011), DEA_OK);
  o.turned_s = 0.42;
  assert_message(dea_timed_read(ctx, &o, 0.42), DEA_E_INTERLOCK, "longer than the queue");
  dea_timed_end(ctx, &o);
}

/* A supply that plays a triangle of 0 to 2 kV and is measured every 0.2 s; when it is off, by its
 * verdict. The measured voltage is `share` of the one of late_s before, and at most most_V. */
static double off_at(double frequency_Hz, double share, double late_s, double most_V)
{
  struct dea_evidence e = {.lag_s = 0.5, .error_V = 1e9, .share = 0.05, .zero_V = 20};
  for (int i = 1; i < 6000; i++) { // every 20 ms
    double time_s = 0.02 * i, past_s = fmax(time_s - late_s, 0);
    double volts =
        2000 * (1 - fabs(2 * (frequency_Hz * time_s - floor(frequency_Hz * time_s)) - 1));
    double past_V =
        2000 * (1 - fabs(2 * (frequency_Hz * past_s - floor(frequency_Hz * past_s)) - 1));
    dea_evidence_sent(&e, volts, time_s);
    if (i % 10 == 0 && dea_evidence_measured(&e, fmin(share * past_V, most_V), time_s, time_s) ==
                           DEA_EVIDENCE_OFF) {
      return time_s;
    }
  }
  return (double)INFINITY;
}

/* Off by more than 5 % for 5 s, also where only the top of a triangle is cut off, which
 * voltage_error does not see; late by less than half of `behind` is fine. */
TEST(test_read_back_that_is_off)
{
  for (double frequency_Hz = 0.02; frequency_Hz < 1; frequency_Hz *= 5) {
    assert_true(isinf(off_at(frequency_Hz, 1, 0, INFINITY)));
    assert_true(isinf(off_at(frequency_Hz, 1, 0.1, INFINITY)));
    assert_true(isinf(off_at(frequency_Hz, 1.04, 0, INFINITY)));
    double low_s = off_at(frequency_Hz, 0.7, 0, INFINITY);
    double high_s = off_at(frequency_Hz, 1.3, 0, INFINITY),
           cut_s = off_at(frequency_Hz, 1, 0, 1000);
    print_message("%g Hz: off after %g, %g, %g s\n", frequency_Hz, low_s, high_s, cut_s);
    assert_true(low_s >= 5 && low_s < 25 && high_s >= 5 && high_s < 25 && cut_s > 5 && cut_s < 60);
  }
  assert_true(off_at(0.02, 0.92, 0, INFINITY) < 30);
}

enum shape { SQUARE, SINE, TRIANGLE };

/* Between 0 and 2 kV, at 0 V first. */
static double shape_at(enum shape shape, double cycles)
{
  double phase = cycles - floor(cycles);
  return shape == SQUARE ? (phase < 0.5 ? 2000 : 0)
         : shape == SINE ? 1000 - 1000 * cos(2 * 3.14159265358979 * phase)
                         : 2000 * (1 - fabs(2 * phase - 1));
}

/* When an output that is `share` of what is set, cut off at most_V, is found to be wrong within the
 * 12 s of a waveform; it answers after 2 ms, and is measured every 0.5 s or so. */
static double found_at(enum shape shape, double frequency_Hz, double share, double most_V)
{
  static const double golden = 0.6180339887498949;
  struct dea_evidence e = {.lag_s = 0.5, .error_V = 300, .share = 0.05, .zero_V = 20};
  double next_s = 0.1;
  for (int i = 1; i < 600; i++) { // every 20 ms
    double time_s = 0.02 * i, volts = shape_at(shape, frequency_Hz * time_s);
    if (time_s >= next_s) { // what was sent before
      double shown_V = fmin(share * shape_at(shape, frequency_Hz * (time_s - 0.02)), most_V);
      next_s = time_s + 0.5 * (0.5 + fmod(golden * (double)e.readings, 1));
      if (dea_evidence_measured(&e, shown_V, time_s - 2e-3, time_s) != DEA_EVIDENCE_FOLLOWS) {
        assert_true(e.contradicted || e.off);
        return time_s;
      }
    }
    dea_evidence_sent(&e, volts, time_s);
  }
  assert_true(share != 1 || most_V < 2000 || dea_evidence_doubt(&e) == NULL);
  return (double)INFINITY;
}

/* Fast waveforms, where each voltage alone may be one that is a little late: twice the voltage, 0.4
 * times, none, and a cut-off are found all the same, and none where all is well. */
TEST(test_wrong_outputs_of_fast_waveforms)
{
  for (enum shape shape = SQUARE; shape <= TRIANGLE; shape++) {
    for (double frequency_Hz = 0.5; frequency_Hz < 3; frequency_Hz *= 2) {
      double good_s = found_at(shape, frequency_Hz, 1, INFINITY);
      double twice_s = found_at(shape, frequency_Hz, 2, INFINITY);
      double less_s = found_at(shape, frequency_Hz, 0.4, INFINITY);
      double none_s = found_at(shape, frequency_Hz, 0, INFINITY);
      double cut_s = found_at(shape, frequency_Hz, 1, 900);
      print_message("shape %d of %g Hz: found after %g, %g, %g, %g s\n", (int)shape, frequency_Hz,
                    twice_s, less_s, none_s, cut_s);
      assert_true(isinf(good_s));
      assert_true(twice_s < 12 && less_s < 12 && none_s < 12 && cut_s < 12);
    }
  }
}

/* 0 V is believed of a meter that was seen to follow, and that has contradicted nothing since: not
 * of one that shows 0 V whatever is set, at first or from some moment on. */
TEST(test_evidence_of_zero)
{
  for (int from = 0; from < 3; from++) { // never, always, after 4 s
    struct dea_evidence e = {.lag_s = 0.5, .error_V = 300, .share = 0.05, .zero_V = 20};
    assert_null(dea_evidence_doubt(&e)); // nothing was sent
    for (int i = 1; i < 800; i++) {
      double time_s = 0.01 * i, volts = shape_at(SQUARE, time_s);
      dea_evidence_sent(&e, volts, time_s);
      assert_true(i > 1 || dea_evidence_doubt(&e) == dea_zero_unseen);
      if (i % 37 == 0) {
        bool lies = from == 1 || (from == 2 && time_s > 4);
        (void)dea_evidence_measured(&e, lies ? 0 : volts, time_s, time_s);
      }
    }
    assert_true(from == 0 ? dea_evidence_doubt(&e) == NULL
                          : dea_evidence_doubt(&e) == dea_zero_contradicted);
  }
}

/* Short pulses, whose readings of 0 V a late output would explain: a meter that shows 0 V from some
 * moment on is not believed once it was looked at in a pulse, and an honest one is. */
TEST(test_evidence_of_zero_in_pulses)
{
  for (int lies = 0; lies < 2; lies++) {
    struct dea_evidence e = {.lag_s = 0.5, .error_V = 300, .share = 0.05, .zero_V = 20};
    for (int i = 1; i < 1195; i++) {
      const double time_s = 0.01 * i, volts = i % 50 >= 10 && i % 50 < 20 ? 2000 : 0;
      dea_evidence_sent(&e, volts, time_s);
      if (i % 43 == 0) { // in a pulse at every fifth time
        const bool good = !lies || time_s < 9;
        assert_int_equal(dea_evidence_measured(&e, good ? volts : 0, time_s, time_s),
                         DEA_EVIDENCE_FOLLOWS);
      }
    }
    assert_true(dea_evidence_doubt(&e) == (lies ? dea_zero_unseen : NULL));
  }
}

/* When a supply that stays at past_V is found to be wrong, where now_V were sent at 10 s and
 * nothing since; it is measured every 0.1 s. */
static double wrong_at(double past_V, double now_V)
{
  struct dea_evidence e = {.lag_s = 0.5, .error_V = 200, .share = 1e9, .zero_V = 20};
  dea_evidence_sent(&e, past_V, 1);
  for (int i = 11; i < 1000; i++) {
    double time_s = 0.1 * i;
    if (i == 100) {
      dea_evidence_sent(&e, now_V, time_s);
    } else if (dea_evidence_measured(&e, past_V, time_s, time_s) == DEA_EVIDENCE_WRONG) {
      return time_s;
    }
  }
  return (double)INFINITY;
}

/* A supply that does not follow a jump, to 0 V for one, is found although nothing else is sent. */
TEST(test_stays_where_it_was)
{
  assert_true(isinf(wrong_at(5000, 5000)));
  static const double to_V[] = {0, 1000, 6000, -5000};
  for (size_t i = 0; i < 4; i++) {
    double found_s = wrong_at(5000, to_V[i]);
    print_message("from 5 kV to %g kV at 10 s: found at %g s\n", 1e-3 * to_V[i], found_s);
    assert_true(found_s > 10.5 && found_s < 11.5);
  }
}

/* A generator of Siglent or BK before an amplifier, set as a direct voltage: what it gets are
 * numbers in its own words, and off comes before 0 V. */
TEST(test_generator)
{
  static const char generator[] =
      "kind: scpi\naddress: 127.0.0.1\nport: %d\nidentity: SDG\n"
      "setup: [\"C1:BSWV WVTP,DC,OFST,0\", \"C1:BTWV STPS,270\", \"C1:OUTP LOAD,HZ\", \"C1:OUTP "
      "ON\"]\n"
      "output: \"C1:BSWV OFST,%%g\"\noutput_off: \"C1:OUTP OFF\"\nbehind: 5 s\nqueue: 5 s\n";
  static const double volts[] = {0, 2.5, 2.5, 0};
  struct behaviour behaviour = usual;
  struct emulator_sink sink = {0};
  b.protocol.rate_Hz.si = 20;
  b.protocol.safety.zero_time_s.si = 2;
  behaviour.identity = "Siglent Technologies,SDG2042X,1,2";
  assert_int_equal(begin(&behaviour, generator), DEA_OK);
  assert_int_equal(b.instrument->type->put(ctx, b.instrument, volts, 4), DEA_OK);
  const struct dea_sink to = {&sink, emulator_samples, emulator_profile, emulator_reading};
  for (double until_s = dea_clock_s() + 0.5; dea_clock_s() < until_s;) {
    assert_int_equal(b.instrument->type->get(ctx, b.instrument, 0.02, &to), DEA_OK);
  }
  emulator_close(ctx, b.instrument);
  b.instrument = NULL;
  end();
  static const char *const order[] = {"C1:BSWV OFST,0\n",
                                      "C1:BSWV WVTP,DC,OFST,0\nC1:BTWV STPS,270\n",
                                      "C1:OUTP ON\n",
                                      "C1:BSWV OFST,2.5\n*OPC?\n",
                                      "C1:BSWV OFST,0\n*OPC?\n",
                                      "C1:OUTP OFF\nC1:BSWV OFST,0\n*OPC?\n"};
  const char *at = b.emulator.log;
  for (size_t i = 0; i < sizeof order / sizeof order[0]; i++) {
    const char *next = strstr(at, order[i]);
    if (next == NULL) {
      fail_msg("no '%s' behind those before it in\n%s", order[i], b.emulator.log);
    } else {
      at = next + strlen(order[i]);
    }
  }
}

static void work(struct dea_context *context)
{
  struct dea_instrument *instrument;
  struct dea_protocol protocol = {.rate_Hz.si = 100, .safety.zero_time_s.si = 2};
  dea_status status = emulator_open(context, &protocol, b.text, &instrument);
  failing_check(context, status);
  if (status == DEA_OK) {
    emulator_close(context, instrument);
  }
}

/* A supply that was opened by its name is brought to 0 V on a new connection where nobody knows
 * that name any more, or takes longer to say so than there is time: by itself, and by its guard.
 * One of which that is kept is found by it, and by its name where it is an old one. */
TEST(test_name_that_nobody_knows)
{
  static const char plays[] =
      "kind: scpi\naddress: localhost\nport: %d\ntimeout: 5 s\noutput: \"SOUR:VOLT %%g\"\n"
      "behind: 0.1 s\nmeasure: \"MEAS:CURR?\"\n";
  struct behaviour behaviour = usual;
  struct dea_yaml *yaml;
  struct dea_zero zero;
  behaviour.current = "0";
  b.protocol.rate_Hz.si = 100;
  b.protocol.safety.at_zero_V.si = 50;
  b.protocol.safety.voltage_error_V.si = 200;
  b.protocol.safety.readback_error.si = 0.05;
  b.protocol.safety.zero_time_s.si = 10;
  assert_int_equal(begin(&behaviour, plays), DEA_OK);
  char host[DEA_INSTRUMENT_HOST_SIZE];
  memcpy(host, b.instrument->host, sizeof host);
  atomic_store(&no_names, true);
  shutdown(atomic_load(&b.emulator.connection), SHUT_RDWR);
  zero = dea_instrument_stop(ctx, b.instrument);
  assert_int_equal(zero.state, DEA_ZERO_READ_BACK);
  b.instrument->type->close(ctx, b.instrument);
  b.instrument = NULL;
  dea_context_clear(ctx);
  assert_int_equal(dea_yaml_parse(ctx, "protocol.yaml", b.text, strlen(b.text), &yaml), DEA_OK);
  b.protocol.document = yaml;
  b.protocol.instruments[0].section = dea_yaml_root(yaml);
  for (int program = 0; program < 2; program++) { // of which it is the guard
    const struct dea_instrument_past past = {usual.identity, program, 1, host, NULL};
    assert_int_equal(
        dea_instrument_zero(ctx, &b.protocol.instruments[0], &b.protocol, &past, &zero), DEA_OK);
    assert_int_equal(zero.state, DEA_ZERO_READ_BACK);
    dea_context_clear(ctx);
  }
  atomic_store(&no_names, false);
  const struct dea_instrument_past moved = {usual.identity, 0, 1, "127.0.0.99", NULL},
                                   fresh = {"", 0, 1, "", NULL};
  assert_int_equal(dea_instrument_zero(ctx, &b.protocol.instruments[0], &b.protocol, &moved, &zero),
                   DEA_OK);
  assert_int_equal(zero.state, DEA_ZERO_READ_BACK);
  assert_int_equal(dea_instrument_zero(ctx, &b.protocol.instruments[0], &b.protocol, &fresh, &zero),
                   DEA_OK);
  assert_int_equal(zero.state, DEA_ZERO_READ_BACK);
  dea_yaml_destroy(ctx, yaml);
  end();
}

TEST(test_memory)
{
  b.behaviour = usual;
  emulator_start(&b.emulator, serve, &b.behaviour);
  int length = snprintf(b.text, sizeof b.text, reads, b.emulator.port);
  snprintf(b.text + length, sizeof b.text - (size_t)length, "output: VOLT %%g\n");
  assert_true(failing_each(work) > 3);
  emulator_stop(&b.emulator);
}

TESTS(context_set_up, context_tear_down)
