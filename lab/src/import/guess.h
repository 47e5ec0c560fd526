/* What a column may be, by its name and unit; the words of names are in table/words.c. */
#pragma once

#include "import/import.h"

// Beside enum dea_channel_kind; UNCERTAINTY: of another column, "z std".
enum { DEA_GUESS_TIME = -1, DEA_GUESS_NOTHING = -2, DEA_GUESS_UNCERTAINTY = -3 };

int dea_guess_by_name(const char *name);
/* si: SI unit of the column's unit. */
int dea_guess_by_unit(const char *name, const char *si);
