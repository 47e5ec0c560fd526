/* In place of the bench, of which the program dea has nothing. */
#define _POSIX_C_SOURCE 200809L // readlink
#include "cli/bench.h"

#include <string.h>
#include <unistd.h>

void cli_bench_enter(char **argv)
{
  static const char name[] = "dea-lab";
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof name);
  if (length > 0) {
    path[length] = '\0';
    char *end = strrchr(path, '/');
    strcpy(end != NULL ? end + 1 : path, name);
    execv(path, argv);
  }
}

static dea_status fail(struct dea_context *ctx)
{
  return dea_fail(ctx, DEA_E_UNSUPPORTED, "the bench is not installed: it is the package dea-lab");
}

struct request {
  struct cli_words words;
};

static dea_status run(struct dea_cli *cli, void *request)
{
  (void)request;
  return fail(cli->ctx);
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_FILE, "FILE", "not installed", CLI_AT(words), .most = CLI_WORDS_MAX}, {0}};

#define NO_COMMAND(command)                                                                        \
  const struct dea_command cmd_##command = {.name = #command,                                      \
                                            .summary = "Not installed: package dea-lab",           \
                                            .options = options,                                    \
                                            .request_size = sizeof(struct request),                \
                                            .run = run}
NO_COMMAND(drive);
NO_COMMAND(reduce);
NO_COMMAND(recording);
NO_COMMAND(import);

dea_status cli_bench_importers(struct dea_cli *cli, struct dea_text *out)
{
  (void)cli;
  (void)out;
  return DEA_OK;
}

dea_status cli_bench_protocol_keys(struct dea_cli *cli, struct dea_text *out)
{
  return cli_bench_importers(cli, out);
}

dea_status cli_bench_schema(struct dea_context *ctx, bool protocol, struct dea_record **out)
{
  (void)protocol;
  *out = NULL;
  return fail(ctx);
}
