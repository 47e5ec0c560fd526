/* LabVIEW's binary measurements (.tdms).
 *
 * A file is a row of segments: a lead-in of 28 bytes, metadata (what objects there are, where their
 * values lie, their properties), raw values. What a segment does not say stays as the one before
 * said it. Source: NI, "TDMS File Format Internal Structure". */
#include "import/import.h"
#include "table/slices.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

enum {
  TDMS_OBJECTS_MAX = 4096,
  TDMS_METADATA = 1 << 1, // bits of a lead-in's table of contents
  TDMS_NEW_LIST = 1 << 2,
  TDMS_RAW = 1 << 3,
  TDMS_INTERLEAVED = 1 << 5,
  TDMS_BIG_ENDIAN = 1 << 6,
  TDMS_DAQMX = 1 << 7,
};

/* Types of values. */
enum {
  TDMS_I8 = 1,
  TDMS_I16,
  TDMS_I32,
  TDMS_I64,
  TDMS_U8,
  TDMS_U16,
  TDMS_U32,
  TDMS_U64,
  TDMS_F32,
  TDMS_F64,
  TDMS_F32_UNIT = 0x19,
  TDMS_F64_UNIT = 0x1a,
  TDMS_TEXT = 0x20,
  TDMS_BOOL = 0x21,
  TDMS_TIME = 0x44,
};

/* A piece of the file that is being read: nothing is taken beyond `end`. */
struct bytes {
  const unsigned char *start, *next, *end; // start: of the file
  uint64_t file_size;
  bool big;    // endian
  bool failed; // more was asked for than there is
};

/* "/'group'/'channel'" */
struct object {
  struct dea_slice path, unit;
  double increment, start_offset; // of its waveform; NAN, 0
  double start_time;              // that this counts from, since 1904; NAN
  double scales;                  // that turn raw values into what is meant; 0: none
  bool applied;                   // values are that already
  bool linear;                    // the first one is value * slope + intercept
  double slope, intercept;
  uint32_t type;          // of its values, 0: none yet
  uint64_t values, bytes; // in a chunk of the segment
  bool in_segment;        // has values in it
  size_t total;           // values of all segments
  size_t column;          // of the table
};

struct tdms {
  struct dea_context *ctx;
  const char *file;
  size_t count, order_count;
  struct object objects[TDMS_OBJECTS_MAX]; // [count]
  size_t order[TDMS_OBJECTS_MAX];          // objects of the segment with values
};

// Metadata ---------------------------------------------------------------------------------------

static const uint32_t no_values = 0xffffffff, same_values = 0;
// "format changing scaler" and "digital line scaler"; the second has been seen with both codes
static const uint32_t daqmx_scaler = 0x1269, daqmx_line = 0x126a, daqmx_other_line = 0x1369;

/* Bytes of a value of this type, 0 when it is none of fixed length. */
static size_t size_of(uint32_t type)
{
  switch (type) {
  case TDMS_I8:
  case TDMS_U8:
  case TDMS_BOOL:
    return 1;
  case TDMS_I16:
  case TDMS_U16:
    return 2;
  case TDMS_I32:
  case TDMS_U32:
  case TDMS_F32:
  case TDMS_F32_UNIT:
    return 4;
  case TDMS_I64:
  case TDMS_U64:
  case TDMS_F64:
  case TDMS_F64_UNIT:
    return 8;
  case TDMS_TIME:
    return 16;
  default:
    return 0;
  }
}

static uint64_t integer(const unsigned char *at, size_t size, bool big)
{
  uint64_t value = 0;
  for (size_t i = 0; i < size; i++) {
    value = value << 8 | at[big ? i : size - 1 - i];
  }
  return value;
}

/* Takes `size` bytes; NULL when there are less. */
static const unsigned char *read_bytes(struct bytes *bytes, uint64_t size)
{
  if (bytes->failed || size > (uint64_t)(bytes->end - bytes->next)) {
    bytes->failed = true;
    return NULL;
  }
  const unsigned char *at = bytes->next;
  bytes->next += size;
  return at;
}

static uint32_t read_u32(struct bytes *bytes)
{
  const unsigned char *at = read_bytes(bytes, 4);
  return at != NULL ? (uint32_t)integer(at, 4, bytes->big) : 0;
}

static uint64_t read_u64(struct bytes *bytes)
{
  const unsigned char *at = read_bytes(bytes, 8);
  return at != NULL ? integer(at, 8, bytes->big) : 0;
}

/* Two's complement of `size` bytes. */
static double signed_value(uint64_t bits, size_t size)
{
  uint64_t sign = (uint64_t)1 << (8 * size - 1);
  if ((bits & sign) == 0) {
    return (double)bits;
  }
  uint64_t mask = size == 8 ? UINT64_MAX : ((uint64_t)1 << (8 * size)) - 1;
  return -(double)((~bits & mask) + 1);
}

/* A value as double; time in seconds since 1904. */
static double value_at(const unsigned char *at, uint32_t type, bool big)
{
  size_t size = size_of(type);
  uint64_t bits = size <= 8 ? integer(at, size, big) : 0;
  uint32_t low = (uint32_t)bits;
  float single;
  double real;
  switch (type) {
  case TDMS_I8:
  case TDMS_I16:
  case TDMS_I32:
  case TDMS_I64:
    return signed_value(bits, size);
  case TDMS_F32:
  case TDMS_F32_UNIT:
    memcpy(&single, &low, sizeof single);
    return single;
  case TDMS_F64:
  case TDMS_F64_UNIT:
    memcpy(&real, &bits, sizeof real);
    return real;
  case TDMS_TIME: // fractions of 2^-64 s and seconds, as one number of 128 bits
    real = signed_value(integer(at + (big ? 0 : 8), 8, big), 8);
    return real + ldexp((double)integer(at + (big ? 8 : 0), 8, big), -64);
  default:
    return (double)bits;
  }
}

static struct dea_slice read_text(struct bytes *bytes)
{
  uint32_t length = read_u32(bytes);
  const unsigned char *at = read_bytes(bytes, length);
  return (struct dea_slice){at != NULL ? (const char *)at : "", at != NULL ? length : 0};
}

static size_t position(const struct bytes *bytes)
{
  return (size_t)(bytes->next - bytes->start);
}

static dea_status refuse(struct tdms *tdms, size_t byte, const char *what)
{
  return dea_fail(tdms->ctx, DEA_E_IO, "'%s' is damaged at byte %zu: %s", tdms->file, byte, what);
}

/* The object of a path, added when it is new; *out its index. */
static dea_status find_object(struct tdms *tdms, struct dea_slice path, size_t *out)
{
  for (*out = 0; *out < tdms->count; ++*out) {
    if (dea_slice_same(tdms->objects[*out].path, path)) {
      return DEA_OK;
    }
  }
  if (tdms->count == TDMS_OBJECTS_MAX) {
    return dea_fail(tdms->ctx, DEA_E_IO, "'%s' has more than %d channels", tdms->file,
                    (int)TDMS_OBJECTS_MAX);
  }
  tdms->objects[tdms->count++] = (struct object){.path = path,
                                                 .unit = {"", 0},
                                                 .increment = NAN,
                                                 .start_time = NAN,
                                                 .slope = NAN,
                                                 .intercept = 0};
  return DEA_OK;
}

/* Puts an object among those with values in this segment, once. */
static void add_to_order(struct tdms *tdms, size_t object)
{
  if (!tdms->objects[object].in_segment) {
    tdms->objects[object].in_segment = true;
    tdms->order[tdms->order_count++] = object;
  }
}

static void read_from_order(struct tdms *tdms, size_t object)
{
  size_t kept = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    if (tdms->order[i] != object) {
      tdms->order[kept++] = tdms->order[i];
    }
  }
  tdms->order_count = kept;
  tdms->objects[object].in_segment = false;
}

/* Type and number of an object's values in this segment. */
static dea_status read_index(struct tdms *tdms, struct bytes *bytes, size_t index, uint32_t length)
{
  struct object *object = &tdms->objects[index];
  if (length == no_values) {
    read_from_order(tdms, index);
    return DEA_OK;
  }
  if (length == daqmx_scaler || length == daqmx_line || length == daqmx_other_line) {
    return dea_fail(tdms->ctx, DEA_E_IO,
                    "'%s' holds DAQmx raw data: open it in LabVIEW or DIAdem and save it as TDMS "
                    "with scaled values, or as CSV",
                    tdms->file);
  }
  if (length == same_values) {
    add_to_order(tdms, index);
    return object->type != 0 ? DEA_OK
                             : refuse(tdms, position(bytes), "values 'as before' of a new channel");
  }
  uint32_t type = read_u32(bytes), dimension = read_u32(bytes);
  uint64_t values = read_u64(bytes);
  size_t size = size_of(type);
  uint64_t total = type == TDMS_TEXT ? read_u64(bytes) : 0;
  if (bytes->failed) {
    return DEA_OK;
  }
  if (dimension != 1) {
    return refuse(tdms, position(bytes), "a channel of more than one dimension");
  }
  if (size == 0 && type != TDMS_TEXT) {
    return dea_fail(tdms->ctx, DEA_E_IO,
                    "'%s': the channel %.*s has values of type 0x%x, which are not read",
                    tdms->file, (int)(object->path.length < 80 ? object->path.length : 80),
                    object->path.text, type);
  }
  if (object->type != 0 && object->type != type) {
    return refuse(tdms, position(bytes), "the type of a channel changes");
  }
  // what is larger than the file cannot be there
  if ((size > 0 && values > bytes->file_size / size) || total > bytes->file_size) {
    return refuse(tdms, position(bytes), "a channel has more values than the file has bytes");
  }
  object->type = type;
  object->values = values;
  object->bytes = size > 0 ? values * size : total;
  add_to_order(tdms, index);
  return DEA_OK;
}

/* Whether an object's values are raw, and slope and intercept make of them what is meant. */
static bool is_linear(const struct object *object)
{
  return !object->applied && object->scales == 1 && object->linear && isfinite(object->slope) &&
         isfinite(object->intercept);
}

/* What NI writes of the scale of raw values. */
static void read_scale(struct object *object, struct dea_slice name, struct dea_slice text,
                       double value)
{
  if (dea_slice_is(name, "NI_Number_Of_Scales") && value > 0) {
    object->scales = value;
  } else if (dea_slice_is(name, "NI_Scaling_Status")) {
    object->applied = dea_slice_is(text, "scaled");
  } else if (dea_slice_is(name, "NI_Scale[0]_Scale_Type")) {
    object->linear = dea_slice_is(text, "Linear");
  } else if (dea_slice_is(name, "NI_Scale[0]_Linear_Slope")) {
    object->slope = value;
  } else if (dea_slice_is(name, "NI_Scale[0]_Linear_Y_Intercept")) {
    object->intercept = value;
  }
}

static void read_property(struct bytes *bytes, struct object *object)
{
  struct dea_slice name = read_text(bytes), text = {"", 0};
  uint32_t type = read_u32(bytes);
  double value = NAN;
  if (type == TDMS_TEXT) {
    text = read_text(bytes);
  } else {
    size_t size = size_of(type);
    const unsigned char *at = size > 0 ? read_bytes(bytes, size) : NULL;
    value = at != NULL ? value_at(at, type, bytes->big) : NAN;
    bytes->failed = bytes->failed || at == NULL;
  }
  if (dea_slice_is(name, "wf_increment") && value > 0) {
    object->increment = value;
  } else if (dea_slice_is(name, "wf_start_time") && value > 0 && isnan(object->start_time)) {
    object->start_time = value; // of its first values: what is appended may write it again
  } else if (dea_slice_is(name, "wf_start_offset") && isfinite(value)) {
    object->start_offset = value;
  } else if ((dea_slice_is(name, "unit_string") || dea_slice_is(name, "NI_UnitDescription")) &&
             text.length > 0) {
    object->unit = text;
  } else {
    read_scale(object, name, text, value);
  }
}

/* Reads a segment's metadata: objects, where their values are, and properties. Errors are findings
 * with the byte, DEA_E_IO. */
static dea_status read_metadata(struct tdms *tdms, struct bytes *bytes, bool new_list)
{
  if (new_list) {
    for (size_t i = 0; i < tdms->order_count; i++) {
      tdms->objects[tdms->order[i]].in_segment = false;
    }
    tdms->order_count = 0;
  }
  uint32_t count = read_u32(bytes);
  for (uint32_t i = 0; i < count && !bytes->failed; i++) {
    struct dea_slice path = read_text(bytes);
    uint32_t length = read_u32(bytes);
    size_t index;
    if (bytes->failed) {
      break;
    }
    DEA_TRY(tdms->ctx, find_object(tdms, path, &index));
    DEA_TRY(tdms->ctx, read_index(tdms, bytes, index, length));
    uint32_t properties = read_u32(bytes);
    for (uint32_t k = 0; k < properties && !bytes->failed; k++) {
      read_property(bytes, &tdms->objects[index]);
    }
  }
  return bytes->failed ? refuse(tdms, position(bytes),
                                "its metadata end early, or hold a property of an "
                                "unknown type")
                       : DEA_OK;
}

// Segments ---------------------------------------------------------------------------------------

enum { LEAD_IN = 28, NAME_SIZE = 512 };

static bool recognise(const char *file, const unsigned char *head, size_t length)
{
  (void)file;
  return length >= 4 && memcmp(head, "TDSm", 4) == 0;
}

/* One segment's lead-in, and where its parts lie. */
struct segment {
  uint32_t contents;
  const unsigned char *metadata, *raw, *end;
  bool open; // its program was ended before it wrote how long it is
};

/* The lead-in at `at`, of which there are enough bytes. */
static dea_status read_lead_in(struct tdms *tdms, const unsigned char *start,
                               const unsigned char *at, const unsigned char *end,
                               struct segment *out)
{
  struct bytes bytes = {start, at + 4, end, (uint64_t)(end - start), false, false};
  size_t place = (size_t)(at - start);
  if (memcmp(at, "TDSm", 4) != 0) {
    return refuse(tdms, place,
                  memcmp(at, "TDSh", 4) == 0 ? "it is an index file; give the .tdms file itself"
                                             : "no segment begins here");
  }
  out->contents = read_u32(&bytes);
  bytes.big = (out->contents & TDMS_BIG_ENDIAN) != 0;
  read_u32(&bytes); // version: 4712 and 4713 have one layout
  uint64_t length = read_u64(&bytes), raw = read_u64(&bytes);
  uint64_t left = (uint64_t)(end - at) - LEAD_IN;
  out->open = length == UINT64_MAX;
  if (!out->open && length > left) { // cut off: what there is of it is read
    out->open = true;
  }
  length = out->open ? left : length;
  if (raw > length) {
    return refuse(tdms, place, "the values of a segment begin behind its end");
  }
  if ((out->contents & TDMS_DAQMX) != 0 && (out->contents & TDMS_RAW) != 0) {
    return dea_fail(tdms->ctx, DEA_E_IO,
                    "'%s' holds DAQmx raw data: open it in LabVIEW or DIAdem and save it as TDMS "
                    "with scaled values, or as CSV",
                    tdms->file);
  }
  out->metadata = at + LEAD_IN;
  out->raw = out->metadata + raw;
  out->end = out->metadata + length;
  return DEA_OK;
}

/* Bytes of one chunk of the segment's values. */
static uint64_t chunk_bytes(const struct tdms *tdms)
{
  uint64_t sum = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    sum += tdms->objects[tdms->order[i]].bytes; // each at most the file's, of a few thousand
  }
  return sum;
}

/* Adds `count` values that lie `stride` bytes apart, or only counts them. */
static void add_values(struct object *object, struct dea_table *table, const unsigned char *at,
                       size_t stride, size_t count, bool big)
{
  if (table == NULL) {
    object->total += count;
    return;
  }
  if (object->column == SIZE_MAX) {
    return;
  }
  struct dea_table_column *column = &table->columns[object->column];
  for (size_t i = 0; i < count && column->count < object->total; i++) {
    column->values[column->count++] = value_at(at + i * stride, object->type, big);
  }
}

/* Whether `left` of the bytes of a chunk are the same share of each channel, in whole values. */
static bool is_even(const struct tdms *tdms, uint64_t left, uint64_t chunk)
{
  bool even = true;
  for (size_t i = 0; i < tdms->order_count; i++) {
    const struct object *object = &tdms->objects[tdms->order[i]];
    bool numbers = size_of(object->type) > 0;
    even = even && numbers && object->values * left % chunk == 0; // both below 2^32
  }
  return even;
}

/* Values one after the other, channel by channel. Of a chunk that is shorter LabVIEW writes the
 * same share of each channel (`even`); where a program was ended the last channels are missing. */
static void read_chunk(struct tdms *tdms, struct dea_table *table, const unsigned char *at,
                       uint64_t left, uint64_t chunk, bool even, bool big)
{
  uint64_t there = left;
  for (size_t i = 0; i < tdms->order_count; i++) {
    struct object *object = &tdms->objects[tdms->order[i]];
    uint64_t bytes = even ? object->bytes * there / chunk : object->bytes;
    bytes = bytes < left ? bytes : left;
    size_t size = size_of(object->type);
    if (size > 0) {
      add_values(object, table, at, size, (size_t)bytes / size, big);
    }
    at += bytes;
    left -= bytes;
  }
}

/* Says that what was not closed, or does not end with a whole chunk, is read as far as it goes. */
static dea_status report_cut(struct tdms *tdms, size_t byte, const char *why)
{
  const struct dea_location location = {.file = tdms->file};
  return dea_finding_add(tdms->ctx, DEA_WARNING, location,
                         "%s segment, from byte %zu on, is read as far as it goes", why, byte);
}

/* A sample of each channel in turn. */
static dea_status read_interleaved(struct tdms *tdms, struct dea_table *table,
                                   const unsigned char *at, uint64_t left, bool big)
{
  size_t stride = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    size_t size = size_of(tdms->objects[tdms->order[i]].type);
    if (size == 0) {
      return dea_fail(tdms->ctx, DEA_E_IO, "'%s' interleaves text with numbers, which is not read",
                      tdms->file);
    }
    stride += size;
  }
  size_t count = stride > 0 ? (size_t)left / stride : 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    struct object *object = &tdms->objects[tdms->order[i]];
    add_values(object, table, at, stride, count, big);
    at += size_of(object->type);
  }
  return DEA_OK;
}

static dea_status read_raw(struct tdms *tdms, struct dea_table *table, size_t position,
                           const struct segment *segment)
{
  bool big = (segment->contents & TDMS_BIG_ENDIAN) != 0;
  uint64_t left = (uint64_t)(segment->end - segment->raw), chunk = chunk_bytes(tdms);
  if ((segment->contents & TDMS_RAW) == 0 || chunk == 0) {
    return DEA_OK;
  }
  if ((segment->contents & TDMS_INTERLEAVED) != 0) {
    return read_interleaved(tdms, table, segment->raw, left, big);
  }
  for (const unsigned char *at = segment->raw; left > 0;) {
    uint64_t now = chunk < left ? chunk : left;
    bool even = now == chunk || (!segment->open && is_even(tdms, now, chunk));
    if (!even && !segment->open && table == NULL) {
      DEA_TRY(tdms->ctx,
              report_cut(tdms, position, "the values end within a row of channels: the"));
    }
    read_chunk(tdms, table, at, now, chunk, even, big);
    at += now;
    left -= now;
  }
  return DEA_OK;
}

/* All segments: counts values (table NULL), or takes them into the table's columns. */
static dea_status read_segments(struct tdms *tdms, const unsigned char *start, size_t length,
                                struct dea_table *table)
{
  const unsigned char *end = start + length, *at = start;
  tdms->order_count = 0;
  for (size_t i = 0; i < tdms->count; i++) {
    tdms->objects[i].in_segment = false;
  }
  while (end - at >= LEAD_IN) {
    struct segment segment = {0};
    DEA_TRY(tdms->ctx, read_lead_in(tdms, start, at, end, &segment));
    if ((segment.contents & TDMS_METADATA) != 0) {
      struct bytes bytes = {
          start, segment.metadata, segment.raw, length, (segment.contents & TDMS_BIG_ENDIAN) != 0,
          false};
      bool new_list = (segment.contents & TDMS_NEW_LIST) != 0 || at == start;
      DEA_TRY(tdms->ctx, read_metadata(tdms, &bytes, new_list));
    }
    DEA_TRY(tdms->ctx, read_raw(tdms, table, (size_t)(at - start), &segment));
    if (segment.open && table == NULL) {
      DEA_TRY(tdms->ctx,
              report_cut(tdms, (size_t)(at - start), "the file was not closed: its last"));
    }
    at = segment.end;
  }
  return DEA_OK;
}

/* A part of a path, "/'group'/'channel'", its quotes undone ('' is one); *next behind it. */
static size_t path_part(struct dea_slice path, size_t *next, char out[NAME_SIZE])
{
  size_t n = 0, i = *next;
  if (i + 1 < path.length && path.text[i] == '/' && path.text[i + 1] == '\'') {
    for (i += 2; i < path.length; i++) {
      if (path.text[i] == '\'') {
        i++;
        if (i >= path.length || path.text[i] != '\'') {
          break;
        }
      }
      if (n < NAME_SIZE - 1) {
        out[n++] = path.text[i];
      }
    }
  }
  out[n] = '\0';
  *next = i;
  return n;
}

/* Whether channels with values are in more than one group. */
static bool many_groups(const struct tdms *tdms)
{
  char first[NAME_SIZE] = "", group[NAME_SIZE];
  for (size_t i = 0; i < tdms->count; i++) {
    size_t next = 0;
    if (tdms->objects[i].total > 0) {
      path_part(tdms->objects[i].path, &next, group);
      if (first[0] != '\0' && strcmp(first, group) != 0) {
        return true;
      }
      memcpy(first, group, sizeof first);
    }
  }
  return false;
}

/* When the first waveform of the file begins; INFINITY: none says so. */
static double first_start(const struct tdms *tdms)
{
  double first = INFINITY;
  for (size_t i = 0; i < tdms->count; i++) {
    const struct object *object = &tdms->objects[i];
    if (object->total > 0 && object->increment > 0) {
      first = fmin(first, object->start_time); // not NAN
    }
  }
  return first;
}

/* Waveforms of several devices count from moments of their own. */
static dea_status set_clock(struct tdms *tdms, const struct object *object, double first,
                            struct dea_table_column *column)
{
  const struct dea_location location = {.file = tdms->file};
  const double later_s = isnan(object->start_time) ? 0 : object->start_time - first;
  column->start = object->start_offset;
  column->interval = object->increment;
  if (!(object->increment > 0) || later_s == 0) {
    return DEA_OK;
  }
  column->start += later_s;
  return dea_finding_add(tdms->ctx, DEA_NOTE, location,
                         "'%.60s' begins %.9g s after the first channel of the file", column->name,
                         later_s);
}

static dea_status add_columns(struct tdms *tdms, struct dea_table *table)
{
  bool groups = many_groups(tdms);
  double first = first_start(tdms);
  for (size_t i = 0; i < tdms->count; i++) {
    struct object *object = &tdms->objects[i];
    char group[NAME_SIZE], channel[NAME_SIZE], name[2 * NAME_SIZE + 2];
    size_t next = 0;
    object->column = SIZE_MAX;
    if (object->total == 0) {
      continue;
    }
    path_part(object->path, &next, group);
    path_part(object->path, &next, channel);
    snprintf(name, sizeof name, "%s%s%s", groups ? group : "", groups ? "/" : "", channel);
    object->column = table->column_count;
    struct dea_table_column *column =
        dea_table_add(tdms->ctx, table, name, strlen(name), object->unit.text, object->unit.length,
                      object->total);
    if (column == NULL) {
      return dea_context_status(tdms->ctx);
    }
    DEA_TRY(tdms->ctx, set_clock(tdms, object, first, column));
    const struct dea_location location = {.file = tdms->file};
    if (is_linear(object)) {
      DEA_TRY(tdms->ctx,
              dea_finding_add(tdms->ctx, DEA_NOTE, location,
                              "'%.60s' has raw values, which become raw x %.9g + %.9g as "
                              "the file says",
                              name, object->slope, object->intercept));
    } else if (object->scales > 0 && !object->applied) {
      DEA_TRY(tdms->ctx, dea_finding_add(tdms->ctx, DEA_WARNING, location,
                                         "'%.60s' has raw values with a scale that is not applied: "
                                         "say per_unit and at_zero in a mapping",
                                         name));
    }
    if (object->type == TDMS_TIME) {
      DEA_TRY(tdms->ctx,
              dea_finding_add(tdms->ctx, DEA_NOTE, location,
                              "'%.60s' holds times of day: they become seconds after the "
                              "first one of the file",
                              name));
    }
  }
  return DEA_OK;
}

/* Applies the scales that the file gives. Times of day become seconds after the first of the file,
 * so that channels with times of their own stay where they are; as doubles since 1904 they end at
 * half a microsecond. */
static void finish_values(struct tdms *tdms, struct dea_table *table)
{
  double first = INFINITY;
  for (size_t i = 0; i < tdms->count; i++) {
    const struct object *object = &tdms->objects[i];
    if (object->type == TDMS_TIME && object->column != SIZE_MAX) {
      first = fmin(first, table->columns[object->column].values[0]); // there is one
    }
  }
  for (size_t i = 0; i < tdms->count; i++) {
    const struct object *object = &tdms->objects[i];
    const bool time = object->type == TDMS_TIME, linear = is_linear(object);
    if (object->column == SIZE_MAX || !(time || linear)) {
      continue;
    }
    struct dea_table_column *column = &table->columns[object->column];
    for (size_t k = 0; k < column->count; k++) {
      column->values[k] -= time ? first : 0;
      column->values[k] =
          linear ? column->values[k] * object->slope + object->intercept : column->values[k];
    }
    if (time) {
      column->origin_s = first;
      dea_free(tdms->ctx, column->unit);
      column->unit = dea_copy_text(tdms->ctx, "s", 1);
    }
  }
}

static dea_status read_tdms(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                            size_t length, struct dea_table *out)
{
  struct tdms *tdms = dea_alloc(ctx, 1, sizeof *tdms);
  DEA_TRY_MEMORY(tdms != NULL);
  tdms->ctx = ctx;
  tdms->file = file;
  dea_status status = read_segments(tdms, bytes, length, NULL);
  status = status == DEA_OK ? add_columns(tdms, out) : status;
  status = status == DEA_OK ? read_segments(tdms, bytes, length, out) : status;
  if (status == DEA_OK) {
    finish_values(tdms, out);
  }
  dea_free(ctx, tdms);
  return status;
}

const struct dea_importer dea_import_tdms = {
    .name = "tdms",
    .formats = "LabVIEW's binary measurements (.tdms)",
    .recognise = recognise,
    .read_bytes = read_tdms,
};
