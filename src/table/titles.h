/* Titles of columns: names, units, what they look like. */
#pragma once

#include "base/context.h"
#include "table/slices.h"

/* SI unit of a unit as people write it ("kV", "Volts", "µm") and the factor to it; NULL when it is
 * none, or one with an offset such as °C. */
const char *dea_title_unit(struct dea_context *ctx, const char *unit, double *factor);
/* The same for a piece of text; units without a factor ("°C", "a.u.", "-") count too. */
bool dea_title_is_unit(struct dea_context *ctx, struct dea_slice unit);

/* Parts "Voltage (kV)", "Voltage [kV]", "Voltage / kV", "Voltage in kV", "voltage_kV" into name and
 * unit; the unit is empty when there is none that is known, the name in "in s". */
void dea_title_split(struct dea_context *ctx, struct dea_slice title, struct dea_slice *name,
                     struct dea_slice *unit);
/* Whether a name ends with brackets around what seems to be a unit, though none that is known:
 * "Voltage (kVpp)", "Current (ma)", "z (m/s)", "Time (mS)". */
bool dea_title_has_odd_unit(const char *name);
/* A line of titles into exactly `count` of them; separator ' ': parted by two blanks, or by one
 * where no bracket is open, or by the end of a bracket. false when there are more or less. */
bool dea_titles_part(struct dea_slice line, char separator, size_t count, struct dea_slice *out);
