/* Fuzz target: a file of the catalogue, read and its first sets taken. Its name has to be "fuzz".
 */
#define _GNU_SOURCE // mkdtemp, setenv
#include "fuzz_h5.h"
#include "material/catalogue.h"

static bool begin(struct dea_context *ctx)
{
  (void)ctx;
  return setenv("DEA_MATERIALS", fuzz_folder, 1) == 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_context("fuzz.yaml", begin);
  struct dea_catalogue_entry *entry;
  struct dea_material material;
  FILE *out = fopen(fuzz_path, "wb");
  if (out == NULL || fwrite(data, 1, size, out) != size || fclose(out) != 0) {
    abort();
  }
  dea_status status = dea_catalogue_read(ctx, "fuzz", (struct dea_location){0}, &entry);
  if (status == DEA_OK) {
    const struct dea_material_choice first = {0};
    status = dea_material_select(ctx, &entry->data, &first, &material);
  }
  fuzz_check_findings(ctx, status);
  dea_catalogue_destroy(ctx, entry);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
