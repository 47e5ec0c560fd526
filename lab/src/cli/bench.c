#include "cli/bench.h"

#include "import/import.h"
#include "instrument/instrument.h"

void cli_bench_enter(char **argv)
{
  (void)argv;
}

dea_status cli_bench_importers(struct dea_cli *cli, struct dea_text *out)
{
  size_t count;
  const struct dea_importer *const *all = dea_importer_all(&count);
  (void)cli;
  for (size_t i = 0; i < count; i++) {
    dea_text_add(out, "%s\n", all[i]->name);
  }
  return DEA_OK;
}

dea_status cli_bench_protocol_keys(struct dea_cli *cli, struct dea_text *out)
{
  struct dea_protocol_schema schema;
  (void)cli;
  dea_instrument_protocol_schema(&schema);
  dea_schema_print_keys(&schema.record, out);
  return DEA_OK;
}

dea_status cli_bench_schema(struct dea_context *ctx, bool protocol, struct dea_record **out)
{
  struct dea_protocol_schema *schema = dea_alloc(ctx, 1, sizeof *schema);
  DEA_TRY_MEMORY(schema != NULL);
  if (protocol) {
    dea_instrument_protocol_schema(schema);
  } else {
    schema->record = dea_mapping_record;
  }
  *out = &schema->record; // its first member
  return DEA_OK;
}
