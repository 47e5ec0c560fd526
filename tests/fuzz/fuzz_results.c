/* Fuzz target: results.h5 of a run that says something else than a run would (fuzz_h5.h). */
#define _GNU_SOURCE // mkdtemp
#include "../fake_result.h"
#include "fuzz_h5.h"
#include "output/results_h5.h"

#include <stdlib.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[] = "/tmp/fuzz-results-XXXXXX", path[64];
static struct dea_design design;
static struct dea_result *result;

static void remove_folder(void)
{
  remove(path);
  rmdir(folder);
}

/* One context for all inputs: reading the unit table takes longer than reading a file. */
static struct dea_context *context(void)
{
  static struct dea_context *ctx;
  if (ctx == NULL) {
    if (mkdtemp(folder) == NULL || dea_context_create(NULL, &ctx) != DEA_OK) {
      abort();
    }
    snprintf(path, sizeof path, "%s/results.h5", folder);
    atexit(remove_folder);
    design = fake_design();
    if (fake_result(ctx, &design, 1, &result) != DEA_OK) {
      abort();
    }
  }
  return ctx;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = context();
  struct dea_run *run;
  if (dea_results_h5_write(ctx, result, path) != DEA_OK) {
    abort();
  }
  fuzz_h5_edit_file(path, data, size);
  dea_status status = dea_run_read(ctx, path, &run);
  if ((status != DEA_OK && dea_context_message(ctx)[0] == '\0') || (size < 3 && status != DEA_OK)) {
    __builtin_trap(); // an error that nobody is told about, or one of a good file
  }
  dea_run_destroy(ctx, run);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
