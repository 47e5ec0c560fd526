#include "cli/cli.h"

static int run(struct dea_cli *cli, int argc, char **argv)
{
  (void)argc;
  (void)argv;
  return cli_usage_error(cli, &cmd_compare, "not built yet");
}

const struct dea_command cmd_compare = {
    .name = "compare",
    .summary = "",
    .usage = "dea compare\n",
    .run = run,
};
