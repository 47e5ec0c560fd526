/* Instrument "gocator": a line profile sensor of LMI Technologies, by its data stream of profiles
 * and measurements. See gocator_parse.h for what is sent. */
#include "base/clock.h"
#include "base/schema_value.h"
#include "instrument/gocator_frames.h"
#include "instrument/instrument_make.h"
#include "instrument/socket.h"

enum { PROFILES, MEASUREMENTS };
static const char *const modes[] = {"profiles", "measurements", NULL};
static const char *const yes_no[] = {"no", "yes", NULL};

enum {
  STATUS_GOOD = 1,
  STATUS_WRONG_STATE = -1000,
  RECEIVE_SIZE = 16384,
  DRAIN_MOST = 2000, // reads before the start; more come than can be thrown away
};

struct raw_measurement {
  struct dea_label name, unit;
  struct dea_choice quantity;
  struct dea_quantity id, factor;
};

struct raw {
  struct dea_label kind, address;
  struct dea_choice mode, start;
  struct dea_quantity port, control_port, timeout_s;
  struct raw_measurement measurements[DEA_INSTRUMENT_READINGS_MAX];
  size_t measurement_count;
};

static const struct dea_field measurement_fields[] = {
    DEA_INSTRUMENT_LABEL(struct raw_measurement, name, "name", "name of its channel", "centre",
                         .required = true),
    DEA_INSTRUMENT_NUMBER(struct raw_measurement, id, "id", "its number in the sensor's web page",
                          0, 65535, "0", .required = true),
    DEA_CHOICE_ROW("quantity", offsetof(struct raw_measurement, quantity), dea_channel_names,
                   "displacement", "what it is", .default_text = "displacement"),
    DEA_NUMBER_ROW(
        "factor", offsetof(struct raw_measurement, factor), "1", "1e-6",
        "SI value of 1 of what is sent, which is thousandths of mm; -1e-6 turns it round",
        .default_text = "1e-6"),
    DEA_INSTRUMENT_LABEL(struct raw_measurement, unit, "unit", "SI unit of an 'other' quantity",
                         "m^2", .absent_text = "none"),
};
static const struct dea_record measurement_record = {
    "measurement", "a number that the sensor forms", measurement_fields,
    DEA_INSTRUMENT_COUNT(measurement_fields)};

static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct raw, "gocator"),
    DEA_INSTRUMENT_LABEL(struct raw, address, "address", "its name or address in the network",
                         "192.168.1.10", .default_text = "192.168.1.10"),
    DEA_INSTRUMENT_CHOICE(struct raw, mode, "mode",
                          "what it sends (set in its web page under Output): profiles and "
                          "measurements, or measurements",
                          modes, "profiles"),
    DEA_INSTRUMENT_PORT(struct raw, port, "port", "TCP port of the data", .default_text = "3196"),
    DEA_INSTRUMENT_PORT(struct raw, control_port, "control_port", "TCP port of commands",
                        .default_text = "3190"),
    DEA_INSTRUMENT_CHOICE(struct raw, start, "start",
                          "start the sensor, and stop it at the end; no: it runs already", yes_no,
                          "yes"),
    DEA_INSTRUMENT_TIME(struct raw, timeout_s, "timeout", "longest silence", "2 s", 3600),
    {.key = "measurements",
     .kind = DEA_FIELD_RECORD,
     .record = &measurement_record,
     DEA_INSTRUMENT_LIST_OF(struct raw, measurements, measurement_count,
                            DEA_INSTRUMENT_READINGS_MAX),
     .doc = "those that become channels",
     .example = "[{name: centre, id: 0}]"},
};
const struct dea_record dea_instrument_gocator_record = {
    "gocator", "a line profile sensor of LMI Technologies", fields, DEA_INSTRUMENT_COUNT(fields)};

struct gocator {
  struct dea_instrument base;
  struct raw raw;
  struct dea_socket data, control;
  struct dea_gocator_frames frames;
  double heard_s;                              // when the last sense was heard
  double value_s[DEA_INSTRUMENT_READINGS_MAX]; // time of the last value of each
  bool started;                                // by us
  bool noted_odd, noted_grid;
  struct dea_gdp stream;
};

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  struct dea_instrument sketch = {0};
  if (raw->mode.value != PROFILES && raw->measurement_count == 0) {
    return dea_schema_error(reader, raw->mode.location,
                            "without profiles it needs its 'measurements', for example "
                            "'measurements: [{name: centre, id: 0}]'");
  }
  for (size_t i = 0; i < raw->measurement_count; i++) {
    const struct raw_measurement *m = &raw->measurements[i];
    DEA_TRY(reader->ctx, dea_instrument_check_reading(reader, protocol, &m->name, &sketch));
    dea_instrument_add_reading(&sketch, &m->name, &m->quantity, &m->unit);
    for (size_t k = 0; k < i; k++) {
      if (raw->measurements[k].id.si == m->id.si) {
        DEA_TRY(reader->ctx, dea_schema_error(reader, m->id.location,
                                              "measurement %.0f is read into '%.60s' already",
                                              m->id.si, raw->measurements[k].name.text));
      }
    }
  }
  return DEA_OK;
}

/* Sends Start by the control connection and reads how it went. */
static dea_status start_sensor(struct dea_context *ctx, struct gocator *g)
{
  unsigned char command[DEA_GOCATOR_COMMAND_SIZE], reply[1024];
  size_t length = 0, more;
  int32_t status;
  DEA_TRY(ctx, dea_socket_connect(ctx, "the Gocator's control", g->raw.address.text,
                                  (int)g->raw.control_port.si, g->raw.timeout_s.si, &g->control));
  dea_gocator_command(DEA_GOCATOR_START, command);
  DEA_TRY(ctx, dea_socket_write(ctx, &g->control, g->raw.timeout_s.si, command, sizeof command));
  double until_s = dea_clock_s() + g->raw.timeout_s.si;
  while (!dea_gocator_reply(reply, length, DEA_GOCATOR_START, &status)) {
    double left_s = until_s - dea_clock_s();
    if (left_s <= 0 || length == sizeof reply) {
      return dea_fail(ctx, DEA_E_INSTRUMENT,
                      "%s does not answer the command to start; start the sensor in its web page "
                      "and write 'start: no'",
                      g->control.name);
    }
    DEA_TRY(ctx, dea_socket_read(ctx, &g->control, left_s, reply + length, sizeof reply - length,
                                 &more));
    length += more;
  }
  if (status == STATUS_WRONG_STATE) {
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "%s runs already, and is left running at the end", g->data.name);
  }
  if (status != STATUS_GOOD) {
    return dea_fail(ctx, DEA_E_INSTRUMENT,
                    "%s does not start: status %d; its web page says what is wrong",
                    g->control.name, (int)status);
  }
  g->started = true;
  return DEA_OK;
}

static dea_status silent(struct dea_context *ctx, const struct gocator *g)
{
  static const char *const what[] = {"profile", "measurement"};
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "no %s came from %s for %g s; look at its laser and its trigger, and at what its "
                  "web page sends under Output",
                  what[g->raw.mode.value], g->data.name, g->raw.timeout_s.si);
}

/* A value of a measurement, if it is one that is wanted; NAN counts as lost. */
static dea_status read_value(struct gocator *g, long id, double thousandths, double clock_s,
                             const struct dea_sink *sink)
{
  for (size_t i = 0; i < g->raw.measurement_count; i++) {
    const struct raw_measurement *m = &g->raw.measurements[i];
    if ((long)m->id.si == id) {
      double time_s = clock_s - g->base.start_s;
      if (sink == NULL || !(time_s >= 0)) {
        return DEA_OK;
      }
      if (time_s <= g->value_s[i]) {
        g->base.lost++;
        return DEA_OK;
      }
      g->value_s[i] = time_s;
      g->heard_s = dea_clock_s();
      g->frames.anchored = true;
      g->base.lost += isnan(thousandths) ? 1 : 0;
      return sink->reading(sink->user, i, time_s, thousandths * m->factor.si);
    }
  }
  return DEA_OK;
}

/* The group's profiles: the first one makes the grid, those after the start are handed over. */
static dea_status read_profiles(struct dea_context *ctx, struct gocator *g, double arrived_s,
                                const struct dea_sink *sink)
{
  const struct dea_gdp_profiles *p = &g->stream.profiles;
  if (g->raw.mode.value != PROFILES) {
    return DEA_OK;
  }
  if (g->frames.points == 0) {
    bool begun;
    DEA_TRY(ctx, dea_gocator_frames_begin(ctx, &g->frames, p, &begun));
  }
  if (g->frames.points == 0 || p->source != g->frames.source) {
    return DEA_OK;
  }
  size_t count = p->count == g->stream.stamp_count ? p->count : 1;
  for (size_t k = 0; k < count && sink != NULL; k++) {
    const struct dea_gdp_stamp *stamp = g->stream.stamp_count > 0 ? &g->stream.stamps[k] : NULL;
    double time_s;
    if (stamp != NULL) {
      dea_gocator_frames_add(&g->frames, stamp, arrived_s);
    }
    if (dea_gocator_frames_time(&g->frames, stamp, arrived_s, g->base.start_s, &time_s,
                                &g->base.lost)) {
      g->heard_s = arrived_s; // what has no time that can be is none
      dea_gocator_frames_place(&g->frames, p, k);
      DEA_TRY(ctx, sink->profile(sink->user, time_s, g->frames.z_m));
    }
  }
  if (g->frames.other_grid && !g->noted_grid) {
    g->noted_grid = true;
    return dea_finding_add(ctx, DEA_NOTE, (struct dea_location){0},
                           "%s changed its positions; frames were interpolated onto the first ones",
                           g->data.name);
  }
  return DEA_OK;
}

/* Time of the group on the computer's clock. */
static double group_clock_s(const struct gocator *g, double arrived_s)
{
  return g->stream.stamp_count > 0 ? 1e-6 * (double)g->stream.stamps[0].time_us + g->frames.offset_s
                                   : arrived_s;
}

/* sink NULL: before the start, nothing is handed over. */
static dea_status read_data(struct dea_context *ctx, struct gocator *g, const unsigned char *bytes,
                            size_t length, const struct dea_sink *sink)
{
  double arrived_s = dea_clock_s();
  for (;;) {
    const struct dea_gdp_measurement *m = &g->stream.measurement;
    switch (dea_gdp_next(&g->stream, &bytes, &length)) {
    case DEA_GDP_MORE:
      return DEA_OK;
    case DEA_GDP_STAMPS:
      dea_gocator_frames_add(&g->frames, &g->stream.stamps[0], arrived_s);
      break;
    case DEA_GDP_PROFILES:
      DEA_TRY(ctx, read_profiles(ctx, g, arrived_s, sink));
      break;
    case DEA_GDP_MEASUREMENT:
      DEA_TRY(ctx, read_value(g, (long)m->id, m->valid ? (double)m->thousandths : (double)NAN,
                              group_clock_s(g, arrived_s), sink));
      break;
    case DEA_GDP_ODD:
      g->base.lost += sink != NULL;
      if (!g->noted_odd) {
        g->noted_odd = true;
        DEA_TRY(ctx, dea_finding_add(ctx, DEA_WARNING, (struct dea_location){0},
                                     "%s sent a message that contradicts itself; it is left out",
                                     g->data.name));
      }
      break;
    case DEA_GDP_BROKEN:
      return dea_fail(ctx, DEA_E_INSTRUMENT,
                      "what %s sends is not a Gocator's data; look at the port, and at 'Protocol: "
                      "Gocator' in its web page under Output",
                      g->data.name);
    }
  }
}

/* Reads what is there once, waiting up to timeout_s. */
static dea_status receive(struct dea_context *ctx, struct gocator *g, double timeout_s,
                          const struct dea_sink *sink, size_t *length)
{
  unsigned char bytes[RECEIVE_SIZE];
  DEA_TRY(ctx, dea_socket_read(ctx, &g->data, timeout_s, bytes, sizeof bytes, length));
  return read_data(ctx, g, bytes, *length, sink);
}

static struct dea_zero stop(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct gocator *g = (struct gocator *)instrument;
  unsigned char command[DEA_GOCATOR_COMMAND_SIZE];
  (void)ctx;
  if (g->started) {
    dea_gocator_command(DEA_GOCATOR_STOP, command);
    dea_socket_write_if_possible(&g->control, command, sizeof command);
  }
  return (struct dea_zero){DEA_ZERO_NONE, NAN, NULL};
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct gocator *g = (struct gocator *)instrument;
  dea_socket_close(&g->data);
  dea_socket_close(&g->control);
  dea_gocator_frames_free(ctx, &g->frames);
  dea_free(ctx, g);
}

static dea_status set_up(struct dea_context *ctx, struct gocator *g)
{
  DEA_TRY(ctx, dea_socket_connect(ctx, "the Gocator", g->raw.address.text, (int)g->raw.port.si,
                                  g->raw.timeout_s.si, &g->data));
  DEA_TRY(ctx, g->raw.start.value == 1 ? start_sensor(ctx, g) : DEA_OK);
  double until_s = dea_clock_s() + g->raw.timeout_s.si;
  while (g->raw.mode.value == PROFILES && g->frames.points == 0) {
    size_t length;
    double left_s = until_s - dea_clock_s();
    if (left_s <= 0) {
      return silent(ctx, g);
    }
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
    DEA_TRY(ctx, receive(ctx, g, left_s, NULL, &length));
  }
  g->base.profile_points = g->frames.points;
  g->base.x_m = g->frames.x_m;
  return DEA_OK;
}

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *raw, const struct dea_protocol *protocol)
{
  (void)protocol;
  struct gocator *g = (struct gocator *)instrument;
  g->raw = *(const struct raw *)raw;
  g->base.reached = true;
  g->base.roles = (g->raw.mode.value == PROFILES ? DEA_SENDS_PROFILES : 0U) |
                  (g->raw.measurement_count > 0 ? DEA_GIVES_READINGS : 0U);
  g->base.start_s = NAN;
  g->frames.offset_s = INFINITY;
  g->data.descriptor = g->control.descriptor = -1;
  for (size_t i = 0; i < g->raw.measurement_count; i++) {
    const struct raw_measurement *m = &g->raw.measurements[i];
    dea_instrument_add_reading(&g->base, &m->name, &m->quantity, &m->unit);
  }
  return set_up(ctx, g);
}

static dea_status start_gocator(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct gocator *g = (struct gocator *)instrument;
  size_t length = 1;
  for (int i = 0; i < DRAIN_MOST && length > 0; i++) { // what waits is from before
    DEA_TRY(ctx, receive(ctx, g, 0, NULL, &length));
  }
  g->base.start_s = g->heard_s = dea_clock_s();
  for (size_t i = 0; i < DEA_INSTRUMENT_READINGS_MAX; i++) {
    g->value_s[i] = -INFINITY;
  }
  return DEA_OK;
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct gocator *g = (struct gocator *)instrument;
  double until_s = dea_clock_s() + timeout_s, left_s = timeout_s;
  size_t length;
  do {
    double wait_s = fmin(left_s, g->heard_s + g->raw.timeout_s.si - dea_clock_s());
    DEA_TRY(ctx, receive(ctx, g, wait_s, sink, &length));
    if (dea_clock_s() - g->heard_s > g->raw.timeout_s.si) {
      return silent(ctx, g);
    }
    left_s = until_s - dea_clock_s();
  } while (length == 0 && left_s > 0);
  return DEA_OK;
}

const struct dea_instrument_type dea_instrument_gocator = {
    .name = "gocator",
    .record = &dea_instrument_gocator_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct gocator),
    .roles = DEA_SENDS_PROFILES | DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start_gocator,
    .get = get,
    .stop = stop,
    .close = close_it,
};
