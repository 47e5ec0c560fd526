/* What the kinds of instruments are made with. */
#pragma once

#include "instrument/instrument.h"
#include "instrument/instrument_list.h"

#define DEA_INSTRUMENT_DECLARE(name)                                                               \
  extern const struct dea_instrument_type dea_instrument_##name;                                   \
  extern const struct dea_record dea_instrument_##name##_record;
DEA_INSTRUMENT_LIST(DEA_INSTRUMENT_DECLARE)
#undef DEA_INSTRUMENT_DECLARE

#define DEA_INSTRUMENT_COUNT(array) (sizeof(array) / sizeof(array)[0])
enum { DEA_INSTRUMENT_READINGS_MAX = 8 };

/* Rows of the kinds' tables; raw: struct that they are read into. */
#define DEA_INSTRUMENT_KIND(raw, usual)                                                            \
  DEA_LABEL_ROW("kind", offsetof(raw, kind), usual, "kind of instrument", .required = true)
#define DEA_INSTRUMENT_LABEL(raw, member, name, text, sample, ...)                                 \
  DEA_LABEL_ROW(name, offsetof(raw, member), sample, text, __VA_ARGS__)
#define DEA_INSTRUMENT_TIME(raw, member, name, text, usual, most)                                  \
  DEA_NUMBER_ROW(name, offsetof(raw, member), "s", usual, text, .above_min = true, .max = most,    \
                 .default_text = usual)
#define DEA_INSTRUMENT_NUMBER(raw, member, name, text, least, most, sample, ...)                   \
  DEA_INTEGER_ROW(name, offsetof(raw, member), sample, text, .min = least, .max = most, __VA_ARGS__)
#define DEA_INSTRUMENT_CHOICE(raw, member, name, text, names, usual)                               \
  DEA_CHOICE_ROW(name, offsetof(raw, member), names, usual, text, .default_text = usual)
#define DEA_INSTRUMENT_PORT(raw, member, name, text, ...)                                          \
  DEA_INSTRUMENT_NUMBER(raw, member, name, text, 1, 65535, "5025", __VA_ARGS__)
/* A list of sections or texts of at most `most`. */
#define DEA_INSTRUMENT_LIST_OF(raw, array, counter, most)                                          \
  .offset = offsetof(raw, array), .list_max = most, .element_size = sizeof((raw *)0)->array[0],    \
  .count_offset = offsetof(raw, counter)
/* How a quantity is called, as in a section of single readings. */
#define DEA_INSTRUMENT_QUANTITY(raw, member)                                                       \
  DEA_CHOICE_ROW("quantity", offsetof(raw, member), dea_channel_names, "force", "what it is",      \
                 .default_text = "other")

/* Adds an error when the names of readings are too long, twice there, or an input's. */
dea_status dea_instrument_check_reading(const struct dea_reader *reader,
                                        const struct dea_protocol *protocol,
                                        const struct dea_label *name,
                                        const struct dea_instrument *sketch);
/* Adds a reading; unit: counts for DEA_CHANNEL_OTHER only. */
void dea_instrument_add_reading(struct dea_instrument *instrument, const struct dea_label *name,
                                const struct dea_choice *kind, const struct dea_label *unit);
/* Adds one of a displacement. */
void dea_instrument_add_displacement(struct dea_instrument *instrument,
                                     const struct dea_label *name);
