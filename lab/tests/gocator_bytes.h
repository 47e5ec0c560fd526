/* Messages of a Gocator, written field by field from the published tables. */
#pragma once

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct gocator_bytes {
  unsigned char bytes[1 << 16];
  size_t length, message; // begin of the last message
};

static inline void gocator_put(struct gocator_bytes *b, int64_t value, int bytes)
{
  for (int i = 0; i < bytes; i++) {
    b->bytes[b->length++] = (unsigned char)(i < 8 ? (uint64_t)value >> (8 * i) : 0);
  }
}

/* Begins a message; gocator_end sets its size. */
static inline void gocator_begin(struct gocator_bytes *b, int type, int last)
{
  b->message = b->length;
  gocator_put(b, 0, 4);
  gocator_put(b, type | (last ? 0x8000 : 0), 2);
}

static inline void gocator_end(struct gocator_bytes *b)
{
  size_t end = b->length;
  b->length = b->message;
  gocator_put(b, (int64_t)(end - b->message), 4);
  b->length = end;
}

static inline void gocator_stamp(struct gocator_bytes *b, int64_t frame, int64_t time_us)
{
  gocator_begin(b, 1, 0);
  gocator_put(b, 1, 4);       // count
  gocator_put(b, 56, 2);      // size of a stamp
  gocator_put(b, 0, 2);       // source, reserved
  gocator_put(b, frame, 8);   //
  gocator_put(b, time_us, 8); //
  gocator_put(b, 0, 40);      // encoder, status, serial number, ...
  gocator_end(b);
}

/* A uniform profile (points 0) or points (x of point i is 2 i units). */
static inline void gocator_profile(struct gocator_bytes *b, int points, int width, int x_nm,
                                   int z_nm, int x_um, int z_um, const int16_t *ranges)
{
  gocator_begin(b, points ? 5 : 6, 1);
  gocator_put(b, points ? 32 : 40, 2); // size of the attributes
  gocator_put(b, 1, 4);                // count
  gocator_put(b, width, 4);
  gocator_put(b, x_nm, 4);
  gocator_put(b, z_nm, 4);
  gocator_put(b, x_um, 4);
  gocator_put(b, z_um, 4);
  gocator_put(b, 0, 1);              // source
  gocator_put(b, 80000, 4);          // exposure
  gocator_put(b, 0, 3);              // camera, reserved
  gocator_put(b, 0, points ? 0 : 8); // stream step and its id
  for (int i = 0; i < width; i++) {
    if (points) {
      gocator_put(b, 2 * i, 2);
    }
    gocator_put(b, ranges[i], 2);
  }
  gocator_end(b);
}

static inline void gocator_measurement(struct gocator_bytes *b, int id, int32_t value, int decision)
{
  gocator_begin(b, 10, 1);
  gocator_put(b, 1, 4); // count
  gocator_put(b, 0, 2); // reserved
  gocator_put(b, id, 2);
  gocator_put(b, value, 4);
  gocator_put(b, decision, 4); // and reserved
  gocator_end(b);
}

enum { GOCATOR_WIDTH = 5 };
static const int16_t gocator_ranges[GOCATOR_WIDTH] = {0, 100, -32768, -200, 32767};

/* Frame number `frame` of the group: stamp, something unknown, two measurements, profile. */
static inline void gocator_frame(struct gocator_bytes *b, int frame, int time_us)
{
  static const int16_t moved[GOCATOR_WIDTH] = {1, 2, 3, 4, 5};
  b->length = 0;
  gocator_stamp(b, frame, time_us);
  gocator_begin(b, 2, 0); // an image
  gocator_put(b, 0, 100);
  gocator_end(b);
  gocator_measurement(b, 3, 1000 * frame, 1);
  b->bytes[b->message + 5] = 0; // not the last of its group
  gocator_measurement(b, 7, 5, frame == 3 ? 2 : 0);
  b->bytes[b->message + 5] = 0;
  gocator_profile(b, 0, GOCATOR_WIDTH, 10000, 500, -20, 1000, frame == 0 ? gocator_ranges : moved);
}
