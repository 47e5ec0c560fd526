/* A folder that one process at a time writes into. */
#pragma once

#include "base/context.h"

/* The hidden file that says who writes, while it does. */
#define DEA_FOLDER_LOCK_FILE ".running"

struct dea_folder_lock;

/* Takes a folder that exists. DEA_E_IO where another process has it, with what that process has
 * said of itself. A process that died has none; where the file system knows no locks all may write.
 * out: owned by the caller, NULL on failure. */
dea_status dea_folder_lock(struct dea_context *ctx, const char *directory,
                           struct dea_folder_lock **out);
/* Gives it back and frees it; NULL is fine. */
void dea_folder_unlock(struct dea_context *ctx, struct dea_folder_lock *lock);
