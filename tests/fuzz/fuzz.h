/* What targets have in common. */
#pragma once

#include "base/context.h"

#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* One context for all inputs, as reading the unit table takes longer than reading a file, with
 * nothing left of the last one. */
static inline struct dea_context *fuzz_begin(void)
{
  static struct dea_context *ctx;
  if (ctx == NULL && dea_context_create(NULL, &ctx) != DEA_OK) {
    abort();
  }
  dea_finding_clear(ctx);
  dea_context_clear(ctx);
  return ctx;
}

/* An error in a file that nobody is told about, or any other. */
static inline void fuzz_check_findings(const struct dea_context *ctx, dea_status status)
{
  if (status == DEA_E_DESIGN && dea_finding_count(ctx, DEA_ERROR) == 0) {
    __builtin_trap();
  }
}

static inline void fuzz_check_message(const struct dea_context *ctx, dea_status status)
{
  if (status != DEA_OK && dea_context_message(ctx)[0] == '\0') {
    __builtin_trap();
  }
}
