/* Where a result comes from: program, libraries, input, time. */
#pragma once

#include "result/result.h"

/* Fills program, compiler, build, libraries and started (now, UTC) and copies the input with its
 * SHA-256. To be called when the work starts. input: bytes of the design file as read.
 * overrides, override_count: as given with --set; command: NULL when there was no command line.
 * What *provenance held before is freed. On DEA_E_MEMORY it stays as it was. */
dea_status dea_provenance_fill(struct dea_context *ctx, const char *input, size_t input_length,
                               const struct dea_override *overrides, size_t override_count,
                               const char *command, struct dea_provenance *provenance);
/* Adds libraries, "PETSc 3.18.5, ...", to those that are there, once. */
void dea_provenance_add_libraries(const char *libraries, struct dea_provenance *provenance);
/* SHA-256 of some bytes in hexadecimal. */
void dea_sha256_hex(const void *bytes, size_t length, char out[65]);
/* The same of a file; "" where it cannot be read. */
void dea_sha256_file(const char *path, char out[65]);
/* Names and versions, found at run time, of the libraries in use: "libyaml 0.2.5, HDF5 1.10.8". */
void dea_libraries_text(char *out, size_t size);
