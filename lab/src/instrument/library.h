/* Libraries of vendors, loaded when an instrument is opened, since few computers have them. */
#pragma once

#include "base/schema.h"

/* A function: its name, and where its pointer goes in the table. */
struct dea_library_symbol {
  const char *name;
  size_t offset;
};

/* Whether a protocol may name that file: loading it runs its code, and protocols come from
 * elsewhere. Only `usual` is, and what the user's own list has: `libraries` of instruments.yaml in
 * $XDG_CONFIG_HOME/dea or ~/.config/dea, as a name or a whole path. Otherwise, and for errors of
 * that list, an error finding. */
dea_status dea_library_check(const struct dea_reader *reader, const struct dea_label *file,
                             const char *usual);

/* Loads a library for good (some do not stand being unloaded) and finds all functions. file: name
 * or path. what, advice: for the message ("NI-DAQmx", "it comes with ..."). DEA_E_UNSUPPORTED when
 * it is not there or lacks a function. */
dea_status dea_library_open(struct dea_context *ctx, const char *file, const char *what,
                            const char *advice, const struct dea_library_symbol *symbols,
                            size_t count, void *table);
