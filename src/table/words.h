/* What a column may be, by words of its name; they are a table in words.c. */
#pragma once

#include "table/slices.h"

enum dea_word {
  DEA_WORD_NONE,
  DEA_WORD_TIME,
  DEA_WORD_COMMAND,
  DEA_WORD_VOLTAGE,
  DEA_WORD_CURRENT,
  DEA_WORD_DISPLACEMENT,
  DEA_WORD_FORCE,
  DEA_WORD_POSITION,
  DEA_WORD_RATE,
  DEA_WORD_INTERVAL,
  DEA_WORD_START,
  DEA_WORD_AMPERE,
  DEA_WORD_UNCERTAINTY
};

/* Kind of the first word of the list that fits a name and is of these; DEA_WORD_NONE: none is. */
enum dea_word dea_word_find(const char *name, enum dea_word first, enum dea_word last);
/* TIME to FORCE, or UNCERTAINTY: of another column, "z std". */
enum dea_word dea_word_of_quantity(const char *name);
/* What a single number of that name says of the clock: RATE [Hz], INTERVAL or START [s]; NONE. */
enum dea_word dea_word_clock(const char *name);
/* Whether 'A' behind that name is a unit without brackets: "channel_A" is no current. */
bool dea_word_takes_ampere(struct dea_slice name);
