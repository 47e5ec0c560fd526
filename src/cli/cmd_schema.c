#include "cli/bench.h"
#include "cli/cli.h"

#include "explore/explore_file.h"
#include "identify/breakdown_fit.h"
#include "identify/device_file.h"
#include "identify/life_fit.h"
#include "study/design_file.h"

struct request {
  bool json, markdown, general, material, protocol, mapping, fit, fit_device, fit_breakdown,
      fit_life, explore;
};

static dea_status run(struct dea_cli *cli, void *user)
{
  const struct request *request = user;
  struct dea_design_schema design;
  struct dea_record *bench = NULL; // owned
  dea_design_file_schema(&design);
  if (request->protocol || request->mapping) {
    DEA_TRY(cli->ctx, cli_bench_schema(cli->ctx, request->protocol, &bench));
  }
  const struct dea_record *record = request->material        ? &dea_material_file_record
                                    : bench != NULL          ? bench
                                    : request->fit           ? &dea_fit_form.record
                                    : request->fit_device    ? &dea_device_form.record
                                    : request->fit_breakdown ? &dea_breakdown_form.record
                                    : request->fit_life      ? &dea_life_form.record
                                    : request->explore       ? &dea_explore_form.record
                                    : request->general       ? &design.general.record
                                                             : &design.disc.record;
  struct dea_text out = {.ctx = cli->ctx};
  dea_status status = DEA_OK;
  if (request->json && record == &design.disc.record) {
    const struct dea_schema_forms forms = {"plies", &design.general.record, record};
    status = dea_schema_print_forms_json(cli->ctx, &forms, "design of an actuator", &out);
  } else if (request->json) {
    status = dea_schema_print_json(cli->ctx, record, record->doc, &out);
  } else if (request->markdown) {
    dea_schema_print_markdown(record, &out);
  } else {
    dea_schema_print_text(record, &out);
  }
  status = cli_print_text(status, &out);
  dea_free(cli->ctx, bench);
  return status;
}

static const struct cli_option options[] = {
    CLI_JSON_ROW("JSON Schema (draft 2020-12), for editors"),
    {"markdown", 0, CLI_FLAG, NULL, "a table in Markdown", CLI_AT(markdown), .or_before = true},
    {"general", 0, CLI_FLAG, NULL, "the keys of a design with 'plies', of any layout, instead",
     CLI_AT(general)},
    {"material", 0, CLI_FLAG, NULL, "the keys of a material file instead", CLI_AT(material)},
    {"protocol", 0, CLI_FLAG, NULL, "the keys of a protocol for `dea drive` instead",
     CLI_AT(protocol), .or_before = true},
    {"mapping", 0, CLI_FLAG, NULL, "the keys of a mapping for `dea import` instead",
     CLI_AT(mapping), .or_before = true},
    {"fit", 0, CLI_FLAG, NULL, "the keys of a fit file for `dea fit` instead", CLI_AT(fit),
     .or_before = true},
    {"fit-device", 0, CLI_FLAG, NULL, "the keys of a fit file of a device instead",
     CLI_AT(fit_device), .or_before = true},
    {"fit-breakdown", 0, CLI_FLAG, NULL, "the keys of a fit file of breakdown tests instead",
     CLI_AT(fit_breakdown), .or_before = true},
    {"fit-life", 0, CLI_FLAG, NULL, "the keys of a fit file of life tests instead",
     CLI_AT(fit_life), .or_before = true},
    {"explore", 0, CLI_FLAG, NULL, "the keys of a file for `dea sweep` and `dea optimise` instead",
     CLI_AT(explore), .or_before = true},
    {0}};

const struct dea_command cmd_schema = {
    .name = "schema",
    .summary = "Print every key of a design file: form, unit, limits, default, meaning",
    CLI_RUN};
