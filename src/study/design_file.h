/* Reading of design files with the sections of all studies. */
#pragma once

#include "design/design_schema.h"

/* Reads and checks a file. All findings go to the context with file:line:column; any error gives
 * DEA_E_DESIGN (DEA_E_IO when the file cannot be read at all) after the whole file was looked at.
 * out: owned by the caller, NULL on failure. */
dea_status dea_design_read(struct dea_context *ctx, const char *file,
                           const struct dea_override *overrides, size_t override_count,
                           struct dea_design **out);
/* The same from memory; name stands for the file in messages. */
dea_status dea_design_read_memory(struct dea_context *ctx, const char *name, const char *bytes,
                                  size_t length, const struct dea_override *overrides,
                                  size_t override_count, struct dea_design **out);
/* The table of a design file with the keys of all studies. */
void dea_design_file_schema(struct dea_design_schema *out);
