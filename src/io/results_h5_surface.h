/* Meshes with fields in results.h5. */
#pragma once

#include "base/h5.h"
#include "result/result.h"

/* Fills an empty group. same: a group with the same places and elements, which then are there only
 * once in the file; negative for none. */
void dea_results_h5_write_surface(struct h5 *h, hid_t group,
                                  const struct dea_surface_record *record, hid_t same);
/* Adds the surface of a group to the result. */
void dea_results_h5_get_surface(struct h5 *h, hid_t group, const char *model,
                                struct dea_result *result);
