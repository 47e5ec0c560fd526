#define _DEFAULT_SOURCE // readlink
#include "cli/ranks.h"

#include <unistd.h>

const char *cli_own_program(void)
{
  static char program[4096];
  const ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
  program[length > 0 ? length : 0] = '\0';
  return length > 0 ? program : "dea";
}

size_t cli_ranks_processes(const struct cli_ranks *ranks, double given)
{
  const size_t cores = cli_processes(0);
  const size_t each = ranks->count > 1 ? (size_t)ranks->count : 1;
  return given > 0 ? (size_t)given : cores > each ? cores / each : 1;
}

dea_status cli_ranks_take(struct dea_cli *cli, const struct cli_ranks *asked, const char *command,
                          const char *file, struct dea_question *question, struct dea_ranks *out)
{
  if (!(asked->count > 1)) {
    return DEA_OK;
  }
  if (question->model.type->tell == NULL) {
    return dea_fail(cli->ctx, DEA_E_UNSUPPORTED,
                    "model %s computes a design in one process: --ranks is of model 3d",
                    question->model.type->name);
  }
  *out = (struct dea_ranks){.count = (size_t)asked->count,
                            .program = cli_own_program(),
                            .command = command,
                            .file = file,
                            .question = question->hash};
  question->evaluator.ranks = out;
  return DEA_OK;
}

dea_status cli_ranks_serve(struct dea_cli *cli, const struct dea_question *question,
                           const struct dea_evaluator *evaluator)
{
  if (question->model.type->tell == NULL) {
    return dea_fail(cli->ctx, DEA_E_UNSUPPORTED, "model %s computes a design in one process",
                    question->model.type->name);
  }
  return dea_ranks_serve(cli->ctx, evaluator, question->hash, !cli->follower,
                         question->model.type->tell);
}
