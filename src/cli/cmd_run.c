#include "cli/cli.h"

static int run(struct dea_cli *cli, int argc, char **argv)
{
  (void)argc;
  (void)argv;
  return cli_usage_error(cli, &cmd_run, "not built yet");
}

const struct dea_command cmd_run = {
    .name = "run",
    .summary = "",
    .usage = "dea run\n",
    .run = run,
};
