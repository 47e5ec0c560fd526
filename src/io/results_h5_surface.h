/* Meshes with fields in results.h5. */
#pragma once

#include "base/h5.h"
#include "result/result.h"

/* Both ways: fills an empty group by the record, or adds that of the group to the result, of the
 * model that the record names, at its point where the group does not say one. same: a group that is
 * written with the same places and elements, which then are there only once in the file; negative
 * for none. */
void dea_results_h5_surface(struct h5 *h, hid_t group, hid_t same, struct dea_result *result,
                            struct dea_surface_record *record);
