/* Growing binary data, little-endian whatever the machine is. */
#pragma once

#include "base/context.h"

#include <stdint.h>

/* As struct dea_text: zero-initialised with the context set; `failed` stays after a failed append.
 */
struct dea_bytes {
  struct dea_context *ctx;
  char *data; // owned
  size_t length, capacity;
  bool failed;
};

void dea_bytes_reserve(struct dea_bytes *bytes, size_t capacity);
void dea_bytes_add(struct dea_bytes *bytes, const void *data, size_t length);
void dea_bytes_add_u8(struct dea_bytes *bytes, uint8_t value);
void dea_bytes_add_i32(struct dea_bytes *bytes, int32_t value);
void dea_bytes_add_u64(struct dea_bytes *bytes, uint64_t value);
void dea_bytes_add_f32(struct dea_bytes *bytes, float value);
void dea_bytes_add_f64(struct dea_bytes *bytes, double value);
/* Writes over the eight bytes from `at`, which are there (nothing after a failure). */
void dea_bytes_set_u64(struct dea_bytes *bytes, size_t at, uint64_t value);
void dea_bytes_free(struct dea_bytes *bytes);
