/* Tables of studies in results.h5. */
#pragma once

#include "base/h5.h"
#include "result/result.h"

/* Fills an empty group. */
void dea_results_h5_write_table(struct h5 *h, hid_t group, const struct dea_result_table *table);
/* Adds the table of a group to the result; its names are interned in the context. */
void dea_results_h5_get_table(struct h5 *h, hid_t group, const char *model,
                              struct dea_result *result);
