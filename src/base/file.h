/* Files read whole, and their names. */
#pragma once

#include "base/context.h"

/* Reads a regular file of at most max bytes. bytes: owned by the caller (dea_free), NUL-terminated.
 * Missing, unreadable, a directory, a pipe or a device: DEA_E_IO, without ever waiting. Larger than
 * max: DEA_E_DESIGN after a finding, without reading it. */
dea_status dea_file_read(struct dea_context *ctx, const char *file, size_t max, char **bytes,
                         size_t *length);

/* Nothing where a file of that name can be written or replaced; DEA_E_IO where a pipe, a socket or
 * a device has it, or a name in /dev that leads to what the program was started with. */
dea_status dea_path_check_target(struct dea_context *ctx, const char *path);
/* Whether two names are of one file that exists. */
bool dea_path_is_same(const char *a, const char *b);

/* The first bytes of a file; *length: how many there are, at most size. false: it is no regular
 * file, or cannot be opened.
 */
bool dea_file_head(const char *path, void *head, size_t size, size_t *length);
/* Whether a file's first bytes are those of HDF5. */
bool dea_head_is_h5(const void *head, size_t length);

/* Name of a file without its folder; lent. */
const char *dea_path_name(const char *path);
/* That name without its ending, which is `length` bytes of it. */
const char *dea_path_stem(const char *path, size_t *length);
/* Whether a name ends so, in letters of either case: ".dxf". */
bool dea_path_ends_with(const char *path, const char *ending);
/* Path of a file that is named in another one: it counts from that one's folder. Owned by the
 * caller (dea_free); NULL on failure. */
char *dea_path_beside(struct dea_context *ctx, const char *file, const char *name);
