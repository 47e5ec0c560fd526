#include "cli/cli.h"

#include "base/text.h"
#include "design/schema.h"
#include "lab/import/import.h"
#include "lab/protocol/protocol.h"

#include <string.h>

static int run(struct dea_cli *cli, int argc, char **argv)
{
  bool json = false, markdown = false, material = false, protocol = false, mapping = false;
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--json") == 0) {
      json = true;
    } else if (strcmp(argv[i], "--markdown") == 0) {
      markdown = true;
    } else if (strcmp(argv[i], "--material") == 0) {
      material = true;
    } else if (strcmp(argv[i], "--protocol") == 0) {
      protocol = true;
    } else if (strcmp(argv[i], "--mapping") == 0) {
      mapping = true;
    } else {
      return cli_usage_error(cli, &cmd_schema, "unknown argument '%s'", argv[i]);
    }
  }
  if (json && markdown) {
    return cli_usage_error(cli, &cmd_schema, "--json and --markdown exclude each other");
  }
  if (material + protocol + mapping > 1) {
    return cli_usage_error(cli, &cmd_schema,
                           "--material, --protocol and --mapping exclude each other");
  }
  const struct dea_record *record = material   ? &dea_material_file_record
                                    : protocol ? &dea_protocol_record
                                    : mapping  ? &dea_mapping_record
                                               : &dea_design_record;
  struct dea_text out = {.ctx = cli->ctx};
  dea_status status = DEA_OK;
  if (json) {
    status = dea_schema_print_json(cli->ctx, record, record->doc, &out);
  } else if (markdown) {
    dea_schema_print_markdown(record, &out);
  } else {
    dea_schema_print_text(record, &out);
  }
  if (out.failed) {
    status = DEA_E_MEMORY;
  }
  if (status == DEA_OK) {
    fputs(dea_text_get(&out), stdout);
  }
  dea_text_free(&out);
  return cli_report(cli, status);
}

const struct dea_command cmd_schema = {
    .name = "schema",
    .summary = "Print every key of a design file: form, unit, limits, default, meaning",
    .usage = "dea schema [--json | --markdown] [--material | --protocol | --mapping]\n\n"
             "  --json      JSON Schema (draft 2020-12), for editors\n"
             "  --markdown  a table in Markdown\n"
             "  --material  the keys of a material file instead\n"
             "  --protocol  the keys of a protocol for `dea drive` instead\n"
             "  --mapping   the keys of a mapping for `dea import` instead\n",
    .run = run,
};
