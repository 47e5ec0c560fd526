#include "cli/cli.h"

static int run(struct dea_cli *cli, int argc, char **argv)
{
  (void)argc;
  (void)argv;
  return cli_usage_error(cli, &cmd_schema, "not built yet");
}

const struct dea_command cmd_schema = {
    .name = "schema",
    .summary = "",
    .usage = "dea schema\n",
    .run = run,
};
