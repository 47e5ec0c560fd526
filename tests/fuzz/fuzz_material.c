/* Fuzz target: a file of the catalogue, read and its first sets taken. Its name has to be "fuzz".
 */
#define _GNU_SOURCE // mkdtemp, setenv
#include "material/catalogue.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[] = "/tmp/fuzz-material-XXXXXX", path[64];

static void remove_folder(void)
{
  remove(path);
  rmdir(folder);
}

/* One context for all inputs: reading the unit table takes longer than reading a material. */
static struct dea_context *context(void)
{
  static struct dea_context *ctx;
  if (ctx == NULL) {
    if (mkdtemp(folder) == NULL || setenv("DEA_MATERIALS", folder, 1) != 0 ||
        dea_context_create(NULL, &ctx) != DEA_OK) {
      abort();
    }
    snprintf(path, sizeof path, "%s/fuzz.yaml", folder);
    atexit(remove_folder);
  }
  return ctx;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = context();
  struct dea_catalogue_entry *entry;
  struct dea_material material;
  FILE *out = fopen(path, "wb");
  if (out == NULL || fwrite(data, 1, size, out) != size || fclose(out) != 0) {
    abort();
  }
  dea_status status = dea_catalogue_read(ctx, "fuzz", (struct dea_location){0}, &entry);
  if (status == DEA_OK) {
    const struct dea_material_choice first = {0};
    status = dea_material_select(ctx, &entry->data, &first, &material);
  }
  if (status == DEA_E_DESIGN && dea_finding_count(ctx, DEA_ERROR) == 0) {
    __builtin_trap(); // an error that nobody is told about
  }
  dea_catalogue_destroy(ctx, entry);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
