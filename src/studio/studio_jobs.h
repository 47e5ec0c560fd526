/* What the studio has the command do: short questions, and a queue of runs, one a core. */
#pragma once

#include "base/text.h"

#include <jansson.h>

/* Arguments of the command, one after the other, each with its zero. Zero-initialise. */
enum { DEA_STUDIO_LINE = 4096, DEA_STUDIO_ARGUMENTS = 48 };
struct dea_studio_line {
  char text[DEA_STUDIO_LINE];
  size_t length, count;
  bool full; // something did not fit
};
void dea_studio_line_add(struct dea_studio_line *line, const char *argument);
/* "dea run 'my design.yaml'", for a shell. */
void dea_studio_line_show(const struct dea_studio_line *line, struct dea_text *out);

/* Runs the command in the current folder and waits for it, at most limit_s. out, err: what it says.
 * *code: its exit code. DEA_E_TOOL where it cannot be started, takes too long or dies. */
dea_status dea_studio_run_command(struct dea_context *ctx, const char *program,
                                  const struct dea_studio_line *line, double limit_s,
                                  struct dea_text *out, struct dea_text *err, int *code);

struct dea_studio_jobs;

/* program: lent. NULL on failure. */
struct dea_studio_jobs *dea_studio_jobs_create(struct dea_context *ctx, const char *program);
/* Stops what runs, waits for it, and frees them. */
void dea_studio_jobs_destroy(struct dea_context *ctx, struct dea_studio_jobs *jobs);

// From any thread:

/* Puts one at the end of the queue. facts: {action, subject, output, command}, with the file that
 * it is about and what it writes; taken. Its number, from 1; 0: too many wait, or another one
 * writes there. */
int dea_studio_jobs_add(struct dea_studio_jobs *jobs, json_t *facts,
                        const struct dea_studio_line *line);
/* Interrupts it, the second time ends it at once; takes one that waits out of the queue. */
bool dea_studio_jobs_stop(struct dea_studio_jobs *jobs, int id);
/* [{id, action, subject, output, command, state, code, progress, said}], the oldest first; state:
 * waiting, running, done, failed, stopped. */
json_t *dea_studio_jobs_json(struct dea_studio_jobs *jobs);

// From the thread that made them, with whose end they end:

/* Starts those whose turn it is, hears what they say, and takes their ends; waits 0.03 s. */
void dea_studio_jobs_turn(struct dea_studio_jobs *jobs);
