#include "instrument/gocator_parse.h"

#include <string.h>

enum { HEADER = 6, STAMP = 1, POINTS = 5, UNIFORM = 6, MEASUREMENT = 10, ATTRIBUTES_LEAST = 25 };

static uint32_t read_u16(const unsigned char *at)
{
  return (uint32_t)at[0] | (uint32_t)at[1] << 8;
}

static uint32_t read_u32(const unsigned char *at)
{
  return read_u16(at) | read_u16(at + 2) << 16;
}

static uint64_t read_u64(const unsigned char *at)
{
  return (uint64_t)read_u32(at) | (uint64_t)read_u32(at + 4) << 32;
}

static int32_t read_i32(const unsigned char *at)
{
  uint32_t bits = read_u32(at);
  return bits <= INT32_MAX ? (int32_t)bits : (int32_t)((int64_t)bits - 0x100000000);
}

static int32_t read_i16(const unsigned char *at)
{
  int32_t bits = (int32_t)read_u16(at);
  return bits <= INT16_MAX ? bits : bits - 0x10000;
}

static enum dea_gdp_event read_stamps(struct dea_gdp *g)
{
  const unsigned char *m = g->message;
  if (g->length < 14) {
    return DEA_GDP_ODD;
  }
  size_t count = read_u32(m + 6), size = read_u16(m + 10);
  if (count == 0 || size < 16 || count > (g->length - 14) / size) {
    return DEA_GDP_ODD;
  }
  g->stamp_count = count < DEA_GDP_STAMPS_MAX ? count : DEA_GDP_STAMPS_MAX;
  for (size_t i = 0; i < g->stamp_count; i++) {
    g->stamps[i].frame = read_u64(m + 14 + i * size);
    g->stamps[i].time_us = read_u64(m + 14 + i * size + 8);
  }
  return DEA_GDP_STAMPS;
}

static enum dea_gdp_event read_profiles(struct dea_gdp *g, bool uniform)
{
  const unsigned char *m = g->message;
  if (g->length < 8 || read_u16(m + 6) < ATTRIBUTES_LEAST || g->length < 8 + read_u16(m + 6)) {
    return DEA_GDP_ODD;
  }
  size_t data = 8 + read_u16(m + 6), point = uniform ? 2 : 4;
  struct dea_gdp_profiles p = {.count = read_u32(m + 8),
                               .width = read_u32(m + 12),
                               .x_scale_m = 1e-9 * read_u32(m + 16),
                               .z_scale_m = 1e-9 * read_u32(m + 20),
                               .x_offset_m = 1e-6 * read_i32(m + 24),
                               .z_offset_m = 1e-6 * read_i32(m + 28),
                               .source = m[32],
                               .uniform = uniform,
                               .ranges = m + data};
  size_t capacity = (g->length - data) / point;
  if (p.count == 0 || p.width == 0 || p.count > capacity || p.width > capacity / p.count ||
      !(p.x_scale_m > 0) || !(p.z_scale_m > 0)) {
    return DEA_GDP_ODD;
  }
  g->profiles = p;
  return DEA_GDP_PROFILES;
}

static enum dea_gdp_event read_measurement(struct dea_gdp *g)
{
  const unsigned char *m = g->message;
  if (g->length < 19 || read_u32(m + 6) == 0) {
    return DEA_GDP_ODD;
  }
  g->measurement = (struct dea_gdp_measurement){read_u16(m + 12), read_i32(m + 14), m[18] < 2};
  g->measurement.valid = g->measurement.valid && g->measurement.thousandths != INT32_MIN;
  return DEA_GDP_MEASUREMENT;
}

/* Appends up to the length `due`; false while bytes are missing. */
static bool gather(struct dea_gdp *g, size_t due, const unsigned char **bytes, size_t *length)
{
  size_t part = due > g->length ? due - g->length : 0;
  part = part < *length ? part : *length;
  memcpy(g->message + g->length, *bytes, part);
  g->length += part;
  *bytes += part;
  *length -= part;
  return g->length >= due;
}

static enum dea_gdp_event read_message(struct dea_gdp *g, unsigned type)
{
  switch (type) {
  case STAMP:
    return read_stamps(g);
  case POINTS:
  case UNIFORM:
    return read_profiles(g, type == UNIFORM);
  default:
    return read_measurement(g);
  }
}

enum dea_gdp_event dea_gdp_next(struct dea_gdp *g, const unsigned char **bytes, size_t *length)
{
  for (;;) {
    size_t skipped = g->skip < *length ? g->skip : *length;
    *bytes += skipped;
    *length -= skipped;
    g->skip -= skipped;
    if (*length == 0) {
      return DEA_GDP_MORE; // a message is handed over as soon as its last byte is there
    }
    if (g->group_ended) {
      g->stamp_count = 0;
      g->group_ended = false;
    }
    if (!gather(g, HEADER, bytes, length)) {
      return DEA_GDP_MORE;
    }
    size_t size = read_u32(g->message);
    unsigned control = read_u16(g->message + 4), type = control & 0x7fff;
    bool known = type == STAMP || type == POINTS || type == UNIFORM || type == MEASUREMENT;
    if (size < HEADER || size > DEA_GDP_SKIPPED_MAX) {
      return DEA_GDP_BROKEN;
    }
    bool whole = known && size <= DEA_GDP_MESSAGE_MAX;
    if (whole && !gather(g, size, bytes, length)) {
      return DEA_GDP_MORE;
    }
    enum dea_gdp_event event = whole ? read_message(g, type) : DEA_GDP_ODD;
    g->skip = whole ? 0 : size - HEADER;
    g->length = 0;
    g->group_ended = (control & 0x8000) != 0;
    if (known) {
      return event;
    }
  }
}

bool dea_gdp_point(const struct dea_gdp_profiles *p, size_t k, size_t i, double *x_m, double *z_m)
{
  const unsigned char *at = p->ranges + (k * p->width + i) * (p->uniform ? 2 : 4);
  int32_t z = read_i16(p->uniform ? at : at + 2);
  int32_t x = p->uniform ? 0 : read_i16(at);
  *x_m = p->x_offset_m + p->x_scale_m * (p->uniform ? (double)i : (double)x);
  *z_m = p->z_offset_m + p->z_scale_m * (double)z;
  return z != DEA_GDP_NO_POINT && x != DEA_GDP_NO_POINT;
}

void dea_gocator_command(unsigned id, unsigned char out[DEA_GOCATOR_COMMAND_SIZE])
{
  const unsigned char bytes[] = {DEA_GOCATOR_COMMAND_SIZE, 0, 0, 0, id & 0xff, (id >> 8) & 0xff};
  memcpy(out, bytes, sizeof bytes);
}

bool dea_gocator_reply(const unsigned char *bytes, size_t length, unsigned id, int32_t *status)
{
  while (length >= 10) {
    size_t size = read_u32(bytes);
    if (size < 10 || size > length) {
      return false;
    }
    if (read_u16(bytes + 4) == id) {
      *status = read_i32(bytes + 6);
      return true;
    }
    bytes += size;
    length -= size;
  }
  return false;
}
