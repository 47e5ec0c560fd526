/* Inside of the reader of TDMS: what a file's segments say of its objects.
 *
 * A file is a row of segments: a lead-in of 28 bytes, metadata (what objects there are, where their
 * values lie, their properties), raw values. What a segment does not say stays as the one before
 * said it. Source: NI, "TDMS File Format Internal Structure". */
#pragma once

#include "import/import.h"

#include <stdint.h>

enum {
  DEA_TDMS_OBJECTS_MAX = 4096,
  DEA_TDMS_METADATA = 1 << 1, // bits of a lead-in's table of contents
  DEA_TDMS_NEW_LIST = 1 << 2,
  DEA_TDMS_RAW = 1 << 3,
  DEA_TDMS_INTERLEAVED = 1 << 5,
  DEA_TDMS_BIG_ENDIAN = 1 << 6,
  DEA_TDMS_DAQMX = 1 << 7,
};

/* Types of values. */
enum {
  DEA_TDMS_I8 = 1,
  DEA_TDMS_I16,
  DEA_TDMS_I32,
  DEA_TDMS_I64,
  DEA_TDMS_U8,
  DEA_TDMS_U16,
  DEA_TDMS_U32,
  DEA_TDMS_U64,
  DEA_TDMS_F32,
  DEA_TDMS_F64,
  DEA_TDMS_F32_UNIT = 0x19,
  DEA_TDMS_F64_UNIT = 0x1a,
  DEA_TDMS_TEXT = 0x20,
  DEA_TDMS_BOOL = 0x21,
  DEA_TDMS_TIME = 0x44,
};

/* A piece of the file that is being read: nothing is taken beyond `end`. */
struct dea_tdms_bytes {
  const unsigned char *start, *next, *end; // start: of the file
  uint64_t file_size;
  bool big;    // endian
  bool failed; // more was asked for than there is
};

struct dea_tdms_text {
  const char *text; // in the file's bytes
  size_t length;
};

/* "/'group'/'channel'" */
struct dea_tdms_object {
  struct dea_tdms_text path, unit;
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
  size_t column, filled;  // of the table
};

struct dea_tdms {
  struct dea_context *ctx;
  const char *file;
  struct dea_tdms_object *objects; // owned
  size_t count, capacity;
  size_t *order, order_count, order_room; // objects of the segment with values; owned
};

/* Bytes of a value of this type, 0 when it is none of fixed length. */
size_t dea_tdms_size(uint32_t type);
uint32_t dea_tdms_u32(struct dea_tdms_bytes *bytes);
uint64_t dea_tdms_u64(struct dea_tdms_bytes *bytes);
/* A value as double; time in seconds since 1904. */
double dea_tdms_value(const unsigned char *at, uint32_t type, bool big);

/* Whether an object's values are raw, and slope and intercept make of them what is meant. */
bool dea_tdms_is_linear(const struct dea_tdms_object *object);
/* Reads a segment's metadata: objects, where their values are, and properties. Errors are findings
 * with the byte, DEA_E_IO. */
dea_status dea_tdms_metadata(struct dea_tdms *tdms, struct dea_tdms_bytes *bytes, bool new_list);
