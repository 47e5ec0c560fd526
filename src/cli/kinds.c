/* What the values of options are, and the words that are known for them. */
#include "base/schema.h"
#include "cli/bench.h"
#include "cli/cli.h"
#include "figures/run_figures.h"
#include "material/catalogue.h"
#include "model/model.h"
#include "result/columns.h"
#include "study/design_file.h"
#include "study/study.h"

/* The names of what a registry holds. */
#define NAMES_OF(function, all)                                                                    \
  static dea_status function(struct dea_cli *cli, struct dea_text *out)                            \
  {                                                                                                \
    size_t count;                                                                                  \
    (void)cli;                                                                                     \
    for (size_t i = 0; all(&count) != NULL && i < count; i++) {                                    \
      dea_text_add(out, "%s\n", all(&count)[i]->name);                                             \
    }                                                                                              \
    return DEA_OK;                                                                                 \
  }
NAMES_OF(list_models, dea_model_all)
NAMES_OF(list_studies, dea_study_all)

static dea_status list_figures(struct dea_cli *cli, struct dea_text *out)
{
  const char *names[DEA_FIGURES_MAX];
  size_t count = dea_figure_names(false, names);
  (void)cli;
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, "%s\n", names[i]);
  }
  return DEA_OK;
}

static dea_status list_commands(struct dea_cli *cli, struct dea_text *out)
{
  for (size_t i = 0; cli->commands[i] != NULL; i++) {
    dea_text_add(out, "%s\n", cli->commands[i]->name);
  }
  return DEA_OK;
}

static dea_status list_examples(struct dea_cli *cli, struct dea_text *out)
{
  struct cli_data_list list;
  dea_status status = cli_examples_find(cli->ctx, ".yaml", &list);
  for (size_t i = 0; i < list.count && status == DEA_OK; i++) {
    dea_text_add(out, "%.*s\n", (int)cli_data_stem(list.files[i].name), list.files[i].name);
  }
  cli_data_free(cli->ctx, &list);
  return status;
}

static dea_status list_materials(struct dea_cli *cli, struct dea_text *out)
{
  const char **names;
  size_t count;
  DEA_TRY(cli->ctx, dea_catalogue_names(cli->ctx, &names, &count));
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, "%s\n", names[i]);
  }
  dea_free(cli->ctx, names);
  return DEA_OK;
}

static dea_status list_quantities(struct dea_cli *cli, struct dea_text *out)
{
  (void)cli;
  for (int c = 0; c < DEA_LOAD_POINT_COLUMNS; c++) {
    dea_text_add(out, "%s\n", dea_point_columns[c].key);
  }
  return DEA_OK;
}

static dea_status list_keys(struct dea_cli *cli, struct dea_text *out)
{
  (void)cli;
  struct dea_design_schema schema;
  dea_design_file_schema(&schema);
  dea_schema_print_keys(&schema.disc.record, out);
  return DEA_OK;
}

dea_status cli_kind_list(struct dea_cli *cli, const struct cli_kind_info *kind,
                         struct dea_text *out)
{
  dea_text_add(out, "%s", kind->words != NULL ? kind->words : "");
  return kind->list != NULL ? kind->list(cli, out) : DEA_OK;
}

const struct cli_kind_info cli_kinds[CLI_KINDS] = {
    [CLI_TEXT] = {.name = "nothing"},
    [CLI_FILE] = {.name = NULL},
    [CLI_NEW_FILE] = {.name = NULL},
    [CLI_FOLDER] = {.folder = true},
    [CLI_DESIGN] = {.name = NULL},
    [CLI_COMMAND] = {"commands", .list = list_commands},
    [CLI_EXAMPLE] = {"examples", .list = list_examples},
    [CLI_FIGURE] = {"figures", .list = list_figures},
    [CLI_FORMAT] = {"formats", .few = true, .words = "svg\npdf\npng\n"},
    [CLI_IMPORTER] = {"importers", .few = true, .list = cli_bench_importers},
    [CLI_KEY] = {"keys", .list = list_keys},
    [CLI_MATERIAL] = {"materials", .list = list_materials},
    [CLI_MODEL] = {"models", .few = true, .list = list_models},
    [CLI_PROTOCOL_KEY] = {"protocol-keys", .list = cli_bench_protocol_keys},
    [CLI_QUANTITY] = {"quantities", .list = list_quantities},
    [CLI_SHELL] = {"shells", .few = true, .words = "bash\nman\n"},
    [CLI_STUDY] = {"studies", .few = true, .list = list_studies},
};
