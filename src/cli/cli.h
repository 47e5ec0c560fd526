/* The command `dea`: a table of commands, one cmd_*.c each. Only this folder prints. */
#ifndef DEA_CLI_CLI_H
#define DEA_CLI_CLI_H

#include "base/text.h"
#include "device/device.h"

#include <jansson.h>
#include <stdio.h>

/* What all commands share. Results go to stdout, everything else to stderr. */
struct dea_cli {
  struct dea_context *ctx;
  bool quiet;    // --quiet: no progress, no notes
  bool verbose;  // --verbose: with the chain of calls of an error
  bool terminal; // stderr is a terminal
  bool follower; // a rank of mpirun other than 0: computes along, says and writes nothing
  bool colour;   // stderr takes colours (terminal, no NO_COLOR)
  const char *command_line; // the whole of it, for provenance
};

struct dea_command {
  const char *name;
  const char *summary; // one line
  const char *usage;   // "dea run DESIGN [options]" and the options, a line each
  /* argv[0] is the command's name. Returns the exit code. */
  int (*run)(struct dea_cli *cli, int argc, char **argv);
};

// X(name of the `const struct dea_command`)
#define DEA_COMMAND_LIST(X)                                                                        \
  X(cmd_run)                                                                                       \
  X(cmd_check)                                                                                     \
  X(cmd_fab)                                                                                       \
  X(cmd_mesh)                                                                                      \
  X(cmd_drive)                                                                                     \
  X(cmd_schema)                                                                                    \
  X(cmd_materials)                                                                                 \
  X(cmd_plot)                                                                                      \
  X(cmd_compare)                                                                                   \
  X(cmd_report)                                                                                    \
  X(cmd_reduce)                                                                                    \
  X(cmd_recording)                                                                                 \
  X(cmd_import)                                                                                    \
  X(cmd_examples)                                                                                  \
  X(cmd_doctor)                                                                                    \
  X(cmd_completion)

#define DEA_COMMAND_DECLARE(name) extern const struct dea_command name;
DEA_COMMAND_LIST(DEA_COMMAND_DECLARE)
#undef DEA_COMMAND_DECLARE

/* Prints all findings, then the recorded failure, in the form "file:line:column: error: text";
 * returns the exit code of `status`. */
int cli_report(struct dea_cli *cli, dea_status status);
/* Prints "dea COMMAND: text" and a hint to --help; returns the exit code of a usage error. */
int cli_usage_error(struct dea_cli *cli, const struct dea_command *command, const char *format, ...)
    DEA_PRINTF(3, 4);
/* Takes "key=value" of --set (text is cut at the '='); false when it is not of that form or there
 * is no room. Keys and values lend from text. */
bool cli_parse_override(char *text, struct dea_override *overrides, size_t room, size_t *count);
/* What a command takes that looks at one design: DESIGN, --set, --json; where it writes one file,
 * --output; where it writes a folder, --force and --drawing too. */
enum { CLI_OVERRIDES_MAX = 256 };
enum cli_writes { CLI_WRITES_NOTHING, CLI_WRITES_FILE, CLI_WRITES_FOLDER };
struct cli_design_arguments {
  const char *design;
  const char *output; // NULL: not given
  bool json, force, drawing;
  struct dea_override overrides[CLI_OVERRIDES_MAX];
  size_t override_count;
};
/* -1, or the exit code after a usage error. */
int cli_parse_design_arguments(struct dea_cli *cli, const struct dea_command *command,
                               enum cli_writes writes, int argc, char **argv,
                               struct cli_design_arguments *out);
/* Reads the design and builds its device; both owned by the caller, also after a failure. */
dea_status cli_build_device(struct dea_cli *cli, const struct cli_design_arguments *arguments,
                            struct dea_design **design, struct dea_device **device);
/* Folder for the results of a design: its file name without ending, plus ".ENDING", in the current
 * folder. */
void cli_folder_name(const char *design, const char *ending, struct dea_text *out);
/* Usage error for what getopt_long answered: ':' or '?'. */
int cli_option_error(struct dea_cli *cli, const struct dea_command *command, int option,
                     char **argv);
/* Prints a command's usage to stdout. */
void cli_print_usage(const struct dea_command *command);
/* All findings so far as an array; owned by the caller. */
json_t *cli_findings_json(const struct dea_context *ctx);
/* Prints JSON to stdout; takes it. */
void cli_print_json(json_t *json);
/* Progress on stderr: one line that is rewritten on a terminal, a plain line otherwise. */
void cli_progress(void *cli, const char *what, size_t done, size_t total);
/* True after SIGINT or SIGTERM. */
bool cli_interrupted(void);
/* From here on no signal ends or stops the program at once, not a second one either, because the
 * voltage has to come down first: hang-up, quit and the like count as an interruption too (hang-up
 * not under nohup). Progress is left out while stderr does not take it. */
void cli_voltage_is_on(void);

#endif
