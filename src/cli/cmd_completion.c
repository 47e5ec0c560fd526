#include "cli/cli.h"

static int run(struct dea_cli *cli, int argc, char **argv)
{
  (void)argc;
  (void)argv;
  return cli_usage_error(cli, &cmd_completion, "not built yet");
}

const struct dea_command cmd_completion = {
    .name = "completion",
    .summary = "",
    .usage = "dea completion\n",
    .run = run,
};
