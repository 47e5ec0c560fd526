/* Plays a protocol. Whatever happens, the loop goes on until the output has come to 0 V: a fault
 * only changes what is asked from the sequence to the ramp. What cannot be played any more, because
 * the playing instrument has failed, is stopped at once. */
#include "drive/drive_loop.h"

#include "base/clock.h"
#include "drive/drive_output.h"
#include "drive/drive_watch.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

// of the output: how much is given at a time, and how far at most it is ahead of the inputs, which
// is what a fault has to wait for before the ramp begins
static const double block_s = 0.05, ahead_s = 0.3;
static const double wait_s = 0.05;         // for what arrives
static const double last_frame_wait_s = 1; // for the profile that ends the last cycle
static const double monitor_s = 0.02;      // mean of a voltage channel that shows 0 V
// of what waits to be written: so much of all samples, and numbers beside them
static const double queue_s = 2;
static const size_t queue_least = 1 << 19;
enum { events_told_most = 50 };
static const double silent_warn_s = 10, silent_most_s = 60; // that a watched reading may be
static const double rounding = 1e-6;                        // of a sample's distance to the next

struct loop;
/* Who gives what arrives. */
struct source {
  struct loop *loop;
  struct dea_instrument *instrument;
  size_t first_channel; // of its readings
  double last_s[DEA_CHANNELS_MAX];
  double value_s[DEA_CHANNELS_MAX]; // when a reading had a value last, by the computer's clock
  bool silent[DEA_CHANNELS_MAX];    // that it has none was said
  double heard_s;                   // when samples or frames came last, by the computer's clock
  bool failed;
};

/* What is measured once all was played: samples that are not recorded. */
struct drive_monitor {
  size_t settle, window; // samples that are waited for, and of a mean
  size_t seen;           // behind the end
  double sum[DEA_PROTOCOL_INPUTS_MAX];
  size_t count[DEA_PROTOCOL_INPUTS_MAX];
  bool zero;
  bool flows;   // a current that explained what a voltage channel showed flows also at 0 V
  double volts; // mean of the last window, of the channel farthest from 0; NAN: none yet
};

struct loop {
  struct dea_context *ctx;
  const struct dea_protocol *protocol;
  struct source sources[DEA_PROTOCOL_INSTRUMENTS_MAX + 1];
  size_t count;
  struct source *player, *reader, *sensor; // of sources; NULL: none
  struct dea_context *own;                 // of the recorder, which the writer's thread has
  struct dea_writer *writer;
  struct dea_drive_output output;
  struct dea_drive_watch watch;
  size_t at_end[DEA_PROTOCOL_INPUTS_MAX]; // samples at the end of an input's range
  size_t put, got, recorded; // samples of the output, of the inputs, of the command's channel
  size_t block, ahead;       // samples
  double *asked, *volts;     // [room] of the samples on their way, by number; [block]
  size_t capacity;
  struct drive_monitor monitor;
  bool held;       // the output stood still for a stall: what the inputs read of it has come late
  double held_V;   // where
  double *columns; // [channels on the clock][block]: samples to be recorded
  size_t columns_used;
  double last_frame_s, frame_interval_s;
  double started_s, lost_reader_s; // by the computer's clock
  double stall_s;
  struct dea_guard *guard;
  const struct dea_supply *supply;
  size_t told;       // events among what is said
  bool outcome;      // a fault came
  dea_status status; // of it
  struct dea_drive_report *report;
};

// Ends -------------------------------------------------------------------------------------------

/* The first fault: from here on the ramp. */
static void end_early(struct loop *loop, dea_status status, const char *format, ...)
    DEA_PRINTF(3, 4);
static void end_early(struct loop *loop, dea_status status, const char *format, ...)
{
  if (loop->outcome) {
    return;
  }
  va_list args;
  va_start(args, format);
  vsnprintf(loop->report->ended, sizeof loop->report->ended, format, args);
  va_end(args);
  loop->outcome = true;
  loop->status = status;
  dea_drive_output_ramp(&loop->output);
}

static void resume(struct loop *loop, double volts);

/* A sign of life. False: the guard has taken over, and nothing is played any more. Without a guard
 * only the ramp is. */
static bool is_guarded(struct loop *loop)
{
  dea_guard_doubt(loop->guard, loop->player->instrument->doubt);
  enum dea_guard_state state = dea_guard_beat(loop->guard);
  if (state == DEA_GUARD_GONE) {
    end_early(loop, DEA_E_INSTRUMENT,
              "the guard of the output was killed, or is stopped: nobody would bring the output to "
              "0 V if this program died");
  }
  if (state != DEA_GUARD_TAKEN) {
    return true;
  }
  loop->player->failed = true;
  end_early(loop, DEA_E_INSTRUMENT,
            "the program was stopped, or gave no sign of life for safety.guard_time of %g s: its "
            "guard has taken over",
            loop->protocol->safety.guard_time_s.si);
  return false;
}

/* One that only held its output can be ramped. */
static void instrument_failed(struct loop *loop, struct source *source)
{
  double volts;
  const struct dea_instrument_type *type = source->instrument->type;
  if (is_guarded(loop) && source == loop->player && type->hold != NULL &&
      dea_context_status(loop->ctx) == DEA_E_INTERLOCK) {
    end_early(loop, DEA_E_INTERLOCK, "%s: %s", type->name, dea_context_message(loop->ctx));
    if (type->hold(loop->ctx, source->instrument, &volts) == DEA_OK) {
      resume(loop, volts);
      return;
    }
  }
  source->failed = true;
  if (source == loop->reader) {
    loop->lost_reader_s = dea_clock_s();
  }
  end_early(loop, DEA_E_INSTRUMENT, "%s: %s", source->instrument->type->name,
            dea_context_message(loop->ctx));
}

/* A recording that cannot be written any more ends the measurement, not the ramp. */
static void check_recorder(struct loop *loop, dea_status status)
{
  if (status != DEA_OK) {
    end_early(loop, status, "%s", dea_context_message(loop->ctx));
  }
}

static bool reads(const struct loop *loop)
{
  return loop->reader != NULL && !loop->reader->failed;
}

// What arrives -----------------------------------------------------------------------------------

static void record_columns(struct loop *loop)
{
  size_t channels = loop->protocol->input_count + 1;
  for (size_t c = 0; c < channels && loop->columns_used > 0; c++) {
    check_recorder(loop, dea_writer_add(loop->ctx, loop->writer, c, loop->columns + c * loop->block,
                                        loop->columns_used));
  }
  loop->columns_used = 0;
}

/* The next sample of all channels; values: of the inputs, NULL: lost. */
static double record_sample(struct loop *loop, const double *values)
{
  double asked_V = loop->asked[loop->recorded++ % loop->capacity];
  loop->columns[loop->columns_used] = asked_V;
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    loop->columns[(i + 1) * loop->block + loop->columns_used] =
        values != NULL ? values[i] : (double)NAN;
  }
  if (++loop->columns_used == loop->block) {
    record_columns(loop);
  }
  return asked_V;
}

/* Into the recording, and among what is said at the end. */
static void record_event(struct loop *loop, const struct dea_recorded_event *event,
                         const char *name)
{
  char text[DEA_NOTICED_TEXT_SIZE];
  bool good = event->kind == DEA_NOTICED_LEARNED;
  dea_noticed_text(event, name, text);
  check_recorder(loop, dea_writer_add_event(loop->ctx, loop->writer, event));
  if (loop->told++ < events_told_most) {
    check_recorder(loop,
                   dea_finding_add(loop->ctx, good ? DEA_NOTE : DEA_WARNING,
                                   (struct dea_location){0}, "at %.6g s: %s", event->time_s, text));
  }
}

static void store_sample(struct loop *loop, const double *volts)
{
  char why[DEA_WHY_ENDED_SIZE];
  double values[DEA_PROTOCOL_INPUTS_MAX];
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    const struct dea_protocol_input *input = &loop->protocol->inputs[i];
    values[i] = volts[i] * input->per_volt + input->at_zero;
    loop->at_end[i] += fabs(volts[i]) >= (1 - DEA_CHANNEL_END) * input->range_V.si;
  }
  double asked_V = record_sample(loop, values);
  loop->got++;
  bool good = dea_drive_watch_sample(&loop->watch, asked_V, values, why);
  for (size_t i = 0; i < loop->watch.event_count && !loop->outcome; i++) {
    struct dea_recorded_event event = loop->watch.events[i];
    const char *name = loop->protocol->inputs[event.channel++].name.text; // 0: the asked voltage
    record_event(loop, &event, name);
  }
  if (!good) {
    end_early(loop, DEA_E_INTERLOCK, "%s", why);
  }
}

/* Of the means of a window, which is forgotten. */
static void end_window(struct loop *loop)
{
  struct drive_monitor *m = &loop->monitor;
  m->zero = true;
  m->flows = false;
  m->volts = 0;
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    double mean = m->count[i] > 0 ? m->sum[i] / (double)m->count[i] : (double)NAN;
    if (loop->protocol->inputs[i].kind.value == DEA_CHANNEL_VOLTAGE) {
      bool zero = fabs(mean) <= loop->protocol->safety.at_zero_V.si; // false for NAN
      m->zero = m->zero && zero;
      m->volts = fabs(mean) > fabs(m->volts) || isnan(mean) ? mean : m->volts;
    }
    m->flows =
        m->flows || (loop->watch.pulled_down && dea_drive_watch_is_over(loop->protocol, i, mean));
    m->sum[i] = 0;
    m->count[i] = 0;
  }
  m->zero = m->zero && !m->flows;
}

/* A sample of 0 V behind the end. */
static void read_after_end(struct loop *loop, const double *volts)
{
  struct drive_monitor *m = &loop->monitor;
  if (m->window == 0 || m->seen++ < m->settle) {
    return;
  }
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    const struct dea_protocol_input *input = &loop->protocol->inputs[i];
    if (!isnan(volts[i])) {
      m->sum[i] += volts[i] * input->per_volt + input->at_zero;
      m->count[i]++;
    }
  }
  if ((m->seen - m->settle) % m->window == 0) {
    end_window(loop);
  }
}

/* A sample of an output that stands still. */
static void hold_sample(struct loop *loop)
{
  loop->asked[loop->put++ % loop->capacity] = loop->held_V;
}

/* The functions of the sink never fail: what goes wrong with the recording is no fault of the
 * instrument. */
static dea_status record_samples(void *user, const double *volts, size_t count)
{
  struct source *source = user;
  struct loop *loop = source->loop;
  for (size_t i = 0; i < count && source == loop->reader; i++) {
    const double *sample = volts + i * loop->protocol->input_count;
    if (loop->got == loop->put && loop->held) {
      hold_sample(loop);
    }
    if (loop->got == loop->put && loop->output.over) {
      read_after_end(loop, sample);
      continue;
    }
    if (loop->got == loop->put) {
      end_early(loop, DEA_E_INSTRUMENT,
                "%s: the inputs are ahead of the output, which ran dry: the computer is too slow "
                "for this rate, or busy",
                source->instrument->type->name);
      break;
    }
    store_sample(loop, sample);
  }
  source->heard_s = count > 0 ? dea_clock_s() : source->heard_s;
  return DEA_OK;
}

/* What comes while only the voltage channels are looked at is not recorded. */
static bool is_behind_end(const struct loop *loop, double time_s)
{
  return loop->monitor.seen > 0 && time_s * loop->protocol->rate_Hz.si > (double)loop->put;
}

static dea_status record_profile(void *user, double time_s, const double *z_m)
{
  struct source *source = user;
  struct loop *loop = source->loop;
  if (source != loop->sensor || !isfinite(time_s) || time_s <= loop->last_frame_s) {
    loop->report->lost++;
    return DEA_OK;
  }
  if (isfinite(loop->last_frame_s)) {
    loop->frame_interval_s = time_s - loop->last_frame_s;
  }
  loop->last_frame_s = time_s;
  source->heard_s = dea_clock_s();
  if (!is_behind_end(loop, time_s)) {
    check_recorder(loop, dea_writer_add_profile(loop->ctx, loop->writer, time_s, z_m,
                                                source->instrument->profile_points));
  }
  return DEA_OK;
}

static dea_status record_reading(void *user, size_t reading, double time_s, double value)
{
  struct source *source = user;
  struct loop *loop = source->loop;
  if (reading >= source->instrument->reading_count || !isfinite(time_s) ||
      time_s <= source->last_s[reading]) {
    loop->report->lost++;
    return DEA_OK;
  }
  source->last_s[reading] = time_s;
  if (isfinite(value)) {
    source->value_s[reading] = dea_clock_s();
    source->silent[reading] = false;
  }
  if (is_behind_end(loop, time_s)) {
    return DEA_OK;
  }
  check_recorder(loop, dea_writer_add_timed(loop->ctx, loop->writer,
                                            source->first_channel + reading, time_s, value));
  return DEA_OK;
}

static void get_from(struct loop *loop, struct source *source, double timeout_s)
{
  const struct dea_sink sink = {source, record_samples, record_profile, record_reading};
  const struct dea_instrument_type *type = source->instrument->type;
  if (!source->failed && type->get != NULL &&
      type->get(loop->ctx, source->instrument, timeout_s, &sink) != DEA_OK) {
    instrument_failed(loop, source);
  }
}

/* Who has been silent for too long has failed. */
static void check_heard(struct loop *loop, struct source *source, double longest_s,
                        const char *what)
{
  if (source != NULL && !source->failed && dea_clock_s() - source->heard_s > longest_s) {
    dea_fail(loop->ctx, DEA_E_INSTRUMENT, "no %s has come for %.3g s", what, longest_s);
    instrument_failed(loop, source);
  }
}

/* A current or voltage that an instrument reads and that has no value (an overflow, nonsense) is
 * not watched by anybody any more. */
static void check_values(struct loop *loop, struct source *source)
{
  const struct dea_instrument *instrument = source->instrument;
  double now_s = dea_clock_s();
  for (size_t i = 0; i < instrument->reading_count && !source->failed; i++) {
    const struct dea_instrument_reading *reading = &instrument->readings[i];
    double silent_s = now_s - source->value_s[i];
    if ((reading->kind != DEA_CHANNEL_CURRENT && reading->kind != DEA_CHANNEL_VOLTAGE) ||
        silent_s < silent_warn_s || loop->outcome) {
      continue;
    }
    if (!source->silent[i]) {
      source->silent[i] = true;
      record_event(loop,
                   &(struct dea_recorded_event){now_s - loop->started_s, DEA_NOTICED_SILENT,
                                                source->first_channel + i, silent_s, silent_most_s},
                   reading->name);
    }
    if (silent_s >= silent_most_s) {
      end_early(loop, DEA_E_INTERLOCK, "reading '%.60s' has given no value for %.3g s",
                reading->name, silent_most_s);
    }
  }
}

/* Without inputs to wait for the asked voltage is recorded when it is given away. */
static void record_asked(struct loop *loop)
{
  while (!reads(loop) && !loop->player->failed && loop->recorded < loop->put) {
    record_sample(loop, NULL);
    loop->report->lost += loop->reader != NULL;
  }
}

/* Samples that have gone out, as far as can be known: their inputs have come, or their time has
 * passed. */
static double gone_out(const struct loop *loop)
{
  double rate_Hz = loop->protocol->rate_Hz.si;
  if (reads(loop)) {
    return (double)loop->got;
  }
  if (loop->reader != NULL) {
    return (double)loop->got + (dea_clock_s() - loop->lost_reader_s) * rate_Hz;
  }
  return (dea_clock_s() - loop->started_s) * rate_Hz;
}

/* Goes on with the ramp after a stall, from where the output stands. What is recorded of the
 * meantime is that it stood there. */
static void resume(struct loop *loop, double volts)
{
  size_t before, dropped = loop->ahead + loop->block; // at most
  double until_s = dea_clock_s() + last_frame_wait_s;
  loop->held_V = volts * loop->protocol->amplifier.gain.si;
  loop->held = true;
  dea_drive_output_ramp_from(&loop->output, loop->held_V);
  loop->output.played = loop->output.played > dropped ? loop->output.played - dropped : 0;
  if (reads(loop)) {
    for (size_t i = loop->got; i < loop->put; i++) { // never played
      loop->asked[i % loop->capacity] = loop->held_V;
    }
    do {
      before = loop->got;
      get_from(loop, loop->reader, 0);
    } while (loop->got > before && dea_clock_s() < until_s);
  }
  while ((double)loop->put < gone_out(loop)) {
    hold_sample(loop);
    record_asked(loop);
  }
  loop->held = false;
}

/* From all; waits for the one that reads the inputs, or else for the one that plays. */
static void get_all(struct loop *loop, double timeout_s)
{
  struct source *waited = reads(loop) ? loop->reader : loop->player;
  double before_s = dea_clock_s();
  get_from(loop, waited, timeout_s);
  for (size_t i = 0; i < loop->count; i++) {
    if (&loop->sources[i] != waited) {
      get_from(loop, &loop->sources[i], 0);
    }
  }
  for (size_t i = 0; i < loop->count; i++) {
    check_values(loop, &loop->sources[i]);
  }
  record_asked(loop);
  record_columns(loop);
  check_heard(loop, loop->reader, loop->put > loop->got ? loop->stall_s : INFINITY, "sample");
  check_heard(loop, loop->sensor, fmax(6 * loop->stall_s, 5 * loop->frame_interval_s), "profile");
  if (!reads(loop)) { // nothing that would keep the loop from turning idly
    dea_clock_wait(fmin(timeout_s, 0.01) - (dea_clock_s() - before_s));
  }
}

// What is played ---------------------------------------------------------------------------------

/* False: the player has failed, or has dropped it after a stall. */
static bool set_outputs(struct loop *loop, const double *volts, size_t count)
{
  struct source *player = loop->player;
  if (player->instrument->type->put(loop->ctx, player->instrument, volts, count) != DEA_OK) {
    instrument_failed(loop, player);
    return false;
  }
  return true;
}

/* 0 V for as long as the voltage channels need to show it. */
static void write_after_end(struct loop *loop)
{
  struct drive_monitor *m = &loop->monitor;
  memset(loop->volts, 0, loop->block * sizeof *loop->volts);
  for (size_t left = m->window > 0 ? m->settle + m->window : 0; left > 0;) {
    size_t part = left < loop->block ? left : loop->block;
    if (!set_outputs(loop, loop->volts, part)) {
      return;
    }
    left -= part;
  }
}

/* A DAQ begins with its first sample, and that may take a while. */
static void begin_clock(struct loop *loop)
{
  loop->started_s = dea_clock_s();
  for (size_t i = 0; i < loop->count; i++) {
    if (&loop->sources[i] != loop->player) {
      loop->sources[i].instrument->start_s = loop->started_s;
    }
  }
}

static void write_block(struct loop *loop)
{
  double asked_V[64];
  size_t filled = 0;
  while (filled < loop->block && !loop->output.over) {
    size_t capacity = loop->block - filled < 64 ? loop->block - filled : 64;
    size_t n = dea_drive_output_next(&loop->output, capacity, asked_V);
    for (size_t i = 0; i < n; i++) {
      loop->asked[(loop->put + filled) % loop->capacity] = asked_V[i];
      loop->volts[filled++] = asked_V[i] / loop->protocol->amplifier.gain.si;
    }
  }
  if (filled == 0 || set_outputs(loop, loop->volts, filled)) {
    if (loop->put == 0) {
      begin_clock(loop);
    }
    loop->put += filled;
    if (loop->output.over) {
      write_after_end(loop);
    }
  }
}

/* The clocks of a computer and of a DAQ agree to some ten parts in a million. */
static bool has_room(const struct loop *loop)
{
  double ahead = (double)loop->ahead + (reads(loop) ? 0 : 2e-4 * (double)loop->put);
  return !loop->output.over && (double)loop->put - gone_out(loop) < ahead;
}

static bool is_played(const struct loop *loop)
{
  double margin = reads(loop) ? 0 : 2 * wait_s * loop->protocol->rate_Hz.si;
  return loop->output.over && gone_out(loop) >= (double)loop->put + margin;
}

// Cycles -----------------------------------------------------------------------------------------

static bool is_recorded(const struct loop *loop, const struct dea_recorded_cycle *cycle)
{
  double rate_Hz = loop->protocol->rate_Hz.si;
  size_t end = (size_t)ceil(cycle->end_s * rate_Hz - rounding);
  if (loop->output.played < end || loop->put < end || (reads(loop) && loop->got < end)) {
    return false;
  }
  if (loop->reader != NULL ? loop->got < end : dea_clock_s() - loop->started_s < cycle->end_s) {
    return false;
  }
  // the next frame will lie behind the end
  return loop->sensor == NULL || loop->last_frame_s + 1.5 * loop->frame_interval_s >= cycle->end_s;
}

static void mark_cycles(struct loop *loop)
{
  struct dea_recorded_cycle cycle;
  while (dea_protocol_cycle(loop->protocol, loop->report->cycles, &cycle) &&
         is_recorded(loop, &cycle)) {
    dea_status status = dea_writer_add_cycle(loop->ctx, loop->writer, &cycle);
    check_recorder(loop, status);
    if (status != DEA_OK) {
      return;
    }
    loop->report->cycles++;
  }
}

// The loop ---------------------------------------------------------------------------------------

static void play(struct loop *loop, const volatile sig_atomic_t *interrupt)
{
  double duration_s = dea_protocol_duration_s(loop->protocol), shown_s = -1;
  bool played = false;
  while (!played && !loop->player->failed) {
    if (!is_guarded(loop)) {
      return;
    }
    if (interrupt != NULL && *interrupt != 0 && !loop->output.over) { // else there is all of it
      end_early(loop, DEA_E_INTERRUPTED, "interrupted");
    }
    if (loop->supply != NULL && !loop->outcome && dea_supply_is_asked(loop->supply)) {
      end_early(loop, DEA_E_INTERRUPTED, "another program (dea drive --zero) asked for 0 V");
    }
    bool more = has_room(loop);
    if (more) {
      write_block(loop);
    }
    get_all(loop, more ? 0 : wait_s);
    mark_cycles(loop);
    played = is_played(loop);
    double now_s = floor((double)loop->output.played / loop->protocol->rate_Hz.si);
    if (now_s > shown_s) {
      dea_progress(loop->ctx, loop->outcome ? "ramp to 0 V (s)" : "drive (s)", (size_t)now_s,
                   (size_t)ceil(duration_s));
      shown_s = now_s;
    }
  }
}

/* A profile sensor is a little behind. */
static void wait_for_frames(struct loop *loop)
{
  struct dea_recorded_cycle cycle;
  double until_s = dea_clock_s() + last_frame_wait_s;
  while (loop->sensor != NULL && !loop->sensor->failed && !loop->outcome &&
         dea_protocol_cycle(loop->protocol, loop->report->cycles, &cycle) &&
         dea_clock_s() < until_s) {
    get_from(loop, loop->sensor, wait_s);
    mark_cycles(loop);
    dea_clock_wait(0.001);
  }
}

static void start_all(struct loop *loop)
{
  loop->started_s = dea_clock_s();
  for (size_t i = 0; i < loop->count && !loop->outcome; i++) { // the one that plays comes last
    struct source *source = &loop->sources[i];
    source->heard_s = dea_clock_s();
    for (size_t r = 0; r < DEA_CHANNELS_MAX; r++) {
      source->value_s[r] = source->heard_s;
    }
    if (source->instrument->type->start(loop->ctx, source->instrument) != DEA_OK) {
      instrument_failed(loop, source);
    }
  }
}

/* What an instrument says after its stop; nothing of one without output. */
static void set_zero(const struct dea_protocol *protocol, struct dea_zero known,
                     struct dea_drive_report *report)
{
  if (known.state != DEA_ZERO_NONE) {
    report->zero = known;
    report->zero.volts *= protocol->amplifier.gain.si;
  }
}

dea_status dea_drive_abort(struct dea_context *ctx, const struct dea_protocol *protocol,
                           struct dea_instrument *const *instruments, size_t count,
                           dea_status status, struct dea_drive_report *out)
{
  char why[512];
  bool said = out->zero.state == DEA_ZERO_UNKNOWN;
  for (size_t i = 0; i < count; i++) {
    set_zero(protocol, dea_instrument_stop(ctx, instruments[i]), out);
  }
  if (said || out->zero.state != DEA_ZERO_UNKNOWN) {
    return status;
  }
  snprintf(why, sizeof why, "%s", dea_context_message(ctx));
  return dea_fail(ctx, DEA_E_INSTRUMENT,
                  "%s; the output is not known to be at 0 V: switch the supply off", why);
}

/* What the voltage channels show, until it is 0 V, nothing comes any more, or the time is over. */
static void read_monitor(struct loop *loop, double until_s)
{
  while (loop->monitor.window > 0 && reads(loop) && !loop->monitor.zero &&
         dea_clock_s() < fmin(until_s, loop->reader->heard_s + loop->stall_s)) {
    get_from(loop, loop->reader, wait_s);
  }
}

/* Brings all to their end, the one that plays first, and finds out where its output is. */
static void stop_all(struct loop *loop)
{
  double until_s = dea_clock_s() + loop->protocol->safety.zero_time_s.si;
  struct drive_monitor *m = &loop->monitor;
  struct dea_zero *zero = &loop->report->zero;
  if (!loop->player->failed && loop->output.over) {
    read_monitor(loop, until_s);
  }
  bool apart = loop->reader != loop->player;
  for (size_t i = loop->count; i-- > 0;) {
    struct dea_instrument *instrument = loop->sources[i].instrument;
    struct dea_zero known = dea_instrument_stop(loop->ctx, instrument);
    loop->report->lost += instrument->lost;
    if (&loop->sources[i] != loop->player) {
      continue;
    }
    set_zero(loop->protocol, known, loop->report);
    if (apart) { // it measures on, also what could not be played to its end
      loop->output.over = true;
      m->seen = 0;
      m->zero = false;
      m->volts = NAN;
      read_monitor(loop, dea_clock_s() + loop->protocol->safety.zero_time_s.si);
    }
  }
  if (m->window == 0 || loop->output.played == 0 || zero->state == DEA_ZERO_UNKNOWN) {
    return;
  }
  if (m->zero) {
    *zero = dea_zero_believe((struct dea_zero){DEA_ZERO_READ_BACK, m->volts, NULL},
                             dea_drive_watch_doubt(&loop->watch));
  } else if (zero->state == DEA_ZERO_COMMANDED || isfinite(m->volts)) { // the channel is to show it
    const char *why = m->flows ? "more than safety.trip_current still flows" : NULL;
    *zero = (struct dea_zero){DEA_ZERO_UNKNOWN, m->volts,
                              isnan(m->volts) ? "the voltage channel does not show it" : why};
  }
}

// Set up -----------------------------------------------------------------------------------------

static dea_status set_sources(struct loop *loop, const struct dea_drive_bench *bench)
{
  struct dea_drive_roles roles;
  DEA_TRY(loop->ctx, dea_drive_find_roles(loop->ctx, loop->protocol, bench, &roles));
  size_t channel = loop->protocol->input_count + 1;
  for (size_t i = 0, k = 0; i < bench->count; i++) {
    struct dea_instrument *instrument = bench->instruments[i];
    struct source *source = &loop->sources[instrument == roles.player ? bench->count - 1 : k++];
    *source = (struct source){.loop = loop, .instrument = instrument, .first_channel = channel};
    channel += instrument->reading_count;
    for (size_t r = 0; r < DEA_CHANNELS_MAX; r++) {
      source->last_s[r] = -INFINITY;
    }
    loop->player = instrument == roles.player ? source : loop->player;
    loop->reader = instrument == roles.reader ? source : loop->reader;
    loop->sensor = instrument == roles.sensor ? source : loop->sensor;
  }
  loop->count = bench->count;
  return DEA_OK;
}

static void set_monitor(struct loop *loop, double settle_s)
{
  double rate_Hz = loop->protocol->rate_Hz.si;
  loop->monitor.volts = NAN;
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    if (loop->protocol->inputs[i].kind.value == DEA_CHANNEL_VOLTAGE) {
      loop->monitor.settle = (size_t)ceil(settle_s * rate_Hz) + 1; // one shows what was before it
      loop->monitor.window = (size_t)fmax(ceil(monitor_s * rate_Hz), 4);
    }
  }
}

static dea_status set_rooms(struct loop *loop)
{
  double rate_Hz = loop->protocol->rate_Hz.si;
  loop->block = (size_t)fmax(1, rint(block_s * rate_Hz));
  loop->ahead = (size_t)fmax(2, rint(ahead_s * rate_Hz));
  loop->capacity = loop->ahead + 2 * loop->block;
  loop->asked = dea_alloc(loop->ctx, loop->capacity, sizeof *loop->asked);
  loop->volts = dea_alloc(loop->ctx, loop->block, sizeof *loop->volts);
  loop->columns =
      dea_alloc(loop->ctx, loop->block * (loop->protocol->input_count + 1), sizeof *loop->columns);
  bool good = loop->asked != NULL && loop->volts != NULL && loop->columns != NULL;
  return good ? DEA_OK : DEA_E_MEMORY;
}

static dea_status begin_recording(struct loop *loop, const struct dea_drive_bench *bench,
                                  const char *file, const struct dea_instrument *sensor)
{
  struct dea_recorder *recorder;
  double samples = queue_s * loop->protocol->rate_Hz.si;
  size_t capacity = queue_least + (size_t)samples * (loop->protocol->input_count + 1);
  DEA_TRY(loop->ctx, dea_context_create(NULL, &loop->own));
  dea_status status = dea_drive_recorder(loop->own, loop->protocol, bench, file, sensor, &recorder);
  if (status != DEA_OK) {
    return dea_fail(loop->ctx, status, "%s", dea_context_message(loop->own));
  }
  return dea_writer_begin(loop->ctx, recorder, capacity, loop->player->instrument->patient,
                          &loop->writer);
}

/* Names the inputs whose range was too small. */
static dea_status note_ranges(const struct loop *loop)
{
  for (size_t i = 0; i < loop->protocol->input_count; i++) {
    const struct dea_protocol_input *input = &loop->protocol->inputs[i];
    double share = (double)loop->at_end[i] / (double)loop->got;
    if (loop->at_end[i] > 0) {
      DEA_TRY(loop->ctx, dea_finding_add(
                             loop->ctx, DEA_WARNING, input->name.location,
                             "channel '%s' was at the end of its range of +-%g V in %.2g %% of its "
                             "samples: what was measured there was cut off",
                             input->name.text, input->range_V.si, 100 * share));
    }
  }
  return DEA_OK;
}

static dea_status finish(struct loop *loop)
{
  struct dea_drive_report *report = loop->report;
  report->played_s = fmin((double)loop->output.played / loop->protocol->rate_Hz.si,
                          dea_protocol_duration_s(loop->protocol));
  report->largest_current_A = loop->watch.largest_current_A;
  char zero[DEA_ZERO_TEXT_SIZE];
  dea_zero_text(report->zero, zero);
  dea_status finished = dea_writer_finish(loop->ctx, loop->writer, zero, report->ended);
  if (finished != DEA_OK && report->ended[0] == '\0') { // with what was still waiting
    snprintf(report->ended, sizeof report->ended, "%s", dea_context_message(loop->ctx));
  } else if (finished != DEA_OK) { // what came first is told first
    (void)dea_finding_add(loop->ctx, DEA_WARNING, (struct dea_location){0}, "%s",
                          dea_context_message(loop->ctx));
  }
  dea_status noted = note_ranges(loop);
  finished = finished == DEA_OK ? noted : finished;
  bool unknown = report->zero.state == DEA_ZERO_UNKNOWN;
  if (loop->status != DEA_OK || unknown) {
    return dea_fail(loop->ctx,
                    unknown && loop->status != DEA_E_INTERLOCK ? DEA_E_INSTRUMENT : loop->status,
                    "the measurement %s%.4g s%s%s; the output is %s%s%s",
                    loop->status != DEA_OK ? "ended after " : "was played to its end at ",
                    report->played_s, loop->status != DEA_OK ? ": " : "", report->ended, zero,
                    unknown ? ": switch the supply off" : "",
                    unknown && loop->guard != NULL ? "; its guard goes on for 10 min" : "");
  }
  return finished;
}

dea_status dea_drive_play(struct dea_context *ctx, const struct dea_protocol *protocol,
                          const struct dea_drive_bench *bench, const char *file,
                          struct dea_drive_report *out)
{
  struct loop loop = {.ctx = ctx,
                      .protocol = protocol,
                      .report = out,
                      .stall_s = bench->stall_s,
                      .guard = bench->guard,
                      .supply = bench->supply};
  *out = (struct dea_drive_report){.largest_current_A = NAN, .zero.volts = NAN};
  loop.last_frame_s = -INFINITY;
  dea_status status = set_sources(&loop, bench);
  status = status == DEA_OK ? set_rooms(&loop) : status;
  if (status == DEA_OK) {
    const struct dea_instrument *sensor = loop.sensor != NULL ? loop.sensor->instrument : NULL;
    status = begin_recording(&loop, bench, file, sensor);
  }
  if (status == DEA_OK) {
    // instruments that wait must not end for a signal: they are needed for the ramp
    const volatile sig_atomic_t *interrupt = dea_context_get_interrupt(ctx);
    dea_context_set_interrupt(ctx, NULL);
    dea_drive_output_start(&loop.output, protocol);
    dea_drive_watch_start(&loop.watch, protocol, bench->settle_s, bench->capacitance_F);
    set_monitor(&loop, bench->settle_s);
    start_all(&loop);
    if (!loop.outcome) {
      dea_guard_limit(loop.guard, protocol->safety.guard_time_s.si);
      play(&loop, interrupt);
      // time for what is left to do; the output is at 0 V, or was brought there by the guard
      dea_guard_limit(loop.guard, last_frame_wait_s + 3 * protocol->safety.zero_time_s.si);
      wait_for_frames(&loop);
    }
    stop_all(&loop);
    dea_guard_limit(loop.guard, 0);
    dea_context_set_interrupt(ctx, interrupt);
    status = finish(&loop);
  } else {
    status = dea_drive_abort(ctx, protocol, bench->instruments, bench->count, status, out);
  }
  dea_free(ctx, loop.asked);
  dea_free(ctx, loop.volts);
  dea_free(ctx, loop.columns);
  dea_context_destroy(loop.own);
  return status;
}
