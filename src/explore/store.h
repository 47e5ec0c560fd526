/* The cases that are done, in files that only grow: whole lines, each with a checksum. Whatever
 * ends the program, what was kept stays and counts once; a computer that fails may take the last
 * second with it. */
#pragma once

#include "explore/evaluator.h"

/* Which part of the cases writes into this store, beside other parts: part of parts, from 1. */
struct dea_shard {
  size_t part, parts;
};

struct dea_store;

/* Opens the store in a folder, which is made, and reads what is there of all parts. hash:
 * of what is asked; DEA_E_IO where the folder holds answers to another one, or where another
 * process writes to the same part. shard: NULL: nothing will be written. out: owned by the caller,
 * NULL on failure. */
dea_status dea_store_open(struct dea_context *ctx, const char *folder, const char *hash,
                          const struct dea_evaluator *evaluator, const struct dea_shard *shard,
                          struct dea_store **out);
/* NULL is fine. */
void dea_store_close(struct dea_store *store);
/* Removes the files of a store from a folder. */
dea_status dea_store_remove(struct dea_context *ctx, const char *folder);

/* Adds a case. */
dea_status dea_store_add(struct dea_store *store, const struct dea_case *done);
/* Number of cases, each once, and one of them; lent until the next dea_store_add. */
size_t dea_store_count(const struct dea_store *store);
const struct dea_case *dea_store_get(const struct dea_store *store, size_t index);
/* The case of these numbers, to the bit; NULL: it is not done. Lent as above. */
const struct dea_case *dea_store_find(const struct dea_store *store, const double *p);
/* Lines that were not whole: of a program that was ended as it wrote. */
size_t dea_store_torn(const struct dea_store *store);
