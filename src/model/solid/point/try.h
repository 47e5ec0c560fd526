/* Failures that are passed on after a clean-up, without a context, or for want of memory. */
#pragma once

#include "base/context.h"

/* DEA_TRY, after `otherwise`, an expression that frees what the function has made. */
#define DEA_TRY_ELSE(ctx, call, otherwise)                                                         \
  do {                                                                                             \
    dea_status dea_try_status_ = (call);                                                           \
    if (dea_try_status_ != DEA_OK) {                                                               \
      (otherwise);                                                                                 \
      return dea_fail_chain((ctx), dea_try_status_, __func__, __FILE__, __LINE__);                 \
    }                                                                                              \
  } while (0)
/* Returns the status of `call` from a function that has no context, unless it is DEA_OK. */
#define DEA_TRY_STATUS(call)                                                                       \
  do {                                                                                             \
    dea_status dea_try_status_ = (call);                                                           \
    if (dea_try_status_ != DEA_OK) {                                                               \
      return dea_try_status_;                                                                      \
    }                                                                                              \
  } while (0)
/* Returns DEA_E_MEMORY, which the context knows of, where there is not what was asked for. */
#define DEA_NEED(there)                                                                            \
  do {                                                                                             \
    if (!(there)) {                                                                                \
      return DEA_E_MEMORY;                                                                         \
    }                                                                                              \
  } while (0)
