#include "cli/cli.h"

static int run(struct dea_cli *cli, int argc, char **argv)
{
  (void)argc;
  (void)argv;
  return cli_usage_error(cli, &cmd_materials, "not built yet");
}

const struct dea_command cmd_materials = {
    .name = "materials",
    .summary = "",
    .usage = "dea materials\n",
    .run = run,
};
