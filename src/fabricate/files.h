/* The folder of files for the workshop. */
#pragma once

#include "fabricate/workshop.h"

struct dea_workshop_options {
  bool force;        // replace files that are there
  bool drawing_only; // drawing.* and nothing else
};

/* To be asked first: DEA_E_IO when the folder holds a file of a name that would be written and
 * force is not set, or when it cannot be made. Makes the folder. */
dea_status dea_workshop_prepare(struct dea_context *ctx, const struct dea_workshop *workshop,
                                const char *directory, const struct dea_workshop_options *options);
/* Writes all files, each as a whole. */
dea_status dea_workshop_write(struct dea_context *ctx, const struct dea_workshop *workshop,
                              const char *directory, const struct dea_workshop_options *options);
/* Name of the i-th file, in the order of writing; false beyond the last. */
enum { DEA_WORKSHOP_NAME_SIZE = DEA_PART_NAME_SIZE + 8 };
bool dea_workshop_file(const struct dea_workshop *workshop,
                       const struct dea_workshop_options *options, size_t i,
                       char out[DEA_WORKSHOP_NAME_SIZE]);
