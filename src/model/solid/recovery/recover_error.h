/* How far displacements of a mesh are from those of an ever finer one (docs/theory/trust.md). */
#pragma once

#include "model/solid/recovery/recover.h"

enum { DEA_ERRORS_MAX = 4 };

/* A place in the plane of an element, by its local coordinates, whose displacement is read there
 * along a direction. */
struct dea_recover_probe {
  size_t element;
  double at[2], along[3];
};

/* A quantity that is linear in u. */
struct dea_recover_quantity {
  double *z; // answer to the load with its weights [3 node_count]; of dea_solid_errors [dofs], the
             // weights before
  struct dea_recover_probe probes[2]; // where it is read inside of elements
  size_t probe_count;
};

/* error[count]: estimated errors, not negative, of which part [count][element_count] (may be NULL)
 * has what each element adds with its sign. count <= DEA_ERRORS_MAX. mirror: as struct
 * dea_recover_second has it. DEA_E_DOMAIN as dea_recover_volume. */
dea_status dea_recover_errors(struct dea_context *ctx, const struct dea_recover_input *in,
                              const double (*mirror)[3], const struct dea_recover_quantity *of,
                              size_t count, double *error, double *part);
