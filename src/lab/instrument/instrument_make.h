/* What the kinds of instruments are made with. */
#ifndef DEA_LAB_INSTRUMENT_INSTRUMENT_MAKE_H
#define DEA_LAB_INSTRUMENT_INSTRUMENT_MAKE_H

#include "lab/instrument/instrument.h"
#include "lab/instrument/instrument_list.h"

#define DEA_INSTRUMENT_DECLARE(name)                                                               \
  extern const struct dea_instrument_type dea_instrument_##name;                                   \
  extern const struct dea_record dea_instrument_##name##_record;
DEA_INSTRUMENT_LIST(DEA_INSTRUMENT_DECLARE)
#undef DEA_INSTRUMENT_DECLARE

#define DEA_INSTRUMENT_COUNT(array) (sizeof(array) / sizeof(array)[0])
enum { DEA_INSTRUMENT_READINGS_MAX = 8 };

/* Rows of the kinds' tables; raw: struct that they are read into. */
#define DEA_INSTRUMENT_KIND(raw, usual)                                                            \
  {                                                                                                \
    .key = "kind", .kind = DEA_FIELD_LABEL, .offset = offsetof(raw, kind), .required = true,       \
    .doc = "kind of instrument", .example = usual                                                  \
  }
#define DEA_INSTRUMENT_LABEL(raw, member, name, text, sample, ...)                                 \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_LABEL, .offset = offsetof(raw, member), .doc = text,            \
    .example = sample, __VA_ARGS__                                                                 \
  }
#define DEA_INSTRUMENT_TIME(raw, member, name, text, usual, most)                                  \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = offsetof(raw, member), .unit = "s",           \
    .above_min = true, .max = most, .doc = text, .default_text = usual, .example = usual           \
  }
#define DEA_INSTRUMENT_NUMBER(raw, member, name, text, least, most, sample, ...)                   \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_INTEGER, .offset = offsetof(raw, member), .unit = "1",          \
    .min = least, .max = most, .doc = text, .example = sample, __VA_ARGS__                         \
  }
#define DEA_INSTRUMENT_CHOICE(raw, member, name, text, names, usual)                               \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_CHOICE, .offset = offsetof(raw, member), .choices = names,      \
    .doc = text, .default_text = usual, .example = usual                                           \
  }
#define DEA_INSTRUMENT_PORT(raw, member, name, text, ...)                                          \
  DEA_INSTRUMENT_NUMBER(raw, member, name, text, 1, 65535, "5025", __VA_ARGS__)
/* A list of sections or texts of at most `most`. */
#define DEA_INSTRUMENT_LIST_OF(raw, array, counter, most)                                          \
  .offset = offsetof(raw, array), .list_max = most, .element_size = sizeof((raw *)0)->array[0],    \
  .count_offset = offsetof(raw, counter)
/* How a quantity is called, as in a section of single readings. */
#define DEA_INSTRUMENT_QUANTITY(raw, member)                                                       \
  {                                                                                                \
    .key = "quantity", .kind = DEA_FIELD_CHOICE, .offset = offsetof(raw, member),                  \
    .choices = dea_channel_names, .default_text = "other", .doc = "what it is", .example = "force" \
  }

/* Adds an error when the names of readings are too long, twice there, or an input's. */
dea_status dea_instrument_check_reading(const struct dea_reader *reader,
                                        const struct dea_protocol *protocol,
                                        const struct dea_label *name,
                                        const struct dea_instrument *sketch);
/* Adds a reading; unit: counts for DEA_CHANNEL_OTHER only. */
void dea_instrument_add_reading(struct dea_instrument *instrument, const struct dea_label *name,
                                const struct dea_choice *kind, const struct dea_label *unit);

#endif
