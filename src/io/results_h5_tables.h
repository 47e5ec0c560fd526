/* Tables of studies in results.h5. */
#pragma once

#include "base/h5.h"
#include "result/result.h"

/* Both ways: fills an empty group by the table `from`, or (NULL) adds that of the group to the
 * result, its names interned in the context. */
void dea_results_h5_table(struct h5 *h, hid_t group, const char *model,
                          const struct dea_result_table *from, struct dea_result *result);
