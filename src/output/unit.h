/* Units of measurement files, by udunits2. */
#ifndef DEA_OUTPUT_UNIT_H
#define DEA_OUTPUT_UNIT_H

#include "base/context.h"

struct dea_unit_table; // the unit database

/* DEA_E_IO when the database of udunits2 cannot be read. out: owned by the caller. */
dea_status dea_unit_table_create(struct dea_context *ctx, struct dea_unit_table **out);
void dea_unit_table_destroy(struct dea_context *ctx, struct dea_unit_table *table);

enum dea_unit_match { DEA_UNIT_FITS, DEA_UNIT_UNKNOWN, DEA_UNIT_OTHER_DIMENSION };

/* Factor that takes a number in `unit` ("um", "%") to `si_unit` ("m", "1"). */
enum dea_unit_match dea_unit_factor(const struct dea_unit_table *table, const char *unit,
                                    const char *si_unit, double *factor);

#endif
