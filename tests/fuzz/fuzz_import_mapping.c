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
  static struct dea_context *ctx;
  struct dea_mapping *mapping;
  struct dea_recording *recording = NULL;
  if (ctx == NULL && dea_context_create(NULL, &ctx) != DEA_OK) {
    return 0;
  }
  dea_status status = dea_mapping_read_memory(ctx, "map.yaml", (const char *)data, size, &mapping);
  if (status == DEA_OK) {
    struct dea_table *table = make_table(ctx);
    if (table != NULL) {
      status = dea_table_record(ctx, table, mapping, &recording);
    }
    dea_table_destroy(ctx, table);
  }
  if (status == DEA_E_DESIGN && dea_finding_count(ctx, DEA_ERROR) == 0) {
    __builtin_trap(); // an error that nobody is told about
  }
  dea_recording_destroy(ctx, recording);
  dea_mapping_destroy(ctx, mapping);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
