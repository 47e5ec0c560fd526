/* dea compare with several curves, or a reduced measurement, beside one reference. */
#ifndef DEA_CLI_COMPARE_MANY_H
#define DEA_CLI_COMPARE_MANY_H

#include "cli/cli.h"
#include "output/plot.h"
#include "result/columns.h"
#include "result/compare.h"

enum { COMPARE_NAMES_MAX = 17, COMPARE_QUANTITIES_MAX = DEA_LOAD_POINT_COLUMNS };

/* Models asked for: of the runs, of the reference. */
struct compare_models {
  size_t count;
  char at[DEA_DESIGN_MODELS_MAX][2][DEA_NAME_SIZE];
};

struct compare_columns {
  size_t count;
  int at[COMPARE_QUANTITIES_MAX];
};

struct compare_request {
  struct cli_words names; // runs, and last what they are compared with
  struct compare_models models;
  struct compare_columns columns;
  double tolerance;   // NAN for none
  const char *output; // folder; NULL for none
  struct dea_plot_format format;
  bool json;
};

/* True for a run: a folder, a store by its name or its first bytes. */
bool cli_compare_is_run(const char *path);
dea_status cli_compare_many(struct dea_cli *cli, const struct compare_request *request);
/* DEA_E_DIFFERS when a tolerance is given and the worst misfit (NULL: none) exceeds it. curve:
 * whose it is, "" for none. */
dea_status cli_compare_judge(struct dea_context *ctx, const struct dea_misfit *worst,
                             const char *curve, double tolerance);
/* " out of tolerance" where it is. */
const char *cli_compare_mark(const struct dea_misfit *misfit, double tolerance);

#endif
