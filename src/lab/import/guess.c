#include "lab/import/guess.h"

#include "base/csv_line.h"

#include <stdio.h>
#include <string.h>

/* A word of a column's name and what it then is; whole: as a word of its own only. The first one
 * that is found counts. */
struct word {
  const char *text;
  bool whole;
  int kind; // enum dea_channel_kind, or DEA_GUESS_TIME
};

static const struct word words[] = {
    {"timestamp", false, DEA_GUESS_TIME},
    {"time", false, DEA_GUESS_TIME},
    {"zeit", false, DEA_GUESS_TIME},
    {"elapsed", false, DEA_GUESS_TIME},
    {"x value", false, DEA_GUESS_TIME}, // of LabVIEW
    {"t", true, DEA_GUESS_TIME},
    {"command", false, DEA_CHANNEL_COMMAND},
    {"setpoint", false, DEA_CHANNEL_COMMAND},
    {"set point", false, DEA_CHANNEL_COMMAND},
    {"soll", false, DEA_CHANNEL_COMMAND},
    {"reference", false, DEA_CHANNEL_COMMAND},
    {"ao0", true, DEA_CHANNEL_COMMAND},
    {"current", false, DEA_CHANNEL_CURRENT},
    {"strom", false, DEA_CHANNEL_CURRENT},
    {"imon", false, DEA_CHANNEL_CURRENT},
    {"leakage", false, DEA_CHANNEL_CURRENT},
    {"i", true, DEA_CHANNEL_CURRENT},
    {"force", false, DEA_CHANNEL_FORCE},
    {"kraft", false, DEA_CHANNEL_FORCE},
    {"load", false, DEA_CHANNEL_FORCE},
    {"f", true, DEA_CHANNEL_FORCE},
    {"displacement", false, DEA_CHANNEL_DISPLACEMENT},
    {"deflection", false, DEA_CHANNEL_DISPLACEMENT},
    {"auslenkung", false, DEA_CHANNEL_DISPLACEMENT},
    {"laser", false, DEA_CHANNEL_DISPLACEMENT},
    {"weg", false, DEA_CHANNEL_DISPLACEMENT},
    {"position", false, DEA_CHANNEL_DISPLACEMENT},
    {"distance", false, DEA_CHANNEL_DISPLACEMENT},
    {"abstand", false, DEA_CHANNEL_DISPLACEMENT},
    {"stroke", false, DEA_CHANNEL_DISPLACEMENT},
    {"hub", true, DEA_CHANNEL_DISPLACEMENT},
    {"z", true, DEA_CHANNEL_DISPLACEMENT},
    {"w", true, DEA_CHANNEL_DISPLACEMENT},
    {"voltage", false, DEA_CHANNEL_VOLTAGE},
    {"spannung", false, DEA_CHANNEL_VOLTAGE},
    {"vmon", false, DEA_CHANNEL_VOLTAGE},
    {"hv", true, DEA_CHANNEL_VOLTAGE},
    {"v", true, DEA_CHANNEL_VOLTAGE},
    {"u", true, DEA_CHANNEL_VOLTAGE},
    {"v0", true, DEA_CHANNEL_VOLTAGE},
};

static bool is_letter(char c)
{
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (unsigned char)c >= 0x80;
}

static bool holds(const char *name, const struct word *word)
{
  size_t n = strlen(word->text);
  for (const char *at = strstr(name, word->text); at != NULL; at = strstr(at + 1, word->text)) {
    if (!word->whole || ((at == name || !is_letter(at[-1])) && !is_letter(at[n]))) {
      return true;
    }
  }
  return false;
}

int dea_guess_by_name(const char *name)
{
  char folded[DEA_CSV_FIELD_MAX];
  dea_csv_fold(name, folded);
  for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
    if (holds(folded, &words[i])) {
      return words[i].kind;
    }
  }
  return DEA_GUESS_NOTHING;
}

int dea_guess_by_unit(const char *name, const char *si)
{
  static const struct word places[] = {{"x", true, 0}, {"y", true, 0}, {"r", true, 0}};
  char folded[DEA_CSV_FIELD_MAX];
  if (strcmp(si, "s") == 0) {
    return DEA_GUESS_TIME;
  }
  dea_csv_fold(name, folded);
  for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
    if (holds(folded, &places[i])) {
      return DEA_GUESS_NOTHING; // where something is, not how it moves
    }
  }
  for (int k = DEA_CHANNEL_VOLTAGE; k < DEA_CHANNEL_OTHER; k++) {
    if (strcmp(si, dea_channel_meanings[k].si_unit) == 0) {
      return k;
    }
  }
  return DEA_GUESS_NOTHING;
}
