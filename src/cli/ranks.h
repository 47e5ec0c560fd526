/* Several processes at each design of dea sweep and dea optimise (explore/ranks.h). */
#ifndef DEA_CLI_RANKS_H
#define DEA_CLI_RANKS_H

#include "cli/cli.h"
#include "explore/question.h"
#include "explore/ranks.h"

/* What of a request is about that. */
struct cli_ranks {
  double count; // 0: not given
  bool serve;   // this is one of them
};

#define CLI_RANKS_ROWS                                                                             \
  {"ranks",                                                                                        \
   0,                                                                                              \
   CLI_TEXT,                                                                                       \
   "N",                                                                                            \
   "have N processes compute each design together, by mpirun (model 3d; default: 1)",              \
   CLI_AT(ranks.count),                                                                            \
   cli_take_processes},                                                                            \
  {                                                                                                \
    "serve", 0, CLI_FLAG, NULL,                                                                    \
        "be one of these: compute what comes on standard input (started by --ranks)",              \
        CLI_AT(ranks.serve)                                                                        \
  }

/* -j, or as many designs at once as there are cores for. */
size_t cli_ranks_processes(const struct cli_ranks *ranks, double given);
/* Has the question evaluated by several processes each, if that is asked for; DEA_E_UNSUPPORTED
 * where its model is not computed so. out: to be kept as long as the question. */
dea_status cli_ranks_take(struct dea_cli *cli, const struct cli_ranks *asked, const char *command,
                          const char *file, struct dea_question *question, struct dea_ranks *out);
/* Serves by an evaluator of the question. */
dea_status cli_ranks_serve(struct dea_cli *cli, const struct dea_question *question,
                           const struct dea_evaluator *evaluator);
/* Path of this program, as other computers have it too. */
const char *cli_own_program(void);

#endif
