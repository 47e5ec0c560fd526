/* One importer on hostile bytes: reads a table and makes what it can of it. */
#pragma once

#include "fuzz.h"

#include "import/import.h"

#include <stdint.h>
#include <string.h>

static inline const struct dea_importer *fuzz_importer(const char *name)
{
  size_t count;
  const struct dea_importer *const *all = dea_importer_all(&count);
  for (size_t i = 0; i < count; i++) {
    if (strcmp(all[i]->name, name) == 0) {
      return all[i];
    }
  }
  __builtin_trap();
}

/* A table of `file`, from the bytes when the importer takes them. */
static inline void fuzz_table(struct dea_context *ctx, const char *name, const char *file,
                              const uint8_t *data, size_t size)
{
  struct dea_recording *recording = NULL;
  struct dea_table *table = dea_alloc(ctx, 1, sizeof *table);
  if (table == NULL) {
    return;
  }
  table->file = "fuzz";
  table->format = name;
  dea_status status = dea_importer_read(ctx, fuzz_importer(name), file, data, size, table);
  if (status == DEA_OK && table->column_count > 0) {
    status = dea_table_record(ctx, table, NULL, &recording);
  }
  fuzz_check_message(ctx, status);
  dea_recording_destroy(ctx, recording);
  dea_table_destroy(ctx, table);
}

#define FUZZ_IMPORTER(name)                                                                        \
  int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)                                     \
  {                                                                                                \
    fuzz_table(fuzz_begin(), name, "fuzz", data, size);                                            \
    return 0;                                                                                      \
  }
