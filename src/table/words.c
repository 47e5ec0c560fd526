#include "table/words.h"

#include "base/csv_line.h"
#include "table/word_list.h"

#include <string.h>

enum where { PART, WORD, WHOLE };

static const struct word {
  const char *text;
  enum where where;
  enum dea_word kind;
} words[] = {
#define WORD_ROW(language, text, where, what) {text, where, DEA_WORD_##what},
    DEA_WORD_LIST(WORD_ROW)
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

enum dea_clock_part dea_word_clock(const char *name)
{
  const char *dot = strrchr(name, '.'); // of a struct: data.fs
  const enum dea_word word =
      dea_word_find(dot != NULL ? dot + 1 : name, DEA_WORD_RATE, DEA_WORD_START);
  return word == DEA_WORD_NONE ? DEA_CLOCK_NOTHING
                               : (enum dea_clock_part)(DEA_CLOCK_RATE + (word - DEA_WORD_RATE));
}

bool dea_word_takes_ampere(struct dea_slice name)
{
  bool takes = false;
  for (size_t i = 0; i < WORDS; i++) {
    takes = takes || (words[i].kind == DEA_WORD_AMPERE && dea_slice_is(name, words[i].text));
  }
  return takes;
}
