/* Fuzz target: a saved state of a model that says something else than was saved (fuzz_h5.h). */
#define _GNU_SOURCE // mkdtemp
#include "io/state_file.h"

#include "fuzz_h5.h"

static const double values[] = {1, 2, 3, 4, 5};
static struct dea_state saved;

static bool begin(struct dea_context *ctx)
{
  return dea_state_add(ctx, &saved, "u", values, 5) == DEA_OK &&
         dea_state_add_numbers(ctx, &saved, "model", values, 2) == DEA_OK &&
         dea_state_add_mark(ctx, &saved, "mesh", values, sizeof values) == DEA_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  struct dea_context *ctx = fuzz_context("state.h5", begin);
  struct dea_state out = {0};
  struct dea_state_reach reach;
  if (dea_state_file_write(ctx, "3d", &saved, (struct dea_state_reach){7, 2}, fuzz_path) !=
      DEA_OK) {
    abort();
  }
  fuzz_h5_edit_file(fuzz_path, data, size);
  dea_status counted = dea_state_file_reach(ctx, fuzz_path, &reach);
  if (counted != DEA_OK && dea_context_message(ctx)[0] == '\0') {
    __builtin_trap(); // an error that nobody is told about
  }
  dea_context_clear(ctx);
  dea_status status = dea_state_file_read(ctx, "3d", &saved, fuzz_path, &out);
  if ((status != DEA_OK && dea_context_message(ctx)[0] == '\0') ||
      (status == DEA_OK && out.array_count != saved.array_count) ||
      (size < 3 && (status != DEA_OK || reach.points != 7))) {
    __builtin_trap();
  }
  dea_state_free_values(ctx, &out);
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return 0;
}
