/* The example designs that come with the program. */
#pragma once

#include "cli/cli.h"

struct cli_data_file {
  char *path; // to open
  char *name; // inside the folder of examples, with "/" between: "paper/fig02.yaml"
};

/* In the order of their names; those of one level of folders come after the others. */
struct cli_data_list {
  char *folder; // where they were found; the last place looked at when nowhere
  struct cli_data_file *files;
  size_t count;
};

/* Files whose name ends in `ending` ("" for all), of the installed examples, or if there are none
 * of those in the source tree. list: to be freed in any case. */
dea_status cli_examples_find(struct dea_context *ctx, const char *outcome,
                             struct cli_data_list *list);
void cli_data_free(struct dea_context *ctx, struct cli_data_list *list);
/* Length of a name without its last ending: 5 for "fig02.yaml". */
size_t cli_data_stem(const char *name);
