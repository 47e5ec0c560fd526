/* Fuzz target: mappings, on a table that has what they may name. */
#include "fuzz_import.h"

static struct dea_table *make_table(struct dea_context *ctx)
{
  static const char *const names[] = {"t", "Dev1/ai0", "Dev1/ai1", "z(1)", "z(2)", "z(3)", "x"};
  struct dea_table *table = dea_alloc(ctx, 1, sizeof *table);
  for (size_t i = 0; table != NULL && i < sizeof names / sizeof names[0]; i++) {
    struct dea_table_column *column =
        dea_table_add(ctx, table, names[i], 8, i == 1 ? "kV" : "", 2, 3);
    for (size_t k = 0; column != NULL && k < 3; k++) {
      column->values[column->count++] = (double)k;
    }
  }
  if (table != NULL) {
    table->file = "table";
  }
  return table;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_begin();
  struct dea_mapping *mapping;
  struct dea_recording *recording = NULL;
  dea_status status = dea_mapping_read_memory(ctx, "map.yaml", (const char *)data, size, &mapping);
  if (status == DEA_OK) {
    struct dea_table *table = make_table(ctx);
    if (table != NULL) {
      status = dea_table_record(ctx, table, mapping, &recording);
    }
    dea_table_destroy(ctx, table);
  }
  fuzz_check_findings(ctx, status);
  dea_recording_destroy(ctx, recording);
  dea_mapping_destroy(ctx, mapping);
  return 0;
}
