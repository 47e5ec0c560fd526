#include "lab/import/guess.h"

#include "base/csv_line.h"
#include "lab/import/guess_list.h"

#include <string.h>

enum where { PART, WORD, WHOLE };
enum {
  IS_TIME = DEA_GUESS_TIME,
  IS_COMMAND = DEA_CHANNEL_COMMAND,
  IS_VOLTAGE = DEA_CHANNEL_VOLTAGE,
  IS_CURRENT = DEA_CHANNEL_CURRENT,
  IS_DISPLACEMENT = DEA_CHANNEL_DISPLACEMENT,
  IS_FORCE = DEA_CHANNEL_FORCE,
  IS_POSITION = DEA_CHANNEL_KINDS,
  IS_RATE,
  IS_INTERVAL,
  IS_START,
  IS_AMPERE,
  IS_UNCERTAINTY,
};

static const struct word {
  const char *text;
  enum where where;
  int kind; // IS_*
} words[] = {
#define WORD_ROW(language, text, where, what) {text, where, IS_##what},
    DEA_GUESS_LIST(WORD_ROW)
#undef WORD_ROW
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

/* The first word from `first` to `last` kind that fits a name; NULL: none does. */
static const struct word *find_word(const char *name, int first, int last)
{
  char folded[DEA_CSV_FIELD_MAX];
  dea_csv_fold(name, folded);
  for (size_t i = 0; i < WORDS; i++) {
    if (words[i].kind >= first && words[i].kind <= last && fits(folded, &words[i])) {
      return &words[i];
    }
  }
  return NULL;
}

int dea_guess_by_name(const char *name)
{
  if (find_word(name, IS_UNCERTAINTY, IS_UNCERTAINTY) != NULL) {
    return DEA_GUESS_UNCERTAINTY;
  }
  const struct word *word = find_word(name, DEA_GUESS_TIME, DEA_CHANNEL_OTHER);
  return word != NULL ? word->kind : DEA_GUESS_NOTHING;
}

int dea_guess_by_unit(const char *name, const char *si)
{
  if (strcmp(si, "s") == 0) {
    return DEA_GUESS_TIME;
  }
  if (find_word(name, IS_POSITION, IS_POSITION) != NULL) {
    return DEA_GUESS_NOTHING; // where something is, not how it moves
  }
  for (int k = DEA_CHANNEL_VOLTAGE; k < DEA_CHANNEL_OTHER; k++) {
    if (strcmp(si, dea_channel_meanings[k].si_unit) == 0) {
      return k;
    }
  }
  return DEA_GUESS_NOTHING;
}

enum dea_clock_part dea_guess_clock(const char *name)
{
  const char *dot = strrchr(name, '.'); // of a struct: data.fs
  const struct word *word = find_word(dot != NULL ? dot + 1 : name, IS_RATE, IS_START);
  return word == NULL ? DEA_CLOCK_NOTHING
                      : (enum dea_clock_part)(DEA_CLOCK_RATE + word->kind - IS_RATE);
}

bool dea_guess_takes_ampere(struct dea_slice name)
{
  bool takes = false;
  for (size_t i = 0; i < WORDS; i++) {
    takes = takes || (words[i].kind == IS_AMPERE && dea_slice_is(name, words[i].text));
  }
  return takes;
}
