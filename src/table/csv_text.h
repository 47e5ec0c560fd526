/* CSV and its relatives: lines of numbers with any separator, whatever stands above them. */
#pragma once

#include "table/imported_table.h"

/* The table of a text (text_file.h): where its numbers begin, what parts them, titles and units
 * from the lines above them. Errors are findings with line and column, DEA_E_IO then. */
dea_status dea_table_read_text(struct dea_context *ctx, struct dea_slice text,
                               struct dea_table *out);
