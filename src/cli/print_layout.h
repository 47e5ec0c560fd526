/* What `dea check` says of any device. */
#pragma once

#include "base/text.h"
#include "device/layout.h"

#include <jansson.h>

/* A row "  name  text", wrapped, to the standard output; none without text. The text is freed.
 * DEA_E_MEMORY. */
dea_status cli_row_print(const char *name, size_t length, struct dea_text *text);
/* Plies from bottom to top as they are stretched, areas of shapes, channels, and the symmetry that
 * was found, to the standard output. DEA_E_MEMORY. */
dea_status cli_layout_print(struct dea_context *ctx, const struct dea_layout *layout);
/* The same as an object. */
json_t *cli_layout_json(const struct dea_layout *layout);
