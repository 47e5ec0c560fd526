/* Instruments on serial lines against imitations on pseudo-terminals: a Keyence LK and an optoNCDT,
 * with fragments, garbage, wrong modes, silence and a pulled cable. */
// ctest: slow
#include "emulator.h"
#include "failing_allocator.h"
#include "instrument/poll_schedule.h"
#include "instrument/serial.h"

#include "message_fixture.h"

#include <fcntl.h>
#include <math.h>
#include <termios.h>

enum fault { GOOD, SETTINGS, GARBAGE, NO_OUTPUT, SILENT, PULLED, NOISY, GAP };
enum { GAP_FROM = 300, GAP_LENGTH = 200 };

/* The other end of a serial line, served by a thread. */
struct line {
  int master, keep; // keep: the device's end, held open so that it stays a line without a user
  char device[64];
  pthread_t thread;
  atomic_bool ended;
  enum fault fault;
  size_t fragment; // bytes at a time; 0: all
  bool settings;   // it is in its mode for settings
  int asked, questions;
  double rate_Hz; // of an optoNCDT
  double sent_s;  // when its first value was sent
};

static bool line_open(struct line *l)
{
  l->master = posix_openpt(O_RDWR | O_NOCTTY);
  if (l->master < 0 || grantpt(l->master) != 0 || unlockpt(l->master) != 0 ||
      ptsname_r(l->master, l->device, sizeof l->device) != 0) {
    return false;
  }
  l->keep = open(l->device, O_RDWR | O_NOCTTY);
  return l->keep >= 0;
}

static void line_write(struct line *l, const void *bytes, size_t length)
{
  const char *at = bytes;
  while (length > 0) {
    size_t part = l->fragment > 0 && l->fragment < length ? l->fragment : length;
    if (write(l->master, at, part) != (ssize_t)part) {
      return;
    }
    at += part;
    length -= part;
    if (length > 0) {
      dea_clock_wait(1e-3);
    }
  }
}

static void keyence_answer(struct line *l, const char *command)
{
  const char *text = "ER,MS,00\r";
  bool second = l->asked > 2;
  if (strcmp(command, "R0") == 0) {
    l->settings = false;
    dea_clock_wait(0.05);
    text = "R0\r";
  } else if (l->settings) {
    text = "ER,MS,01\r";
  } else if (strcmp(command, "MS,01") == 0) {
    static const char *const values[] = {"MS,01,+01.2345\r", "MS,01,-00.0120\r", "MS,01,+FFFFFFF\r",
                                         "MS,01,XXXXXXXX\r"};
    text = l->fault == GARBAGE && second ? "MS,0\x05x\xff,nan\r" : values[l->asked % 4];
    l->asked++;
  } else if (strcmp(command, "MS,02") == 0 && l->fault != NO_OUTPUT) {
    text = "MS,02,+0012.50\r";
  }
  if (l->fault == NOISY && second && l->questions++ % 7 < 2) { // two in a row
    text = l->questions % 2 == 0 ? "ER,MS,00\r" : "";
  }
  if (l->fault != SILENT || !second) {
    line_write(l, text, strlen(text));
  }
}

static void *keyence_run(void *user)
{
  struct line *l = user;
  char command[64];
  size_t length = 0;
  while (!atomic_load(&l->ended)) {
    struct pollfd entry = {.fd = l->master, .events = POLLIN};
    char c;
    if (poll(&entry, 1, 5) <= 0 || read(l->master, &c, 1) != 1) {
      continue;
    }
    if (c == '\r') {
      command[length] = '\0';
      length = 0;
      keyence_answer(l, command);
      if (l->fault == PULLED && l->asked > 2) {
        close(l->master);
        l->master = -1;
        return NULL;
      }
    } else if (length + 1 < sizeof command) {
      command[length++] = c;
    }
  }
  return NULL;
}

/* A triangle from 0 to 16207 and back in 400 values, and each 50th nothing in view. */
static int optoncdt_number(size_t i)
{
  size_t phase = i % 400;
  return i % 50 == 49 ? 16370 : 161 + (int)(phase < 200 ? phase : 400 - phase) * 80;
}

static void *optoncdt_run(void *user)
{
  struct line *l = user;
  l->sent_s = dea_clock_s();
  for (size_t i = 0; !atomic_load(&l->ended);) {
    unsigned char bytes[2 * 64];
    size_t count = 0; // an adapter hands over what has gathered
    for (; count < 64 && l->sent_s + (double)i / l->rate_Hz <= dea_clock_s(); count++, i++) {
      int number = optoncdt_number(i);
      bytes[2 * count] = (unsigned char)(0x80 | number >> 7);
      bytes[2 * count + 1] = (unsigned char)(number & 0x7f);
    }
    if (l->fault == GARBAGE && i > 200 && i < 300 && count > 1) {
      memmove(bytes, bytes + 1, 2 * count - 1); // a byte is lost
      line_write(l, bytes, 2 * count - 1);
    } else if (l->fault != SILENT || i < 300) {
      line_write(l, bytes, 2 * count);
    }
    i += l->fault == GAP && i >= GAP_FROM && i - count < GAP_FROM ? GAP_LENGTH : 0;
    dea_clock_wait(0.016);
  }
  return NULL;
}

static const char keyence[] = "kind: keyence\ndevice: %s\ntimeout: 0.5 s\ninterval: 5 ms\n"
                              "readings:\n"
                              "  - {name: laser, output: 1}\n"
                              "  - {name: other, output: 2, factor: -1e-3, offset: 20 mm}\n";
static const char quick_keyence[] = "kind: keyence\ndevice: %s\ntimeout: 50 ms\ninterval: 5 ms\n"
                                    "readings:\n"
                                    "  - {name: laser, output: 1}\n"
                                    "  - {name: other, output: 2, factor: -1e-3, offset: 20 mm}\n";
static const char optoncdt[] = "kind: optoncdt\ndevice: %s\nrange: 10 mm\nrate: 750 Hz\n"
                               "average: 3\nfactor: -1\noffset: 5 mm\ntimeout: 0.5 s\n";

struct bench {
  struct line line;
  struct dea_protocol protocol;
  struct dea_instrument *instrument;
  struct emulator_sink sink;
  char text[1024];
};

/* Skips the test where there is no pseudo-terminal. */
static dea_status begin(struct bench *b, const char *section, void *(*run)(void *))
{
  if (!line_open(&b->line)) {
    skip();
  }
  snprintf(b->text, sizeof b->text, section, b->line.device);
  assert_int_equal(pthread_create(&b->line.thread, NULL, run, &b->line), 0);
  dea_finding_clear(ctx);
  dea_status status = emulator_open(ctx, &b->protocol, b->text, &b->instrument);
  return status == DEA_OK ? b->instrument->type->start(ctx, b->instrument) : status;
}

static void end(struct bench *b)
{
  if (b->instrument != NULL) {
    emulator_close(ctx, b->instrument);
  }
  atomic_store(&b->line.ended, true);
  pthread_join(b->line.thread, NULL);
  close(b->line.keep);
  if (b->line.master >= 0) {
    close(b->line.master);
  }
}

TEST(test_keyence)
{
  static const double laser[] = {1.2345e-3, -0.012e-3, NAN, NAN};
  for (size_t fragment = 0; fragment < 4; fragment++) {
    struct bench b = {.line.fragment = fragment, .line.settings = fragment == 1};
    assert_int_equal(begin(&b, keyence, keyence_run), DEA_OK);
    assert_int_equal(b.instrument->readings[0].kind, DEA_CHANNEL_DISPLACEMENT);
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 16, 0, 0), DEA_OK);
    assert_int_equal(b.instrument->lost, 0);
    for (size_t i = 0; i < 16; i++) {
      double wanted = i % 2 == 1 ? 7.5e-3 : laser[(i / 2 + 1) % 4]; // the first one was at opening
      assert_int_equal(b.sink.reading[i].reading, i % 2);
      assert_true(isnan(wanted) ? isnan(b.sink.reading[i].value)
                                : fabs(b.sink.reading[i].value - wanted) < 1e-12);
      assert_true(i == 0 || b.sink.reading[i].time_s > b.sink.reading[i - 1].time_s);
    }
    if (fragment == 0) {
      emulator_check_clock(ctx, b.instrument, &b.sink);
    }
    end(&b);
  }
}

TEST(test_keyence_faults)
{
  struct bench b = {.line.fault = GARBAGE};
  assert_int_equal(begin(&b, keyence, keyence_run), DEA_OK);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 12, 0, 0), DEA_OK);
  for (size_t i = 4; i < 12; i += 2) {
    assert_true(isnan(b.sink.reading[i].value));
    assert_true(fabs(b.sink.reading[i + 1].value - 7.5e-3) < 1e-12);
  }
  assert_true(b.instrument->lost >= 4);
  end(&b);
  static const struct {
    enum fault fault;
    const char *message;
  } cases[] = {{SILENT, "did not answer 3 questions in a row within 0.5 s each"},
               {PULLED, "the connection to the Keyence LK at /dev/"}};
  for (size_t i = 0; i < 2; i++) {
    struct bench c = {.line.fault = cases[i].fault};
    assert_int_equal(begin(&c, keyence, keyence_run), DEA_OK);
    assert_message(emulator_get(ctx, c.instrument, &c.sink, 100, 0, 0), DEA_E_INSTRUMENT,
                   cases[i].message);
    end(&c);
  }
  struct bench e = {.line.fault = NOISY};
  size_t values = 0;
  assert_int_equal(begin(&e, quick_keyence, keyence_run), DEA_OK);
  assert_int_equal(emulator_get(ctx, e.instrument, &e.sink, 40, 0, 0), DEA_OK);
  for (size_t i = 0; i < 40; i++) { // what comes is what was asked for
    bool other = e.sink.reading[i].reading == 1, none = isnan(e.sink.reading[i].value);
    assert_true(none || (fabs(e.sink.reading[i].value - 7.5e-3) < 1e-12) == other);
    values += !none && other ? 1 : 0;
  }
  assert_true(values > 5 && e.instrument->lost > 5);
  end(&e);
  struct bench d = {.line.fault = NO_OUTPUT};
  assert_message(begin(&d, keyence, keyence_run), DEA_E_INSTRUMENT, "to a question for OUT 2");
  end(&d);
}

/* Value by value in their order, at times that differ from those at which they were measured by the
 * adapter's delay at most. */
TEST(test_optoncdt)
{
  struct bench b = {.line.rate_Hz = 750};
  assert_int_equal(begin(&b, optoncdt, optoncdt_run), DEA_OK);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 256, 0, 0), DEA_OK);
  assert_int_equal(b.instrument->lost, 0);
  size_t nothing = 0;
  for (size_t i = 1; i < 256; i++) {
    double step_s = b.sink.reading[i].time_s - b.sink.reading[i - 1].time_s;
    double step_m = b.sink.reading[i].value - b.sink.reading[i - 1].value;
    assert_true(step_s > 0 && step_s < 0.1);
    nothing += isnan(b.sink.reading[i].value) ? 1 : 0;
    if (!isnan(step_m)) { // 80 of 16368, the way of the triangle, but at its corner
      assert_true(fabs(fabs(step_m) - 1.02 * 80 / 16368 * 10e-3) < 1e-9 || step_m == 0);
    }
  }
  assert_in_range(nothing, 5, 6);
  double rate_Hz = 255 / (b.sink.reading[255].time_s - b.sink.reading[0].time_s);
  assert_true(fabs(rate_Hz - 750) < 75); // a piece of 16 ms at both ends
  emulator_check_clock(ctx, b.instrument, &b.sink);
  end(&b);
}

TEST(test_optoncdt_faults)
{
  struct bench b = {.line.rate_Hz = 750, .line.fault = GARBAGE};
  assert_int_equal(begin(&b, optoncdt, optoncdt_run), DEA_OK);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 400, 0, 0), DEA_OK);
  assert_true(b.instrument->lost > 0);
  for (size_t i = 0; i < 256; i++) { // never half of one value and half of another
    double value = b.sink.reading[i].value;
    double number = ((5e-3 - value) / 10e-3 + 0.01) * 16368 / 1.02;
    assert_true(isnan(value) || fabs(fmod(number - 161 + 40, 80) - 40) < 1e-6);
  }
  end(&b);
  struct bench c = {.line.rate_Hz = 750, .line.fault = SILENT};
  assert_int_equal(begin(&c, optoncdt, optoncdt_run), DEA_OK);
  assert_message(emulator_get(ctx, c.instrument, &c.sink, 5000, 0, 0), DEA_E_INSTRUMENT,
                 "nothing came from the optoNCDT");
  end(&c);
  struct bench d = {0}; // a Keyence where an optoNCDT was expected
  assert_message(begin(&d, optoncdt, keyence_run), DEA_E_INSTRUMENT, "nothing came from");
  end(&d);
}

/* Those behind a gap have the time at which they came, once a second has shown it. */
TEST(test_optoncdt_gap)
{
  struct bench b = {.line.rate_Hz = 750, .line.fault = GAP};
  assert_int_equal(begin(&b, optoncdt, optoncdt_run), DEA_OK);
  static struct emulator_sink sink;
  assert_int_equal(emulator_get(ctx, b.instrument, &sink, 1600, 0, 0), DEA_OK);
  double behind_s =
      sink.reading[1599].time_s - sink.reading[100].time_s - (1499. + GAP_LENGTH) / 750;
  assert_true(fabs(behind_s) < 0.04); // a piece of 16 ms at both ends
  assert_true(b.instrument->lost > GAP_LENGTH - 40 && b.instrument->lost < GAP_LENGTH + 40);
  end(&b);
}

/* A line that another program left with another idea of it. */
TEST(test_line_as_left)
{
  struct line l = {0};
  struct dea_socket socket;
  struct termios termios;
  if (!line_open(&l)) {
    skip();
  }
  assert_int_equal(tcgetattr(l.keep, &termios), 0);
  termios.c_cflag |= CRTSCTS | CSTOPB;
  termios.c_iflag |= IXON | IXOFF | IXANY | IGNPAR;
  assert_int_equal(tcsetattr(l.keep, TCSANOW, &termios), 0);
  for (int parity = 0; parity < 2; parity++) {
    assert_int_equal(dea_serial_open(ctx, "a line", l.device, 9600, parity, &socket), DEA_OK);
    assert_int_equal(tcgetattr(l.keep, &termios), 0);
    assert_int_equal(termios.c_cflag & (tcflag_t)(CRTSCTS | CSTOPB), 0);
    assert_int_equal(termios.c_iflag & (tcflag_t)(IXON | IXOFF | IXANY | IGNPAR), 0);
    assert_int_equal((termios.c_iflag & (tcflag_t)INPCK) != 0, parity);
    dea_socket_close(&socket);
  }
  close(l.keep);
  close(l.master);
}

/* A line is one program's, whatever name it has. */
TEST(test_line_in_use)
{
  char in_use[64];
  struct bench b = {0}, second = {0};
  assert_int_equal(begin(&b, keyence, keyence_run), DEA_OK);
  snprintf(second.text, sizeof second.text, keyence, b.line.device);
  snprintf(in_use, sizeof in_use, "is in use by process %ld (test_lab_serial)", (long)getpid());
  assert_message(emulator_open(ctx, &second.protocol, second.text, &second.instrument),
                 DEA_E_INSTRUMENT, in_use);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 4, 0, 0), DEA_OK); // undisturbed
  emulator_close(ctx, b.instrument);
  b.instrument = NULL;
  assert_int_equal(emulator_open(ctx, &second.protocol, second.text, &b.instrument), DEA_OK);
  end(&b);
}

TEST(test_wrong_keys)
{
  static const struct {
    const char *section;
    dea_status status;
    const char *message;
  } cases[] = {
      {"kind: keyence\ndevice: /no/such/line\nreadings: [{name: a}]\n", DEA_E_INSTRUMENT,
       "No such file"},
      {"kind: keyence\ndevice: /dev/null\nreadings: [{name: a}]\n", DEA_E_INSTRUMENT,
       "it is no serial line"},
      {"kind: keyence\ndevice: /dev/null\nbaud: 9601\nreadings: [{name: a}]\n", DEA_E_INSTRUMENT,
       "no speed of 9601 baud"},
      {"kind: keyence\ndevice: /dev/null\nreadings: [{name: a}, {name: a}]\n", DEA_E_DESIGN, NULL},
      {"kind: keyence\ndevice: /dev/null\nreadings: [{name: a, output: 13}]\n", DEA_E_DESIGN, NULL},
      {"kind: keyence\ndevice: /dev/null\n", DEA_E_DESIGN, NULL},
      {"kind: optoncdt\ndevice: /dev/null\n", DEA_E_DESIGN, NULL},
      {"kind: optoncdt\ndevice: /dev/null\nrange: 10 mm\n", DEA_E_INSTRUMENT, "no serial line"}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct bench b = {0};
    dea_finding_clear(ctx);
    dea_status status = emulator_open(ctx, &b.protocol, cases[i].section, &b.instrument);
    if (cases[i].message != NULL) {
      assert_message(status, cases[i].status, cases[i].message);
    } else {
      assert_int_equal(status, cases[i].status);
      assert_true(dea_finding_count(ctx, DEA_ERROR) == 1);
    }
  }
}

TEST(test_asking)
{
  struct dea_poll_schedule a = {.count = 2, .interval_s = 1, .timeout_s = 5};
  double next_s;
  dea_poll_schedule_start(&a, 10);
  assert_true(dea_poll_schedule_next(&a, 10, &next_s) && a.reading == 0 && next_s == 15);
  assert_true(dea_poll_schedule_next(&a, 10.2, &next_s) && a.reading == 1);
  assert_true(!dea_poll_schedule_next(&a, 10.5, &next_s) && next_s == 11);
  assert_true(dea_poll_schedule_next(&a, 14, &next_s) &&
              a.reading == 0); // late: not for what was missed
  assert_true(dea_poll_schedule_next(&a, 14, &next_s) && a.reading == 1);
  assert_true(dea_poll_schedule_next(&a, 14, &next_s) && dea_poll_schedule_next(&a, 14, &next_s));
  assert_false(dea_poll_schedule_next(&a, 14.5, &next_s));
}

TESTS(context_set_up, context_tear_down)
