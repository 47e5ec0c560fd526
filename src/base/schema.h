/* A schema: one table of fields that reads a file, lists its values and prints itself.
 *
 * A record is a section of the file and a struct in C; a field is one key of it and one member.
 * From the same table come the reader (all errors at once, each at its place), the list of values
 * for `dea check`, the tables of `dea schema` and a JSON Schema for editors. */
#pragma once

#include "base/text.h"
#include "base/units.h"
#include "base/value.h"
#include "base/yaml.h"

enum dea_field_kind {
  DEA_FIELD_LABEL,     // struct dea_label: a text of at most DEA_TITLE_SIZE - 1 bytes
  DEA_FIELD_TEXT,      // const char *: a text of any length, lent by the document; NULL when absent
  DEA_FIELD_NUMBER,    // struct dea_quantity: a number in `unit`
  DEA_FIELD_INTEGER,   // struct dea_quantity: a whole number
  DEA_FIELD_INPLANE,   // struct dea_inplane_length: "5 mm stretched" or "5 mm unstretched"
  DEA_FIELD_STRETCHED, // struct dea_quantity: the same, where only the stretched film makes sense
  DEA_FIELD_CHOICE,    // struct dea_choice: one of `choices`, value is its index
  DEA_FIELD_ROWS,      // const struct dea_node *: a list of lists of numbers, for its reader
  DEA_FIELD_RECORD,    // a section; its fields' offsets count from this record's offset
  DEA_FIELD_SECTION,   // const struct dea_node *: a section whose keys another table knows
  DEA_FIELD_SETTINGS,  // void *: a section read into zeroed memory of its own, of element_size
                       // bytes, also where the file has none; owned by the struct
};

struct dea_record;

struct dea_field {
  const char *key;
  const char *alias; // an older word that is read as well; NULL: none
  enum dea_field_kind kind;
  size_t offset;       // of the member in the record's struct
  const char *doc;     // meaning, one clause
  const char *example; // "100 um"; with the unit that suggestions use
  bool required;
  const char *default_text; // as it would be written; NULL: none
  const char *absent_text;  // what an optional field without default then means, for the listing
  /* Alternatives: fields of one group (> 0) with different options exclude each other; at least one
   * option must be there when a field of the group is required. When none is given the defaults of
   * the first option that has any apply. */
  int group, option;

  const char *unit;           // of numbers: SI unit, "1" for a bare number
  double min, max;            // SI, inclusive unless said otherwise; both 0: no limits
  bool above_min, below_max;  // exclusive
  double scale;               // factor on the SI value (0.5: a diameter kept as radius); 0 means 1
  const char *const *choices; // NULL-terminated

  const struct dea_record *record; // of a section
  size_t
      present_offset; // bool member set when it is there; of a DEA_FIELD_RECORD: 0: defaults apply

  /* A list: `list_max` > 0 elements of `element_size` bytes at offset; their number (size_t) at
   * count_offset. */
  size_t list_min, list_max, element_size, count_offset;
  bool own_list;   // at offset is a pointer to the elements, which are owned by the struct
  bool lone;       // a single value stands for a list of one
  bool one_line;   // of a label that is shown: line ends in it become blanks
  bool or_section; // of a label: a section may stand for it, which was replaced before the reading

  /* Of a DEA_FIELD_SECTION: the tables of which one holds, for printing; ended by NULL, NULL: none.
   */
  const struct dea_record *const *kinds;
  bool kinds_elsewhere; // tables for people have them at another field, which `doc` names

  /* Of a key that is none here, but is one of another form of file: what to write instead, for the
   * message; NULL: it is one. */
  const char *elsewhere;
};

/* Choices of a key that is on (1) or off. */
extern const char *const dea_no_yes[];

/* Rows of a table; what else there is to say of a field comes last, by its member. */
#define DEA_LABEL_ROW(name, at, sample, text, ...)                                                 \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_LABEL, .offset = at, .example = sample, .doc = text,            \
    __VA_ARGS__                                                                                    \
  }
#define DEA_NUMBER_ROW(name, at, si, sample, text, ...)                                            \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_NUMBER, .offset = at, .unit = si, .example = sample,            \
    .doc = text, __VA_ARGS__                                                                       \
  }
#define DEA_INTEGER_ROW(name, at, sample, text, ...)                                               \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_INTEGER, .offset = at, .unit = "1", .example = sample,          \
    .doc = text, __VA_ARGS__                                                                       \
  }
#define DEA_CHOICE_ROW(name, at, names, sample, text, ...)                                         \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_CHOICE, .offset = at, .choices = names, .example = sample,      \
    .doc = text, __VA_ARGS__                                                                       \
  }

#define DEA_FIELD_ROW(its_kind, name, at, ...)                                                     \
  {                                                                                                \
    .key = name, .kind = DEA_FIELD_##its_kind, .offset = at, __VA_ARGS__                           \
  }
/* Of such a row: the table of a section within the file. */
#define DEA_ROWS(rows)                                                                             \
  (&(const struct dea_record){.fields = (rows), .field_count = DEA_COUNT(rows)})
/* Of such a row: it is a list, in the struct or in memory of its own. */
#define DEA_LIST(least, most, type, count)                                                         \
  .list_min = least, .list_max = most, .element_size = sizeof(type), .count_offset = count
#define DEA_OWN_LIST(least, most, type, count) DEA_LIST(least, most, type, count), .own_list = true

/* Whether the keys of a section are those of the field's record. */
bool dea_field_has_record(const struct dea_field *field);

struct dea_record {
  const char *name; // of a file, for messages, or of a kind of section; NULL of other sections
  const char *doc;  // the same
  const struct dea_field *fields;
  size_t field_count;
};

/* Field of a dotted key of sections, "film.thickness"; NULL: there is none, or it is in a list.
 * offset: of its member from the record's base; NULL: not wanted. */
const struct dea_field *dea_record_find(const struct dea_record *record, const char *key,
                                        size_t *offset);
/* Whether its numbers have a least and a largest value. */
void dea_field_limits(const struct dea_field *field, bool *lower, bool *upper);
/* Whether its values can change little by little. */
bool dea_field_varies(const struct dea_field *field);

/* One reading of a document. listing: NULL if no list of values is wanted. */
struct dea_reader {
  struct dea_context *ctx;
  struct dea_yaml *yaml;
  struct dea_listing *listing;
};

/* Reads a section into the struct at base, which is zeroed memory. path: its dotted path, "" for
 * the file itself. Errors are findings; the status is DEA_OK also then, and only
 * other failures (memory, unit database) come back. What an error left out is NAN, -1 or NULL: a
 * caller goes on only when the number of errors has not grown. */
dea_status dea_schema_read(const struct dea_reader *reader, const struct dea_record *record,
                           const struct dea_node *node, const char *path, void *base);

/* Adds a value to the reader's list. text: lent for as long as the list. */
dea_status dea_schema_list(const struct dea_reader *reader, const char *path, const char *text,
                           const char *unit, double si, enum dea_origin origin,
                           struct dea_location location);

/* JSON Schema (draft 2020-12) of a record as text, ended by a newline. */
dea_status dea_schema_print_json(struct dea_context *ctx, const struct dea_record *record,
                                 const char *title, struct dea_text *out);
/* The same of a file of two forms, told apart by a key of the first one. */
struct dea_schema_forms {
  const char *key;
  const struct dea_record *with, *without;
};
dea_status dea_schema_print_forms_json(struct dea_context *ctx,
                                       const struct dea_schema_forms *forms, const char *title,
                                       struct dea_text *out);
/* The same as a table for people: plain text for a terminal, or Markdown. */
void dea_schema_print_text(const struct dea_record *record, struct dea_text *out);
void dea_schema_print_markdown(const struct dea_record *record, struct dea_text *out);
/* The dotted paths of the values that are in no list, a line each. */
void dea_schema_print_keys(const struct dea_record *record, struct dea_text *out);
