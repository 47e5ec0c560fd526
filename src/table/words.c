#include "table/words.h"

#include "base/csv_line.h"

#include <string.h>

/* Where a word stands in a name: anywhere, as a word of its own, or it is the whole name. */
enum where { PART, WORD, WHOLE };

/* Words in lower case that columns and numbers of files are known by; of those that fit a name the
 * first counts. RATE [Hz] and INTERVAL [s] between samples are of a single number; POSITION: where
 * something is, not how it moves; AMPERE: a bare 'A' behind it is a unit; UNCERTAINTY: how far the
 * rest of the name may be off, whatever that is. */
static const struct word {
  const char *text;
  enum where where;
  enum dea_word kind;
} words[] = {
    {"std", WORD, DEA_WORD_UNCERTAINTY},
    {"stdev", WORD, DEA_WORD_UNCERTAINTY},
    {"stddev", WORD, DEA_WORD_UNCERTAINTY},
    {"sd", WORD, DEA_WORD_UNCERTAINTY},
    {"sem", WORD, DEA_WORD_UNCERTAINTY},
    {"deviation", WORD, DEA_WORD_UNCERTAINTY},
    {"error", WORD, DEA_WORD_UNCERTAINTY},
    {"err", WORD, DEA_WORD_UNCERTAINTY},
    {"uncertainty", WORD, DEA_WORD_UNCERTAINTY},
    {"standardabweichung", WORD, DEA_WORD_UNCERTAINTY},
    {"fehler", WORD, DEA_WORD_UNCERTAINTY},
    {"unsicherheit", WORD, DEA_WORD_UNCERTAINTY},
    {"sigma", WORD, DEA_WORD_UNCERTAINTY},
    {"\xcf\x83", WORD, DEA_WORD_UNCERTAINTY}, // the letter
    {"timestamp", PART, DEA_WORD_TIME},
    {"time", PART, DEA_WORD_TIME},
    {"zeit", PART, DEA_WORD_TIME},
    {"elapsed", PART, DEA_WORD_TIME},
    {"x value", PART, DEA_WORD_TIME}, // of LabVIEW
    {"t", WORD, DEA_WORD_TIME},
    {"command", PART, DEA_WORD_COMMAND},
    {"setpoint", PART, DEA_WORD_COMMAND},
    {"set point", PART, DEA_WORD_COMMAND},
    {"soll", PART, DEA_WORD_COMMAND},
    {"reference", PART, DEA_WORD_COMMAND},
    {"ao0", WORD, DEA_WORD_COMMAND},
    {"current", PART, DEA_WORD_CURRENT},
    {"strom", PART, DEA_WORD_CURRENT},
    {"imon", PART, DEA_WORD_CURRENT},
    {"leakage", PART, DEA_WORD_CURRENT},
    {"i", WORD, DEA_WORD_CURRENT},
    {"force", PART, DEA_WORD_FORCE},
    {"kraft", PART, DEA_WORD_FORCE},
    {"load", PART, DEA_WORD_FORCE},
    {"f", WORD, DEA_WORD_FORCE},
    {"displacement", PART, DEA_WORD_DISPLACEMENT},
    {"deflection", PART, DEA_WORD_DISPLACEMENT},
    {"auslenkung", PART, DEA_WORD_DISPLACEMENT},
    {"laser", PART, DEA_WORD_DISPLACEMENT},
    {"weg", PART, DEA_WORD_DISPLACEMENT},
    {"position", PART, DEA_WORD_DISPLACEMENT},
    {"distance", PART, DEA_WORD_DISPLACEMENT},
    {"abstand", PART, DEA_WORD_DISPLACEMENT},
    {"stroke", PART, DEA_WORD_DISPLACEMENT},
    {"hub", WORD, DEA_WORD_DISPLACEMENT},
    {"z", WORD, DEA_WORD_DISPLACEMENT},
    {"w", WORD, DEA_WORD_DISPLACEMENT},
    {"voltage", PART, DEA_WORD_VOLTAGE},
    {"spannung", PART, DEA_WORD_VOLTAGE},
    {"vmon", PART, DEA_WORD_VOLTAGE},
    {"hv", WORD, DEA_WORD_VOLTAGE},
    {"v", WORD, DEA_WORD_VOLTAGE},
    {"u", WORD, DEA_WORD_VOLTAGE},
    {"v0", WORD, DEA_WORD_VOLTAGE},
    {"x", WORD, DEA_WORD_POSITION},
    {"y", WORD, DEA_WORD_POSITION},
    {"r", WORD, DEA_WORD_POSITION},
    {"fs", WHOLE, DEA_WORD_RATE},
    {"sr", WHOLE, DEA_WORD_RATE},
    {"rate", WHOLE, DEA_WORD_RATE},
    {"sample rate", WHOLE, DEA_WORD_RATE},
    {"samplerate", WHOLE, DEA_WORD_RATE},
    {"sampling rate", WHOLE, DEA_WORD_RATE},
    {"samplingrate", WHOLE, DEA_WORD_RATE},
    {"sampling frequency", WHOLE, DEA_WORD_RATE},
    {"sample frequency", WHOLE, DEA_WORD_RATE},
    {"samples per second", WHOLE, DEA_WORD_RATE},
    {"abtastrate", WHOLE, DEA_WORD_RATE},
    {"dt", WHOLE, DEA_WORD_INTERVAL},
    {"ts", WHOLE, DEA_WORD_INTERVAL},
    {"tstart", WHOLE, DEA_WORD_START},
    {"tinterval", WHOLE, DEA_WORD_INTERVAL},
    {"delta t", WHOLE, DEA_WORD_INTERVAL},
    {"interval", WHOLE, DEA_WORD_INTERVAL},
    {"sample interval", WHOLE, DEA_WORD_INTERVAL},
    {"sampling interval", WHOLE, DEA_WORD_INTERVAL},
    {"sample period", WHOLE, DEA_WORD_INTERVAL},
    {"sampling period", WHOLE, DEA_WORD_INTERVAL},
    {"abtastintervall", WHOLE, DEA_WORD_INTERVAL},
    {"i", WHOLE, DEA_WORD_AMPERE},
    {"current", WHOLE, DEA_WORD_AMPERE},
    {"strom", WHOLE, DEA_WORD_AMPERE},
};
enum { WORDS = sizeof words / sizeof words[0] };

static bool is_letter(char c)
{
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || (unsigned char)c >= 0x80;
}

/* name: folded. */
static bool fits(const char *name, const struct word *word)
{
  size_t n = strlen(word->text);
  if (word->where == WHOLE) {
    return strcmp(name, word->text) == 0;
  }
  for (const char *at = strstr(name, word->text); at != NULL; at = strstr(at + 1, word->text)) {
    if (word->where == PART || ((at == name || !is_letter(at[-1])) && !is_letter(at[n]))) {
      return true;
    }
  }
  return false;
}

enum dea_word dea_word_find(const char *name, enum dea_word first, enum dea_word last)
{
  char folded[DEA_CSV_FIELD_MAX];
  dea_csv_fold(name, folded);
  for (size_t i = 0; i < WORDS; i++) {
    if (words[i].kind >= first && words[i].kind <= last && fits(folded, &words[i])) {
      return words[i].kind;
    }
  }
  return DEA_WORD_NONE;
}

enum dea_word dea_word_of_quantity(const char *name)
{
  return dea_word_find(name, DEA_WORD_UNCERTAINTY, DEA_WORD_UNCERTAINTY) != DEA_WORD_NONE
             ? DEA_WORD_UNCERTAINTY
             : dea_word_find(name, DEA_WORD_TIME, DEA_WORD_FORCE);
}

enum dea_word dea_word_clock(const char *name)
{
  const char *dot = strrchr(name, '.'); // of a struct: data.fs
  return dea_word_find(dot != NULL ? dot + 1 : name, DEA_WORD_RATE, DEA_WORD_START);
}

bool dea_word_takes_ampere(struct dea_slice name)
{
  bool takes = false;
  for (size_t i = 0; i < WORDS; i++) {
    takes = takes || (words[i].kind == DEA_WORD_AMPERE && dea_slice_is(name, words[i].text));
  }
  return takes;
}
