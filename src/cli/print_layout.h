/* What `dea check` tells of a device of parts. */
#ifndef DEA_CLI_PRINT_LAYOUT_H
#define DEA_CLI_PRINT_LAYOUT_H

#include "device/layout.h"

#include <jansson.h>

/* Areas of shapes, plies, channels, and the symmetry that was found, to the standard output. */
void cli_layout_print(const struct dea_layout *layout);
/* The same as an object. */
json_t *cli_layout_json(const struct dea_layout *layout);

#endif
