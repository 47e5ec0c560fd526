/* Processes that evaluate each case together: ranks of MPI, of which the first is sent cases
 * through its standard input and sends replies through its standard output, as lines of text,
 * whatever mpirun and others make of these. */
#ifndef DEA_EXPLORE_RANKS_H
#define DEA_EXPLORE_RANKS_H

#include "explore/evaluator.h"

#include <stdio.h>
#include <sys/types.h>

/* How they are started: DEA_MPIRUN -n COUNT PROGRAM COMMAND FILE --serve. All lent. */
struct dea_ranks {
  size_t count;
  const char *program, *command, *file;
  const char *question; // hash of what they are to compute, up to 64 characters
};

/* What comes of a case. */
struct dea_reply {
  struct dea_case done;
  dea_status status;
  char message[256];
};

/* Evaluates the case that is in it; q of it: NAN where there is no value. */
void dea_reply_find(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                    struct dea_reply *reply);

enum { DEA_RANKS_LINE = 2 * sizeof(struct dea_reply) + 32 };

/* Those that were started. */
struct dea_ranks_running {
  pid_t process; // mpirun
  int socket;
  FILE *said;                // on their standard error
  char line[DEA_RANKS_LINE]; // what has come of the next one
  size_t used;
};

enum dea_ranks_heard { DEA_RANKS_NOTHING, DEA_RANKS_REPLY, DEA_RANKS_GONE };

/* Starts them and waits until they are there. DEA_E_TOOL where they are not or another question is
 * theirs. They end with this process. */
dea_status dea_ranks_start(struct dea_context *ctx, const struct dea_ranks *ranks,
                           struct dea_ranks_running *out);
/* A case to them; false where they are gone. */
bool dea_ranks_give(const struct dea_ranks_running *ranks, const struct dea_case *now);
/* Some of what they say, for which this waits: their reply when it is whole. */
enum dea_ranks_heard dea_ranks_hear(struct dea_ranks_running *ranks, struct dea_reply *out);
/* Ends them and all that they left. why: how they had ended, NULL: not wanted. */
void dea_ranks_end(struct dea_ranks_running *ranks, char why[DEA_CASE_WHY_SIZE]);

/* As one of them: answers cases until no more come. first: the one that they come to. tell: bytes
 * of the first to all. */
dea_status dea_ranks_serve(struct dea_context *ctx, const struct dea_evaluator *evaluator,
                           const char *question, bool first,
                           dea_status (*tell)(struct dea_context *ctx, void *bytes, size_t length));

#endif
