/* What a column may be, by its name and unit; the words of names are a table, guess_list.h. */
#ifndef DEA_LAB_IMPORT_GUESS_H
#define DEA_LAB_IMPORT_GUESS_H

#include "lab/import/import.h"
#include "lab/import/slices.h"

// Beside enum dea_channel_kind; UNCERTAINTY: of another column, "z std".
enum { DEA_GUESS_TIME = -1, DEA_GUESS_NOTHING = -2, DEA_GUESS_UNCERTAINTY = -3 };

int dea_guess_by_name(const char *name);
/* si: SI unit of the column's unit. */
int dea_guess_by_unit(const char *name, const char *si);
/* What a single number of that name says of the clock: a rate [Hz], an interval or a start [s]. */
enum dea_clock_part { DEA_CLOCK_NOTHING, DEA_CLOCK_RATE, DEA_CLOCK_INTERVAL, DEA_CLOCK_START };
enum dea_clock_part dea_guess_clock(const char *name);
/* Whether 'A' behind that name is a unit without brackets: "channel_A" is no current. */
bool dea_guess_takes_ampere(struct dea_slice name);

#endif
