/* Instrument "keyence": a laser displacement sensor of the series LK-G or LK-H by Keyence, on the
 * serial line of its controller. Each reading is asked for by "MS,nn" and answered by
 * "MS,nn,value"; values have eight characters, "+0001.234" of them fewer digits, "+FFFFFFF" beyond
 * the range and "XXXXXXXX" not measurable. Errors are "ER,MS,code". Source: Keyence, LK-G user's
 * manual, chapter 5.
 *
 * A discharge on the way garbles a question or its answer: a question that is not answered, or with
 * an error, is a lost value, and only the third in a row ends the measurement. */
#include "base/clock.h"
#include "base/schema_value.h"
#include "base/text.h"
#include "instrument/instrument_make.h"
#include "instrument/line_link.h"
#include "instrument/poll_schedule.h"
#include "instrument/serial.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OUTPUTS_MAX = 12, COMMAND_SIZE = 16, FAILED_MAX = 3 };
/* Longest time that the controller takes to leave its mode for settings. */
static const double mode_change_s = 5;

struct raw_reading {
  struct dea_label name;
  struct dea_quantity output, factor, offset;
};

struct raw {
  struct dea_label kind, device;
  struct dea_quantity baud, timeout_s, interval_s;
  struct dea_choice parity;
  struct raw_reading readings[DEA_INSTRUMENT_READINGS_MAX];
  size_t reading_count;
};

struct keyence {
  struct dea_instrument base;
  struct raw raw;
  struct dea_line_link link;
  struct dea_poll_schedule schedule;
  bool waits; // for an answer
  int failed; // questions in a row without a value or what stands for none
};

static const struct dea_field reading_fields[] = {
    DEA_INSTRUMENT_LABEL(struct raw_reading, name, "name", "name of its channel", "laser",
                         .required = true),
    DEA_INSTRUMENT_NUMBER(struct raw_reading, output, "output", "OUT of the controller", 1,
                          OUTPUTS_MAX, "1", .default_text = "1"),
    DEA_NUMBER_ROW("factor", offsetof(struct raw_reading, factor), "1", "-1e-3",
                   "displacement in m of 1 on its display, negative where it counts towards the "
                   "film; 1e-3 for a display in mm",
                   .default_text = "1e-3"),
    DEA_NUMBER_ROW("offset", offsetof(struct raw_reading, offset), "m", "0 mm",
                   "added to it afterwards", .default_text = "0 mm"),
};
static const struct dea_record reading_record = {
    "reading", "an output of the controller", reading_fields, DEA_INSTRUMENT_COUNT(reading_fields)};

static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct raw, "keyence"),
    DEA_INSTRUMENT_LABEL(struct raw, device, "device", "its serial line", "/dev/ttyUSB0",
                         .required = true),
    DEA_INSTRUMENT_NUMBER(struct raw, baud, "baud", "bits a second, as set at the controller", 1200,
                          921600, "9600", .default_text = "9600"),
    DEA_INSTRUMENT_CHOICE(struct raw, parity, "parity", "as set at the controller",
                          dea_serial_parities, "none"),
    DEA_INSTRUMENT_TIME(struct raw, timeout_s, "timeout", "longest wait for an answer", "1 s", 60),
    DEA_INSTRUMENT_TIME(struct raw, interval_s, "interval", "between two rounds of readings",
                        "20 ms", 3600),
    {.key = "readings",
     .kind = DEA_FIELD_RECORD,
     .record = &reading_record,
     DEA_INSTRUMENT_LIST_OF(struct raw, readings, reading_count, DEA_INSTRUMENT_READINGS_MAX),
     .list_min = 1,
     .required = true,
     .doc = "what it is asked for",
     .example = "[{name: laser, output: 1}]"},
};
const struct dea_record dea_instrument_keyence_record = {
    "keyence", "a laser sensor of the series LK-G or LK-H on a serial line", fields,
    DEA_INSTRUMENT_COUNT(fields)};

static void add_readings(struct dea_instrument *instrument, const struct raw *raw, size_t count)
{
  for (size_t i = instrument->reading_count; i < count; i++) {
    dea_instrument_add_displacement(instrument, &raw->readings[i].name);
  }
}

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  struct dea_instrument sketch = {0};
  for (size_t i = 0; i < raw->reading_count; i++) {
    DEA_TRY(reader->ctx,
            dea_instrument_check_reading(reader, protocol, &raw->readings[i].name, &sketch));
    add_readings(&sketch, raw, i + 1);
  }
  return DEA_OK;
}

static dea_status send_command(struct dea_context *ctx, const struct keyence *k,
                               const char *command)
{
  char line[COMMAND_SIZE + 1];
  int length = snprintf(line, sizeof line, "%.*s\r", COMMAND_SIZE - 1, command);
  return dea_socket_write(ctx, &k->link.socket, k->raw.timeout_s.si, line, (size_t)length);
}

/* Asks for a reading. */
static dea_status query(struct dea_context *ctx, struct keyence *k, size_t reading)
{
  char command[COMMAND_SIZE];
  snprintf(command, sizeof command, "MS,%02d", (int)k->raw.readings[reading].output.si);
  k->waits = true;
  return send_command(ctx, k, command);
}

/* The output that an answer is of, and where its value begins; -1: it is no answer to MS,nn. */
static long output_of(const char *answer, const char **value)
{
  char *comma = NULL;
  *value = NULL;
  long output = strncmp(answer, "MS,", 3) == 0 ? strtol(answer + 3, &comma, 10) : -1;
  if (output < 0 || comma == answer + 3 || *comma != ',') {
    return -1;
  }
  *value = comma + 1;
  return output;
}

/* The value of an answer to MS,nn; NAN: it says that there is none. False: it is no such answer. */
static bool value_of(const char *answer, int output, double *value)
{
  const char *end, *at;
  if (output_of(answer, &at) != output || at == NULL) {
    return false;
  }
  *value = NAN;
  if (strspn(at, "X") == strlen(at) || strspn(at, "+-F") == strlen(at)) {
    return *at != '\0';
  }
  if (at[strspn(at, "+-0123456789. ")] != '\0') { // it may be more than a number
    return false;
  }
  *value = dea_text_to_double(at, &end);
  return end != at && *end == '\0' && isfinite(*value);
}

static dea_status refused(struct dea_context *ctx, const struct keyence *k, const char *answer)
{
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s answered '%.40s' to a question for OUT %d; look at which outputs its "
                  "controller has",
                  k->link.socket.name, answer, (int)k->raw.readings[k->schedule.reading].output.si);
}

/* Asks for all readings once; in its mode for settings it measures nothing, and is led out of it.
 */
static dea_status find_out(struct dea_context *ctx, struct keyence *k)
{
  bool led = false;
  for (size_t i = 0; i < k->raw.reading_count;) {
    const char *answer;
    double value;
    k->schedule.reading = i;
    DEA_TRY(ctx, query(ctx, k, i));
    DEA_TRY(ctx, dea_line_wait(ctx, &k->link, k->raw.timeout_s.si, &answer));
    if (answer == NULL) {
      return dea_fail(ctx, DEA_E_INSTRUMENT,
                      "%s does not answer; look at its power, its cable, and whether baud and "
                      "parity are those of its controller",
                      k->link.socket.name);
    }
    if (value_of(answer, (int)k->raw.readings[i].output.si, &value)) {
      i++;
    } else if (strncmp(answer, "ER,", 3) == 0 && !led) {
      led = true;
      DEA_TRY(ctx, send_command(ctx, k, "R0"));
      DEA_TRY(ctx, dea_line_wait(ctx, &k->link, mode_change_s, &answer));
    } else {
      return refused(ctx, k, answer);
    }
  }
  k->waits = false;
  return DEA_OK;
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct keyence *k = (struct keyence *)instrument;
  dea_socket_close(&k->link.socket);
  dea_free(ctx, k);
}

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *raw, const struct dea_protocol *protocol)
{
  struct keyence *k = (struct keyence *)instrument;
  (void)protocol;
  k->raw = *(const struct raw *)raw;
  add_readings(&k->base, &k->raw, k->raw.reading_count);
  k->schedule = (struct dea_poll_schedule){.count = k->raw.reading_count,
                                           .interval_s = k->raw.interval_s.si,
                                           .timeout_s = k->raw.timeout_s.si};
  DEA_TRY(ctx, dea_serial_open(ctx, "the Keyence LK", k->raw.device.text, (int)k->raw.baud.si,
                               k->raw.parity.value, &k->link.socket));
  return find_out(ctx, k);
}

static dea_status start_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct keyence *k = (struct keyence *)instrument;
  (void)ctx;
  k->base.start_s = dea_clock_s();
  dea_poll_schedule_start(&k->schedule, k->base.start_s);
  return DEA_OK;
}

/* The question gave no value. */
static dea_status lose(struct keyence *k, const struct dea_sink *sink)
{
  k->waits = false;
  k->base.lost++;
  return sink->reading(sink->user, k->schedule.reading, dea_clock_s() - k->base.start_s, NAN);
}

/* An answer; one that makes no sense is a lost value. */
static dea_status parse_answer(struct dea_context *ctx, struct keyence *k, const char *answer,
                               const struct dea_sink *sink)
{
  const struct raw_reading *r = &k->raw.readings[k->schedule.reading];
  const char *at;
  double value, now_s = dea_clock_s();
  long output = output_of(answer, &at);
  if (!k->waits || (output >= 0 && output != (long)r->output.si)) { // late, of an earlier question
    k->base.lost++;
    return DEA_OK;
  }
  if (strncmp(answer, "ER,", 3) == 0) {
    return ++k->failed < FAILED_MAX ? lose(k, sink) : refused(ctx, k, answer);
  }
  if (!value_of(answer, (int)r->output.si, &value)) {
    return lose(k, sink);
  }
  k->waits = false;
  k->failed = 0;
  return sink->reading(sink->user, k->schedule.reading,
                       0.5 * (k->schedule.asked_s + now_s) - k->base.start_s,
                       value * r->factor.si + r->offset.si);
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  struct keyence *k = (struct keyence *)instrument;
  double until_s = dea_clock_s() + timeout_s;
  bool came = false;
  do {
    char bytes[1024];
    const char *at = bytes, *answer;
    size_t length, dropped = k->link.lines.dropped;
    double now_s = dea_clock_s(), next_s = k->schedule.asked_s + k->schedule.timeout_s;
    if (k->waits && now_s > next_s) {
      if (++k->failed >= FAILED_MAX) {
        return dea_fail(ctx, DEA_E_INSTRUMENT,
                        "%s did not answer %d questions in a row within %g s each",
                        k->link.socket.name, FAILED_MAX, k->schedule.timeout_s);
      }
      DEA_TRY(ctx, lose(k, sink));
    }
    if (!k->waits && dea_poll_schedule_next(&k->schedule, now_s, &next_s)) {
      DEA_TRY(ctx, query(ctx, k, k->schedule.reading));
    }
    DEA_TRY(ctx, dea_socket_read(ctx, &k->link.socket, fmin(until_s, next_s) - dea_clock_s(), bytes,
                                 sizeof bytes, &length));
    while ((answer = dea_line_next(&k->link.lines, &at, &length)) != NULL) {
      came = true;
      DEA_TRY(ctx, parse_answer(ctx, k, answer, sink));
    }
    if (k->link.lines.dropped > dropped) {
      DEA_TRY(ctx, parse_answer(ctx, k, "", sink)); // what came makes no sense
    }
  } while (!came && dea_clock_s() < until_s);
  return DEA_OK;
}

const struct dea_instrument_type dea_instrument_keyence = {
    .name = "keyence",
    .record = &dea_instrument_keyence_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct keyence),
    .roles = DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start_it,
    .get = get,
    .close = close_it,
};
