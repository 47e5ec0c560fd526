// The Gocator's messages and its connection, against an emulator on the loopback interface.
#include "base/clock.h"
#include "emulator.h"
#include "failing_allocator.h"
#include "gocator_bytes.h"

#include "message_fixture.h"

/* What the emulated sensor sends on its data connection: `head`, then frames until it is enough. */
struct sensor {
  struct gocator_bytes head;
  struct gocator_bytes frames[8];
  size_t count, cut; // bytes of the last frame that are sent, then it hangs up; 0: all
  bool hangs_up;
  atomic_bool goes_on; // after the first frame, once the instrument has been started
  int status;          // of its reply to Start; -1: none
};

/* Control: replies to every command of six bytes. */
static void serve_control(struct emulator *e, int connection)
{
  struct sensor *s = e->user;
  char bytes[64];
  size_t length = 0, more;
  while ((more = emulator_receive(e, connection, bytes + length, sizeof bytes - length)) > 0) {
    for (length += more; length >= 6; length -= 6) {
      static struct gocator_bytes reply;
      reply.length = 0;
      gocator_put(&reply, 10, 4);
      reply.bytes[reply.length++] = (unsigned char)bytes[4];
      reply.bytes[reply.length++] = (unsigned char)bytes[5];
      gocator_put(&reply, s->status, 4);
      if (s->status != -1) {
        emulator_send(e, connection, reply.bytes, reply.length);
      }
      memmove(bytes, bytes + 6, length - 6);
    }
  }
}

static void serve_data(struct emulator *e, int connection)
{
  struct sensor *s = e->user;
  char bytes[64];
  emulator_send(e, connection, s->head.bytes, s->head.length);
  for (size_t i = 0; i < s->count; i++) {
    while (i > 0 && !atomic_load(&s->goes_on) && !atomic_load(&e->ended)) {
      dea_clock_wait(0.001);
    }
    bool cut = i + 1 == s->count && s->cut > 0;
    emulator_send(e, connection, s->frames[i].bytes, cut ? s->cut : s->frames[i].length);
  }
  if (s->hangs_up) {
    shutdown(connection, SHUT_RDWR);
  }
  while (emulator_receive(e, connection, bytes, sizeof bytes) > 0) {
  }
}

/* Of one sensor; what it sends is set before it begins. */
static struct bench {
  struct emulator data, control;
  struct sensor sensor;
  struct dea_protocol protocol;
  struct dea_instrument *instrument;
  struct emulator_sink sink;
  char text[1024];
} b = {.sensor.status = 1};

// A short timeout only where it is to pass: the machine may be busy.
#define USUAL(timeout)                                                                             \
  "kind: gocator\naddress: 127.0.0.1\nport: %d\ncontrol_port: %d\n"                                \
  "timeout: " timeout "\n"                                                                         \
  "measurements: [{name: centre, id: 3}, {name: tip, id: 7, factor: -1e-6}]\n"
// All but the first frame are that much later by the sensor's clock: after any start.
enum { LATER_US = 20000000 };
static const char usual[] = USUAL("5 s");
static const char hasty[] = USUAL("0.25 s");

static dea_status begin(const char *section, void (*serve)(struct emulator *e, int connection))
{
  emulator_start(&b.data, serve, &b.sensor);
  emulator_start(&b.control, serve_control, &b.sensor);
  snprintf(b.text, sizeof b.text, section, b.data.port, b.control.port);
  dea_finding_clear(ctx);
  b.sink.points = GOCATOR_WIDTH;
  dea_status status = emulator_open(ctx, &b.protocol, b.text, &b.instrument);
  if (status == DEA_OK) {
    status = b.instrument->type->start(ctx, b.instrument);
    atomic_store(&b.sensor.goes_on, true);
  }
  return status;
}

static void reset(void)
{
  memset(&b, 0, sizeof b);
  b.sensor.status = 1;
}

static void end(void)
{
  if (b.instrument != NULL) {
    emulator_close(ctx, b.instrument);
  }
  emulator_stop(&b.data);
  emulator_stop(&b.control);
  reset();
}

TEST(test_frames)
{
  static const size_t fragments[] = {0, 1, 7};
  for (size_t f = 0; f < 3; f++) {
    static const int numbers[] = {0, 1, 2, 6}; // three are missing
    for (size_t i = 0; i < 4; i++) {
      gocator_frame(&b.sensor.frames[i], numbers[i], 30000 * numbers[i] + (i > 0 ? LATER_US : 0));
    }
    b.sensor.count = 4;
    b.data.fragment = fragments[f];
    assert_int_equal(begin(usual, serve_data), DEA_OK);
    assert_int_equal(b.instrument->roles, DEA_SENDS_PROFILES | DEA_GIVES_READINGS);
    assert_int_equal(b.instrument->profile_points, GOCATOR_WIDTH);
    for (size_t i = 0; i < GOCATOR_WIDTH; i++) {
      assert_close(b.instrument->x_m[i], -20e-6 + 10e-6 * (double)i, 1e-12, 1e-18);
    }
    assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 6, 3, 0), DEA_OK);
    assert_int_equal(b.sink.profiles, 3);
    assert_int_equal(b.instrument->lost, 3);
    assert_true(b.sink.profile_time_s[0] >= 0 && b.sink.profile_time_s[0] < 21);
    // The sensor's clock, whenever the frames came.
    assert_close(b.sink.profile_time_s[1] - b.sink.profile_time_s[0], 0.03, 0, 1e-9);
    assert_close(b.sink.profile_time_s[2] - b.sink.profile_time_s[0], 0.15, 0, 1e-9);
    for (size_t i = 0; i < GOCATOR_WIDTH; i++) {
      assert_close(b.sink.z_m[2][i], 1e-3 + 0.5e-6 * (double)(i + 1), 1e-12, 0);
    }
    assert_int_equal(b.sink.readings, 6);
    assert_close(b.sink.reading[0].value, 1e-3, 1e-12, 0); // 1 mm
    assert_close(b.sink.reading[1].value, -5e-6, 1e-12, 0);
    assert_close(b.sink.reading[4].time_s, b.sink.profile_time_s[2], 0, 1e-9);
    end();
  }
}

TEST(test_invalid_and_other_grid)
{
  static const int16_t line[] = {0, 10, 20, -32768, 40, 50, 60, 70, 80, 90};
  gocator_frame(&b.sensor.frames[0], 0, 0);
  // Half the spacing, then a wider field, then points: heights of 10 um a 10 um, one missing.
  gocator_stamp(&b.sensor.frames[1], 1, LATER_US + 1000);
  gocator_profile(&b.sensor.frames[1], 0, 10, 5000, 500, -20, 0, line);
  gocator_stamp(&b.sensor.frames[2], 2, LATER_US + 2000);
  gocator_profile(&b.sensor.frames[2], 0, 4, 20000, 500, -30, 0, line);
  gocator_stamp(&b.sensor.frames[3], 3, LATER_US + 3000);
  gocator_profile(&b.sensor.frames[3], 1, 10, 2500, 500, -20, 0, line);
  b.sensor.count = 4;
  assert_int_equal(begin(usual, serve_data), DEA_OK);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 3, 0), DEA_OK);
  assert_int_equal(b.sink.profiles, 3);
  // Positions -20, -10, 0, 10, 20 um; units of 0.5 um.
  static const double wanted[3][GOCATOR_WIDTH] = {
      {0, 20, 40, 60, 80}, {5, 10, 15, 20, NAN}, {0, 20, 40, 60, 80}};
  for (size_t k = 0; k < 3; k++) {
    for (size_t i = 0; i < GOCATOR_WIDTH; i++) {
      double z = b.sink.z_m[k][i] / 0.5e-6;
      if (isnan(wanted[k][i]) != isnan(z) || fabs(z - wanted[k][i]) > 1e-6) {
        fail_msg("frame %zu, point %zu: %g, wanted %g", k, i, z, wanted[k][i]);
      }
    }
  }
  assert_int_equal(dea_finding_count(ctx, DEA_NOTE), 1); // interpolated
  end();
}

TEST(test_start_and_stop)
{
  static const struct {
    int status;
    dea_status wanted;
    const char *message, *commands;
    size_t length;
  } cases[] = {
      {1, DEA_OK, "", "\x06\0\0\0\x0d\x10\x06\0\0\0\x01\x10", 12},
      {-1000, DEA_OK, "", "\x06\0\0\0\x0d\x10", 6}, // it ran already: not stopped
      {0, DEA_E_INSTRUMENT, "does not start: status 0", "\x06\0\0\0\x0d\x10", 6},
      {-1, DEA_E_INSTRUMENT, "does not answer the command to start", "\x06\0\0\0\x0d\x10", 6},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    b.sensor.status = cases[i].status;
    gocator_frame(&b.sensor.frames[0], 0, 0);
    b.sensor.count = 1;
    assert_message(begin(cases[i].status == -1 ? hasty : usual, serve_data), cases[i].wanted,
                   cases[i].wanted != DEA_OK ? cases[i].message : dea_context_message(ctx));
    if (b.instrument != NULL) {
      emulator_close(ctx, b.instrument);
      b.instrument = NULL;
    }
    emulator_stop(&b.control);
    emulator_stop(&b.data);
    assert_int_equal(atomic_load(&b.control.got), cases[i].length);
    assert_memory_equal(b.control.log, cases[i].commands, cases[i].length);
    reset();
  }
}

TEST(test_goes_silent)
{
  // not one frame
  assert_message(begin(hasty, serve_data), DEA_E_INSTRUMENT, "no profile came from the Gocator");
  end();
  gocator_frame(&b.sensor.frames[0], 0, 0);
  b.sensor.count = 1; // one, and no more
  assert_int_equal(begin(hasty, serve_data), DEA_OK);
  assert_message(emulator_get(ctx, b.instrument, &b.sink, 0, 1, 0), DEA_E_INSTRUMENT,
                 "for 0.25 s; look at its laser");
  end();
}

TEST(test_hangs_up)
{
  gocator_frame(&b.sensor.frames[0], 0, 0);
  size_t length = b.sensor.frames[0].length;
  reset();
  for (size_t cut = 1; cut <= length; cut += cut < 30 ? 1 : 23) {
    b.sensor.hangs_up = true;
    gocator_frame(&b.sensor.frames[0], 0, 0);
    gocator_frame(&b.sensor.frames[1], 1, LATER_US);
    b.sensor.count = 2;
    b.sensor.cut = cut;
    assert_int_equal(begin(usual, serve_data), DEA_OK);
    assert_message(emulator_get(ctx, b.instrument, &b.sink, 0, 2, 0), DEA_E_INSTRUMENT,
                   "the connection to the Gocator at 127.0.0.1");
    assert_int_equal(b.sink.profiles, cut == length ? 1 : 0);
    end();
  }
}

TEST(test_garbage)
{
  memcpy(b.sensor.head.bytes, "HTTP/1.1 400 Bad Request\r\n", 26);
  b.sensor.head.length = 26;
  assert_message(begin(usual, serve_data), DEA_E_INSTRUMENT, "is not a Gocator's data");
  end();
  // A message that contradicts itself is left out, and the next ones are good.
  gocator_profile(&b.sensor.head, 0, GOCATOR_WIDTH, 10000, 500, 0, 0, gocator_ranges);
  b.sensor.head.bytes[12] = 200;
  for (int i = 0; i < 3; i++) {
    gocator_frame(&b.sensor.frames[i], i, LATER_US * i);
  }
  b.sensor.frames[1].bytes[10] = 0xff; // size of a stamp: its profile has no time of its own
  b.sensor.frames[1].bytes[11] = 0xff;
  b.sensor.count = 3;
  assert_int_equal(begin(usual, serve_data), DEA_OK);
  assert_int_equal(dea_finding_count(ctx, DEA_WARNING), 1);
  assert_int_equal(emulator_get(ctx, b.instrument, &b.sink, 0, 2, 0), DEA_OK);
  assert_true(b.instrument->lost >= 1);
  // the profile without a time of its own has that of its arrival, and moves no other
  assert_int_equal(b.sink.profiles, 2);
  assert_true(b.sink.profile_time_s[0] >= 0 && b.sink.profile_time_s[0] < 20);
  assert_close(b.sink.profile_time_s[1], 2e-6 * LATER_US, 0, 15);
  end();
}

/* Two frames, then one after the other without end. */
static void serve_without_end(struct emulator *e, int connection)
{
  struct sensor *s = e->user;
  static struct gocator_bytes frame;
  emulator_send(e, connection, s->frames[0].bytes, s->frames[0].length);
  for (int i = 1; !atomic_load(&e->ended); i++) {
    frame.length = 0;
    gocator_frame(&frame, i, LATER_US + 10000 * i);
    const struct gocator_bytes *next = i == 1 ? &s->frames[1] : &frame;
    while (!atomic_load(&s->goes_on) && !atomic_load(&e->ended)) {
      dea_clock_wait(0.001);
    }
    emulator_send(e, connection, next->bytes, next->length);
    dea_clock_wait(0.01);
  }
}

/* A time that cannot be, of the frame before the start or of the one after it, leaves no other that
 * counts: that is silence, which ends it, and not a recording without profiles. */
TEST(test_times_that_cannot_be)
{
  for (int wrong = 0; wrong < 2; wrong++) {
    for (int i = 0; i < 2; i++) {
      gocator_frame(&b.sensor.frames[i], i, LATER_US * i);
    }
    b.sensor.frames[wrong].bytes[22 + 6] = 0x40; // 2^54 us later
    assert_int_equal(begin(hasty, serve_without_end), DEA_OK);
    assert_message(emulator_get(ctx, b.instrument, &b.sink, 0, 1000, 0), DEA_E_INSTRUMENT,
                   "no profile came");
    assert_true(b.sink.profiles <= 1);
    end();
  }
}

TEST(test_not_there)
{
  snprintf(b.text, sizeof b.text, usual, emulator_no_port(), emulator_no_port());
  assert_message(emulator_open(ctx, &b.protocol, b.text, &b.instrument), DEA_E_INSTRUMENT,
                 "there is no connection to the Gocator at 127.0.0.1, port");
  emulator_start(&b.data, serve_data, &b.sensor);
  snprintf(b.text, sizeof b.text, usual, b.data.port, emulator_no_port());
  assert_message(emulator_open(ctx, &b.protocol, b.text, &b.instrument), DEA_E_INSTRUMENT,
                 "the Gocator's control at 127.0.0.1");
  emulator_stop(&b.data);
}

TEST(test_wrong_keys)
{
  static const char *const cases[][2] = {
      {"kind: gocator\nmode: measurements\n", "without profiles it needs its 'measurements'"},
      {"kind: gocator\nmeasurements: [{name: a, id: 1}, {name: b, id: 1}]\n",
       "measurement 1 is read into 'a' already"},
      {"kind: gocator\nmode: binary\n", "mode"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    struct dea_protocol protocol = {0};
    struct dea_instrument *instrument;
    size_t count;
    dea_finding_clear(ctx);
    assert_int_equal(emulator_open(ctx, &protocol, cases[i][0], &instrument), DEA_E_DESIGN);
    const struct dea_finding *findings = dea_finding_get(ctx, &count);
    assert_true(count >= 1 && strstr(findings[0].text, cases[i][1]) != NULL);
  }
  dea_finding_clear(ctx);
}

static void work(struct dea_context *context)
{
  struct dea_instrument *instrument;
  struct dea_protocol protocol = {0};
  dea_status status = emulator_open(context, &protocol, b.text, &instrument);
  failing_check(context, status);
  if (status == DEA_OK) {
    emulator_close(context, instrument);
  }
}

TEST(test_memory)
{
  gocator_frame(&b.sensor.frames[0], 0, 0);
  b.sensor.count = 1;
  emulator_start(&b.data, serve_data, &b.sensor);
  emulator_start(&b.control, serve_control, &b.sensor);
  snprintf(b.text, sizeof b.text, usual, b.data.port, b.control.port);
  assert_true(failing_each(work) > 4);
  emulator_stop(&b.data);
  emulator_stop(&b.control);
}

TESTS(context_set_up, context_tear_down)
