/* The files that come with the program: design examples and material data. */
#ifndef DEA_CLI_DATA_FILES_H
#define DEA_CLI_DATA_FILES_H

#include "cli/cli.h"

enum dea_data_kind { DEA_DATA_EXAMPLES, DEA_DATA_MATERIALS };

struct cli_data_file {
  char *path; // to open
  char *name; // inside its folder, with "/" between: "paper/fig02.yaml"
};

/* kind's files whose name ends in `ending` ("" for all), in the order of their names; those of one
 * level of folders come after the others. Empty when the folder is missing. */
struct cli_data_list {
  char *folder; // where they were found; the last place looked at when nowhere
  struct cli_data_file *files;
  size_t count;
};

/* Looks in the installed data first, then in the source tree. list: to be freed in any case. */
dea_status cli_data_find(struct dea_context *ctx, enum dea_data_kind kind, const char *ending,
                         struct cli_data_list *list);
void cli_data_free(struct dea_context *ctx, struct cli_data_list *list);
/* Length of a name without its last ending: 5 for "fig02.yaml". */
size_t cli_data_stem(const char *name);

#endif
