/* Drawing by a gnuplot process. */
#pragma once

#include "base/context.h"

/* Runs `gnuplot -d` on NAME.gp of each name in directory; the pictures take their names only when
 * they are complete. DEA_E_TOOL when gnuplot is missing, fails (with what it said) or draws
 * nothing; the scripts and their data stay. DEA_E_INTERRUPTED after an interruption. */
dea_status dea_gnuplot_draw(struct dea_context *ctx, const char *directory,
                            const char *const names[], size_t count);

/* Before a folder is written to: removes with `force`, refuses without (DEA_E_IO), a file of that
 * name and all that a drawing of that name leaves: script, data, pictures. */
dea_status dea_gnuplot_create_folders(struct dea_context *ctx, const char *directory,
                                      const char *name, bool force);
