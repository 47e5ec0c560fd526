/* What the command asks of the bench, a component of its own (lab/): lab/src/cli/bench.c of the
 * program dea-lab, or no_bench.c of the program dea, as are cmd_drive, cmd_reduce, cmd_recording
 * and cmd_import. */
#pragma once

#include "base/schema.h"
#include "cli/cli.h"

/* Goes on as dea-lab where that is installed beside dea; comes back where it is not, or is that. */
void cli_bench_enter(char **argv);
/* Names, a line each. */
dea_status cli_bench_importers(struct dea_cli *cli, struct dea_text *out);
dea_status cli_bench_protocol_keys(struct dea_cli *cli, struct dea_text *out);
/* The keys of a protocol, or of a mapping of imported columns; freed by dea_free. */
dea_status cli_bench_schema(struct dea_context *ctx, bool protocol, struct dea_record **out);
