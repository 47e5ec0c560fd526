/* Fuzz target: results.h5 of a run that says something else than a run would (fuzz_h5.h). */
#define _GNU_SOURCE // mkdtemp
#include "../fake_result.h"
#include "fuzz_h5.h"
#include "io/results_h5.h"

static struct dea_design design;
static struct dea_result *result;

static bool begin(struct dea_context *ctx)
{
  design = fake_design();
  return fake_result(ctx, &design, 1, &result) == DEA_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_context("results.h5", begin);
  struct dea_run *run;
  if (dea_results_h5_write(ctx, result, fuzz_path) != DEA_OK) {
    abort();
  }
  fuzz_h5_edit_file(fuzz_path, data, size);
  dea_status status = dea_run_read(ctx, fuzz_path, &run);
  if ((status != DEA_OK && dea_context_message(ctx)[0] == '\0') || (size < 3 && status != DEA_OK)) {
    __builtin_trap(); // an error that nobody is told about, or one of a good file
  }
  dea_run_destroy(ctx, run);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
