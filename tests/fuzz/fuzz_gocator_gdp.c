/* Fuzz target: a Gocator's data stream, whole and in pieces, onto the grid of its first profile. */
#include "fuzz.h"

#include "instrument/gocator_frames.h"

#include <math.h>
#include <string.h>

struct stream {
  struct dea_gdp reader;
  struct dea_gocator_frames frames;
  size_t events, lost;
  double sum; // of everything read, so that two streams can be compared
};

static void take_profiles(struct dea_context *ctx, struct stream *s)
{
  const struct dea_gdp_profiles *p = &s->reader.profiles;
  double time_s;
  bool begun = s->frames.points > 0;
  if (!begun && dea_gocator_frames_begin(ctx, &s->frames, p, &begun) != DEA_OK) {
    __builtin_trap();
  }
  for (size_t k = 0; k < p->count && k < 4 && begun; k++) {
    const struct dea_gdp_stamp *stamp = k < s->reader.stamp_count ? &s->reader.stamps[k] : NULL;
    dea_gocator_frames_time(&s->frames, stamp, 1, 0, &time_s, &s->lost);
    dea_gocator_frames_place(&s->frames, p, k);
    for (size_t i = 0; i < s->frames.points; i++) {
      s->sum += isnan(s->frames.z_m[i]) ? 1 : s->frames.z_m[i];
    }
  }
}

static void feed(struct dea_context *ctx, struct stream *s, const uint8_t *bytes, size_t length)
{
  enum dea_gdp_event event;
  while ((event = dea_gdp_next(&s->reader, &bytes, &length)) != DEA_GDP_MORE) {
    s->events++;
    if (event == DEA_GDP_BROKEN) {
      return;
    }
    if (event == DEA_GDP_STAMPS) {
      dea_gocator_frames_add(&s->frames, &s->reader.stamps[0], 1);
    } else if (event == DEA_GDP_MEASUREMENT) {
      s->sum += s->reader.measurement.thousandths;
    } else if (event == DEA_GDP_PROFILES) {
      take_profiles(ctx, s);
    }
  }
  if (length > 0) {
    __builtin_trap(); // asked for more with bytes left
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  static struct stream whole, pieces;
  memset(&whole, 0, sizeof whole);
  memset(&pieces, 0, sizeof pieces);
  whole.frames.offset_s = pieces.frames.offset_s = INFINITY;
  feed(ctx, &whole, data, size);
  for (size_t at = 0, part = 1; at < size; at += part, part = part % 97 + 1) {
    feed(ctx, &pieces, data + at, size - at < part ? size - at : part);
  }
  bool broken = whole.events > 0 && pieces.events != whole.events; // which repeats itself
  if (!broken && (whole.sum != pieces.sum || whole.lost != pieces.lost)) {
    __builtin_trap(); // how it is cut must not matter
  }
  int32_t status;
  dea_gocator_reply(data, size, DEA_GOCATOR_START, &status);
  dea_gocator_frames_free(ctx, &whole.frames);
  dea_gocator_frames_free(ctx, &pieces.frames);
  return 0;
}
