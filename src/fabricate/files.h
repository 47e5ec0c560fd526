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
/* Calls for the name of each file, in their order. */
typedef dea_status (*dea_file_sink)(void *user, const char *name);
dea_status dea_workshop_files(const struct dea_workshop *workshop,
                              const struct dea_workshop_options *options, dea_file_sink sink,
                              void *user);
