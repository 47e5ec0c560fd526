/* The command `dea`: a table of commands, one cmd_*.c each. Only this folder prints. */
#pragma once

#include "base/text.h"
#include "base/units.h"
#include "device/device.h"

#include <jansson.h>
#include <stddef.h>

/* What all commands share. Results go to stdout, everything else to stderr. */
struct dea_cli {
  struct dea_context *ctx;
  const struct dea_command *const *commands; // all of them in the order of the list, ended by NULL
  const struct dea_command *command;         // that is asked for
  bool quiet;                                // --quiet: no progress, no notes
  bool verbose;                              // --verbose: with the chain of calls of an error
  bool help;                                 // --help: say how it is used, and do nothing
  bool terminal;                             // stderr is a terminal
  bool follower; // a rank of mpirun other than 0: computes along, says and writes nothing
  int ranks;     // that mpirun has started, this one among them
  bool colour;   // stderr takes colours (terminal, no NO_COLOR)
  bool refused;  // a usage error has been printed
  const char *command_line; // the whole of it, for provenance
  struct {                  // for the progress that is shown
    char what[64];
    double began_s, last_s; // when this part began, and the last call
    bool open;              // its line has no end yet
  } progress;
};

struct cli_option;

struct dea_command {
  const char *name;
  const char *summary; // one line
  const char *about;   // more of it, NULL: nothing; lines are wrapped
  /* Everything that it takes, ended by a row without help. Parsing, --help, completion and manual
   * page follow from it. */
  const struct cli_option *options;
  /* The struct that the options fill, and what it holds before; NULL: zeros. */
  size_t request_size;
  const void *defaults;
  bool on_ranks; // several ranks of mpirun can compute it
  /* request: filled from the command line. What it returns is reported by who calls it. */
  dea_status (*run)(struct dea_cli *cli, void *request);
};

// X(name of the `const struct dea_command`)
#define DEA_COMMAND_LIST(X)                                                                        \
  X(cmd_run)                                                                                       \
  X(cmd_check)                                                                                     \
  X(cmd_optimise)                                                                                  \
  X(cmd_sweep)                                                                                     \
  X(cmd_fab)                                                                                       \
  X(cmd_mesh)                                                                                      \
  X(cmd_drive)                                                                                     \
  X(cmd_schema)                                                                                    \
  X(cmd_materials)                                                                                 \
  X(cmd_plot)                                                                                      \
  X(cmd_compare)                                                                                   \
  X(cmd_report)                                                                                    \
  X(cmd_studio)                                                                                    \
  X(cmd_reduce)                                                                                    \
  X(cmd_reduce_order)                                                                              \
  X(cmd_fit)                                                                                       \
  X(cmd_recording)                                                                                 \
  X(cmd_import)                                                                                    \
  X(cmd_examples)                                                                                  \
  X(cmd_doctor)                                                                                    \
  X(cmd_completion)

#define DEA_COMMAND_DECLARE(name) extern const struct dea_command name;
DEA_COMMAND_LIST(DEA_COMMAND_DECLARE)
#undef DEA_COMMAND_DECLARE

// Options ----------------------------------------------------------------------------------------

/* What the value of an option is, and so what a shell offers for it: a row of cli_kinds. */
enum cli_kind {
  CLI_FLAG, // no value
  CLI_TEXT, // nothing to offer
  CLI_FILE,
  CLI_NEW_FILE, // that is written
  CLI_FOLDER,
  CLI_DESIGN,
  CLI_COMMAND,
  CLI_EXAMPLE,
  CLI_FIGURE,
  CLI_FORMAT,
  CLI_IMPORTER,
  CLI_KEY,
  CLI_MATERIAL,
  CLI_MODEL,
  CLI_PROTOCOL_KEY,
  CLI_QUANTITY,
  CLI_SHELL,
  CLI_STUDY,
  CLI_KINDS,
};

struct cli_kind_info {
  const char *name;  // for "dea completion names NAME"; NULL: files
  bool folder;       // folders only
  bool few;          // help lists them too
  const char *words; // a line each; NULL: what `list` adds, or nothing
  dea_status (*list)(struct dea_cli *cli, struct dea_text *out);
};
extern const struct cli_kind_info cli_kinds[CLI_KINDS];
dea_status cli_kind_list(struct dea_cli *cli, const struct cli_kind_info *kind,
                         struct dea_text *out);

/* A row of a command's table: an option, or without a name the argument (one row at most). */
struct cli_option {
  const char *name; // "output" of --output
  char letter;      // 'o' of -o; 0: none
  enum cli_kind kind;
  const char *value; // what help calls it: "DIR"
  const char *help;
  /* Offset in the request of a bool (flag), a `const char *`, a struct cli_words (most above 1), or
   * of what `take` fills. */
  size_t target;
  /* Reads the value in place of keeping it. */
  dea_status (*take)(struct dea_cli *cli, const struct cli_option *option, const char *text,
                     void *target);
  size_t least, most;             // how many; most 0: one, of an option the last counts
  const char *too_few, *too_many; // what is said then
  bool or_before;                 // excludes the row before
  struct dea_measure measure;     // of cli_parse_quantity: unit and example
  bool positive;                  // of cli_parse_quantity: more than 0
};

enum { CLI_OPTIONS_MAX = 24, CLI_WORDS_MAX = 64, CLI_OVERRIDES_MAX = 256 };

struct cli_words {
  size_t count;
  const char *at[CLI_WORDS_MAX];
};

struct cli_overrides {
  size_t count;
  struct dea_override at[CLI_OVERRIDES_MAX];
};

/* Options of every command, into a struct dea_cli. */
extern const struct cli_option cli_common_options[];
/* Takes them out of argv, wherever they stand; returns the new argc. */
int cli_parse_common(struct dea_cli *cli, int argc, char **argv);
/* Reads a command line (argv[0] is the command's name) into the command's request. What it keeps
 * lends from argv. */
dea_status cli_parse(struct dea_cli *cli, int argc, char **argv, void *request);
/* For `take`: "key=value" into a struct cli_overrides; a number with its unit into a double; "5%"
 * or "0.05", of 0 and more, into a double; "svg,pdf" and "85 mm" into a struct dea_plot_format. */
dea_status cli_parse_override(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target);
dea_status cli_parse_quantity(struct dea_cli *cli, const struct cli_option *option,
                              const char *text, void *target);
dea_status cli_parse_formats(struct dea_cli *cli, const struct cli_option *option, const char *text,
                             void *target);
dea_status cli_parse_width(struct dea_cli *cli, const struct cli_option *option, const char *text,
                           void *target);
/* "4" into a double, and how many processes that are: without it, 0, one a core. */
dea_status cli_parse_processes(struct dea_cli *cli, const struct cli_option *option,
                               const char *text, void *target);
size_t cli_processes(double given);
/* "0.2" or "20%"; false otherwise. */
bool cli_read_share(const char *text, double *share);

// The last members of a command whose file has `options`, `struct request` and `run`.
#define CLI_RUN .options = options, .request_size = sizeof(struct request), .run = run
// Rows of several tables, for a `struct request` whose members have the options' names.
#define CLI_AT(member) .target = offsetof(struct request, member)
#define CLI_ONE(what, word, text, member, none, more)                                              \
  {                                                                                                \
    NULL, 0, what, word, text, CLI_AT(member), .least = 1, .too_few = none, .too_many = more       \
  }
#define CLI_MANY(what, word, text, member, count, none, more)                                      \
  {                                                                                                \
    NULL, 0, what, word, text, CLI_AT(member), .least = 1, .most = count, .too_few = none,         \
                                               .too_many = more                                    \
  }
#define CLI_DESIGN_ROW                                                                             \
  CLI_ONE(CLI_DESIGN, "DESIGN", "design file", design, "a design file is needed",                  \
          "one design file at a time")
#define CLI_RECORDING_ROW                                                                          \
  CLI_ONE(CLI_FILE, "FILE", "recording", file, "give one recording", "give one recording")
#define CLI_OUTPUT_ROW(kind, word, text)                                                           \
  {                                                                                                \
    "output", 'o', kind, word, text, CLI_AT(output)                                                \
  }
#define CLI_SET_ROW(letter, keys, example)                                                         \
  {                                                                                                \
    "set", letter, keys, "KEY=VALUE",                                                              \
        "take VALUE in place of the file's, for example --set " example, CLI_AT(overrides),        \
        cli_parse_override, .most = CLI_OVERRIDES_MAX                                              \
  }
#define CLI_FORCE_ROW(letter, text)                                                                \
  {                                                                                                \
    "force", letter, CLI_FLAG, NULL, text, CLI_AT(force)                                           \
  }
#define CLI_JSON_ROW(text)                                                                         \
  {                                                                                                \
    "json", 0, CLI_FLAG, NULL, text, CLI_AT(json)                                                  \
  }
#define CLI_FORMAT_ROW(text)                                                                       \
  {                                                                                                \
    "format", 0, CLI_FORMAT, "LIST", text, CLI_AT(format), cli_parse_formats                       \
  }
#define CLI_WIDTH_ROW(text)                                                                        \
  {                                                                                                \
    "width", 0, CLI_TEXT, "MM", text, CLI_AT(format), cli_parse_width                              \
  }

// Help -------------------------------------------------------------------------------------------

/* Adds "Usage: dea ..." and the options. */
void cli_add_usage(struct dea_cli *cli, const struct dea_command *command, struct dea_text *out);
/* Adds words [length] broken into lines that start at the column `margin`, where the first line is
 * already. Ends the last one. */
void cli_add_wrapped(struct dea_text *out, int margin, const char *text, size_t length);
/* Prints the manual page dea(1) in mdoc to stdout. */
dea_status cli_print_manual(struct dea_cli *cli);

// For all commands -------------------------------------------------------------------------------

/* Prints all findings, then the recorded failure, in the form "file:line:column: error: text";
 * returns the exit code of `status`. */
int cli_report(struct dea_cli *cli, dea_status status);
/* Prints "dea COMMAND: text" and a hint to --help; returns DEA_E_USAGE. */
dea_status cli_usage_error(struct dea_cli *cli, const char *format, ...) DEA_PRINTF(2, 3);
/* Reads a design, builds its device, and hands both to `work` with a request. */
typedef dea_status cli_device_work(struct dea_cli *cli, const void *request,
                                   const struct dea_design *design,
                                   const struct dea_device *device);
dea_status cli_with_device(struct dea_cli *cli, const char *file,
                           const struct cli_overrides *overrides, cli_device_work *work,
                           const void *request);
/* Takes a text; *out is lent as long as the context. DEA_E_MEMORY where it is not whole. */
dea_status cli_keep_text(struct dea_text *text, const char **out);
/* Where the results of a file go: *name as given, or where that is NULL the file's name without
 * ending, plus ".ENDING", in the current folder; lent as long as the context. */
dea_status cli_output_name(struct dea_cli *cli, const char *file, const char *ending,
                           const char **name);
/* All findings so far as an array; owned by the caller. */
json_t *cli_findings_json(const struct dea_context *ctx);
/* The row of a command's argument, or the last one, without help. */
const struct cli_option *cli_argument_of(const struct dea_command *command);
/* What a file says of itself, cut where it is long, without signs that would begin a line of their
 * own, such as one that says what the output was, or change the terminal. */
enum { CLI_PLAIN_SIZE = 512 };
const char *cli_plain(const char *text, char out[CLI_PLAIN_SIZE]);
/* Prints JSON to stdout; takes it. */
void cli_print_json(json_t *json);
/* Prints a text to stdout if `status` is good and it is whole, and frees it. */
dea_status cli_print_text(dea_status status, struct dea_text *text);
/* Has Ctrl-C and SIGTERM interrupt what the library does, a second one end the program, and
 * progress shown. */
void cli_watch(struct dea_cli *cli);
/* Clears the line of a progress that has no end, for what is printed next. */
void cli_progress_clear(struct dea_cli *cli);
/* From here on no signal ends or stops the program at once, not a second one either, because the
 * voltage has to come down first: hang-up, quit and the like count as an interruption too (hang-up
 * not under nohup). Progress is left out while stderr does not take it. */
void cli_voltage_is_on(void);

// The example designs that come with the program --------------------------------------------------

struct cli_data_file {
  char *path; // to open
  char *name; // its end inside the folder of examples, with "/" between: "paper/fig02.yaml"
};

/* In the order of their names; those of one level of folders come after the others. */
struct cli_data_list {
  char *folder; // where they were found; the last place looked at when nowhere
  struct cli_data_file *files;
  size_t count;
};

/* Files whose name ends in `ending` ("" for all), of the installed examples, or if there are none
 * of those in the source tree. list: to be freed in any case. */
dea_status cli_examples_find(struct dea_context *ctx, const char *ending,
                             struct cli_data_list *list);
void cli_data_free(struct dea_context *ctx, struct cli_data_list *list);
/* Length of a name without its last ending: 5 for "fig02.yaml". */
size_t cli_data_stem(const char *name);
