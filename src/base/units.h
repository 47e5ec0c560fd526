/* Numbers with a unit, read through udunits2 and converted to SI. */
#pragma once

/* What stands behind a number of a unit, for "%s%s": nothing of "1". */
#define DEA_UNIT_BEHIND(unit)                                                                      \
  (strcmp(unit, "1") == 0 ? "" : " "), (strcmp(unit, "1") == 0 ? "" : (unit))

#include "base/context.h"

/* What is due: a number in a unit. */
struct dea_measure {
  const char *unit;    // SI unit the value is converted to: "m", "Pa", "1" for a bare number
  const char *example; // how a value is written, for messages: "100 um"
};

enum { DEA_WHY_SIZE = 400 };

/* Unit of an example such as "100 um" or "[0 kV, 1 kV]", *length bytes of it; none of a bare
 * number. Lent. */
const char *dea_units_shown(const char *example, size_t *length);

/* Reads "100 um", "2.5 kV", "80 V/um" (or "0.2" where the unit due is "1"; "20 %" only where the
 * example is in percent too), numbers in the C locale. true: *si is finite and in SI. false: why
 * holds a clause that says what is wrong and what to write instead, or the context holds
 * DEA_E_MEMORY or DEA_E_TOOL (no unit database) and why is "". */
bool dea_units_read(struct dea_context *ctx, const char *text, struct dea_measure due, double *si,
                    char why[DEA_WHY_SIZE]);
