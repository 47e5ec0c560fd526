#include "result/load_point.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double tension_none = -1e-6; // [N/m] below: none; a film free of stress has rounding
static const double locking_near = 0.8;   // of the locking stretch (docs/theory/trust.md)

struct dea_load_point dea_load_point_empty(void)
{
  return (struct dea_load_point){
#define LOAD_POINT_NAN(member, si, display, factor, header, meaning) .member = NAN,
      DEA_LOAD_POINT_LIST(LOAD_POINT_NAN)
#undef LOAD_POINT_NAN
          .stable = true,
      .unstable_modes = 0,
  };
}

#define FLAG_ROW(name, word, kind, sentence) {word, sentence, DEA_FLAG_##kind},
const struct dea_flag_words dea_flag_words[DEA_FLAG_COUNT] = {DEA_FLAG_LIST(FLAG_ROW)};
#undef FLAG_ROW

/* With the size of the slack part where a model knows it: a corner that is slack does not wrinkle.
 */
static bool is_slack(const struct dea_load_point *p)
{
  return isnan(p->compression_ratio) ? p->min_tension_N_per_m < tension_none
                                     : p->compression_ratio >= 1;
}

unsigned dea_load_point_flags(const struct dea_load_point *p)
{
  unsigned flags = p->own_flags;
  flags |= (unsigned)is_slack(p) << DEA_FLAG_SLACK;
  flags |= (unsigned)(!p->stable || p->unstable_modes > 0) << DEA_FLAG_UNSTABLE;
  flags |= (unsigned)(p->locking_share >= locking_near) << DEA_FLAG_LOCKING;
  flags |= (unsigned)(p->range_share > 1) << DEA_FLAG_RANGE;
  flags |= (unsigned)(p->breakdown_margin < 0) << DEA_FLAG_BREAKDOWN;
  return flags;
}

bool dea_flags_have(unsigned flags, enum dea_flag_kind kind)
{
  for (int k = 0; k < DEA_FLAG_COUNT; k++) {
    if ((flags >> k & 1u) != 0 && dea_flag_words[k].kind == kind) {
      return true;
    }
  }
  return false;
}

bool dea_load_point_valid(const struct dea_load_point *point)
{
  return !dea_flags_have(dea_load_point_flags(point), DEA_FLAG_DOUBT);
}

bool dea_load_point_trusted(const struct dea_load_point *point)
{
  return dea_load_point_valid(point) && !dea_load_point_bounds(point);
}

bool dea_load_point_safe(const struct dea_load_point *point)
{
  return !dea_flags_have(dea_load_point_flags(point), DEA_FLAG_DANGER);
}

bool dea_load_point_bounds(const struct dea_load_point *point)
{
  return (dea_load_point_flags(point) >> DEA_FLAG_BOUND & 1u) != 0;
}

bool dea_load_point_is_one_of_several(const struct dea_load_point *point)
{
  const unsigned several = 1u << DEA_FLAG_SLACK | 1u << DEA_FLAG_UNSTABLE | 1u << DEA_FLAG_STATES;
  return (dea_load_point_flags(point) & several) != 0;
}

const char *dea_flags_text(unsigned flags, char out[DEA_FLAGS_SIZE])
{
  size_t n = 0;
  out[0] = '\0';
  for (int k = 0; k < DEA_FLAG_COUNT; k++) {
    if ((flags >> k & 1u) != 0 && n < DEA_FLAGS_SIZE) {
      n += (size_t)snprintf(out + n, DEA_FLAGS_SIZE - n, "%s%s", n > 0 ? " " : "",
                            dea_flag_words[k].word);
    }
  }
  return out;
}

const char *dea_flag_line(enum dea_flag flag, char out[DEA_FLAG_LINE_SIZE])
{
  const struct dea_flag_words *words = &dea_flag_words[flag];
  snprintf(out, DEA_FLAG_LINE_SIZE, "%s%s: %s",
           words->kind == DEA_FLAG_DOUBT ? "not trusted, " : "", words->word, words->sentence);
  return out;
}

unsigned dea_flags_of_text(const char *text)
{
  unsigned flags = 0;
  while (*text != '\0') {
    size_t length = strcspn(text, " ");
    for (int k = 0; k < DEA_FLAG_COUNT; k++) {
      const char *word = dea_flag_words[k].word;
      bool same = strlen(word) == length && memcmp(word, text, length) == 0;
      flags |= (unsigned)same << k;
    }
    text += length + (text[length] == ' ');
  }
  return flags;
}
