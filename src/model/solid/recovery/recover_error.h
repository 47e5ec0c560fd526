/* How far displacements of a mesh are from those of an ever finer one (docs/theory/trust.md). */
#ifndef DEA_MODEL_SOLID_RECOVERY_RECOVER_ERROR_H
#define DEA_MODEL_SOLID_RECOVERY_RECOVER_ERROR_H

#include "model/solid/recovery/recover.h"

enum { DEA_ERRORS_MAX = 4 };

/* error[count]: estimated errors, not negative, of which part [count][element_count] (may be NULL)
 * has what each element adds with its sign, of quantities that are linear in u, whose dual
 * displacements z [count][3 node_count] are the answers to the load that has their weights. count
 * <= DEA_ERRORS_MAX. mirror: as struct dea_recover_second has it. DEA_E_DOMAIN as
 * dea_recover_volume. */
dea_status dea_recover_errors(struct dea_context *ctx, const struct dea_recover_input *in,
                              const double (*mirror)[3], const double *const *z, size_t count,
                              double *error, double *part);

#endif
