/* The usage texts read back: what the shell completions are made from.
 *
 * A usage text starts with the synopsis ("dea run DESIGN [-o DIR]", further forms indented below
 * it); after a blank line come paragraphs and, each on a line of its own that starts with spaces,
 * options
 * ("  -o, --output DIR  folder") and arguments ("  DESIGN  design file"). Two spaces or more stand
 * before the explanation; of one that goes on over several lines the first is read. A word in
 * capitals says what is expected there: see kind_of() in cmd_completion.c. */
#ifndef DEA_CLI_USAGE_H
#define DEA_CLI_USAGE_H

#include "cli/cli.h"

enum { CLI_COMMON_COUNT = 3, CLI_OPTIONS_MAX = 32, CLI_WORD_SIZE = 32, CLI_EXPLANATION_SIZE = 160 };

struct cli_option {
  char letter[CLI_WORD_SIZE]; // "-o" or ""
  char name[CLI_WORD_SIZE];   // "--output" or ""
  char value[CLI_WORD_SIZE];  // "DIR"; "" for a flag
  char explanation[CLI_EXPLANATION_SIZE];
};

struct cli_usage {
  struct cli_option options[CLI_OPTIONS_MAX];
  size_t option_count;
  char arguments[CLI_OPTIONS_MAX][CLI_WORD_SIZE]; // words in capitals that are no option's value
  size_t argument_count;
};

/* Options that main.c takes for every command. */
extern const struct cli_option cli_common_options[CLI_COMMON_COUNT];
/* All commands of the table, in its order. Static storage. */
const struct dea_command *const *cli_commands(size_t *count);
void cli_usage_read(const struct dea_command *command, struct cli_usage *usage);

/* Prints the manual page dea(1) in mdoc to stdout. */
void cli_print_manual(void);

#endif
