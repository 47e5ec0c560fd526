/* The files of the folder, none outside of it: no "..", no hidden name, no symbolic link. */
#pragma once

#include "base/text.h"

#include <jansson.h>

/* Whether a text is the name of a file in the folder itself, or with `deep` of one below it too. */
bool dea_studio_name_good(const char *name, bool deep);
/* Reads a file of at most max bytes; owned by the caller. folder: open. DEA_E_IO. */
dea_status dea_studio_read(struct dea_context *ctx, int folder, const char *name, size_t max,
                           struct dea_text *out);
/* What changes when a file is written; "" where there is none. */
enum { DEA_STUDIO_STAMP = 64 };
void dea_studio_stamp(int folder, const char *name, char out[DEA_STUDIO_STAMP]);
/* {designs: [{name, stamp}], runs: [{name, stamp, report, state, summary}], tables: [name],
 * folders: [name], sweeps: [{name, stamp}]} in the order of their names; NULL when memory is short.
 * The last two of a run are stamps of what it can go on from, and of how it has ended; sweeps are
 * those over numbers of designs, between which there are values. */
json_t *dea_studio_list(int folder);
/* [name] of the files in a folder of the folder; NULL: there is none. */
json_t *dea_studio_list_in(int folder, const char *name);
