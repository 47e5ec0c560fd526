/* Single values of a schema: what schema.c and kinds read sections with. Not for others. */
#pragma once

#include "base/schema.h"

enum { DEA_KEY_PATH_SIZE = 256 };

/* A value being read. text: as written, or the default. */
struct dea_schema_value {
  const struct dea_field *field;
  const char *text;
  struct dea_location location;
  enum dea_origin origin;
  const char *path;
};

/* Adds an error as a finding. */
dea_status dea_schema_error(const struct dea_reader *reader, struct dea_location location,
                            const char *format, ...) DEA_PRINTF(3, 4);
/* Reads one value into the member at target and lists it. */
dea_status dea_schema_value_read(const struct dea_reader *reader,
                                 const struct dea_schema_value *value, char *target);
/* Which of names[count] the section's key 'kind' says; *index = count after a finding. what: with
 * its article, for messages ("a waveform"). */
dea_status dea_schema_kind(const struct dea_reader *reader, const struct dea_node *node,
                           const char *what, const char *const names[], size_t count,
                           size_t *index);
/* Sets the member at target to what says "absent". */
void dea_schema_value_absent(const struct dea_field *field, char *target,
                             struct dea_location location);
