/* An instrument on the loopback interface: a thread that serves one TCP connection after the other,
 * and what it takes to open an instrument of a section of text. */
#pragma once

#include "base/clock.h"
#include "instrument/instrument.h"
#include "testing.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct emulator {
  int listener, port;
  atomic_int connection; // the latest
  pthread_t thread;
  atomic_bool ended;
  void (*serve)(struct emulator *emulator, int connection);
  void *user;
  size_t fragment;   // bytes that are sent at a time; 0: all
  atomic_size_t got; // bytes of `log`
  char log[1 << 16]; // what came, NUL-terminated
};

/* Sends in fragments; the other end may be gone. */
static inline void emulator_send(struct emulator *emulator, int connection, const void *bytes,
                                 size_t length)
{
  const char *at = bytes;
  while (length > 0) {
    size_t part =
        emulator->fragment > 0 && emulator->fragment < length ? emulator->fragment : length;
    ssize_t sent = send(connection, at, part, MSG_NOSIGNAL);
    if (sent <= 0) {
      return;
    }
    at += sent;
    length -= (size_t)sent;
  }
}

/* Waits for bytes, which are logged too; 0 when the other end is gone or the test is over. */
static inline size_t emulator_receive(struct emulator *emulator, int connection, char *bytes,
                                      size_t capacity)
{
  struct pollfd entry = {.fd = connection, .events = POLLIN};
  do { // what was sent before the end is still taken
    if (poll(&entry, 1, 5) > 0) {
      ssize_t got = recv(connection, bytes, capacity, 0);
      size_t length = got > 0 ? (size_t)got : 0, at = atomic_load(&emulator->got);
      if (at + length < sizeof emulator->log) {
        memcpy(emulator->log + at, bytes, length);
        atomic_store(&emulator->got, at + length);
      }
      return length;
    }
  } while (!atomic_load(&emulator->ended));
  return 0;
}

static inline void *emulator_run(void *user)
{
  struct emulator *emulator = user;
  struct pollfd entry = {.fd = emulator->listener, .events = POLLIN};
  while (!atomic_load(&emulator->ended)) {
    if (poll(&entry, 1, 5) > 0) {
      int connection = accept(emulator->listener, NULL, NULL);
      int on = 1;
      if (connection >= 0) {
        setsockopt(connection, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        atomic_store(&emulator->connection, connection);
        emulator->serve(emulator, connection);
        close(connection);
      }
    }
  }
  return NULL;
}

static inline void emulator_start(struct emulator *emulator,
                                  void (*serve)(struct emulator *emulator, int connection),
                                  void *user)
{
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
  emulator->listener = socket(AF_INET, SOCK_STREAM, 0);
  emulator->serve = serve;
  emulator->user = user;
  assert_true(emulator->listener >= 0);
  assert_int_equal(bind(emulator->listener, (struct sockaddr *)&address, sizeof address), 0);
  assert_int_equal(listen(emulator->listener, 4), 0);
  assert_int_equal(getsockname(emulator->listener, (struct sockaddr *)&address, &size), 0);
  emulator->port = ntohs(address.sin_port);
  atomic_store(&emulator->ended, false);
  atomic_store(&emulator->got, 0);
  memset(emulator->log, 0, sizeof emulator->log);
  assert_int_equal(pthread_create(&emulator->thread, NULL, emulator_run, emulator), 0);
}

static inline void emulator_stop(struct emulator *emulator)
{
  atomic_store(&emulator->ended, true);
  pthread_join(emulator->thread, NULL);
  close(emulator->listener);
}

/* A port on which nobody listens. */
static inline int emulator_no_port(void)
{
  struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof address;
  int listener = socket(AF_INET, SOCK_STREAM, 0);
  assert_int_equal(bind(listener, (struct sockaddr *)&address, sizeof address), 0);
  assert_int_equal(getsockname(listener, (struct sockaddr *)&address, &size), 0);
  close(listener);
  return ntohs(address.sin_port);
}

/* Opens the instrument of a section's text; protocol: zero but for what the test sets. */
static inline dea_status emulator_open(struct dea_context *ctx, struct dea_protocol *protocol,
                                       const char *text, struct dea_instrument **out)
{
  struct dea_yaml *yaml;
  *out = NULL;
  dea_status status = dea_yaml_parse(ctx, "protocol.yaml", text, strlen(text), &yaml);
  if (status != DEA_OK) {
    return status;
  }
  if (protocol->amplifier.gain.si == 0) { // one of 10 kV for 10 V
    protocol->amplifier.gain.si = 1000;
    protocol->amplifier.control_V.si = 10;
    protocol->amplifier.highest_V.si = 10e3;
    protocol->amplifier.lowest_V.si = -10e3;
  }
  protocol->file = "protocol.yaml";
  protocol->document = yaml;
  protocol->instrument_count = 1;
  protocol->instruments[0] =
      (struct dea_protocol_instrument){dea_yaml_root(yaml), "instruments[0]"};
  status = dea_instrument_open(ctx, &protocol->instruments[0], protocol, out);
  dea_yaml_destroy(ctx, yaml);
  return status;
}

static inline void emulator_close(struct dea_context *ctx, struct dea_instrument *instrument)
{
  dea_instrument_stop(ctx, instrument);
  instrument->type->close(ctx, instrument);
}

enum { EMULATOR_READINGS_MAX = 2048 };

/* What an instrument hands over, kept. */
struct emulator_sink {
  size_t readings, profiles, samples, channels; // channels: of the samples
  struct {
    size_t reading;
    double time_s, value;
  } reading[EMULATOR_READINGS_MAX];
  double profile_time_s[256];
  double z_m[64][64]; // of the first ones
  size_t points;
  double *volts; // [samples][channels]; free
};

static inline dea_status emulator_reading(void *user, size_t reading, double time_s, double value)
{
  struct emulator_sink *sink = user;
  if (sink->readings < EMULATOR_READINGS_MAX) {
    sink->reading[sink->readings].reading = reading;
    sink->reading[sink->readings].time_s = time_s;
    sink->reading[sink->readings].value = value;
  }
  sink->readings++;
  return DEA_OK;
}

static inline dea_status emulator_profile(void *user, double time_s, const double *z_m)
{
  struct emulator_sink *sink = user;
  if (sink->profiles < 256) {
    sink->profile_time_s[sink->profiles] = time_s;
  }
  for (size_t i = 0; sink->profiles < 64 && i < sink->points && i < 64; i++) {
    sink->z_m[sink->profiles][i] = z_m[i];
  }
  sink->profiles++;
  return DEA_OK;
}

static inline dea_status emulator_samples(void *user, const double *volts, size_t count)
{
  struct emulator_sink *sink = user;
  size_t n = sink->channels;
  sink->volts = realloc(sink->volts, (sink->samples + count) * n * sizeof *volts);
  memcpy(sink->volts + sink->samples * n, volts, count * n * sizeof *volts);
  sink->samples += count;
  return DEA_OK;
}

/* Gets for at most `seconds`, until the test finds what it wants; the first failure comes back. */
static inline dea_status emulator_get(struct dea_context *ctx, struct dea_instrument *instrument,
                                      struct emulator_sink *sink, size_t readings, size_t profiles,
                                      size_t samples)
{
  const struct dea_sink to = {sink, emulator_samples, emulator_profile, emulator_reading};
  // By time, not by calls: what comes byte by byte takes one for each.
  for (double until_s = dea_clock_s() + 8; dea_clock_s() < until_s;) {
    if (sink->readings >= readings && sink->profiles >= profiles && sink->samples >= samples) {
      return DEA_OK;
    }
    dea_status status = instrument->type->get(ctx, instrument, 0.02, &to);
    if (status != DEA_OK) {
      return status;
    }
  }
  return DEA_OK;
}

/* Sets its clock a while after its start, as where a DAQ takes that long to begin: nothing comes
 * with a later time than has passed since. */
static inline void emulator_check_clock(struct dea_context *ctx, struct dea_instrument *instrument,
                                        struct emulator_sink *sink)
{
  dea_clock_wait(0.3);
  double zero_s = instrument->start_s = dea_clock_s();
  sink->readings = 0;
  assert_int_equal(emulator_get(ctx, instrument, sink, 2, 0, 0), DEA_OK);
  assert_true(sink->readings >= 2);
  for (size_t i = 0; i < sink->readings && i < 256; i++) {
    assert_true(sink->reading[i].time_s >= 0);
    assert_true(sink->reading[i].time_s <= dea_clock_s() - zero_s);
  }
}
