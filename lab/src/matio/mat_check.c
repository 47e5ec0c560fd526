/* Looks through a file of version 5 before libmatio does, which allocates what a variable claims:
 * dimensions, fields and parts of a variable need bytes, and there must be that many.
 *
 * A variable is an element "matrix" of elements: flags with its class, dimensions, name, and then
 * its numbers, or for structs the names of the fields and a matrix for each, or for cells a matrix
 * for each. An element has a tag of 8 bytes, type and length, and its data, padded to 8 bytes; one
 * of up to 4 bytes has them in the tag. A variable may be compressed as a whole. Source: MathWorks,
 * "MAT-File Format". */
#include "matio/mat_check.h"

#include <stdio.h>
#include <string.h>
#include <zlib.h>

enum {
  HEADER_SIZE = 128,
  TAG_SIZE = 8,
  DEPTH_MAX = 32,
  RANK_MAX = 32,
  CHUNK = 4096,
  RATIO_MAX = 1100, // what deflate makes smaller at best
  COMPLEX = 0x800,  // among a matrix's flags
};
enum { TYPE_INT8 = 1, TYPE_INT32 = 5, TYPE_UINT32 = 6, TYPE_MATRIX = 14, TYPE_COMPRESSED = 15 };

/* Bytes of one variable, as they are or inflated. */
struct source {
  FILE *stream;
  bool big, zipped;
  uint64_t left; // in the file, of this variable
  z_stream z;
  unsigned char in[CHUNK];
};

static uint32_t integer(const unsigned char *at, bool big)
{
  uint32_t value = 0;
  for (size_t i = 0; i < 4; i++) {
    value = value << 8 | at[big ? i : 3 - i];
  }
  return value;
}

/* Fills the inflater's input when it is empty. */
static bool feed(struct source *source)
{
  if (source->z.avail_in == 0 && source->left > 0) {
    size_t n = source->left < CHUNK ? (size_t)source->left : CHUNK;
    if (fread(source->in, 1, n, source->stream) != n) {
      return false;
    }
    source->left -= n;
    source->z.next_in = source->in;
    source->z.avail_in = (uInt)n;
  }
  return true;
}

/* Takes n bytes; false when there are less. */
static bool read_bytes(struct source *source, unsigned char *out, size_t n)
{
  if (!source->zipped) {
    if (n > source->left || fread(out, 1, n, source->stream) != n) {
      return false;
    }
    source->left -= n;
    return true;
  }
  source->z.next_out = out;
  source->z.avail_out = (uInt)n;
  while (source->z.avail_out > 0) {
    uInt before = source->z.avail_out;
    if (!feed(source)) {
      return false;
    }
    int code = inflate(&source->z, Z_SYNC_FLUSH);
    if ((code != Z_OK && code != Z_STREAM_END) ||
        (source->z.avail_out == before && source->z.avail_in == 0 && source->left == 0) ||
        (code == Z_STREAM_END && source->z.avail_out > 0)) {
      return false;
    }
  }
  return true;
}

static bool skip(struct source *source, uint64_t n)
{
  unsigned char scratch[CHUNK];
  if (!source->zipped) {
    bool good = n <= source->left && fseek(source->stream, (long)n, SEEK_CUR) == 0;
    source->left -= good ? n : 0;
    return good;
  }
  while (n > 0) {
    size_t now = n < CHUNK ? (size_t)n : CHUNK;
    if (!read_bytes(source, scratch, now)) {
      return false;
    }
    n -= now;
  }
  return true;
}

/* An element's tag; short ones have their data in it. */
struct tag {
  uint32_t type, length;
  uint64_t padded; // bytes of data that follow the tag
  unsigned char data[4];
};

static bool read_tag(struct source *source, uint64_t *capacity, struct tag *tag)
{
  unsigned char bytes[TAG_SIZE];
  if (*capacity < TAG_SIZE || !read_bytes(source, bytes, TAG_SIZE)) {
    return false;
  }
  *capacity -= TAG_SIZE;
  uint32_t first = integer(bytes, source->big);
  memcpy(tag->data, bytes + 4, 4);
  if (first >> 16 != 0) {
    *tag = (struct tag){.type = first & 0xffff, .length = first >> 16};
    memcpy(tag->data, bytes + 4, 4);
    return tag->length <= 4;
  }
  tag->type = first;
  tag->length = integer(bytes + 4, source->big);
  tag->padded = ((uint64_t)tag->length + 7) / 8 * 8;
  if (tag->type != TYPE_MATRIX && tag->padded > *capacity && tag->length <= *capacity) {
    tag->padded = *capacity; // the last one may end without
  }
  return tag->padded <= *capacity || tag->type == TYPE_MATRIX;
}

/* The data of an element that was begun, at most `size` bytes. */
static bool read_data(struct source *source, uint64_t *capacity, const struct tag *tag,
                      unsigned char *out, size_t size)
{
  if (tag->padded == 0) {
    memcpy(out, tag->data, tag->length);
    return true;
  }
  if (tag->padded > size || tag->padded > *capacity ||
      !read_bytes(source, out, (size_t)tag->padded)) {
    return false;
  }
  *capacity -= tag->padded;
  return true;
}

static bool skip_data(struct source *source, uint64_t *capacity, const struct tag *tag)
{
  if (tag->padded > *capacity || !skip(source, tag->padded)) {
    return false;
  }
  *capacity -= tag->padded;
  return true;
}

/* Number of fields of a struct, whose names are skipped. */
static bool read_fields(struct source *source, uint64_t *capacity, uint64_t *count)
{
  unsigned char data[8];
  struct tag tag;
  if (!read_tag(source, capacity, &tag) || tag.type != TYPE_INT32 || tag.length != 4 ||
      !read_data(source, capacity, &tag, data, sizeof data)) {
    return false;
  }
  uint32_t each = integer(data, source->big);
  if (!read_tag(source, capacity, &tag) || tag.type != TYPE_INT8 ||
      !skip_data(source, capacity, &tag)) {
    return false;
  }
  *count = each > 0 ? tag.length / each : 0;
  return each > 0 || tag.length == 0;
}

/* The numbers of a matrix, at least so many elements: libmatio allocates what they say, and reads
 * on in what follows the matrix where there are less. */
static bool skip_numbers(struct source *source, uint64_t capacity, unsigned least)
{
  struct tag tag;
  unsigned found = 0;
  while (capacity >= TAG_SIZE) {
    if (!read_tag(source, &capacity, &tag) || !skip_data(source, &capacity, &tag)) {
      return false;
    }
    found++;
  }
  return found >= least && skip(source, capacity);
}

/* A matrix of `length` bytes, whose tag was taken. */
static bool check_matrix(struct source *source, uint64_t length, int depth)
{
  unsigned char data[4 * RANK_MAX];
  struct tag tag;
  uint64_t capacity = length, count = 1, fields = 1;
  if (length == 0) {
    return true;
  }
  if (depth > DEPTH_MAX || !read_tag(source, &capacity, &tag) || tag.type != TYPE_UINT32 ||
      tag.length != 8 || !read_data(source, &capacity, &tag, data, sizeof data)) {
    return false;
  }
  unsigned flags = integer(data, source->big), class = flags & 0xff;
  if (class == MAT_C_OPAQUE) { // has no dimensions, but libmatio would read some
    return read_tag(source, &capacity, &tag) && tag.type == TYPE_INT8 && skip(source, capacity);
  }
  if (!read_tag(source, &capacity, &tag) || tag.type != TYPE_INT32 || tag.length < 8 ||
      !read_data(source, &capacity, &tag, data, sizeof data)) {
    return false;
  }
  for (uint32_t k = 0; k < tag.length / 4; k++) {
    uint64_t n = integer(data + 4 * k, source->big);
    if (class != MAT_C_SPARSE && n > 0 && count > length / n) {
      return false; // each element takes a byte at least
    }
    count *= n;
  }
  if (!read_tag(source, &capacity, &tag) || tag.type != TYPE_INT8 ||
      !skip_data(source, &capacity, &tag)) {
    return false;
  }
  bool parts = class == MAT_C_CELL || class == MAT_C_STRUCT || class == MAT_C_FUNCTION;
  if (class == MAT_C_OBJECT) { // the name of its class
    parts = read_tag(source, &capacity, &tag) && skip_data(source, &capacity, &tag);
  }
  if ((class == MAT_C_STRUCT || class == MAT_C_OBJECT) &&
      !read_fields(source, &capacity, &fields)) {
    return false;
  }
  if (!parts) {
    // rows and columns of a sparse one; real and imaginary part
    unsigned least = (class == MAT_C_SPARSE ? 2U : 0U) + ((flags & COMPLEX) != 0 ? 2U : 1U);
    return class != MAT_C_OBJECT && skip_numbers(source, capacity, count > 0 ? least : 0);
  }
  if (fields > 0 && count > capacity / TAG_SIZE / fields) {
    return false;
  }
  for (uint64_t i = 0; i < count * fields; i++) {
    if (!read_tag(source, &capacity, &tag) || tag.type != TYPE_MATRIX || tag.length > capacity ||
        !check_matrix(source, tag.length, depth + 1)) {
      return false;
    }
    capacity -= tag.length;
  }
  return skip(source, capacity);
}

static bool check_compressed(struct source *source)
{
  struct tag tag;
  uint64_t capacity = source->left * RATIO_MAX;
  source->zipped = true;
  if (inflateInit(&source->z) != Z_OK) {
    return false;
  }
  bool good = read_tag(source, &capacity, &tag) && tag.type == TYPE_MATRIX &&
              tag.length <= capacity && check_matrix(source, tag.length, 0);
  inflateEnd(&source->z);
  return good;
}

dea_status dea_matio_check(struct dea_context *ctx, const char *file)
{
  unsigned char bytes[HEADER_SIZE];
  FILE *stream = fopen(file, "rb");
  bool good = stream != NULL && fread(bytes, 1, HEADER_SIZE, stream) == HEADER_SIZE;
  bool big = good && memcmp(bytes + 126, "MI", 2) == 0;
  bool marked = big || (good && memcmp(bytes + 126, "IM", 2) == 0);
  uint64_t at = HEADER_SIZE;
  dea_status status = DEA_OK;
  // that each variable lies within the file was looked at before
  bool five = marked && bytes[big ? 124 : 125] == 1 && bytes[big ? 125 : 124] == 0;
  while (five && status == DEA_OK) {
    unsigned char tag[TAG_SIZE];
    if (fseek(stream, (long)at, SEEK_SET) != 0 || fread(tag, 1, TAG_SIZE, stream) != TAG_SIZE) {
      break;
    }
    struct source source = {.stream = stream, .big = big, .left = integer(tag + 4, big)};
    uint64_t length = source.left;
    good = integer(tag, big) == TYPE_COMPRESSED ? check_compressed(&source)
                                                : check_matrix(&source, length, 0);
    if (!good) {
      status = dea_fail(ctx, DEA_E_IO,
                        "'%s' is damaged: the variable at byte %llu is not what it says it is",
                        file, (unsigned long long)at);
    }
    at += TAG_SIZE + length;
  }
  if (stream != NULL) {
    fclose(stream);
  }
  return status;
}
