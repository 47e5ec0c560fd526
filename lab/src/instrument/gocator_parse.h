/* What Gocator line profile sensors (LMI Technologies) send: the data stream "GDP" (TCP 3196),
 * little-endian messages of
 *     size u32 (with itself), control u16 (bit 15: last of its group, bits 0-14: type), content.
 * Type 1, stamps: count u32, size of one u16, source u8, reserved u8; each: frame index u64,
 *   time [us] u64, and what is not read here.
 * Type 6, uniform (resampled) profile, and 5, profile points: size of the attributes u16, then
 *   these: count u32, width u32, x scale [nm] u32, z scale [nm] u32, x offset [um] i32,
 *   z offset [um] i32, source u8, ...; then count x width ranges i16 (type 5: pairs x, z), where
 *   -32768 is no point.
 * Type 10, measurement: count u32, reserved u16, id u16; each: value [1/1000 of its unit] i32,
 *   decision u8 (bits 1-7: 0 valid), reserved 3 x u8.
 * Source: "Gocator Line Profile Sensors: User Manual", chapter "Data Results". Order and size of
 * the fields, the types' numbers and INT32_MIN for no measurement are those of the manufacturer's
 * GoSdk (Messages/GoDataTypes.c), too. That -32768 is the missing point is in the sensor's
 * published examples; that the x of a point cloud has it too, and that several profiles of one
 * message belong to as many stamps, is concluded, not published. Type 31 (measurements of several
 * parts) is passed over. Not tried with a sensor. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
  DEA_GDP_MESSAGE_MAX = 256 * 1024,       // bytes of a message that is read
  DEA_GDP_SKIPPED_MAX = 64 * 1024 * 1024, // of one that is passed over
  DEA_GDP_STAMPS_MAX = 64,
  DEA_GDP_NO_POINT = -32768,
};

enum dea_gdp_event {
  DEA_GDP_MORE,        // all bytes are taken
  DEA_GDP_STAMPS,      // stamps[stamp_count] are new
  DEA_GDP_PROFILES,    // profiles are new
  DEA_GDP_MEASUREMENT, // measurement is new
  DEA_GDP_ODD,         // a message that contradicts itself was passed over
  DEA_GDP_BROKEN,      // no message can begin like that; nothing after it can be read
};

struct dea_gdp_stamp {
  uint64_t frame, time_us;
};

/* x = x_offset_m + i x_scale_m of a uniform profile; see dea_gdp_point. */
struct dea_gdp_profiles {
  size_t count, width;
  double x_offset_m, x_scale_m, z_offset_m, z_scale_m;
  unsigned source;
  bool uniform;
  const unsigned char *ranges; // in the reader; until its next event
};

struct dea_gdp_measurement {
  unsigned id;
  int32_t thousandths;
  bool valid;
};

/* Zero-initialise. */
struct dea_gdp {
  struct dea_gdp_stamp stamps[DEA_GDP_STAMPS_MAX];
  size_t stamp_count; // of the group; 0 after its last message
  struct dea_gdp_profiles profiles;
  struct dea_gdp_measurement measurement;
  /* Its own. */
  size_t length, skip;
  bool group_ended;
  unsigned char message[DEA_GDP_MESSAGE_MAX];
};

/* Takes bytes, moving *bytes and *length on, up to the next event. */
enum dea_gdp_event dea_gdp_next(struct dea_gdp *reader, const unsigned char **bytes,
                                size_t *length);
/* Point i < width of profile k < count; false where there is none. */
bool dea_gdp_point(const struct dea_gdp_profiles *profiles, size_t k, size_t i, double *x_m,
                   double *z_m);

/* A command of the control connection (TCP 3190): length u32, id u16. Reply: length u32, the same
 * id, status i32 (1: good, -1000: not in this state). */
enum { DEA_GOCATOR_START = 0x100D, DEA_GOCATOR_STOP = 0x1001, DEA_GOCATOR_COMMAND_SIZE = 6 };
void dea_gocator_command(unsigned id, unsigned char out[DEA_GOCATOR_COMMAND_SIZE]);
/* Status of the reply to a command that is first in bytes[length]; false: not there whole. Replies
 * to others before it are passed over. */
bool dea_gocator_reply(const unsigned char *bytes, size_t length, unsigned id, int32_t *status);
