/* Other programs, started as processes: what they say is kept, and they have a time limit. */
#pragma once

#include "base/context.h"

#include <sys/types.h>

enum { DEA_PROGRAM_SAID = 4096 };

struct dea_program {
  pid_t process;
  int said; // end of the pipe that it writes into
};

/* Starts argv[0] from the PATH in a folder, without input; hears what it writes to its standard
 * error, and with `all` to its standard output. Returns errno's value: 0 when it runs, ENOENT when
 * there is no such program. */
int dea_program_start(char *const argv[], const char *directory, bool all,
                      struct dea_program *program);

enum dea_program_end {
  DEA_PROGRAM_DONE,       // exit code 0
  DEA_PROGRAM_FAILED,     // another exit code
  DEA_PROGRAM_CRASHED,    // by a signal
  DEA_PROGRAM_TOO_LONG,   // ended by us after limit_s
  DEA_PROGRAM_INTERRUPTED // ended by us as the context was interrupted
};

/* Waits for its end. ctx: an interruption ends the program; NULL: it does not. limit_s: of the
 * program's processor time, so that a loaded machine does not end it, and a tenth of what it may
 * take by the clock; > 0, may be INFINITY. said: the last of what it wrote, without blanks at its
 * end. number: exit code or signal. */
enum dea_program_end dea_program_wait(const struct dea_context *ctx,
                                      const struct dea_program *program, double limit_s,
                                      char said[DEA_PROGRAM_SAID], int *number);

/* The last `lines` lines of a text; lent. */
const char *dea_last_lines(const char *text, int lines);
