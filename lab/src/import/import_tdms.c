/* LabVIEW's binary measurements (.tdms). */
#include "import/tdms.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

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

static dea_status refuse(struct dea_tdms *tdms, size_t byte, const char *what)
{
  return dea_fail(tdms->ctx, DEA_E_IO, "'%s' is damaged at byte %zu: %s", tdms->file, byte, what);
}

/* The lead-in at `at`, of which there are enough bytes. */
static dea_status read_lead_in(struct dea_tdms *tdms, const unsigned char *start,
                               const unsigned char *at, const unsigned char *end,
                               struct segment *out)
{
  struct dea_tdms_bytes bytes = {start, at + 4, end, (uint64_t)(end - start), false, false};
  size_t position = (size_t)(at - start);
  if (memcmp(at, "TDSm", 4) != 0) {
    return refuse(tdms, position,
                  memcmp(at, "TDSh", 4) == 0 ? "it is an index file; give the .tdms file itself"
                                             : "no segment begins here");
  }
  out->contents = dea_tdms_u32(&bytes);
  bytes.big = (out->contents & DEA_TDMS_BIG_ENDIAN) != 0;
  dea_tdms_u32(&bytes); // version: 4712 and 4713 have one layout
  uint64_t length = dea_tdms_u64(&bytes), raw = dea_tdms_u64(&bytes);
  uint64_t left = (uint64_t)(end - at) - LEAD_IN;
  out->open = length == UINT64_MAX;
  if (!out->open && length > left) { // cut off: what there is of it is read
    out->open = true;
  }
  length = out->open ? left : length;
  if (raw > length) {
    return refuse(tdms, position, "the values of a segment begin behind its end");
  }
  if ((out->contents & DEA_TDMS_DAQMX) != 0 && (out->contents & DEA_TDMS_RAW) != 0) {
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
static uint64_t chunk_bytes(const struct dea_tdms *tdms)
{
  uint64_t sum = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    sum += tdms->objects[tdms->order[i]].bytes; // each at most the file's, of a few thousand
  }
  return sum;
}

/* Adds `count` values that lie `stride` bytes apart, or only counts them. */
static void add_values(struct dea_tdms_object *object, struct dea_table *table,
                       const unsigned char *at, size_t stride, size_t count, bool big)
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
    column->values[column->count++] = dea_tdms_value(at + i * stride, object->type, big);
  }
}

/* Whether `left` of the bytes of a chunk are the same share of each channel, in whole values. */
static bool is_even(const struct dea_tdms *tdms, uint64_t left, uint64_t chunk)
{
  bool even = true;
  for (size_t i = 0; i < tdms->order_count; i++) {
    const struct dea_tdms_object *object = &tdms->objects[tdms->order[i]];
    bool numbers = dea_tdms_size(object->type) > 0;
    even = even && numbers && object->values * left % chunk == 0; // both below 2^32
  }
  return even;
}

/* Values one after the other, channel by channel. Of a chunk that is shorter LabVIEW writes the
 * same share of each channel (`even`); where a program was ended the last channels are missing. */
static void read_chunk(struct dea_tdms *tdms, struct dea_table *table, const unsigned char *at,
                       uint64_t left, uint64_t chunk, bool even, bool big)
{
  uint64_t there = left;
  for (size_t i = 0; i < tdms->order_count; i++) {
    struct dea_tdms_object *object = &tdms->objects[tdms->order[i]];
    uint64_t bytes = even ? object->bytes * there / chunk : object->bytes;
    bytes = bytes < left ? bytes : left;
    size_t size = dea_tdms_size(object->type);
    if (size > 0) {
      add_values(object, table, at, size, (size_t)bytes / size, big);
    }
    at += bytes;
    left -= bytes;
  }
}

/* Says that what was not closed, or does not end with a whole chunk, is read as far as it goes. */
static dea_status report_cut(struct dea_tdms *tdms, size_t byte, const char *why)
{
  const struct dea_location location = {.file = tdms->file};
  return dea_finding_add(tdms->ctx, DEA_WARNING, location,
                         "%s segment, from byte %zu on, is read as far as it goes", why, byte);
}

/* A sample of each channel in turn. */
static dea_status read_interleaved(struct dea_tdms *tdms, struct dea_table *table,
                                   const unsigned char *at, uint64_t left, bool big)
{
  size_t stride = 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    size_t size = dea_tdms_size(tdms->objects[tdms->order[i]].type);
    if (size == 0) {
      return dea_fail(tdms->ctx, DEA_E_IO, "'%s' interleaves text with numbers, which is not read",
                      tdms->file);
    }
    stride += size;
  }
  size_t count = stride > 0 ? (size_t)left / stride : 0;
  for (size_t i = 0; i < tdms->order_count; i++) {
    struct dea_tdms_object *object = &tdms->objects[tdms->order[i]];
    add_values(object, table, at, stride, count, big);
    at += dea_tdms_size(object->type);
  }
  return DEA_OK;
}

static dea_status read_raw(struct dea_tdms *tdms, struct dea_table *table, size_t position,
                           const struct segment *segment)
{
  bool big = (segment->contents & DEA_TDMS_BIG_ENDIAN) != 0;
  uint64_t left = (uint64_t)(segment->end - segment->raw), chunk = chunk_bytes(tdms);
  if ((segment->contents & DEA_TDMS_RAW) == 0 || chunk == 0) {
    return DEA_OK;
  }
  if ((segment->contents & DEA_TDMS_INTERLEAVED) != 0) {
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
static dea_status read_segments(struct dea_tdms *tdms, const unsigned char *start, size_t length,
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
    if ((segment.contents & DEA_TDMS_METADATA) != 0) {
      struct dea_tdms_bytes bytes = {start,
                                     segment.metadata,
                                     segment.raw,
                                     length,
                                     (segment.contents & DEA_TDMS_BIG_ENDIAN) != 0,
                                     false};
      bool new_list = (segment.contents & DEA_TDMS_NEW_LIST) != 0 || at == start;
      DEA_TRY(tdms->ctx, dea_tdms_metadata(tdms, &bytes, new_list));
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
static size_t path_part(struct dea_tdms_text path, size_t *next, char out[NAME_SIZE])
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
static bool many_groups(const struct dea_tdms *tdms)
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
static double first_start(const struct dea_tdms *tdms)
{
  double first = INFINITY;
  for (size_t i = 0; i < tdms->count; i++) {
    const struct dea_tdms_object *object = &tdms->objects[i];
    if (object->total > 0 && object->increment > 0) {
      first = fmin(first, object->start_time); // not NAN
    }
  }
  return first;
}

/* Waveforms of several devices count from moments of their own. */
static dea_status set_clock(struct dea_tdms *tdms, const struct dea_tdms_object *object,
                            double first, struct dea_table_column *column)
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

static dea_status add_columns(struct dea_tdms *tdms, struct dea_table *table)
{
  bool groups = many_groups(tdms);
  double first = first_start(tdms);
  for (size_t i = 0; i < tdms->count; i++) {
    struct dea_tdms_object *object = &tdms->objects[i];
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
    if (dea_tdms_is_linear(object)) {
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
    if (object->type == DEA_TDMS_TIME) {
      DEA_TRY(tdms->ctx,
              dea_finding_add(tdms->ctx, DEA_NOTE, location,
                              "'%.60s' holds times of day: they become seconds after the "
                              "first one of the file",
                              name));
    }
  }
  return DEA_OK;
}

/* Times of day as seconds after the first of the file, so that channels with times of their own
 * stay where they are; as doubles since 1904 they end at half a microsecond. */
static void relate_times(struct dea_tdms *tdms, struct dea_table *table)
{
  double first = INFINITY;
  for (size_t i = 0; i < tdms->count; i++) {
    const struct dea_tdms_object *object = &tdms->objects[i];
    if (object->type == DEA_TDMS_TIME && object->column != SIZE_MAX) {
      first = fmin(first, table->columns[object->column].values[0]); // there is one
    }
  }
  for (size_t i = 0; i < tdms->count; i++) {
    const struct dea_tdms_object *object = &tdms->objects[i];
    if (object->type == DEA_TDMS_TIME && object->column != SIZE_MAX) {
      struct dea_table_column *column = &table->columns[object->column];
      for (size_t k = 0; k < column->count; k++) {
        column->values[k] -= first;
      }
      column->origin_s = first;
      dea_free(tdms->ctx, column->unit);
      column->unit = dea_copy_text(tdms->ctx, "s", 1);
    }
  }
}

/* Applies the scales that the file gives. */
static void scale_values(const struct dea_tdms *tdms, struct dea_table *table)
{
  for (size_t i = 0; i < tdms->count; i++) {
    const struct dea_tdms_object *object = &tdms->objects[i];
    if (object->column != SIZE_MAX && dea_tdms_is_linear(object)) {
      struct dea_table_column *column = &table->columns[object->column];
      for (size_t k = 0; k < column->count; k++) {
        column->values[k] = column->values[k] * object->slope + object->intercept;
      }
    }
  }
}

static dea_status read_tdms(struct dea_context *ctx, const char *file, const unsigned char *bytes,
                            size_t length, struct dea_table *out)
{
  struct dea_tdms tdms = {.ctx = ctx, .file = file};
  dea_status status = read_segments(&tdms, bytes, length, NULL);
  status = status == DEA_OK ? add_columns(&tdms, out) : status;
  status = status == DEA_OK ? read_segments(&tdms, bytes, length, out) : status;
  if (status == DEA_OK) {
    relate_times(&tdms, out);
    scale_values(&tdms, out);
  }
  dea_free(ctx, tdms.objects);
  dea_free(ctx, tdms.order);
  return status;
}

const struct dea_importer dea_import_tdms = {
    .name = "tdms",
    .formats = "LabVIEW's binary measurements (.tdms)",
    .recognise = recognise,
    .read_bytes = read_tdms,
};
