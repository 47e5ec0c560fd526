/* Reading of design files with sections that others own. Everyone above the studies reads with
 * study/design_file.h, which knows theirs. */
#pragma once

#include "design/design.h"

/* Reads and checks a file. All findings go to the context with file:line:column; any error gives
 * DEA_E_DESIGN (DEA_E_IO when the file cannot be read at all) after the whole file was looked at.
 * sections: lent, at most DEA_DESIGN_SECTIONS_MAX; static storage. out: owned by the caller, NULL
 * on failure. */
dea_status dea_design_read_with(struct dea_context *ctx, const struct dea_design_sections *sections,
                                const char *file, const struct dea_override *overrides,
                                size_t override_count, struct dea_design **out);
/* The same from memory; name stands for the file in messages. */
dea_status dea_design_read_memory_with(struct dea_context *ctx,
                                       const struct dea_design_sections *sections, const char *name,
                                       const char *bytes, size_t length,
                                       const struct dea_override *overrides, size_t override_count,
                                       struct dea_design **out);
