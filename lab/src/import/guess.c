#include "import/guess.h"

#include "table/words.h"

#include <string.h>

int dea_guess_by_name(const char *name)
{
  static const int kinds[] = {
      [DEA_WORD_NONE] = DEA_GUESS_NOTHING,      [DEA_WORD_TIME] = DEA_GUESS_TIME,
      [DEA_WORD_COMMAND] = DEA_CHANNEL_COMMAND, [DEA_WORD_VOLTAGE] = DEA_CHANNEL_VOLTAGE,
      [DEA_WORD_CURRENT] = DEA_CHANNEL_CURRENT, [DEA_WORD_DISPLACEMENT] = DEA_CHANNEL_DISPLACEMENT,
      [DEA_WORD_FORCE] = DEA_CHANNEL_FORCE,     [DEA_WORD_UNCERTAINTY] = DEA_GUESS_UNCERTAINTY,
  };
  return kinds[dea_word_of_quantity(name)];
}

int dea_guess_by_unit(const char *name, const char *si)
{
  if (strcmp(si, "s") == 0) {
    return DEA_GUESS_TIME;
  }
  if (dea_word_find(name, DEA_WORD_POSITION, DEA_WORD_POSITION) != DEA_WORD_NONE) {
    return DEA_GUESS_NOTHING; // where something is, not how it moves
  }
  for (int k = DEA_CHANNEL_VOLTAGE; k < DEA_CHANNEL_OTHER; k++) {
    if (strcmp(si, dea_channel_meanings[k].si_unit) == 0) {
      return k;
    }
  }
  return DEA_GUESS_NOTHING;
}
