#include "base/bytes.h"

#include <string.h>

void dea_bytes_reserve(struct dea_bytes *bytes, size_t capacity)
{
  if (bytes->failed || capacity <= bytes->capacity) {
    return;
  }
  char *moved = dea_resize(bytes->ctx, bytes->data, capacity, 1);
  if (moved == NULL) {
    bytes->failed = true;
    return;
  }
  bytes->data = moved;
  bytes->capacity = capacity;
}

/* Room for `length` more; NULL after a failure. */
static char *extend(struct dea_bytes *bytes, size_t length)
{
  if (length > bytes->capacity - bytes->length) {
    size_t doubled = 2 * bytes->capacity, needed = bytes->length + length;
    dea_bytes_reserve(bytes, doubled > needed ? doubled : needed + 4096);
  }
  if (bytes->failed) {
    return NULL;
  }
  char *at = bytes->data + bytes->length;
  bytes->length += length;
  return at;
}

void dea_bytes_add(struct dea_bytes *bytes, const void *data, size_t length)
{
  char *to = length > 0 ? extend(bytes, length) : NULL;
  if (to != NULL) {
    memcpy(to, data, length);
  }
}

static void store_bytes(char *to, uint64_t value, size_t length)
{
  for (size_t i = 0; i < length; i++) {
    to[i] = (char)(unsigned char)(value >> (8 * i) & 0xff);
  }
}

static void add_word(struct dea_bytes *bytes, uint64_t value, size_t length)
{
  char *to = extend(bytes, length);
  if (to != NULL) {
    store_bytes(to, value, length);
  }
}

void dea_bytes_add_u8(struct dea_bytes *bytes, uint8_t value)
{
  add_word(bytes, value, 1);
}

void dea_bytes_add_i32(struct dea_bytes *bytes, int32_t value)
{
  add_word(bytes, (uint32_t)value, 4);
}

void dea_bytes_add_u64(struct dea_bytes *bytes, uint64_t value)
{
  add_word(bytes, value, 8);
}

void dea_bytes_add_f32(struct dea_bytes *bytes, float value)
{
  uint32_t word;
  memcpy(&word, &value, sizeof word);
  add_word(bytes, word, 4);
}

void dea_bytes_add_f64(struct dea_bytes *bytes, double value)
{
  uint64_t word;
  memcpy(&word, &value, sizeof word);
  add_word(bytes, word, 8);
}

void dea_bytes_set_u64(struct dea_bytes *bytes, size_t at, uint64_t value)
{
  if (!bytes->failed && at + 8 <= bytes->length) {
    store_bytes(bytes->data + at, value, 8);
  }
}

void dea_bytes_free(struct dea_bytes *bytes)
{
  dea_free(bytes->ctx, bytes->data);
  *bytes = (struct dea_bytes){.ctx = bytes->ctx};
}
