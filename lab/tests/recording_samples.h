/* Recordings whose every value is known, for the tests of what writes and reads them. */
#pragma once

#include "recording/recorder.h"
#include "testing.h"

enum { SAMPLE_CHANNELS = 3, SAMPLE_POINTS = 7 };

/* Value of a channel's sample: no two neighbours alike, and a gap now and then. */
static inline double sample_value(size_t channel, size_t i)
{
  return i % 997 == 5 ? (double)NAN
                      : (double)((i * 2654435761U + channel * 97) % 100003) / 7.0 - 5000.0;
}

static inline double sample_reading_time(size_t i)
{
  return 0.013 * (double)i + 1e-4 * (double)(i % 3);
}

static inline double sample_height(size_t frame, size_t point)
{
  return point == 0 && frame % 4 == 0 ? (double)NAN : 1e-6 * (double)(frame * 31 + point);
}

/* Two channels on a clock of 10 kHz, one of readings, frames of a sensor. */
static inline dea_status sample_create(struct dea_context *context, const char *file, bool plain,
                                       double flush_s, struct dea_recorder **out)
{
  static const struct dea_recorder_channel channels[SAMPLE_CHANNELS] = {
      {"voltage", DEA_CHANNEL_VOLTAGE, NULL, 0.25, 1e-4, NAN, 0, 0},
      {"centre/laser", DEA_CHANNEL_DISPLACEMENT, NULL, 0.25, 1e-4, 250.0, -1e-3, 2e-3},
      {"temperature", DEA_CHANNEL_OTHER, "K", 0, 0, NAN, 0, 0},
  };
  static const double x_m[SAMPLE_POINTS] = {-0.03, -0.02, -0.01, 0, 0.01, 0.02, 0.03};
  const struct dea_recorder_options options = {
      .title = "Sample",
      .protocol = "title: Sample\n",
      .design = "film: no\n",
      .design_name = "sample.yaml",
      .provenance = "{\"program\": \"test\"}",
      .channels = channels,
      .channel_count = SAMPLE_CHANNELS,
      .profile_points = SAMPLE_POINTS,
      .x_m = x_m,
      .flush_s = flush_s,
      .plain = plain,
  };
  return dea_recorder_create(context, file, &options, out);
}

/* Adds the samples [first, first + count) of both clocked channels. */
static inline dea_status sample_add(struct dea_recorder *recorder, size_t first, size_t count)
{
  double values[1000];
  dea_status status = DEA_OK;
  for (size_t c = 0; c < 2; c++) {
    for (size_t done = 0; done < count && status == DEA_OK;) {
      size_t n = count - done < 1000 ? count - done : 1000;
      for (size_t i = 0; i < n; i++) {
        values[i] = sample_value(c, first + done + i);
      }
      status = dea_recorder_add(recorder, c, values, n);
      done += n;
    }
  }
  return status;
}

static inline dea_status sample_add_reading(struct dea_recorder *recorder, size_t i)
{
  const double time_s = sample_reading_time(i), value = sample_value(2, i);
  return dea_recorder_add_timed(recorder, 2, &time_s, &value, 1);
}

static inline dea_status sample_add_frame(struct dea_recorder *recorder, size_t i)
{
  double z_m[SAMPLE_POINTS];
  for (size_t k = 0; k < SAMPLE_POINTS; k++) {
    z_m[k] = sample_height(i, k);
  }
  return dea_recorder_add_profile(recorder, 0.02 * (double)i, z_m);
}

/* Cycle `i` ends with the sample 700 (i + 1) of its channels. */
enum { SAMPLE_CYCLE = 700 };
static inline struct dea_recorded_cycle sample_cycle(size_t i)
{
  double length_s = SAMPLE_CYCLE * 1e-4;
  return (struct dea_recorded_cycle){i / 15, i % 15, 0.25 + (double)i * length_s,
                                     0.25 + (double)(i + 1) * length_s, 500.0 * (double)(i / 15)};
}

static inline bool sample_same(double a, double b)
{
  return a == b || (isnan(a) && isnan(b));
}

/* Whatever is in the recording is what was written, and at least that many of each. */
static inline void sample_check(const struct dea_recording *r, size_t samples, size_t readings,
                                size_t frames, size_t cycles)
{
  assert_string_equal(r->title, "Sample");
  assert_string_equal(r->protocol, "title: Sample\n");
  assert_string_equal(r->design, "film: no\n");
  assert_string_equal(r->design_name, "sample.yaml");
  assert_string_equal(r->provenance, "{\"program\": \"test\"}");
  assert_int_equal(r->channel_count, SAMPLE_CHANNELS);
  assert_string_equal(r->channels[1].name, "centre/laser");
  assert_int_equal(r->channels[1].kind, DEA_CHANNEL_DISPLACEMENT);
  assert_string_equal(r->channels[0].unit, "V");
  assert_string_equal(r->channels[2].unit, "K");
  assert_true(isnan(r->channels[0].filter_Hz) && r->channels[1].filter_Hz == 250.0);
  assert_true(r->channels[0].lowest == r->channels[0].highest); // not known
  assert_true(r->channels[1].lowest == -1e-3 && r->channels[1].highest == 2e-3);
  assert_true(r->channels[0].interval_s == 1e-4 && r->channels[0].start_s == 0.25);
  for (size_t c = 0; c < 3; c++) {
    const struct dea_channel *channel = &r->channels[c];
    assert_true(channel->count >= (c < 2 ? samples : readings));
    for (size_t i = 0; i < channel->count; i++) {
      if (!sample_same(channel->values[i], sample_value(c, i)) ||
          (c == 2 && channel->time_s[i] != sample_reading_time(i))) {
        fail_msg("channel %zu, sample %zu is %.17g", c, i, channel->values[i]);
      }
    }
  }
  assert_int_equal(r->profiles.points, SAMPLE_POINTS);
  assert_true(r->profiles.x_m[6] == 0.03);
  assert_true(r->profiles.count >= frames);
  for (size_t i = 0; i < r->profiles.count; i++) {
    assert_true(r->profiles.time_s[i] == 0.02 * (double)i);
    for (size_t k = 0; k < SAMPLE_POINTS; k++) {
      assert_true(sample_same(r->profiles.z_m[i * SAMPLE_POINTS + k], sample_height(i, k)));
    }
  }
  assert_true(r->cycle_count >= cycles);
  for (size_t i = 0; i < r->cycle_count; i++) {
    struct dea_recorded_cycle wanted = sample_cycle(i);
    assert_int_equal(r->cycles[i].step, wanted.step);
    assert_int_equal(r->cycles[i].number, wanted.number);
    assert_true(r->cycles[i].start_s == wanted.start_s && r->cycles[i].end_s == wanted.end_s);
    assert_true(r->cycles[i].level_V == wanted.level_V);
    assert_true(r->channels[0].count >= (i + 1) * SAMPLE_CYCLE &&
                r->channels[1].count >= (i + 1) * SAMPLE_CYCLE);
  }
}
