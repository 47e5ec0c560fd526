/* From a column's numbers to SI. */
#pragma once

#include "import/mapping.h"

/* What a mapping says of a column's numbers; members may be NULL. */
struct dea_scale_text {
  const struct dea_label *unit, *per_unit, *at_zero;
};

/* SI value = value * factor + offset, from the column's unit and what the mapping says. si: the
 * unit due, "": none in particular. Errors are findings at the mapping's values, or at `place` for
 * the file's unit; *good false then. */
dea_status dea_scale_find(struct dea_context *ctx, const struct dea_table_column *column,
                          const char *si, const struct dea_scale_text *text,
                          struct dea_location location, double *factor, double *offset, bool *good);
