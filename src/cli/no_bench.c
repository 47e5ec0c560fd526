/* In place of the bench in a build without it (DEA_LAB=OFF). */
#include "cli/bench.h"

static dea_status fail(struct dea_context *ctx)
{
  return dea_fail(ctx, DEA_E_UNSUPPORTED, "this build has no bench: build with -DDEA_LAB=ON");
}

struct request {
  struct cli_words words;
};

static int run(struct dea_cli *cli, void *request)
{
  (void)request;
  return cli_report(cli, fail(cli->ctx));
}

static const struct cli_option options[] = {
    {NULL, 0, CLI_FILE, "FILE", "not in this build", CLI_AT(words), .most = CLI_WORDS_MAX}, {0}};

#define NO_COMMAND(command)                                                                        \
  const struct dea_command cmd_##command = {.name = #command,                                      \
                                            .summary = "Not in this build: it has no bench",       \
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

bool cli_bench_find_matio(char *out, size_t size)
{
  (void)out;
  (void)size;
  return false;
}
