/* Drawing by a gnuplot process. */
#ifndef DEA_OUTPUT_GNUPLOT_H
#define DEA_OUTPUT_GNUPLOT_H

#include "base/context.h"

/* Runs `gnuplot -d` on NAME.gp of each name in directory; the pictures take their names only when
 * they are complete. DEA_E_TOOL when gnuplot is missing or fails (with what it said); the scripts
 * and their data stay. DEA_E_INTERRUPTED after an interruption. */
dea_status dea_gnuplot_draw(struct dea_context *ctx, const char *directory,
                            const char *const names[], size_t count);

#endif
