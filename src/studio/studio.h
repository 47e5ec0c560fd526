/* A server for one user on this computer: designs and runs of the current folder in a page
 * (docs/studio.md). */
#pragma once

#include "base/context.h"

/* A design that can be copied into the folder; both lent. */
struct dea_studio_example {
  const char *name; // "devices/lens.yaml"
  const char *path; // to open
};

/* All lent, and constant while the studio is there. */
struct dea_studio_options {
  const char *open;                          // name of the design that is shown first; NULL: none
  const char *program;                       // the command that checks and runs
  int port;                                  // of 127.0.0.1; 0: a free one
  const struct dea_studio_example *examples; // [example_count]
  size_t example_count;
};

struct dea_studio;

/* Starts to serve the current folder, whose files are shown and written, and no others; it stays
 * the current one. DEA_E_IO where the folder or the port cannot be had. out: owned by the caller,
 * NULL on failure. */
dea_status dea_studio_start(struct dea_context *ctx, const struct dea_studio_options *options,
                            struct dea_studio **out);
/* Where the page is, with the secret that all requests need; lent. */
const char *dea_studio_address(const struct dea_studio *studio);
/* A file that only this user can read and that leads a browser there, so that the secret is not in
 * the list of processes; lent. */
const char *dea_studio_doorway(const struct dea_studio *studio);
/* Computes what is asked for, until the context is interrupted. */
void dea_studio_serve(struct dea_studio *studio);
/* Ends it and the runs that it has started, which keep what they have; NULL is fine. */
void dea_studio_stop(struct dea_studio *studio);
