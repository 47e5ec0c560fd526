/* Libraries of vendors, loaded when an instrument is opened, since few computers have them. */
#ifndef DEA_LAB_INSTRUMENT_LIBRARY_H
#define DEA_LAB_INSTRUMENT_LIBRARY_H

#include "base/context.h"

/* A function: its name, and where its pointer goes in the table. */
struct dea_library_symbol {
  const char *name;
  size_t offset;
};

/* Loads a library for good (some do not stand being unloaded) and finds all functions. file: name
 * or path. what, advice: for the message ("NI-DAQmx", "it comes with ..."). DEA_E_UNSUPPORTED when
 * it is not there or lacks a function. */
dea_status dea_library_open(struct dea_context *ctx, const char *file, const char *what,
                            const char *advice, const struct dea_library_symbol *symbols,
                            size_t count, void *table);

#endif
