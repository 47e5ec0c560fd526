/* Instrument "optoncdt": a laser triangulation sensor optoNCDT 1302 or 1402 by Micro-Epsilon, which
 * sends its values unasked on a serial line (RS-422), each as two bytes: the upper seven bits of a
 * number of 14 with the top bit of the byte set, then the lower seven without it.
 *
 *   distance = (1.02 n / 16368 - 0.01) range, from n = 161 to 16207; 16370 and more say why there
 * is none (nothing in view, too close, too far, ...).
 *
 * Times: values come at the sensor's own rate, in the pieces in which the adapter hands them over.
 * Each is one interval after the one before; where a piece comes earlier than that says, the clock
 * was late and is set, and where later, it follows by 200 ppm at most, which is more than two
 * crystals differ by. Where all of a second come later by more than that, values were lost on the
 * way: they are counted, and those behind them get the time at which they came. An average over N
 * values lags by (N - 1) / 2 of them, which is taken off. Source: Micro-Epsilon, optoNCDT 1402
 * instruction manual. */
#include "base/clock.h"
#include "base/schema_value.h"
#include "instrument/instrument_make.h"
#include "instrument/serial.h"

#include <math.h>

enum { LEAST = 161, MOST = 16207 };
static const double drift = 2e-4;
static const double window_s = 1, jump_s = 5e-3;

struct raw {
  struct dea_label kind, device, name;
  struct dea_quantity baud, rate_Hz, range_m, average, factor, offset_m, timeout_s;
};

struct optoncdt {
  struct dea_instrument base;
  struct raw raw;
  struct dea_socket line;
  int upper;              // byte that waits for its lower one; -1: none
  double heard_s;         // computer's clock
  double last_s;          // time of the last value; NAN: none
  double late_s, until_s; // least that a value of this window came behind its time; its end
};

static const struct dea_field fields[] = {
    DEA_INSTRUMENT_KIND(struct raw, "optoncdt"),
    DEA_INSTRUMENT_LABEL(struct raw, device, "device", "its serial line", "/dev/ttyUSB0",
                         .required = true),
    DEA_INSTRUMENT_NUMBER(struct raw, baud, "baud", "bits a second", 1200, 921600, "115200",
                          .default_text = "115200"),
    DEA_INSTRUMENT_LABEL(struct raw, name, "name", "name of its channel", "laser",
                         .default_text = "laser"),
    DEA_NUMBER_ROW("range", offsetof(struct raw, range_m), "m", "10 mm",
                   "measuring range, as on its label", .required = true, .above_min = true,
                   .max = 10),
    DEA_NUMBER_ROW("rate", offsetof(struct raw, rate_Hz), "Hz", "1500 Hz", "of its measurements",
                   .above_min = true, .max = 1e5, .default_text = "1500 Hz"),
    DEA_INSTRUMENT_NUMBER(struct raw, average, "average",
                          "how many values it averages over; its lag is taken off the times", 1,
                          128, "1", .default_text = "1"),
    DEA_NUMBER_ROW("factor", offsetof(struct raw, factor), "1", "-1",
                   "1 where the film moves away from the sensor, -1 towards it",
                   .default_text = "1"),
    DEA_NUMBER_ROW("offset", offsetof(struct raw, offset_m), "m", "0 mm", "added to it afterwards",
                   .default_text = "0 mm"),
    DEA_INSTRUMENT_TIME(struct raw, timeout_s, "timeout", "longest silence", "2 s", 60),
};
const struct dea_record dea_instrument_optoncdt_record = {
    "optoncdt", "a laser sensor optoNCDT 1302 or 1402 on a serial line", fields,
    DEA_INSTRUMENT_COUNT(fields)};

static dea_status check(const struct dea_reader *reader, const void *data,
                        const struct dea_protocol *protocol)
{
  const struct raw *raw = data;
  const struct dea_instrument sketch = {0};
  return dea_instrument_check_reading(reader, protocol, &raw->name, &sketch);
}

/* Of one that came at arrived_s. */
static double time_of(struct optoncdt *o, double arrived_s)
{
  double interval_s = 1 / o->raw.rate_Hz.si, time_s = o->last_s + interval_s;
  if (isnan(o->last_s) || arrived_s < time_s) {
    time_s = isnan(o->last_s) ? arrived_s : fmax(arrived_s, o->last_s + 1e-3 * interval_s);
    o->until_s = isnan(o->last_s) ? arrived_s : o->until_s;
  } else {
    time_s += fmin(arrived_s - time_s, drift * interval_s);
  }
  o->late_s = fmin(o->late_s, arrived_s - time_s);
  if (arrived_s < o->until_s) {
    return time_s;
  }
  if (o->late_s > fmax(jump_s, 2 * interval_s) && isfinite(o->late_s)) {
    o->base.lost += (size_t)(o->late_s / interval_s);
    time_s += o->late_s;
  }
  o->late_s = INFINITY;
  o->until_s = arrived_s + window_s;
  return time_s;
}

/* A value that came at arrived_s; NAN where it says why there is none. */
static dea_status add_value(struct optoncdt *o, int number, double arrived_s,
                            const struct dea_sink *sink)
{
  double interval_s = 1 / o->raw.rate_Hz.si, value = NAN;
  double time_s = time_of(o, arrived_s);
  o->last_s = time_s;
  if (number >= LEAST && number <= MOST) {
    double distance_m = (1.02 * number / 16368 - 0.01) * o->raw.range_m.si;
    value = o->raw.factor.si * distance_m + o->raw.offset_m.si;
  }
  time_s -= 0.5 * (o->raw.average.si - 1) * interval_s + o->base.start_s;
  return sink != NULL && time_s >= 0 ? sink->reading(sink->user, 0, time_s, value) : DEA_OK;
}

/* The bytes of a piece, the last of which came at now_s. */
static dea_status read_bytes(struct optoncdt *o, const unsigned char *bytes, size_t length,
                             double now_s, const struct dea_sink *sink)
{
  for (size_t i = 0; i < length; i++) {
    if ((bytes[i] & 0x80U) != 0) {
      o->base.lost += o->upper >= 0 ? 1 : 0;
      o->upper = bytes[i] & 0x7F;
    } else if (o->upper < 0) {
      o->base.lost++; // its upper byte was lost
    } else {
      int number = (o->upper << 7) | bytes[i];
      double behind_s = 0.5 * (double)(length - 1 - i) / o->raw.rate_Hz.si;
      o->upper = -1;
      DEA_TRY_STATUS(add_value(o, number, now_s - behind_s, sink));
    }
  }
  return DEA_OK;
}

/* Takes what comes within a time; *came: whether something did. */
static dea_status listen_for(struct dea_context *ctx, struct optoncdt *o, double timeout_s,
                             const struct dea_sink *sink, bool *came)
{
  unsigned char bytes[4096];
  size_t length;
  DEA_TRY(ctx, dea_socket_read(ctx, &o->line, timeout_s, bytes, sizeof bytes, &length));
  double now_s = dea_clock_s();
  *came = length > 0;
  if (*came) {
    o->heard_s = now_s;
    return read_bytes(o, bytes, length, now_s, sink);
  }
  return now_s - o->heard_s <= o->raw.timeout_s.si
             ? DEA_OK
             : dea_fail(ctx, DEA_E_INSTRUMENT,
                        "nothing came from %s for %g s; look at its laser, its cable, its baud, "
                        "and whether its output is digital and binary",
                        o->line.name, o->raw.timeout_s.si);
}

static void close_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct optoncdt *o = (struct optoncdt *)instrument;
  dea_socket_close(&o->line);
  dea_free(ctx, o);
}

/* Until a value has come: one of another rate, speed or format would make none of these. */
static dea_status find_out(struct dea_context *ctx, struct optoncdt *o)
{
  bool came;
  o->heard_s = dea_clock_s();
  for (double until_s = o->heard_s + o->raw.timeout_s.si; isnan(o->last_s);) {
    DEA_TRY(ctx, listen_for(ctx, o, 0.1, NULL, &came));
    if (dea_interrupted(ctx)) {
      return dea_fail(ctx, DEA_E_INTERRUPTED, "interrupted");
    }
    if (dea_clock_s() > until_s && isnan(o->last_s)) {
      return dea_fail(ctx, DEA_E_INSTRUMENT,
                      "what %s sends is no measurement; look at its baud, and whether its output "
                      "is digital and binary",
                      o->line.name);
    }
  }
  o->base.lost = 0; // the first byte may have been half a value
  return DEA_OK;
}

static dea_status open_it(struct dea_context *ctx, struct dea_instrument *instrument,
                          const void *raw, const struct dea_protocol *protocol)
{
  struct optoncdt *o = (struct optoncdt *)instrument;
  (void)protocol;
  o->raw = *(const struct raw *)raw;
  o->upper = -1;
  o->last_s = NAN;
  o->late_s = INFINITY;
  dea_instrument_add_displacement(&o->base, &o->raw.name);
  DEA_TRY(ctx, dea_serial_open(ctx, "the optoNCDT", o->raw.device.text, (int)o->raw.baud.si, 0,
                               &o->line));
  return find_out(ctx, o);
}

/* What came before the start is no part of the recording. */
static dea_status start_it(struct dea_context *ctx, struct dea_instrument *instrument)
{
  struct optoncdt *o = (struct optoncdt *)instrument;
  bool came = true;
  while (came) {
    DEA_TRY(ctx, listen_for(ctx, o, 0, NULL, &came));
  }
  o->base.start_s = o->heard_s = dea_clock_s();
  o->last_s = NAN; // while nobody listened some may have been lost
  return DEA_OK;
}

static dea_status get(struct dea_context *ctx, struct dea_instrument *instrument, double timeout_s,
                      const struct dea_sink *sink)
{
  bool came;
  return listen_for(ctx, (struct optoncdt *)instrument, timeout_s, sink, &came);
}

const struct dea_instrument_type dea_instrument_optoncdt = {
    .name = "optoncdt",
    .record = &dea_instrument_optoncdt_record,
    .raw_size = sizeof(struct raw),
    .size = sizeof(struct optoncdt),
    .roles = DEA_GIVES_READINGS,
    .check = check,
    .open = open_it,
    .start = start_it,
    .get = get,
    .close = close_it,
};
